"""The dock next to the 3D view: torque maps, the map of one quantity, curves, answers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import viser

from paminsa_viz.explorer.browser.bridge import Slots, finite_place
from paminsa_viz.explorer.core.docks import ANSWER_TAB, BESIDE, fit_right, left_dock
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.clearance.tab import CLEARANCE
from paminsa_viz.explorer.features.export.tab import curves_line, maps_line
from paminsa_viz.explorer.features.maps.pictures import MapPicture
from paminsa_viz.explorer.features.maps.tab import single_entries, torque_entries
from paminsa_viz.explorer.features.motion import point_entries as motion_points
from paminsa_viz.explorer.features.motion.plots import MotionPlots
from paminsa_viz.explorer.features.motion.points import click_map
from paminsa_viz.explorer.features.view.tab import view_entries
from paminsa_viz.explorer.kit.answers import AnswerTab, PlacedAnswer
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.curves import PLACE as MOTION_SLOT
from paminsa_viz.explorer.scene.legend import SceneLegend
from paminsa_viz.quantities import TORQUES

VIEW_PANEL = 350
"""Width of the panel of the view [px]."""

TORQUE_SLOT, SINGLE_SLOT = "torques", "single"


class MapsPanel:
    """The tabs next to the 3D view: torque maps, single map, motion plots, answers.

    Attributes:
        store: Where the maps come from; the floor map can share it.
        legend: Legend of the 3D view, which pictures of it have too.
    """

    def __init__(self, session: Session, answers: Sequence[PlacedAnswer]) -> None:
        client = session.client
        self._session = session
        self.store, self.legend = MapStore(), SceneLegend(session.bridge)
        width, self._folded = left_dock(session.state, session.window)
        slots = Slots(
            session.bridge, session.dispatch, {TORQUE_SLOT: width, SINGLE_SLOT: 0, MOTION_SLOT: 0}
        )
        self._panel = panel = client.gui.add_panel()
        with panel.add_tab("Torque maps"):
            self._torques = MapPicture(
                session, self.store, slots, TORQUE_SLOT, lambda _: TORQUES, "inside"
            )
            line = maps_line("torque maps", "torque maps", self.store, single=False)
            self._torque_inputs = Panel(
                session, (*torque_entries("torque maps", self._torques), line)
            )
        with panel.add_tab("Single map"):
            self._single = MapPicture(
                session, self.store, slots, SINGLE_SLOT, lambda s: (s.map_view.quantity,),
                "below",
            )  # fmt: skip
            line = maps_line("single map", "single map", self.store, single=True)
            self._single_inputs = Panel(
                session, (*single_entries("single map", self._single), line)
            )
        motion_tab = panel.add_tab("Motion plots")
        with motion_tab:
            self.motion = MotionPlots(session, slots, motion_tab)
            self._curves_line = Panel(session, (curves_line(),))
        with panel.add_tab(ANSWER_TAB):
            self._answers = AnswerTab(session, answers)
        panel.dock_left()
        session.unfold = dict.fromkeys(BESIDE, panel.expand)
        session.fit_docks = self._fit_both
        panel.set_width(width)
        if self._folded:
            panel.minimize()
        for kind in ("hello", "window"):  # one that comes late, or another size
            session.bridge.on(kind, lambda _: session.submit(self._fit))
        session.bridge.on("click", self._click)
        session.bridge.on(motion_points.DRAW, partial(motion_points.receive_switch, session))

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw the maps that are seen, and what the inputs show: the ranges of the pictures."""
        for view in (
            self._torques, self._torque_inputs, self._single, self._single_inputs, self.motion,
            self._curves_line, self._answers,
        ):  # fmt: skip
            view.draw(frame, dragging)

    def _fit(self) -> None:
        """Take the size for a window that is known only now, or that a saved state has."""
        self.motion.fit(self._session.window[1])
        width, folded = left_dock(self._session.state, self._session.window)
        self._panel.set_width(width)
        if folded != self._folded:
            (self._panel.minimize if folded else self._panel.expand)()
        self._folded = folded
        self._session.bridge.call("whole", self._session.window[0], folded)

    def _fit_both(self) -> None:
        self._fit()
        fit_right(self._session)

    def _click(self, data: Any) -> None:
        """Move the robot to where a map was clicked, or draw; ``data`` comes from the page."""
        place = clicked_place(data)
        if place is not None:
            self._session.dispatch("map click", lambda state: click_map(state, *place))


def view_panel(session: Session) -> Panel:
    """Add the panel of the view, over the scene; it is folded at first."""
    panel = session.client.gui.add_panel()
    with panel.add_tab("View", viser.Icon.EYE):
        built = Panel(session, (*view_entries(), *CLEARANCE), "View")
    panel.float(x=-10, y=10, width=VIEW_PANEL)
    panel.minimize()
    return built


def clicked_place(data: Any) -> tuple[float, float] | None:
    """Read a click on one of the maps, sent in mm; return (x, y) [m], or None if it is not one."""
    place = finite_place(data)
    if place is None or data.get("title") not in (TORQUE_SLOT, SINGLE_SLOT):
        return None
    return place[0] / 1e3, place[1] / 1e3
