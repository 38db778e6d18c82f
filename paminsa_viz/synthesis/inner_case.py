"""What is free in a robot of given lengths, what for, and within which limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.balancing import Changes, CounterweightRange, MassRange, SpringPlace
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.ranges import LARGEST
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.inner_goals import GOALS, find_goal
from paminsa_viz.trajectory.sampled import Trajectory

ACTUATORS_OF: dict[str, tuple[int, ...]] = {
    "tau_1": (0,), "tau_2": (1,), "tau_3": (2,), "max_torque": (0, 1, 2), "f_4": (3,),
}  # fmt: skip
"""Quantities that are linear in masses and springs at every pose, and their actuators."""


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
            problem = f"factors 0 <= low <= high are needed, not {self.low!r} to {self.high!r}"
            raise InvalidInput(self.path, problem)

    def of(self, design: Design) -> MassRange:
        """Return the range for a design."""
        mass = design.value(self.path)
        return MassRange(self.path, self.low * mass, self.high * mass, self.inertia_follows)


@dataclass(frozen=True)
class InnerCase:
    """What is free in a robot of given lengths, what for, and within which limits.

    Attributes:
        goal: Key of `inner_goals.GOALS`: ``"peak_torque"``, ``"energy"`` or ``"moving_mass"``.
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
            if limit is not None and not (np.isfinite(limit) and limit >= 0):
                raise InvalidInput(name, f"a finite number of at least 0 is needed, not {limit!r}")
            if limit is not None and not self.motions:
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
        moved = tuple(replace(motion, pose=motion.pose + shift) for motion in self.motions)
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
