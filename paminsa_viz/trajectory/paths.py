"""Paths of the platform, and a path with its time law as a curve in unit time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_vectors, own_vectors
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.resizing import TURN_LENGTH
from paminsa_viz.trajectory.plan import Spline, UnitCurve
from paminsa_viz.trajectory.planners import shared_time

if TYPE_CHECKING:
    from scipy.interpolate import BSpline, PPoly

_GAUSS = leggauss(8)

_CELLS = 16  # polynomials of the length run between two breaks, at least
_ROUGH = 1e-11  # share of the largest speed by which a polynomial may be off before it is halved
_HALVINGS = 16  # of polynomials where a motion nearly stands still
_SAME = 1e-9  # difference below which two instants are one
_AT_REST = 1e-9  # share of the largest speed below which a motion stands still
_OFF_REST = 1e-5  # share of a piece by which directions are looked at off an instant of rest


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
    begin, end = own_vectors(start, "start"), own_vectors(goal, "goal")
    if begin.shape != (4,) or end.shape != (4,) or not np.isfinite([begin, end]).all():
        raise InvalidInput("poses", "two finite poses (4,) are needed")
    if (begin == end).all():
        raise InvalidInput("poses", "two different poses are needed")
    return StraightPath(begin, end)


def spline_path(poses: ArrayLike, geometry: Geometry | Design | None = None) -> Path:
    """Return the quintic spline through poses (n, 4), n >= 2, s by the root of their distances.

    Args:
        poses: The poses [m, m, rad, m].
        geometry: The robot, of whose size a turn counts as a length; Appendix 4's without one.

    Raises:
        InvalidInput: If neighbors are the same or a number is not finite.
    """
    waypoints = as_vectors(poses, "poses")
    if waypoints.ndim != 2 or len(waypoints) < 2 or not np.isfinite(waypoints).all():
        raise InvalidInput("poses", "at least two finite poses (n, 4) are needed")
    s = shared_time(waypoints, geometry)
    if len(s) == 2:
        return straight_path(*waypoints)
    return Spline.through(waypoints, s, (3, 4))


@dataclass(frozen=True, eq=False)
class TimedPath:
    """A path with its time law, as a curve in unit time.

    Attributes:
        path: The path.
        z: s'^2 by s, with s' by true time [1/s^2]; zero at both ends.
        rests: Places s at which z is zero, both ends among them.
    """

    path: Path
    z: BSpline
    rests: tuple[float, ...] = (0.0, 1.0)

    bounded_jerk = False  # at the ends the acceleration steps, as a trapezoid's

    @property
    def breaks(self) -> Array:
        """See `plan.UnitCurve`: the ends; of a spline of a low degree, all of its knots."""
        time = self._table[1]
        return np.array([0.0, 1.0]) if self.z.k > 2 else time[::2] / time[-1]

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Angles q, see `_place`, and the times at which they are reached [s]."""
        q = self._angle(self.z.t)
        q = np.unique(np.concatenate([q, 0.5 * (q[1:] + q[:-1])]))
        return q, np.concatenate([[0.0], np.cumsum(self._spans(q[:-1], q[1:]))])

    def _place(self, q: Array) -> Array:
        """Return s at angles: (1 - cos pi q)/2 of the way from a stop, 0 <= q <= 1, to the next."""
        rests = np.array(self.rests)
        i = np.clip(np.floor(q).astype(int), 0, len(rests) - 2)
        return rests[i] + np.diff(rests)[i] * 0.5 * (1.0 - np.cos(np.pi * (q - i)))

    def _angle(self, s: Array) -> Array:
        """Return the angles of places (n,)."""
        rests = np.array(self.rests)
        i = np.clip(np.searchsorted(rests, s, "right") - 1, 0, len(rests) - 2)
        share = np.clip((s - rests[i]) / np.diff(rests)[i], 0.0, 1.0)
        return i + np.arccos(1.0 - 2.0 * share) / np.pi

    def _spans(self, begin: Array, end: Array) -> Array:
        """Return the time from one q to another, (n,) [s]."""
        nodes, weights = _GAUSS
        half = 0.5 * (end - begin)
        return half * (self._slowness((begin + half)[:, None] + half[:, None] * nodes) @ weights)

    def _slowness(self, q: Array) -> Array:
        """Return dt/dq [s]: finite at the ends, where s' is zero."""
        rests = np.array(self.rests)
        i = np.clip(np.floor(q).astype(int), 0, len(rests) - 2)
        q = i + np.clip(q - i, 1e-7, 1.0 - 1e-7)
        rate = np.diff(rests)[i] * 0.5 * np.pi * np.sin(np.pi * (q - i))
        return rate / np.sqrt(np.maximum(self.z(self._place(q)), 1e-300))

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(self._table[1][-1])

    def time_at(self, s: float) -> float:
        """Return when a point of the path is passed [s]."""
        q, t = self._table
        at = float(self._angle(np.array([s]))[0])
        i = int(np.searchsorted(q, at, "right")) - 1
        return float(t[i] + self._spans(q[[i]], np.array([at]))[0])

    def place_at(self, t: Array) -> Array:
        """Return s at times (n,) [s]; that of the last ones is kept, for all derivatives there."""
        key = t.tobytes()
        if key not in self._places:
            self._places.clear()
            self._places[key] = self._place_at(t)
        return self._places[key]

    @cached_property
    def _places(self) -> dict[bytes, Array]:
        """The places of the times asked for last."""
        return {}

    def _place_at(self, t: Array) -> Array:
        q_nodes, t_nodes = self._table
        i = np.clip(np.searchsorted(t_nodes, t, "right") - 1, 0, len(q_nodes) - 2)
        low, high = q_nodes[i], q_nodes[i + 1]
        q = np.interp(t, t_nodes, q_nodes)
        for _ in range(6):
            error = t_nodes[i] + self._spans(low, q) - t
            q = np.clip(q - error / self._slowness(q), low, high)
        return self._place(q)

    def __call__(self, u: Array, order: int = 0) -> Array:
        u = np.asarray(u, dtype=np.float64)
        s = self.place_at(u.ravel() * self.duration)
        if order == 0:
            return self.path(s).reshape(*u.shape, 4)
        parts = [self.path(s, n) for n in range(1, order + 1)]
        z = np.maximum(self.z(s), 0.0)
        first, second = np.sqrt(z)[:, None], 0.5 * self.z(s, 1)[:, None]
        if order == 1:
            value = parts[0] * first
        elif order == 2:
            value = parts[1] * first**2 + parts[0] * second
        else:
            third = 0.5 * self.z(s, 2)[:, None] * first
            value = parts[2] * first**3 + 3.0 * parts[1] * first * second + parts[0] * third
        return (value * self.duration**order).reshape(*u.shape, 4)


