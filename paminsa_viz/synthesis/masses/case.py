"""What is free in a robot of given lengths, what for, and within which limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.balancing import Changes, CounterweightRange, MassRange, SpringPlace
from paminsa_viz.balancing.changes import MASS
from paminsa_viz.balancing.convex import ConvexTerm, MaxAbs, PositivePartSum
from paminsa_viz.balancing.terms import GROUP
from paminsa_viz.checks import require_at_least
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.parameters import LARGEST
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.space import ACTUATORS_OF, InnerSpace
from paminsa_viz.trajectory.integrals import time_weights
from paminsa_viz.trajectory.sampled import Trajectory
from paminsa_viz.trajectory.solved import SolvedTrajectory

MotionRows = tuple[SolvedTrajectory, Array, Array]
"""A solved motion with its torques as matrix . s + offset, see `space.motion_rows`."""


def peak_term(motions: Sequence[MotionRows], actuators: tuple[int, ...]) -> ConvexTerm:
    """Return the largest torque, in size, of some actuators (0 to 3) on motions [N m, N]."""
    # samples of one actuator stay neighbors, so that a part of the list is a part of time
    rows = [m[:, j] for _, m, _ in motions for j in actuators]
    offsets = [b[:, j] for _, _, b in motions for j in actuators]
    return MaxAbs(np.concatenate(rows), np.concatenate(offsets))


def energy_term(motions: Sequence[MotionRows]) -> ConvexTerm:
    """Return the energy that all four actuators put in on motions; braking gives none back [J]."""
    rows, offsets, starts, first = [], [], [], 0
    for solved, matrix, offset in motions:
        weight = time_weights(solved.trajectory.t)[:, None] * solved.speed
        for j in range(4):
            rows.append(matrix[:, j] * weight[:, j, None])
            offsets.append(offset[:, j] * weight[:, j])
            starts.append(np.arange(first, first + len(weight), GROUP))
            first += len(weight)
    return PositivePartSum(np.concatenate(rows), np.concatenate(offsets), np.concatenate(starts))


def _moving_mass(space: InnerSpace, motions: Sequence[MotionRows]) -> ConvexTerm:
    del motions
    row = np.eye(1, len(space.start), MASS)
    return MaxAbs(row, np.array([-space.design.payload.mass]), absolute=False)


@dataclass(frozen=True)
class InnerGoal:
    """A convex measure of a robot of given lengths.

    Attributes:
        key: Its name.
        label: The same in words.
        unit: Its SI unit.
        needs_motion: Whether it is one of motions.
        term: ``term(space, motions)`` as a function of the program's state.
    """

    key: str
    label: str
    unit: str
    needs_motion: bool
    term: Callable[[InnerSpace, Sequence[MotionRows]], ConvexTerm]


GOALS: dict[str, InnerGoal] = {
    goal.key: goal
    for goal in (
        InnerGoal(
            "peak_torque", "peak torque of M1-M3 on the motions", "N m", True,
            lambda space, motions: peak_term(motions, (0, 1, 2)),
        ),
        InnerGoal(
            "energy", "driving energy on the motions", "J", True,
            lambda space, motions: energy_term(motions),
        ),
        InnerGoal("moving_mass", "moving mass without payload", "kg", False, _moving_mass),
    )
}  # fmt: skip
"""Goals by key."""

_STATIC = (
    "the static torque of M1..M3 is no goal where masses or springs are free: M_p2 = 0, or a "
    "spring that does the same, makes it zero at every pose, whatever the lengths"
)


def find_goal(key: str, *, free: bool, motions: int) -> InnerGoal:
    """Return a goal.

    Args:
        key: Its key.
        free: Whether masses or springs are free.
        motions: How many motions there are.

    Raises:
        InvalidInput: If there is no such goal, or it makes no sense here.
    """
    if key in ("static_torque", "max_torque", "rms_torque") and free:
        raise InvalidInput("goal", f"{_STATIC}; choose {', '.join(GOALS)}")
    goal = GOALS.get(key)
    if goal is None:
        raise InvalidInput("goal", f"{', '.join(GOALS)} are known, not {key!r}")
    if goal.needs_motion and not motions:
        raise InvalidInput("motions", f"the {goal.label} needs at least one motion")
    return goal


@dataclass(frozen=True)
class MassFactor:
    """A mass that may change in proportion to what a trial's lengths make of it.

    Attributes:
        path: Its path in the design, such as ``"links.b3"``.
        low, high: Bounds as parts of the trial's own mass.
        inertia_follows: As in `MassRange`.

    Raises:
        InvalidInput: If the bounds are not possible.
    """

    path: str
    low: float
    high: float
    inertia_follows: bool = True

    def __post_init__(self) -> None:
        if not 0 <= self.low <= self.high <= LARGEST["kg"]:
            ends = f"0 <= low <= high <= {LARGEST['kg']:g}"
            problem = f"factors {ends} are needed, not {self.low!r} to {self.high!r}"
            raise InvalidInput(self.path, problem)

    def of(self, design: Design) -> MassRange:
        """Return the range for a design."""
        mass = design.value(self.path)
        return MassRange(self.path, self.low * mass, self.high * mass, self.inertia_follows)


@dataclass(frozen=True)
class InnerCase:
    """What is free in a robot of given lengths, what for, and within which limits.

    Attributes:
        goal: Key of `GOALS`: ``"peak_torque"``, ``"energy"`` or ``"moving_mass"``.
        motions: Motions that the robot has to run; a search needs some 40 samples of each.
        masses: Masses that may change.
        counterweights: Places for counterweights.
        springs: Places for springs.
        bounds: Bounds at rest; those of `ACTUATORS_OF` alone, others masses do not meet.
        motion_torque: Largest torque of M1..M3 on the motions [N m]; None for no limit.
        motion_force: Largest force of M4 on the motions [N]; None for no limit.
        most: Largest values of other goals, by key [SI].
        from_center: Whether positions of motions count from the workspace's center, which a search
            may move; otherwise from the base.

    Raises:
        InvalidInput: If there is no such goal, a bound or a limit is none of masses or springs, or
            a mass is free twice.
    """

    goal: str = "peak_torque"
    motions: tuple[Trajectory, ...] = ()
    masses: tuple[MassRange | MassFactor, ...] = ()
    counterweights: tuple[CounterweightRange, ...] = ()
    springs: tuple[SpringPlace, ...] = ()
    bounds: tuple[Requirement, ...] = ()
    motion_torque: float | None = None
    motion_force: float | None = None
    most: tuple[tuple[str, float], ...] = ()
    from_center: bool = False

    def __post_init__(self) -> None:
        find_goal(self.goal, free=self.free, motions=len(self.motions))
        for key, _ in self.most:
            find_goal(key, free=self.free, motions=len(self.motions))
        for bound in self.bounds:
            if bound.quantity not in ACTUATORS_OF:
                known = ", ".join(ACTUATORS_OF)
                raise InvalidInput(bound.quantity, f"masses and springs decide {known} alone")
            if bound.quantity == "max_torque" and bound.low is not None and bound.low > 0:
                raise InvalidInput(bound.quantity, "a least value is no convex limit of masses")
        for name in ("motion_torque", "motion_force"):
            limit = getattr(self, name)
            if limit is not None:
                require_at_least(limit, name, what="a finite number of at least 0")
                if not self.motions:
                    raise InvalidInput(name, "there is no motion that it limits")
        paths = [mass.path for mass in self.masses]
        for path in paths:
            if paths.count(path) > 1:
                raise InvalidInput(path, "this mass is free twice")

    @property
    def free(self) -> bool:
        """Whether there is anything to choose."""
        return bool(self.masses or self.counterweights or self.springs)

    def placed(self, center: Array) -> InnerCase:
        """Return the case with its motions where a workspace with some center (3,) [m] is."""
        if not self.from_center:
            return self
        shift = np.array([center[0], center[1], 0.0, center[2]])
        moved = tuple(motion.moved(shift) for motion in self.motions)
        return replace(self, motions=moved, from_center=False)

    def changes(self, design: Design) -> Changes:
        """Return what may change in a design of some lengths."""
        masses = tuple(m.of(design) if isinstance(m, MassFactor) else m for m in self.masses)
        return Changes(masses, self.counterweights)


def linear_bounds(bounds: Sequence[Requirement]) -> tuple[Requirement, ...]:
    """Return those bounds that masses and springs can be chosen to meet."""
    return tuple(
        bound
        for bound in bounds
        if bound.quantity in ACTUATORS_OF
        and (bound.quantity != "max_torque" or bound.high is not None)
    )


def check_inner(inner: InnerCase | None, objectives: Sequence[str]) -> None:
    """Check that what is to be minimized or limited makes sense with what is free.

    Args:
        inner: Masses, springs and motions of a search, if there are any.
        objectives: Keys of what the search minimizes and limits.

    Raises:
        InvalidInput: If an objective is of motions and there are none, or is one that free masses
            make zero; or if there are bounds of its own.
    """
    if inner is not None and inner.bounds:
        raise InvalidInput("inner.bounds", "bounds at rest are those of the case's requirements")
    free = inner is not None and inner.free
    motions = 0 if inner is None else len(inner.motions)
    for key in objectives:
        if key in GOALS or (key == "static_torque" and free):
            find_goal(key, free=free, motions=motions)
