"""A slider for one coordinate of the pose, and the range that it offers."""

from __future__ import annotations

from functools import lru_cache
from math import ceil, floor, pi

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State, home_pose
from paminsa_viz.meshes.layout import layout
from paminsa_viz.model import Geometry
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.reach import workspace_radius

NAMES = ("x  [mm]", "y  [mm]", "θ  [°]", "z  [mm]")
SCALES = (1e3, 1e3, 180 / pi, 1e3)
"""From SI to what a person sees: mm, mm, degrees, mm."""

STEPS = (1.0, 1.0, 0.5, 1.0)
HINTS = (
    "Platform position along x",
    "Platform position along y",
    "Turn of the platform about the vertical",
    "Height of the platform; 0 is the plane of the guides. The slider keeps the robot clear of its "
    "frame as it is drawn; any other height can be typed.",
)

GRAIN = 10
"""Ends of ranges are multiples of this [mm or degrees]."""

Range = tuple[float, float]


@lru_cache(maxsize=64)
def pose_limits(geometry: Geometry) -> tuple[Range, Range, Range, Range]:
    """Return (lowest, highest) of the sliders for x, y, theta, z, in mm and degrees."""
    radius = float(ceil(1e3 * workspace_radius(geometry) / GRAIN) * GRAIN)
    return (-radius, radius), (-radius, radius), (-180.0, 180.0), heights(geometry)


def heights(geometry: Geometry) -> Range:
    """Return the platform heights that the slider offers, which are those clear of the frame [mm].

    Home is always among them. The frame is drawn for machines like the paper's; to others it may
    leave less room, or none.
    """
    place = layout(geometry)
    low = ceil(1e3 * place.platform_low / GRAIN) * GRAIN
    high = floor(1e3 * place.platform_high / GRAIN) * GRAIN
    return holding((low, max(high, low + GRAIN)), 1e3 * home_pose(geometry)[3])


def holding(ends: Range, value: float) -> Range:
    """Return a range, grown if it has to be to hold a value."""
    low, high = ends
    return (
        float(min(low, floor(value / GRAIN) * GRAIN)),
        float(max(high, ceil(value / GRAIN) * GRAIN)),
    )


class PoseSlider:
    """One coordinate of the pose.

    A pose from elsewhere (typed, clicked, opened, brought back by undo) may lie beyond the range,
    which then grows to hold it. It shrinks again when a pose from elsewhere lies within.

    Attributes:
        slider: viser's handle.
    """

    def __init__(self, session: Session, index: int) -> None:
        """Make the slider of the coordinate ``COORDINATES[index]``."""
        self._index, self._scale = index, SCALES[index]
        state = session.state
        value = self._show(state)
        self._limits = pose_limits(state.document.design.geometry)[index]
        self._ends = holding(self._limits, value)
        self.slider = session.client.gui.add_slider(
            NAMES[index], *self._ends, STEPS[index], value, hint=HINTS[index]
        )
        self._control = Control(
            session, self.slider, f"pose.{COORDINATES[index]}", self._apply, self._show
        )

    def _apply(self, state: State, value: float) -> State:
        return actions.move(state, **{COORDINATES[self._index]: value / self._scale})

    def _show(self, state: State) -> float:
        return round(state.document.pose[self._index] * self._scale, 6)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state; the range follows the geometry and poses beyond it."""
        document, before = frame.state.document, self.slider.value
        self._control.draw(frame, moving)
        limits = pose_limits(document.design.geometry)[self._index]
        # While a hand is on the slider its ends stay, or the thumb would slip from under it.
        by_hand = limits == self._limits and self.slider.value == before
        self._limits = limits
        self._fit(holding(self._ends if by_hand else limits, self._show(frame.state)))

    def _fit(self, ends: Range) -> None:
        (low, high), (old_low, old_high) = ends, self._ends
        self._ends = ends
        if low != old_low:
            self.slider.min = low
        if high != old_high:
            self.slider.max = high