@dataclass(frozen=True, eq=False)
class TracedPath:
    """The path of a motion without its time law: poses by the share s of the length run.

    A turn counts as a length, `turn_length`. Where the motion stops on its way, the path may have a
    corner; derivatives there are those right after it.

    Attributes:
        curve: The motion in unit time.
        turn_length: What a turn of 1 rad counts as [m].
    """

    curve: UnitCurve
    turn_length: float = TURN_LENGTH

    @cached_property
    def _metric(self) -> Array:
        return np.array([1.0, 1.0, self.turn_length**2, 1.0])

    @cached_property
    def _run(self) -> PPoly:
        """The length run [m] by the instant of unit time.

        Polynomials through 8 speeds a cell; where they are off between these, it is halved.
        """
        from scipy.interpolate import PPoly

        breaks = self.breaks
        share = np.arange(_CELLS) / _CELLS
        begin = np.append(
            (breaks[:-1, None] + np.diff(breaks)[:, None] * share).ravel(), breaks[-1]
        )
        nodes = 0.5 * (1.0 + _GAUSS[0])
        halves = np.concatenate([0.5 * nodes, 0.5 + 0.5 * nodes])
        inverse = np.linalg.inv(np.vander(nodes, increasing=True))
        # Legendre's polynomials lose no digits here, as powers would
        series = np.linalg.inv(legvander(_GAUSS[0], len(nodes) - 1))
        between = legvander(2.0 * halves - 1.0, len(nodes) - 1) @ series
        low, size = begin[:-1], np.diff(begin)
        speed = self._speeds(low, size, nodes)
        cells, most = [], _ROUGH * speed.max()
        for _ in range(_HALVINGS):
            finer = self._speeds(low, size, halves)
            rough = np.abs(finer - speed @ between.T).max(axis=1) > most
            cells.append((low[~rough], size[~rough], speed[~rough]))
            half = 0.5 * size[rough]
            low, size = np.concatenate([low[rough], low[rough] + half]), np.tile(half, 2)
            speed = np.concatenate(np.split(finer[rough], 2, axis=1))
            if not len(low):
                break
        cells.append((low, size, speed))
        low, size, speed = map(np.concatenate, zip(*cells, strict=True))
        order = np.argsort(low)
        powers = inverse @ speed[order].T / size[order] ** np.arange(len(nodes))[:, None]
        rates = PPoly(powers[::-1], np.append(low[order], breaks[-1]))
        return rates.antiderivative()

    def _speeds(self, low: Array, size: Array, shares: Array) -> Array:
        """Return speeds at shares (m,) of cells (n,), (n, m)."""
        at = low[:, None] + size[:, None] * shares
        return self._speed(at.ravel()).reshape(at.shape)

    def _speed(self, u: Array) -> Array:
        return np.sqrt(self.curve(u, 1) ** 2 @ self._metric)

    @cached_property
    def length(self) -> float:
        """Its length [m]."""
        return float(self._run(1.0))

    @cached_property
    def breaks(self) -> Array:
        """The motion's breaks in unit time, those that differ by rounding alone as one."""
        breaks = self.curve.breaks
        return breaks[np.concatenate([np.diff(breaks) > _SAME, [True]])]

    @cached_property
    def rests(self) -> Array:
        """Instants of unit time, both ends among them, at which the motion stops."""
        breaks = self.breaks
        stopped = self._speed(breaks) <= _AT_REST * self._speed(np.linspace(0.0, 1.0, 101)).max()
        stopped[[0, -1]] = True
        return breaks[stopped]

    def place(self, u: Array) -> Array:
        """Return s at instants (n,) of unit time."""
        return self._run(u) / self.length

    def instant(self, s: Array) -> Array:
        """Return the instants of unit time at which places s (n,) are passed."""
        key = s.tobytes()
        if key not in self._instants:
            self._instants.clear()
            self._instants[key] = self._instant(s)
        return self._instants[key]

    @cached_property
    def _instants(self) -> dict[bytes, Array]:
        """The places asked for last: one place is asked for several derivatives."""
        return {}

    def _instant(self, s: Array) -> Array:
        at, wanted = self._run.x, s * self.length
        ends = self._run(at)
        i = np.clip(np.searchsorted(ends, wanted, "right") - 1, 0, len(at) - 2)
        low, high = at[i], at[i + 1]
        u = np.interp(wanted, ends, at)
        rate = self._run.derivative()
        for _ in range(60):
            error = self._run(u) - wanted
            low, high = np.where(error < 0, u, low), np.where(error > 0, u, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = u - error / rate(u)
            inside = (step >= low) & (step <= high)
            new = np.where(inside, step, 0.5 * (low + high))
            there = np.abs(new - u) < 1e-14
            u = new
            if there.all():
                break
        return u

    def law(self, s: Array) -> tuple[Array, Array]:
        """Return (ds/du)^2 of the motion itself and its derivative by s, at places (n,)."""
        u = self.instant(s)
        rate, growth = self._run.derivative()(u), self._run.derivative(2)(u)
        return (rate / self.length) ** 2, 2.0 * growth / self.length

    def __call__(self, s: Array, order: int = 0) -> Array:
        s = np.asarray(s, dtype=np.float64)
        u = self.instant(s.ravel())
        if order == 0:
            return self.curve(u).reshape(*s.shape, 4)
        i = np.clip(np.searchsorted(self.rests, u, "right") - 1, 0, len(self.rests) - 2)
        begin, end = self.rests[i], self.rests[i + 1]
        u = np.clip(u, begin + _OFF_REST * (end - begin), end - _OFF_REST * (end - begin))
        rate = [self.curve(u, n) for n in range(1, order + 1)]
        v = np.sqrt(rate[0] ** 2 @ self._metric)[:, None]
        value = first = rate[0] / v
        if order > 1:
            growth = (rate[0] * rate[1]) @ self._metric[:, None] / v
            value = second = (rate[1] - first * growth) / v**2
            if order > 2:
                bend = (rate[1] ** 2 + rate[0] * rate[2]) @ self._metric[:, None]
                third = (bend - growth**2) / v
                value = (rate[2] - first * third - 3.0 * second * v * growth) / v**3
        return (value * self.length**order).reshape(*s.shape, 4)
