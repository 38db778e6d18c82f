"""Tasks of the balance and their outcomes: plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from paminsa_viz.balancing import (
    Changes,
    CounterweightRange,
    MassRange,
    Optimum,
    ParetoFront,
    Tornado,
    beyond,
    paper_changes,
)
from paminsa_viz.balancing.changes import MOST
from paminsa_viz.balancing.sensitivity import MASSES
from paminsa_viz.explorer.balancing.weight_clearance import WeightClearance
from paminsa_viz.model import Design, InvalidInput, PaminsaError
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.trajectory import Trajectory


class Goal(Enum):
    """What is minimized; values are the labels."""

    ADDED = "balance, least added mass"
    MOVED = "balance, least mass moved"
    PEAK = "peak torque, current motion"
    RMS = "RMS torque, current motion"
    BOTH = "peaks: dynamic and static"

    @property
    def static(self) -> bool:
        """Whether it is about the balance alone, whatever the motion."""
        return self in (Goal.ADDED, Goal.MOVED)


class FreeMasses(Enum):
    """Which joints and links may change; values are the labels."""

    PANTOGRAPH = "all that M_p2 depends on"
    ALL = "all joints and links"
    NONE = "none"


@dataclass(frozen=True)
class CounterweightSlot:
    """A place for counterweights: beyond an end joint of a bar.

    Attributes:
        max_lever: Longest lever [m].
        max_mass: Largest mass on each leg [kg]; 0 for none.
    """

    max_lever: float = 0.1
    max_mass: float = 0.0


SLOTS = (("slot_b8", "b8", 8), ("slot_b3", "b3", 7))
"""Fields of `BalanceSettings` for counterweights, with their bars and joints."""


@dataclass(frozen=True)
class BalanceSettings:
    """What a person set.

    Attributes:
        goal: What is minimized.
        motion_weight: Weight of the motion against the static torques, 0 to 1, for `Goal.BOTH`.
        movable: Joints and links that may change.
        max_increase: By how much each of them may grow [kg].
        max_decrease: By what part each may shrink, 0 to 1.
        slot_b8, slot_b3: Counterweights beyond joint 8 on B8, and beyond joint 7 on B3.
        exact: Whether M_p2 has to be zero.
        max_added: Largest added mass of the robot, for goals on the motion [kg]; 0 for no limit.
        variation: By what part each value varies in the sensitivity, 0 to 1.
    """

    goal: Goal = Goal.ADDED
    motion_weight: float = 0.5
    movable: FreeMasses = FreeMasses.NONE
    max_increase: float = 5.0
    max_decrease: float = 0.0
    slot_b8: CounterweightSlot = CounterweightSlot(max_mass=5.0)
    slot_b3: CounterweightSlot = CounterweightSlot(max_mass=5.0)
    exact: bool = True
    max_added: float = 0.0
    variation: float = 0.05

    @property
    def counterweight_ranges(self) -> tuple[CounterweightRange, ...]:
        """The slots that are in use."""
        named = [(getattr(self, name), bar, joint) for name, bar, joint in SLOTS]
        return tuple(
            beyond(bar, joint, slot.max_lever, slot.max_mass)
            for slot, bar, joint in named
            if slot.max_mass > 0
        )


def changes_of(settings: BalanceSettings, design: Design) -> Changes:
    """Return what may change in a design; its counterweights may shrink.

    Raises:
        InvalidInput: If nothing may change.
    """
    paths: tuple[str, ...] = ()
    if settings.movable is FreeMasses.PANTOGRAPH:
        paths = tuple(mass.path for mass in paper_changes(design).masses)
    elif settings.movable is FreeMasses.ALL:
        paths = tuple(path for path in MASSES if path.startswith(("joints.", "links.")))
    masses = []
    for path in paths:
        held = design.value(path)
        most = min(held + settings.max_increase, MOST)
        masses.append(MassRange(path, (1 - settings.max_decrease) * held, most))
    for number, weight in enumerate(design.counterweights):
        masses.append(MassRange(f"counterweights.{number}.mass", 0.0, weight.mass))
    if not masses and not settings.counterweight_ranges:
        raise InvalidInput(
            "settings", "nothing may change: choose joints and links, or give counterweights a mass"
        )
    return Changes(tuple(masses), settings.counterweight_ranges)


class Task(Enum):
    """What is computed."""

    PAPER = "the paper's balance"
    OPTIMUM = "the optimal masses"
    FRONT = "the Pareto front"
    SENSITIVITY = "the sensitivity"


@dataclass(frozen=True, eq=False)
class Job:
    """A task with everything it depends on.

    Attributes:
        task: What is computed.
        design: The robot as it is.
        theta, z: The plane of poses of the static torques, that of the maps [rad, m].
        trajectory: The current motion, or None.
        problem: Why there is no motion.
        settings: What a person set.
        condition_limit: Largest condition number of a pose of the plane that counts.
    """

    task: Task
    design: Design
    theta: float
    z: float
    trajectory: Trajectory | None
    problem: str
    settings: BalanceSettings
    condition_limit: float = CONDITION_LIMIT


@dataclass(frozen=True)
class Effect:
    """A size before and after; NaN where it has no value.

    Attributes:
        label: What it is, or whose.
        unit: SI unit.
        before, after: The size.
        group: Heading of the rows that belong together, such as those of the four actuators.
    """

    label: str
    unit: str
    before: float
    after: float
    group: str = ""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of a job: an optimum, a front or a tornado, or why there is none.

    Attributes:
        job: The job.
        after: The best design, or None.
        optimum: It, with its proof.
        effects: What it does to torques and masses.
        weights: Whether its counterweights hit anything; None without any.
        front: The front, if that was the task.
        designs: The designs of its points.
        tornado: The sensitivity, if that was the task.
        problem: Why there is nothing.
    """

    job: Job
    after: Design | None = None
    optimum: Optimum | None = None
    effects: tuple[Effect, ...] = ()
    front: ParetoFront | None = None
    designs: tuple[Design, ...] = ()
    tornado: Tornado | None = None
    problem: PaminsaError | None = None
    weights: WeightClearance | None = None


@dataclass(frozen=True)
class Balancing:
    """The balancing of a session.

    Attributes:
        settings: What a person set.
        running: The job that runs, or None.
        done: What part of it is done, 0 to 1.
        outcome: The last optimum, or why there is none, or None.
        front: The last front, likewise.
        tornado: The last sensitivity, likewise.
        output: Which of `paminsa_viz.balancing.OUTPUTS` the tornado chart shows.
    """

    settings: BalanceSettings = field(default_factory=BalanceSettings)
    running: Job | None = None
    done: float = 0.0
    outcome: Outcome | None = None
    front: Outcome | None = None
    tornado: Outcome | None = None
    output: int = 0
