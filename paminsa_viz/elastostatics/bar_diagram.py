"""Diagrams of axial force N, shear force V and bending moment M along a bar.

A bar is cut at a distance s from its start; e is the direction from start to end, and n is e turned
by +90 degrees, from r to z. The part beyond the cut acts on the part before it with the force
N e - V n and the moment M (positive from r to z). So

    N > 0: tension,    V > 0: turns a piece of the bar from z to r (clockwise),
    M > 0: bends the bar hollow toward n,
    dN/ds = -q_e,    dV/ds = q_n,    dM/ds = V - c,

with the forces q and couple c on the bar for its length. The bars' masses and the couples of their
inertias are spread evenly; pins, counterweights and joints act at points. A counterweight beyond an
end of its bar acts on the end by its force and moment. Between points N and V are parabolas and M
is a cubic, so that extremes are exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arrays import Array

COMPONENTS = ("N", "V", "M")
"""Axial force [N], shear force [N], bending moment [N m]."""


class PointLoad(NamedTuple):
    """A force [N] and a couple [N m] at a place on a bar [m]; components along e and n."""

    place: Any
    along: Any
    across: Any
    couple: Any = 0.0


@dataclass(frozen=True, eq=False)
class BarLoads:
    """N, V and M along one bar of all legs; batch shape (...), which ends with the three legs.

    Attributes:
        bar: Key of the bar.
        length: Of the bar [m].
        places: (..., points) where forces act, sorted, from 0 to the length [m].
        coefficients: (..., points - 1, 3, 4) of N, V, M between them, as polynomials of the
            distance from the point before, constant first.
        residual: (..., 3) N, V and M left behind the end [N, N, N m]; zero in equilibrium.
    """

    bar: str
    length: float
    places: Array
    coefficients: Array
    residual: Array

    def at(self, s: ArrayLike) -> Array:
        """Return N, V, M at places s (m,), (..., m, 3) [N, N, N m]; at a point load beyond it.

        At the end it is what the last point load acts against.
        """
        s = np.asarray(s, dtype=np.float64)
        inner = self.places[..., 1:-1]
        index = (s[:, None] >= inner[..., None, :]).sum(axis=-1)
        start = np.take_along_axis(self.places, index, axis=-1)
        chosen = np.take_along_axis(self.coefficients, index[..., None, None], axis=-3)
        return _polynomial(chosen, (s - start)[..., None])

    def extremes(self) -> Array:
        """Return N, V, M that are largest in size, with their signs, (..., 3) [N, N, N m]."""
        return self.largest()[0]

    def largest(self, components: tuple[int, ...] = (0, 1, 2)) -> tuple[Array, Array]:
        """Return what is largest in size, with its sign, and where it is [m].

        Args:
            components: Indices into `COMPONENTS`.

        Returns:
            Two arrays (..., len(components)).
        """
        found = [
            largest_value(self.places, self.coefficients[..., component, :])
            for component in components
        ]
        return np.stack([f[0] for f in found], -1), np.stack([f[1] for f in found], -1)


def largest_value(places: Array, coefficients: Array) -> tuple[Array, Array]:
    """Return the value of piecewise cubics that is largest in size, with its sign, and its place.

    Args:
        places: (..., points) ends of the pieces.
        coefficients: (..., points - 1, 4) of the distance from a piece's start, constant first.

    Returns:
        Two arrays (...).
    """
    c = np.moveaxis(coefficients, (-1, -2), (0, 1))
    start = np.moveaxis(places, -1, 0)
    step = np.diff(start, axis=0)
    with np.errstate(all="ignore"):
        # where the derivative is zero; of a parabola, c_3 = 0, the second root is left
        half = -(c[2] + np.copysign(np.sqrt(c[2] * c[2] - 3 * c[3] * c[1]), c[2]))
        x = np.stack([np.zeros_like(step), step, half / (3 * c[3]), c[1] / half])
        x[2:] = np.where((x[2:] > 0) & (x[2:] < step), x[2:], 0.0)
    values = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    values = values.reshape(math.prod(values.shape[:2]), *values.shape[2:])
    reached = (start[:-1] + x).reshape(values.shape)
    best = np.abs(values).argmax(axis=0)[None]
    return (
        np.take_along_axis(values, best, axis=0)[0],
        np.take_along_axis(reached, best, axis=0)[0],
    )


def _polynomial(coefficients: Array, x: Array) -> Array:
    """Evaluate polynomials (..., 4), constant first, at x (...)."""
    c0, c1, c2, c3 = np.moveaxis(coefficients, -1, 0)
    return np.asarray(c0 + x * (c1 + x * (c2 + x * c3)))


def make_diagram(
    batch: tuple[int, ...],
    bar: str,
    length: float,
    points: list[PointLoad],
    spread: tuple[Any, Any, Any, Any],
    couple: Any,
) -> BarLoads:
    """Add up the loads of a bar from its start.

    Args:
        batch: Batch shape of the result, (..., 3).
        bar, length: Key and length [m].
        points: Loads at points, sorted unless all places are numbers.
        spread: Load along at start and end, load across at start and end, linear between [N/m].
        couple: Couple for the length [N].
    """
    flat = (math.prod(batch) // 3, 3)
    if all(isinstance(point.place, float) for point in points):
        points = sorted(points, key=lambda point: point.place)
    sorted_places: list[Any] = [0.0]
    jumps = [np.zeros((3, *flat))]
    for point in (*points, PointLoad(length, 0.0, 0.0)):
        if point.place is not sorted_places[-1] and not _same(point.place, sorted_places[-1]):
            sorted_places.append(point.place)
            jumps.append(np.zeros((3, *flat)))
        jumps[-1][0] -= point.along
        jumps[-1][1] += point.across
        jumps[-1][2] -= point.couple
    if len(sorted_places) == 1:  # a bar without length
        sorted_places.append(length)
        jumps.append(np.zeros((3, *flat)))
    places = np.stack([np.broadcast_to(place, flat) for place in sorted_places])
    step = np.diff(places, axis=0)
    c = np.zeros((3, 4, len(step), *flat))
    along0, along1, across0, across1 = spread
    rise_along = (along1 - along0) / length if length else 0.0
    rise_across = (across1 - across0) / length if length else 0.0
    now = jumps[0]
    for index, x in enumerate(step):
        along = along0 + rise_along * places[index]
        across = across0 + rise_across * places[index]
        c[:, 0, index] = now
        c[0, 1, index], c[0, 2, index] = -along, -0.5 * rise_along
        c[1, 1, index], c[1, 2, index] = across, 0.5 * rise_across
        c[2, 1, index] = now[1] - couple
        c[2, 2, index], c[2, 3, index] = 0.5 * across, rise_across / 6
        c0, c1, c2, c3 = (c[:, power, index] for power in range(4))
        now = c0 + x * (c1 + x * (c2 + x * c3)) + jumps[index + 1]
    return BarLoads(
        bar,
        length,
        np.moveaxis(places, 0, -1).reshape(*batch, len(places)),
        np.moveaxis(c.reshape(*c.shape[:3], *batch), (2, 0, 1), (-3, -2, -1)),
        np.moveaxis(now, 0, -1).reshape(*batch, 3),
    )


def _same(one: Any, other: Any) -> bool:
    return isinstance(one, float) and isinstance(other, float) and one == other
