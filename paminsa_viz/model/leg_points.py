"""Points of a leg as combinations of its joints 5 and 9.

In the leg's plane every joint, and so every point of a bar or of its extension, stands at

    r = r5 rho + knee r9,      z = z5 zeta + knee z9,

with rho = X_1 and zeta = z_5 of joint 5, and r9, z9 of the knee (see `docs/model.md`). The three
factors follow from |85| = k |83| and from the parallelogram 8-9-4-7; they depend on k and on ratios
of lengths alone.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from paminsa_viz.model.counterweight import BAR_ENDS
from paminsa_viz.model.design import Geometry


class LegPoint(NamedTuple):
    """Factors of a point of the leg: r = r5 rho + knee r9, z = z5 zeta + knee z9."""

    r5: Any
    z5: Any
    knee: Any

    def along(self, other: LegPoint, share: Any) -> LegPoint:
        """Return the point at ``share`` of the way from here to another point."""
        return LegPoint(*(a + share * (b - a) for a, b in zip(self, other, strict=True)))


def joint_point(magnification: float, joint: int) -> LegPoint:
    """Return joint 3, 4, 5, 7, 8 or 9 (by the paper's number)."""
    k = magnification
    return {
        3: LegPoint(0.0, 1 / k, 0.0),
        4: LegPoint(1 / k, 1 / k, (k - 1) / k),
        5: LegPoint(1.0, 1.0, 0.0),
        7: LegPoint(-1 / (k * (k - 1)), 1 / k, -1 / k),
        8: LegPoint(-1 / (k - 1), 0.0, 0.0),
        9: LegPoint(0.0, 0.0, 1.0),
    }[joint]


def bar_length(geometry: Geometry, bar: str) -> float:
    """Return the length of B3, B4, B7 or B8, given as ``"b3"`` and so on [m]."""
    return {
        "b3": geometry.crank_length,
        "b4": geometry.coupler_length,
        "b7": geometry.short_coupler_length,
        "b8": geometry.crank_length,
    }[bar]


def bar_point(geometry: Geometry, bar: str, joint: int, beyond: Any) -> LegPoint:
    """Return a point of a bar or of its extension; arguments as in `Counterweight`.

    ``beyond`` may be an array; the point's factors then have its shape.
    """
    first, second = BAR_ENDS[bar]
    other = second if joint == first else first
    start = joint_point(geometry.magnification, joint)
    end = joint_point(geometry.magnification, other)
    return start.along(end, -beyond / bar_length(geometry, bar))
