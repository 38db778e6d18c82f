"""The rest of the page: the map panel, the tabs after the first, the layers on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.entries import Entry
from paminsa_viz.explorer.panels.accuracy_panel import ACCURACY
from paminsa_viz.explorer.panels.balance_panel import BALANCE
from paminsa_viz.explorer.panels.compare_panel import COMPARE
from paminsa_viz.explorer.panels.design_panel import DESIGN
from paminsa_viz.explorer.panels.drives_panel import DRIVES
from paminsa_viz.explorer.panels.file_panel import FILE
from paminsa_viz.explorer.panels.identify_panel import IDENTIFY
from paminsa_viz.explorer.panels.loads_panel import LOADS
from paminsa_viz.explorer.panels.maps_panel import MapsPanel
from paminsa_viz.explorer.panels.motion_panel import MOTION
from paminsa_viz.explorer.panels.requirements_panel import REQUIREMENTS
from paminsa_viz.explorer.panels.stiffness_panel import STIFFNESS
from paminsa_viz.explorer.panels.synthesize_panel import SYNTHESIZE
from paminsa_viz.explorer.panels.view_panel import register_commands, view_entries
from paminsa_viz.explorer.scene.layers import SceneContext, build_views
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.tab_store import TabStore

TABS: dict[str, Sequence[Entry]] = {
    "Design": DESIGN, "Balance": BALANCE, "Motion": MOTION, "Drives": DRIVES, "Loads": LOADS,
    "Accuracy": ACCURACY, "Stiffness": STIFFNESS, "Identify": IDENTIFY,
    "Requirements": REQUIREMENTS, "Synthesize": SYNTHESIZE, "Compare": COMPARE, "File": FILE,
}  # fmt: skip
"""What the tabs hold; that of the tab View follows the layers."""


def build_tabs(session: Session, places: Mapping[str, Any], context: SceneContext) -> None:
    """Fill the tabs and add their views to the session, which draws them with its next state.

    Args:
        session: The tab of the browser.
        places: The empty tabs by name, see `paminsa_viz.explorer.page.LATER_TABS`.
        context: What the layers of the scene are made with.
    """
    maps = MapsPanel(session)
    views: dict[str, Panel] = {}
    for name, entries in (TABS | {"View": view_entries()}).items():
        with places[name]:
            views[name] = Panel(session, entries, name)
    compare, files = views.pop("Compare"), views.pop("File")
    session.fast += views.values()
    floor = build_views(replace(context, maps=maps.store, legend=maps.legend), animated=False)
    session.deferred += [maps, *floor, maps.legend, compare, files, TabStore(session.bridge)]
    register_commands(session)
