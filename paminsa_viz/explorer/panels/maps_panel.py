"""The floating panel: torque maps, the map of one quantity, the motion's curves, the export."""

from __future__ import annotations

from typing import Any

import viser

from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.browser.bridge import Bridge, Slots
from paminsa_viz.explorer.browser.style import MARGIN
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import finite
from paminsa_viz.explorer.maps import MapStore, go_to
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels.export_panel import export_entries
from paminsa_viz.explorer.panels.map_controls import single_entries, torque_entries
from paminsa_viz.explorer.panels.map_picture import MapPicture
from paminsa_viz.explorer.panels.motion_chart import PLACE as MOTION_SLOT
from paminsa_viz.explorer.panels.motion_plots import MotionPlots
from paminsa_viz.explorer.session import Session
from paminsa_viz.quantities import TORQUES

TORQUE_SLOT, SINGLE_SLOT = "torques", "single"


class MapsPanel:
    """Four tabs over the 3D view: torque maps, single map, motion plots, export.

    Attributes:
        store: Where the maps come from; the floor map can share it.
    """

    def __init__(self, session: Session, bridge: Bridge, motions: MotionStore) -> None:
        client = session.client
        self._session = session
        self.store = MapStore()
        width = session.panel_width
        slots = Slots(session, bridge, {TORQUE_SLOT: width, SINGLE_SLOT: 0, MOTION_SLOT: 0})
        panel = client.gui.add_panel()
        with panel.add_tab("Torque maps", viser.Icon.CHART_GRID_DOTS):
            self._torques = MapPicture(
                session, self.store, slots, TORQUE_SLOT, lambda _: TORQUES, "below", motions
            )
            self._torque_inputs = Panel(session, torque_entries("torque maps", self._torques))
        with panel.add_tab("Single map", viser.Icon.SQUARE_ROUNDED):
            self._single = MapPicture(
                session, self.store, slots, SINGLE_SLOT, lambda s: (s.map_view.quantity,),
                "right", motions,
            )  # fmt: skip
            self._single_inputs = Panel(session, single_entries("single map", self._single))
        motion_tab = panel.add_tab("Motion plots", viser.Icon.CHART_LINE)
        with motion_tab:
            self.motion = MotionPlots(session, bridge, slots, motion_tab, motions)
        with panel.add_tab("Export", viser.Icon.DOWNLOAD):
            self.export = Panel(session, export_entries(self.store))
        panel.float(x=MARGIN, y=-MARGIN, width=width)
        bridge.on("click", self._click)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw the maps that are seen, and what the inputs show: the ranges of the pictures."""
        for view in (
            self._torques, self._torque_inputs, self._single, self._single_inputs, self.motion,
            self.export,
        ):  # fmt: skip
            view.draw(frame, dragging)

    def _click(self, data: Any) -> None:
        """Move the robot to where a map was clicked; ``data`` comes from the page."""
        place = clicked_place(data)
        if place is not None:
            self._session.dispatch("map click", lambda state: go_to(state, *place))


def clicked_place(data: Any) -> tuple[float, float] | None:
    """Read a click on one of the maps, sent in mm; return (x, y) [m], or None if it is not one."""
    if not isinstance(data, dict) or data.get("title") not in (TORQUE_SLOT, SINGLE_SLOT):
        return None
    x, y = finite(data.get("x")), finite(data.get("y"))
    return None if x is None or y is None else (x / 1e3, y / 1e3)
