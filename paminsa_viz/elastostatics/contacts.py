"""Where bars of a leg would touch if their center lines lay in one plane, as in the structure.

A real leg has its bars side by side; the model of `structure` has not, and lets them pass. Hanging,
the shaft passes the root of B10 at the leg axis, and B7 passes the shaft in every pose of the
prototype: there a design needs forks or offsets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.leg_frame import leg_frame
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import LEG_AXES

PAIRS: tuple[tuple[str, str], ...] = (
    ("b2", "b10"),
    ("b2", "b7"),
    ("b2", "b4"),
    ("b2", "b8"),
    ("b3", "b10"),
    ("b4", "b10"),
    ("b3", "b8"),
    ("b4", "b7"),
)
"""Bars of a leg that no joint connects."""

_ENDS = {"b2": (3, 2), "b3": (7, 4), "b4": (9, 5), "b7": (8, 7), "b8": (8, 9)}


@dataclass(frozen=True, eq=False)
class Contacts:
    """Gaps between bars at poses of batch shape (...); NaN where a pose cannot be reached.

    Attributes:
        gap: (..., 3 legs, pairs) distance of the center lines less the two outer radii, negative
            where the bars would touch [m]; pairs in the order of `PAIRS`.
        point: (..., 3 legs, pairs, 3) where they are nearest, in base axes [m].
    """

    gap: Array
    point: Array

    def touching(self) -> list[str]:
        """Return the pairs that would touch in any leg of any pose: ``"B2–B10"``."""
        found = (self.gap < 0).reshape(-1, len(PAIRS)).any(axis=0)
        return [pair_name(i) for i, touches in enumerate(np.atleast_1d(found)) if touches]


def pair_name(index: int) -> str:
    """Return the name of a pair: ``"B2–B10"``."""
    first, second = PAIRS[index]
    return f"{first.upper()}–{second.upper()}"


@of_design
def contacts(design: Design, pose: ArrayLike) -> Contacts:
    """Return the gaps between the bars of each leg that no joint connects.

    Args:
        design: The robot; the radii are those of its tubes.
        pose: (..., 4) [m, m, rad, m].
    """
    frame = leg_frame(design.geometry, pose)
    ends = {bar: (frame.points[a], frame.points[b]) for bar, (a, b) in _ENDS.items()}
    root = np.zeros_like(frame.points[2]) * frame.rho[..., None]
    tip = root - np.array([design.geometry.guide_link_length, 0.0])
    ends["b10"] = (root, tip)
    gaps, points = [], []
    for first, second in PAIRS:
        distance, place = _nearest(*ends[first], *ends[second])
        radii = sum(0.5 * design.value(f"elastic.{bar}_outer") for bar in (first, second))
        gaps.append(distance - radii)
        points.append(place)
    place = np.stack(points, axis=-2)
    u = frame.axes[..., 0, :]
    base = np.zeros_like(u)
    base[..., :2] = design.geometry.base_radius * LEG_AXES
    whole = base[..., None, :] + place[..., :1] * u[..., None, :]
    whole[..., 2] = place[..., 1]
    return Contacts(np.stack(gaps, axis=-1), whole)


@np.errstate(all="ignore")
def _nearest(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, Array]:
    """Return the distance of two segments a-b and c-d in a plane, and the middle between them."""
    along, other, between = b - a, d - c, c - a
    cross = _cross(along, other)
    s, t = _cross(between, other) / cross, _cross(between, along) / cross
    crossing = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    distance = np.where(crossing, 0.0, np.inf)
    place = np.where(crossing[..., None], a + s[..., None] * along, np.nan)
    for point, start, way in ((c, a, along), (d, a, along), (a, c, other), (b, c, other)):
        share = ((point - start) * way).sum(axis=-1) / (way * way).sum(axis=-1)
        foot = start + np.clip(np.nan_to_num(share), 0.0, 1.0)[..., None] * way
        apart = np.linalg.norm(point - foot, axis=-1)
        nearer = ~(apart >= distance)
        distance = np.where(nearer, apart, distance)
        place = np.where(nearer[..., None], 0.5 * (point + foot), place)
    return distance, place


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
