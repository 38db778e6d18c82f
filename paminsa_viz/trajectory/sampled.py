"""A motion as a list of samples: what everything that computes or draws a trajectory takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers, as_pose, own_vectors
from paminsa_viz.trajectory.plant import hermite
from paminsa_viz.units import rounded_to_side

RATE = 1000.0
"""Default samples a second [1/s]."""

STEPS = (1e-12, 1e12)
"""Shortest and longest time between two samples [s]: splines take their fifth powers."""

MOST_SAMPLES = 1_000_000
"""Longest list of samples; with all that is computed along it some 2 GB."""

LARGEST = 1e12
"""Largest pose and rate of a trajectory [SI], so that nothing overflows."""


def sample_times(begin: float, end: float, rate: float) -> Array:
    """Return times in equal steps, both ends among them, at about a rate [1/s].

    Raises:
        InvalidInput: If the rate is not positive, or there would be more than `MOST_SAMPLES`.
    """
    require_positive(rate, "rate", "a finite rate above 0")
    count = (end - begin) * rate
    if count > MOST_SAMPLES:
        problem = f"{count:.3g} samples are more than {MOST_SAMPLES:,}"
        most = rounded_to_side(MOST_SAMPLES / (end - begin), 3, up=False)
        raise InvalidInput("rate", f"{problem}; at most {most:.3g} a second")
    return np.linspace(begin, end, max(2, round(count) + 1))


def _check_times(t: Array) -> None:
    """Refuse times whose differences, or powers of these, are lost in the arithmetic.

    Raises:
        InvalidInput: If they are not finite, do not increase, or one of their steps is out of
            `STEPS` or of the size of their own rounding.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(t)
    if not (np.isfinite(t).all() and (steps > 0).all()):
        raise InvalidInput("t", "times have to be finite and to increase")
    shortest, longest = STEPS
    if steps.min() < shortest or not steps.max() <= longest:
        problem = f"times have to be from {shortest:g} s to {longest:g} s apart"
        raise InvalidInput("t", problem)
    if steps.min() < 4 * np.spacing(np.abs(t).max()):
        raise InvalidInput("t", "times this far from zero are less exact than they are apart")


class Locus(Enum):
    """Which of the type-2 loci; its value is the column in `check.limit_margins`' distances."""

    CIRCLE = 0
    ROTATION = 1

    @property
    def label(self) -> str:
        """What messages call it."""
        return ("singular circle", "singular rotation")[self.value]


class States(NamedTuple):
    """Poses with their rates at some instants, each (..., 4)."""

    pose: Array
    velocity: Array
    acceleration: Array


OFF_CROSSING = 1e-6
"""How far from the crossing of a singularity its states beside it are, and samples at least, where
they allow it [s]."""


class Passage(NamedTuple):
    """A planned crossing of a type-2 locus: any other one stays forbidden.

    Attributes:
        t: When: [s] in a trajectory, in unit time in a plan.
        locus: Which locus.
        states: Of a sampled motion whose plan is known: (3, 4) each, `OFF_CROSSING` before the
            crossing, at it and after it. None takes them from the samples, between which the plan
            of a quick motion may change more than once.
    """

    t: float
    locus: Locus
    states: States | None = None


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A sampled motion of the platform; its arrays are read-only.

    Attributes:
        t: (n,) increasing times, at least two [s].
        pose: (n, 4) = (x, y, theta, z) [m, m, rad, m].
        velocity: (n, 4) [m/s, m/s, rad/s, m/s].
        acceleration: (n, 4) [m/s^2, m/s^2, rad/s^2, m/s^2]; at a jump the value after it.
        load: (n, 6) wrench on the platform that varies with time, on top of the design's load, at
            its point and in its directions, see `LoadCase`; linear between samples [N, N m]. None
            for none.
        passages: Planned crossings of type-2 singularities, see `time_optimal`.
        name: What a person calls it.
        kind: How it was made, for example ``"arch, s-curve"``.
        notes: What a person should know about it, a sentence each.

    Raises:
        InvalidInput: If shapes do not fit, a number is not finite or too large, or times do not
            increase in `STEPS`.
    """

    t: Array
    pose: Array
    velocity: Array
    acceleration: Array
    name: str = "trajectory"
    kind: str = ""
    notes: tuple[str, ...] = ()
    load: Array | None = None
    passages: tuple[Passage, ...] = ()

    def __post_init__(self) -> None:
        t = np.array(as_numbers(self.t, "t"))
        if t.ndim != 1 or t.size < 2:
            raise InvalidInput("t", f"a list of at least two times is needed; got {t.shape}")
        _check_times(t)
        found = {"t": t}
        for name in States._fields:
            array = own_vectors(getattr(self, name), name)
            if array.shape != (t.size, 4):
                raise InvalidInput(name, f"the shape has to be {(t.size, 4)}, not {array.shape}")
            if not np.isfinite(array).all():
                raise InvalidInput(name, "all numbers have to be finite")
            if np.abs(array).max() > LARGEST:
                raise InvalidInput(name, f"numbers up to {LARGEST:g} are possible; check the unit")
            found[name] = array
        if self.load is not None:
            found["load"] = load = own_vectors(self.load, "load", 6)
            if load.shape != (t.size, 6) or not np.isfinite(load).all():
                problem = f"finite numbers of shape {(t.size, 6)} are needed"
                raise InvalidInput("load", problem)
        for name, array in found.items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.t[-1] - self.t[0])

    @property
    def size(self) -> int:
        """Number of samples."""
        return self.t.size

    def at(self, t: ArrayLike) -> States:
        """Return the state at any times (...), (..., 4) each; before and after, the end states.

        Between samples it is the polynomial of fifth degree that has their poses, velocities and
        accelerations: all three are continuous, and exact at the samples.
        """
        t = np.clip(as_numbers(t, "t"), self.t[0], self.t[-1])
        right = np.clip(np.searchsorted(self.t, t, "right"), 1, self.t.size - 1)
        left = right - 1
        h = (self.t[right] - self.t[left])[..., None]
        u = (t - self.t[left])[..., None] / h
        ends = [
            values[at] for at in (left, right)
            for values in (self.pose, self.velocity, self.acceleration)
        ]  # fmt: skip
        return States(*hermite(u, h, *ends))

    def load_at(self, t: Array) -> Array | None:
        """Return the load at times (n,), linear between samples, (n, 6); None without one."""
        if self.load is None:
            return None
        return np.stack([np.interp(t, self.t, column) for column in self.load.T], axis=-1)

    def resampled(self, rate: float = RATE) -> Trajectory:
        """Return the same motion in equal steps at about another rate [1/s], as `at` has it.

        Raises:
            InvalidInput: As `sample_times`.
        """
        t = sample_times(float(self.t[0]), float(self.t[-1]), rate)
        return replace(self, t=t, **self.at(t)._asdict(), load=self.load_at(t))

    def moved(self, shift: Array) -> Trajectory:
        """Return the motion with its poses moved by (4,) [m, m, rad, m].

        Raises:
            InvalidInput: If the shift has another shape or is not of numbers.
        """
        shift = as_pose(shift, "shift")
        passages = tuple(
            Passage(t, locus, states and states._replace(pose=states.pose + shift))
            for t, locus, states in self.passages
        )
        return replace(self, pose=self.pose + shift, passages=passages)

    def take(self, kept: NDArray[np.intp]) -> Trajectory:
        """Return the trajectory with some of its samples, given by their indices."""
        load = None if self.load is None else self.load[kept]
        states = {name: getattr(self, name)[kept] for name in States._fields}
        return replace(self, t=self.t[kept], **states, load=load)
