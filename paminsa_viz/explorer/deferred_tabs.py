"""The rest of the page: the map panel, the tabs after the first, the layers on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.entries import Entry
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
    legend = SceneLegend(bridge)
    maps = MapsPanel(session, bridge, legend)
    tables: dict[str, Sequence[Entry]] = {
        "Design": DESIGN, "Drives": DRIVES, "Loads": loads_entries(), "Accuracy": ACCURACY,
        "Stiffness": STIFFNESS, "Identify": identify_entries(), "Compare": COMPARE,
        "View": view_entries(), "File": FILE,
    }  # fmt: skip
    panels = {
        "Balance": BalancePanel,
        "Requirements": RequirementsPanel,
        "Synthesize": SynthesizePanel,
    }
    views: dict[str, Panel] = {}
    for name, entries in tables.items():
        with places[name]:
            views[name] = Panel(session, entries)
    for name, make in panels.items():
        with places[name]:
            views[name] = make(session, bridge)
    with places["Motion"]:
        views["Motion"] = MotionPanel(session, bridge)
    for name, panel in views.items():
        panel.tab = name
    bridge.on(EXAMPLE, partial(receive_example, session))
    compare, files = views.pop("Compare"), views.pop("File")
    session.fast += views.values()
    floor = build_views(replace(context, maps=maps.store, legend=legend), animated=False)
    session.deferred += [maps, *floor, legend, compare, files, TabStore(bridge)]
    register_commands(session)
