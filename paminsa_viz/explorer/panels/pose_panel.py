"""Sliders for the platform pose, the assembly mode, and the steps back and forth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import Assembly, Geometry
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.reach import workspace_height, workspace_radius

ASSEMBLY_LABELS = {
    Assembly.PRINTED: "lower knee (as printed)",
    Assembly.MIRROR: "upper knee (mirror)",
}


def pose_limits(geometry: Geometry) -> tuple[tuple[float, float, float], ...]:
    """Return (lowest, highest, step) of the sliders for x, y, theta, z, in mm and degrees."""
    radius = float(np.ceil(100 * workspace_radius(geometry))) * 10
    height = workspace_height(geometry)
    low, high = (
        float(np.ceil(100 * (sign * height - geometry.platform_joint_height))) * 10
        for sign in (-1, 1)
    )
    return (
        (-radius, radius, 1.0),
        (-radius, radius, 1.0),
        (-180.0, 180.0, 0.5),
        (low, high, 1.0),
    )


SCALE = (1e3, 1e3, 180 / np.pi, 1e3)
"""From SI to what a person sees: mm, mm, degrees, mm."""


def _apply(index: int) -> Callable[[State, float], State]:
    def apply(state: State, value: float) -> State:
        return actions.move(state, **{COORDINATES[index]: value / SCALE[index]})

    return apply


def _show(index: int) -> Callable[[State], float]:
    return lambda state: round(state.document.pose[index] * SCALE[index], 6)


class PosePanel:
    """Four sliders with number entry, assembly mode, home, undo and redo."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self.session = session
        state = session.state
        self._geometry = state.document.design.geometry
        limits = pose_limits(self._geometry)
        names = ("x  [mm]", "y  [mm]", "θ  [°]", "z  [mm]")
        hints = (
            "Platform position along x",
            "Platform position along y",
            "Turn of the platform about the vertical",
            "Height of the platform; 0 is the plane of the guides",
        )
        self.sliders = [
            gui.add_slider(
                name, low, high, step, min(max(_show(i)(state), low), high), hint=hints[i]
            )
            for i, (name, (low, high, step)) in enumerate(zip(names, limits, strict=True))
        ]
        self._controls = [
            Control(session, slider, f"pose.{COORDINATES[i]}", _apply(i), _show(i))
            for i, slider in enumerate(self.sliders)
        ]
        self.assembly = gui.add_dropdown(
            "Assembly",
            tuple(ASSEMBLY_LABELS.values()),
            initial_value=ASSEMBLY_LABELS[state.document.assembly],
            hint="Which root of Appendix 1 the knee 9 takes; switching mirrors the height",
        )
        self._controls.append(
            Control(
                session,
                self.assembly,
                "pose.assembly",
                lambda s, label: actions.assemble(s, _assembly(label)),
                lambda s: ASSEMBLY_LABELS[s.document.assembly],
            )
        )
        steps = gui.add_button_group("Steps", ("Home", "Undo", "Redo"))

        @steps.on_click
        def _(event) -> None:  # type: ignore[no-untyped-def]
            {
                "Home": lambda: session.ask("home", actions.go_home),
                "Undo": session.undo,
                "Redo": session.redo,
            }.get(event.target.value, lambda: None)()

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state; ranges follow the geometry."""
        geometry = frame.state.document.design.geometry
        if geometry != self._geometry:
            self._geometry = geometry
            for slider, (low, high, step) in zip(self.sliders, pose_limits(geometry), strict=True):
                slider.min, slider.max, slider.step = low, high, step
        for control in self._controls:
            control.draw(frame, moving)


def _assembly(label: str) -> Assembly:
    for assembly, name in ASSEMBLY_LABELS.items():
        if name == label:
            return assembly
    return Assembly.PRINTED
