"""Planned motions: curves in unit time with exact derivatives, and a duration for each.

A curve gives the pose (..., 4) = (x, y, theta, z) as a function of u in [0, 1], and does not depend
on its duration; `Plan` scales it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers
from paminsa_viz.trajectory.sampled import (
    OFF_CROSSING,
    RATE,
    STEPS,
    Passage,
    States,
    Trajectory,
    sample_times,
)
from paminsa_viz.trajectory.time_laws import TimeLaw

if TYPE_CHECKING:  # SciPy's splines take most of a second to load; only waypoints need them
    from scipy.interpolate import BSpline


class UnitCurve(Protocol):
    """A motion in unit time."""

    @property
    def breaks(self) -> Array:
        """Instants in [0, 1], ends included, between which all derivatives are continuous."""
        ...

    @property
    def bounded_jerk(self) -> bool:
        """Whether the acceleration never jumps, also against the rest before and after."""
        ...

    def __call__(self, u: Array, order: int = 0) -> Array:
        """Return the pose or a derivative by u, up to the third, at instants u (n,); (n, 4)."""
        ...


@dataclass(frozen=True, eq=False)
class Displacement:
    """A displacement (4,) made with a law between two instants of unit time."""

    shift: Array
    law: TimeLaw
    begin: float = 0.0
    end: float = 1.0


@dataclass(frozen=True, eq=False)
class Blend:
    """A start pose (4,) and displacements on top of each other: lines, arches, pauses."""

    start: Array
    terms: tuple[Displacement, ...]

    @property
    def breaks(self) -> Array:
        inner = [t.begin + (t.end - t.begin) * t.law.breaks for t in self.terms]
        return np.unique(np.concatenate([[0.0, 1.0], *inner]))

    @property
    def bounded_jerk(self) -> bool:
        return all(term.law.bounded_jerk for term in self.terms)

    def __call__(self, u: Array, order: int = 0) -> Array:
        u = np.asarray(u, dtype=np.float64)
        value = np.zeros((*u.shape, 4)) + (self.start if order == 0 else 0.0)
        for term in self.terms:
            span = term.end - term.begin
            part = term.law((u - term.begin) / span, order) / span**order
            if order and term.end < 1.0:
                part = np.where(u < term.end, part, 0.0)
            value += part[..., None] * term.shift
        return value


@dataclass(frozen=True, eq=False)
class Arc:
    """A circular motion: center + first cos phi + second sin phi, phi = angle * law(u).

    Attributes:
        center, first, second: (4,) poses; the last two of equal length across each other.
        angle: Angle run through [rad].
        law: Its time law.
    """

    center: Array
    first: Array
    second: Array
    angle: float
    law: TimeLaw

    @property
    def breaks(self) -> Array:
        return self.law.breaks

    @property
    def bounded_jerk(self) -> bool:
        return self.law.bounded_jerk

    def __call__(self, u: Array, order: int = 0) -> Array:
        u = np.asarray(u, dtype=np.float64)
        phi = self.angle * self.law(u)[..., None]
        out = self.first * np.cos(phi) + self.second * np.sin(phi)
        if order == 0:
            return self.center + out
        along = self.second * np.cos(phi) - self.first * np.sin(phi)
        rate = self.angle * self.law(u, 1)[..., None]
        if order == 1:
            return along * rate
        growth = self.angle * self.law(u, 2)[..., None]
        if order == 2:
            return along * growth - out * rate**2
        third = self.angle * self.law(u, 3)[..., None]
        return along * (third - rate**3) - 3.0 * out * rate * growth


@dataclass(frozen=True, eq=False)
class Spline:
    """A quintic spline of the pose, (4,) on [0, 1].

    Attributes:
        start: The first pose (4,). Counted from it, a coordinate that stays has rates of exactly 0.
        change: The spline of the difference from it.
        breaks: The instants of its waypoints.
    """

    start: Array
    change: BSpline
    breaks: Array
    bounded_jerk: bool = True

    @classmethod
    def through(cls, poses: Array, u: Array, orders: tuple[int, int]) -> Spline:
        """Return the spline through poses (n, 4) at u (n,); two derivatives are 0 at both ends."""
        from scipy.interpolate import make_interp_spline  # slow to load

        ends = [(order, np.zeros(4)) for order in orders]
        change = make_interp_spline(u, poses - poses[0], k=5, bc_type=(ends, ends))
        return cls(poses[0], change, u)

    def __call__(self, u: Array, order: int = 0) -> Array:
        value: Array = self.change(np.asarray(u, dtype=np.float64), order)
        return value if order else self.start + value


@dataclass(frozen=True, eq=False)
class Chain:
    """Curves after each other, each in its share of the time.

    Attributes:
        curves: Each starts where the one before it ends; all at rest there.
        ends: (number of curves + 1,) instants at which they begin and end, from 0 to 1.
        backward: Which of them are run backward.
    """

    curves: tuple[UnitCurve, ...]
    ends: Array
    backward: tuple[bool, ...] = ()

    def _spans(self) -> list[tuple[UnitCurve, float, float]]:
        """Return the curves with the instants of their own 0 and 1."""
        turned = self.backward or (False,) * len(self.curves)
        spans = zip(self.curves, turned, pairwise(self.ends), strict=True)
        return [(c, b, a) if back else (c, a, b) for c, back, (a, b) in spans]

    @property
    def breaks(self) -> Array:
        return np.unique(np.concatenate([a + (b - a) * c.breaks for c, a, b in self._spans()]))

    @property
    def bounded_jerk(self) -> bool:
        return all(curve.bounded_jerk for curve in self.curves)

    def __call__(self, u: Array, order: int = 0) -> Array:
        u = np.asarray(u, dtype=np.float64)
        which = np.clip(np.searchsorted(self.ends, u, "right") - 1, 0, len(self.curves) - 1)
        value = np.empty((*u.shape, 4))
        for index, (curve, begin, end) in enumerate(self._spans()):
            mine = which == index
            local = (u[mine] - begin) / (end - begin)
            value[mine] = curve(local, order) / (end - begin) ** order
        return value


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion of the platform that starts and ends at rest, known at every instant.

    Attributes:
        curve: The motion in unit time.
        duration: Its duration [s].
        name: What a person calls it.
        kind: How it was made.
        notes: What a person should know about it, a sentence each.
        passages: Planned crossings of type-2 singularities, in unit time.

    Raises:
        InvalidInput: If the duration is not a number within bounds.
    """

    curve: UnitCurve
    duration: float
    name: str = "trajectory"
    kind: str = ""
    notes: tuple[str, ...] = ()
    passages: tuple[Passage, ...] = ()

    def __post_init__(self) -> None:
        if not STEPS[0] <= self.duration <= STEPS[1]:
            problem = f"{STEPS[0]:g} to {STEPS[1]:g} s are possible, not {self.duration!r}"
            raise InvalidInput("duration", problem)

    @kinds_checked
    def lasting(self, duration: float) -> Plan:
        """Return the same motion with another duration [s].

        Raises:
            InvalidInput: If it is no number, or out of range.
        """
        return replace(self, duration=float(duration))

    def at(self, t: ArrayLike) -> States:
        """Return the state at times (...) from 0 to the duration [s]; outside it is at rest."""
        t = as_numbers(t, "t")
        u = t / self.duration
        outside = ((u < 0.0) | (u > 1.0))[..., None]
        u = np.clip(u, 0.0, 1.0)
        rates = (self.curve(u, order) / self.duration**order for order in (1, 2))
        return States(self.curve(u), *(np.where(outside, 0.0, rate) for rate in rates))

    def jerk(self, t: ArrayLike) -> Array:
        """Return the third derivative at times (...), (..., 4) [m/s^3, m/s^3, rad/s^3, m/s^3]."""
        return self.curve(as_numbers(t, "t") / self.duration, 3) / self.duration**3

    def sample(self, rate: float = RATE) -> Trajectory:
        """Return samples in equal steps, both ends among them.

        One at a crossing of a singularity, where there is no torque but in the limit, is moved to
        `OFF_CROSSING` after it.

        Args:
            rate: Samples a second; the step is made to fit the duration [1/s].

        Raises:
            InvalidInput: If the rate is not positive or the list would be longer than
                `MOST_SAMPLES`.
        """
        t = sample_times(0.0, self.duration, rate)
        times = [(passage.t * self.duration, passage.locus) for passage in self.passages]
        beside = OFF_CROSSING * np.array([-1.0, 0.0, 1.0])
        passages = tuple(Passage(at, locus, self.at(at + beside)) for at, locus in times)
        for at, _ in times:
            least = min(OFF_CROSSING, 0.25 * t[1])
            near = np.abs(t - at) < least
            t[near] = at + least
        return Trajectory(t, *self.at(t), self.name, self.kind, self.notes, passages=passages)
