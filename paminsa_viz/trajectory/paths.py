"""Paths of the platform, and a path with its time law as a curve in unit time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.trajectory.plan import Spline
from paminsa_viz.trajectory.planners import shared_time

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

_GAUSS = np.polynomial.legendre.leggauss(8)


class Path(Protocol):
    """A path: the pose (n, 4), or its derivative by s up to the third, at s (n,) in [0, 1]."""

    def __call__(self, s: Array, order: int = 0, /) -> Array: ...


@dataclass(frozen=True, eq=False)
class StraightPath:
    """From a pose (4,) to another, all coordinates in proportion; s from 0 to 1."""

    start: Array
    goal: Array

    def __call__(self, s: Array, order: int = 0) -> Array:
        s = np.asarray(s, dtype=np.float64)[..., None]
        shift = self.goal - self.start
        if order == 0:
            return self.start + s * shift
        return shift + 0.0 * s if order == 1 else 0.0 * s * shift


def straight_path(start: ArrayLike, goal: ArrayLike) -> StraightPath:
    """Return the straight path between two poses (4,) [m, m, rad, m].

    Raises:
        InvalidInput: If they are not two different, finite poses.
    """
    begin, end = as_vectors(start, "start"), as_vectors(goal, "goal")
    if begin.shape != (4,) or end.shape != (4,) or not np.isfinite([begin, end]).all():
        raise InvalidInput("poses", "two finite poses (4,) are needed")
    if (begin == end).all():
        raise InvalidInput("poses", "two different poses are needed")
    return StraightPath(begin, end)


def spline_path(poses: ArrayLike) -> Path:
    """Return the quintic spline through poses (n, 4), n >= 2, s by the root of their distances.

    Raises:
        InvalidInput: If neighbors are the same or a number is not finite.
    """
    from scipy.interpolate import make_interp_spline  # slow to load

    waypoints = as_vectors(poses, "poses")
    if waypoints.ndim != 2 or len(waypoints) < 2 or not np.isfinite(waypoints).all():
        raise InvalidInput("poses", "at least two finite poses (n, 4) are needed")
    s = shared_time(waypoints)
    if len(s) == 2:
        return straight_path(*waypoints)
    free = [(3, np.zeros(4)), (4, np.zeros(4))]
    return Spline(make_interp_spline(s, waypoints, k=5, bc_type=(free, free)), s)


@dataclass(frozen=True, eq=False)
class TimedPath:
    """A path with its time law, as a curve in unit time.

    Attributes:
        path: The path.
        z: s'^2 by s, with s' by true time [1/s^2]; zero at both ends.
    """

    path: Path
    z: BSpline

    breaks = np.array([0.0, 1.0])
    bounded_jerk = False  # at the ends the acceleration steps, as a trapezoid's

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Angles q in [0, 1], s = (1 - cos pi q)/2, and the times at which they are reached [s]."""
        knots = np.unique(np.clip(self.z.t, 0.0, 1.0))
        q = np.arccos(1.0 - 2.0 * knots) / np.pi
        q = np.unique(np.concatenate([q, 0.5 * (q[1:] + q[:-1])]))
        return q, np.concatenate([[0.0], np.cumsum(self._spans(q[:-1], q[1:]))])

    def _spans(self, begin: Array, end: Array) -> Array:
        """Return the time from one q to another, (n,) [s]."""
        nodes, weights = _GAUSS
        half = 0.5 * (end - begin)
        return half * (self._slowness((begin + half)[:, None] + half[:, None] * nodes) @ weights)

    def _slowness(self, q: Array) -> Array:
        """Return dt/dq [s]: finite at the ends, where s' is zero."""
        q = np.clip(q, 1e-7, 1.0 - 1e-7)
        s = 0.5 * (1.0 - np.cos(np.pi * q))
        return 0.5 * np.pi * np.sin(np.pi * q) / np.sqrt(np.maximum(self.z(s), 1e-300))

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(self._table[1][-1])

    def time_at(self, s: float) -> float:
        """Return when a point of the path is passed [s]."""
        q, t = self._table
        at = np.arccos(1.0 - 2.0 * float(s)) / np.pi
        i = min(int(np.searchsorted(q, at, "right")) - 1, len(q) - 2)
        return float(t[i] + self._spans(q[i : i + 1], np.array([at]))[0])

    def place_at(self, t: Array) -> Array:
        """Return s at times (n,) [s]."""
        q_nodes, t_nodes = self._table
        i = np.clip(np.searchsorted(t_nodes, t, "right") - 1, 0, len(q_nodes) - 2)
        low, high = q_nodes[i], q_nodes[i + 1]
        q = low + (high - low) * (t - t_nodes[i]) / (t_nodes[i + 1] - t_nodes[i])
        for _ in range(6):
            error = t_nodes[i] + self._spans(low, q) - t
            q = np.clip(q - error / self._slowness(q), low, high)
        return 0.5 * (1.0 - np.cos(np.pi * q))

    def __call__(self, u: Array, order: int = 0) -> Array:
        u = np.asarray(u, dtype=np.float64)
        s = self.place_at(np.clip(u.ravel(), 0.0, 1.0) * self.duration)
        parts = [self.path(s, n) for n in range(order + 1)]
        z = np.maximum(self.z(s), 0.0)
        first, second = np.sqrt(z)[:, None], 0.5 * self.z(s, 1)[:, None]
        if order == 0:
            value = parts[0]
        elif order == 1:
            value = parts[1] * first
        elif order == 2:
            value = parts[2] * first**2 + parts[1] * second
        else:
            third = 0.5 * self.z(s, 2)[:, None] * first
            value = parts[3] * first**3 + 3.0 * parts[2] * first * second + parts[1] * third
        return (value * self.duration**order).reshape(*u.shape, 4)
