"""The rest of the page: the map panel, the tabs after the first, the layers on the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.clearing import ClearanceChecker
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels.accuracy_panel import ACCURACY
from paminsa_viz.explorer.panels.balance_panel import BalancePanel
from paminsa_viz.explorer.panels.compare_panel import COMPARE
from paminsa_viz.explorer.panels.design_panel import DESIGN
from paminsa_viz.explorer.panels.drives_panel import DRIVES
from paminsa_viz.explorer.panels.file_panel import EXAMPLE, FILE, receive_example
from paminsa_viz.explorer.panels.identify_panel import identify_entries
from paminsa_viz.explorer.panels.loads_panel import loads_entries
from paminsa_viz.explorer.panels.maps_panel import MapsPanel
from paminsa_viz.explorer.panels.motion_panel import MotionPanel
from paminsa_viz.explorer.panels.requirements_panel import RequirementsPanel
from paminsa_viz.explorer.panels.stiffness_panel import STIFFNESS
from paminsa_viz.explorer.panels.synthesize_panel import SynthesizePanel
from paminsa_viz.explorer.panels.view_panel import register_commands, view_entries
from paminsa_viz.explorer.scene.layers import SceneContext, build_views
from paminsa_viz.explorer.scene.legend import SceneLegend
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.tab_store import TabStore


def build_tabs(
    session: Session, bridge: Bridge, places: Mapping[str, Any], context: SceneContext
) -> None:
    """Fill the tabs and add their views to the session, which draws them with its next state.

    Args:
        session: The tab of the browser.
        bridge: Scripts to it and messages from it.
        places: The empty tabs by name, see `paminsa_viz.explorer.page.LATER_TABS`.
        context: What the layers of the scene are made with.
    """
    motions = context.motions or MotionStore()
    legend = SceneLegend(bridge)
    maps = MapsPanel(session, bridge, motions, legend)
    with places["Design"]:
        design = Panel(session, DESIGN)
    with places["Balance"]:
        balance = BalancePanel(session, bridge)
    with places["Motion"]:
        motion = MotionPanel(session, bridge, motions)
    with places["Drives"]:
        drives = Panel(session, DRIVES)
    with places["Loads"]:
        loads = Panel(session, loads_entries(motions))
    with places["Accuracy"]:
        accuracy = Panel(session, ACCURACY)
    with places["Stiffness"]:
        stiffness = Panel(session, STIFFNESS)
    with places["Identify"]:
        identify = Panel(session, identify_entries())
    with places["Requirements"]:
        requirements = RequirementsPanel(session, bridge)
    with places["Synthesize"]:
        synthesize = SynthesizePanel(session, bridge)
    with places["Compare"]:
        compare = Panel(session, COMPARE)
    with places["View"]:
        view = Panel(session, view_entries())
    with places["File"]:
        files = Panel(session, FILE)
        bridge.on(EXAMPLE, partial(receive_example, session))
    session.fast += [design, balance, motion, drives, loads, accuracy, stiffness, identify, view]
    session.fast += [requirements, synthesize]
    floor = build_views(replace(context, maps=maps.store, legend=legend), animated=False)
    session.deferred += [maps, *floor, legend, compare, files, TabStore(bridge)]
    session.deferred.append(ClearanceChecker(session, motions))
    register_commands(session)
