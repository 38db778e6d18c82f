"""Tasks of the balance and what they find: plain data."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
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
from paminsa_viz.balancing.effects import Effect
from paminsa_viz.balancing.sensitivity import MASSES
from paminsa_viz.explorer.state.outcome import Outcome, TaskState
from paminsa_viz.explorer.state.plane import PlaneJob
from paminsa_viz.explorer.state.settings import PERCENT, Settings, setting
from paminsa_viz.model import Design, InvalidInput
from paminsa_viz.model.arrays import Pose
from paminsa_viz.trajectory import Trajectory


class Goal(Enum):
    """What is minimized; values are the labels."""

    ADDED = "balance, least added mass"
    MOVED = "balance, least mass moved"
    PEAK = "peak torque, current motion"
    RMS = "RMS torque, current motion"
    ENERGY = "driving energy, current motion"
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


LONGEST_LEVER, LARGEST_MASS = 1.0, 1e4
"""What can be typed [m, kg]; a robot five times as long as the prototype is 125 times as heavy."""


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
class BalanceSettings(Settings):
    """What a person set.

    Attributes:
        goal: What is minimized.
        motion_weight: Weight of the motion against the static torques, 0 to 1, for `Goal.BOTH`.
        slot_b8, slot_b3: Counterweights beyond joint 8 on B8, and beyond joint 7 on B3.
        variation: By what part each value varies in the sensitivity, 0 to 1.
    """

    goal: Goal = setting(
        Goal.ADDED, "Goal", "What is minimized; torques of M1–M3, energy of all four"
    )  # fmt: skip
    motion_weight: float = 0.5
    movable: FreeMasses = setting(
        FreeMasses.NONE, "Joints, links", "Which other masses of a leg may change"
    )
    max_increase: float = setting(
        5.0, "Max increase [kg]",
        "By how much each of them may grow; a link’s inertia grows in proportion",
        range=(0.0, LARGEST_MASS), step=0.001,
    )  # fmt: skip
    max_decrease: float = setting(
        0.0, "Max decrease [%]", "By what part each of them may shrink", range=(0.0, 1.0),
        step=0.1, unit=PERCENT,
    )  # fmt: skip
    slot_b8: CounterweightSlot = CounterweightSlot(max_mass=5.0)
    slot_b3: CounterweightSlot = CounterweightSlot(max_mass=5.0)
    exact: bool = setting(
        True, "Only M_p2 = 0",
        "Otherwise a balance comes as near as it can, and other goals are free of it",
    )  # fmt: skip
    max_added: float = setting(
        0.0, "Max added [kg]",
        "Largest added mass of the whole robot, for goals on the motion and for the front; "
        "0: no limit",
        range=(0.0, 10 * LARGEST_MASS), step=0.001,
    )  # fmt: skip
    variation: float = setting(
        0.05, "Variation ± [%]", "Of every mass and length, one at a time", range=(0.001, 0.5),
        step=0.1, unit=PERCENT,
    )  # fmt: skip

    def of(self, kind: BalanceKind) -> BalanceSettings:
        """Return those that a task depends on, the others as they are at first."""
        start = BalanceSettings()
        match kind:
            case BalanceKind.PAPER:
                return start
            case BalanceKind.OPTIMUM:
                return replace(self, variation=start.variation)
            case BalanceKind.FRONT:
                return replace(
                    self, goal=start.goal, exact=start.exact, motion_weight=start.motion_weight,
                    variation=start.variation,
                )  # fmt: skip
            case BalanceKind.SENSITIVITY:
                return replace(start, variation=self.variation)

    @property
    def possible(self) -> bool:
        slots = (self.slot_b8, self.slot_b3)
        lever_and_mass = all(
            0 <= s.max_lever <= LONGEST_LEVER and 0 <= s.max_mass <= LARGEST_MASS for s in slots
        )
        return lever_and_mass and 0 <= self.motion_weight <= 1

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


class BalanceKind(Enum):
    """What is computed."""

    PAPER = "the paper’s balance"
    OPTIMUM = "the optimal masses"
    FRONT = "the Pareto front"
    SENSITIVITY = "the sensitivity"


@dataclass(frozen=True)
class BalanceJob(PlaneJob):
    """A task with everything it depends on.

    Attributes:
        task: What is computed.
        trajectory: The current motion, or None.
        problem: Why there is no motion.
    """

    task: BalanceKind
    trajectory: Trajectory | None
    problem: str


@dataclass(frozen=True)
class WeightClearance:
    """The least distance of a counterweight to another body.

    Attributes:
        distance: Negative where they overlap [m].
        names: The two bodies.
        pose: Where it is, (x, y, theta, z) [m, m, rad, m].
        touching: Part of the poses where a counterweight overlaps another body, 0 to 1.
        poses: Poses that were looked at.
    """

    distance: float
    names: tuple[str, str]
    pose: Pose
    touching: float
    poses: int


@dataclass(frozen=True, eq=False)
class Balanced:
    """The optimal masses.

    Attributes:
        after: The best design.
        optimum: It, with its proof.
        effects: What it does to torques and masses.
        weights: Whether its counterweights hit anything; None without any.
    """

    after: Design
    optimum: Optimum
    effects: tuple[Effect, ...]
    weights: WeightClearance | None


@dataclass(frozen=True, eq=False)
class MassFront:
    """A Pareto front, and the designs of its points."""

    front: ParetoFront
    designs: tuple[Design, ...]


BalanceOutcome = Outcome[BalanceJob, Balanced]


@dataclass(frozen=True)
class BalanceState(TaskState[BalanceJob, Balanced]):
    """The balancing of a session; one of its tasks runs at a time.

    Attributes:
        settings: What a person set.
        front: What came of the last front, or None.
        tornado: What came of the last sensitivity, or None.
        output: Which of `paminsa_viz.balancing.OUTPUTS` the tornado chart shows.
    """

    settings: BalanceSettings = field(default_factory=BalanceSettings)
    front: Outcome[BalanceJob, MassFront] | None = None
    tornado: Outcome[BalanceJob, Tornado] | None = None
    output: int = 0

    @property
    def kind(self) -> str:
        """What is computed."""
        return "" if self.running is None else self.running.task.name

    @property
    def unkept(self) -> tuple[str, ...]:
        """Kinds of the jobs that a reload ends, or whose results it loses.

        The masses of an optimum are those of the design, which is kept.
        """
        found = {BalanceKind.FRONT: self.front, BalanceKind.SENSITIVITY: self.tornado}
        lost = [kind for kind, one in found.items() if one is not None and one.result is not None]
        running = () if self.running is None else (self.running.task,)
        return tuple(kind.name for kind in dict.fromkeys((*running, *lost)))

    @property
    def points(self) -> tuple[Design, ...]:
        """Designs of the points of the last front."""
        found = None if self.front is None else self.front.result
        return () if found is None else found.designs
