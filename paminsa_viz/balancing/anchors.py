"""Where a spring of a leg can be hooked in: every one of these points lies in the leg's plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.counterweight import Counterweight
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg_points import (
    PointWeights,
    bar_point,
    point_weights,
)
from paminsa_viz.units import format_ascii

KINDS = ("joint", "bar", "guide", "slider")


@dataclass(frozen=True)
class Anchor:
    """A named point; make it with `at_joint`, `on_bar`, `on_guide` or `on_slider`.

    Attributes:
        kind: One of `KINDS`.
        joint: Number of the joint, for a joint or a place on a bar.
        bar: The bar, for a place on one.
        beyond: As in `Counterweight` [m].
        radius: Distance from the leg axis toward the platform, for the guide [m].
        height: Above the guides, for guide and slider [m].
    """

    kind: str
    joint: int = 0
    bar: str = ""
    beyond: float = 0.0
    radius: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InvalidInput("anchor", f"{self.kind!r} is none of {', '.join(KINDS)}")
        if self.kind == "joint" and self.joint not in (2, 3, 4, 5, 7, 8, 9):
            raise InvalidInput("anchor", f"a leg has joints 2, 3, 4, 5, 7, 8, 9, not {self.joint}")
        if self.kind == "bar":
            Counterweight(self.bar, self.joint, self.beyond)
        if not np.isfinite([self.radius, self.height]).all():
            raise InvalidInput("anchor", "its radius and height have to be finite")

    def weights(self, geometry: Geometry) -> PointWeights:
        """Return where it is, as a weighted sum of the leg's joints 5 and 9."""
        if self.kind == "joint":
            return point_weights(geometry)[self.joint]
        if self.kind == "bar":
            return bar_point(geometry, self.bar, self.joint, self.beyond)
        if self.kind == "slider":
            return point_weights(geometry)[8]._replace(z0=self.height)
        return PointWeights(0.0, 0.0, 0.0, self.height, self.radius)

    @property
    def name(self) -> str:
        """The point in words, lengths in mm."""
        if self.kind == "joint":
            return f"joint {self.joint}"
        if self.kind == "bar":
            return Counterweight(self.bar, self.joint, self.beyond).place
        height = f"{format_ascii(self.height, 'm')} above"
        if self.kind == "slider":
            return f"mast on slider 8, {height}"
        return f"post on the guide link, {format_ascii(self.radius, 'm')} from the axis, {height}"


def at_joint(joint: int) -> Anchor:
    """Return a joint, by the paper's number."""
    return Anchor("joint", joint=joint)


def on_bar(bar: str, joint: int, beyond: float) -> Anchor:
    """Return a point of a bar or of its extension; arguments as in `Counterweight`."""
    return Anchor("bar", joint=joint, bar=bar, beyond=beyond)


def on_guide(radius: float, height: float) -> Anchor:
    """Return a point fixed to the guide link B10, which turns with the leg; radius 0: the axis."""
    return Anchor("guide", radius=radius, height=height)


def on_slider(height: float) -> Anchor:
    """Return the top of a mast on slider 8, which travels along the guide."""
    return Anchor("slider", height=height)
