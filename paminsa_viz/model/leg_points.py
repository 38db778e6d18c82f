"""Points of a leg as weighted sums of its joints 5 and 9.

A pantograph copies: each joint, and so every point of a bar or of its extension, is an affine
function of 5 and 9 with constant weights. They follow from |85| = k |83| and from the parallelogram
8-9-4-7 (see `docs/model.md`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from paminsa_viz.model.design import Geometry
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight


class PointWeights(NamedTuple):
    """A point of a leg: r = r5 rho + r9 H + r0, z = z5 z_5 + r9 z_9 + z0."""

    r5: Any
    r9: Any
    z5: Any
    z0: Any = 0.0
    r0: Any = 0.0

    def toward(self, other: PointWeights, share: Any) -> PointWeights:
        """Return the point at ``share`` of the way from here to another point."""
        return PointWeights(*(a + share * (b - a) for a, b in zip(self, other, strict=True)))


def point_weights(geometry: Geometry) -> dict[int, PointWeights]:
    """Return the weights of every joint of a leg, by the paper's number."""
    k = geometry.magnification
    return {
        2: PointWeights(0.0, 0.0, 1 / k, geometry.shaft_length),
        3: PointWeights(0.0, 0.0, 1 / k),
        4: PointWeights(1 / k, (k - 1) / k, 1 / k),
        5: PointWeights(1.0, 0.0, 1.0),
        7: PointWeights(-1 / (k * (k - 1)), -1 / k, 1 / k),
        8: PointWeights(-1 / (k - 1), 0.0, 0.0),
        9: PointWeights(0.0, 1.0, 0.0),
    }


def bar_length(geometry: Geometry, bar: str) -> float:
    """Return the length of B3, B4, B7 or B8, given as ``"b3"`` and so on [m]."""
    return {
        "b3": geometry.crank_length,
        "b4": geometry.coupler_length,
        "b7": geometry.short_coupler_length,
        "b8": geometry.crank_length,
    }[bar]


def bar_point(geometry: Geometry, bar: str, joint: int, beyond: Any) -> PointWeights:
    """Return a point of a bar or of its extension; arguments as in `Counterweight`.

    ``beyond`` may be an array; the weights that depend on it then have its shape.
    """
    first, second = BAR_ENDS[bar]
    joints = point_weights(geometry)
    other = joints[second if joint == first else first]
    return joints[joint].toward(other, -beyond / bar_length(geometry, bar))


def counterweight_point(geometry: Geometry, weight: Counterweight) -> PointWeights:
    """Return where a counterweight is."""
    return bar_point(geometry, weight.bar, weight.joint, weight.beyond)
