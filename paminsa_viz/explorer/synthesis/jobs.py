"""The search for a robot on the page: settings, job, progress and outcome, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from paminsa_viz.model import Design
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.case import (
    DEFAULT_PATHS,
    DIMENSIONS,
    Effort,
    Regime,
    SearchRange,
    SynthesisCase,
)

Range = tuple[float, float]

HEIGHT, WIDTH, TALL = DIMENSIONS
"""Paths of the workspace's height and sizes."""


class EffortChoice(Enum):
    """How long a search looks; values are the labels."""

    QUICK = "quick"
    NORMAL = "normal"
    THOROUGH = "thorough"


EFFORTS: dict[EffortChoice, Effort] = {
    EffortChoice.QUICK: Effort(40, 8),
    EffortChoice.NORMAL: Effort(150, 12),
    EffortChoice.THOROUGH: Effort(400, 16),
}

REGIMES: dict[str, tuple[Regime, ...]] = {
    "R_pl < R_b and R_pl > R_b": (Regime.SMALLER, Regime.LARGER),
    "R_pl < R_b": (Regime.SMALLER,),
    "R_pl > R_b": (Regime.LARGER,),
}
"""Which of base and platform may be larger, by labels."""


class Shown(Enum):
    """How the best robot so far is shown while a search runs; values are the labels."""

    GHOST = "as a ghost"
    ROBOT = "as the robot"
    NOT = "not"


@dataclass(frozen=True)
class SynthesisSettings:
    """What a person set.

    Attributes:
        ranges: Least and largest value of what differs from `default_ranges`, by path [SI]; a
            length is held where the two are equal.
        objective: Key of what is minimized.
        against: Key of a second objective, for a Pareto front; empty for none.
        regimes: Which of base and platform may be larger, a key of `REGIMES`.
        above_guides: Whether heights above the guides count.
        effort: How long to search.
        seed: The same seed gives the same result.
        shown: How the best so far is shown.
    """

    ranges: tuple[tuple[str, Range], ...] = ()
    objective: str = "footprint"
    against: str = ""
    regimes: str = next(iter(REGIMES))
    above_guides: bool = False
    effort: EffortChoice = EffortChoice.QUICK
    seed: int = 0
    shown: Shown = Shown.GHOST


def default_ranges(design: Design, requirements: Requirements) -> dict[str, Range]:
    """Return ranges around a design, by path [SI]: half to twice its own lengths.

    With a workspace, those of its height and sizes as well.
    """
    held = {path: design.value(path) for path in DEFAULT_PATHS}
    found = {path: (round(0.5 * value, 3), round(2.0 * value, 3)) for path, value in held.items()}
    low, high = found["geometry.magnification"]
    found["geometry.magnification"] = max(low, 1.5), max(high, 3.0)
    workspace = requirements.workspace
    if workspace is not None:
        wide, _, tall = workspace.size
        found[WIDTH] = wide, 3.0 * wide
        found[TALL] = tall, tall
    return found


def ranges_of(
    settings: SynthesisSettings, design: Design, requirements: Requirements
) -> dict[str, Range]:
    """Return the ranges of a search, by path [SI]."""
    found = default_ranges(design, requirements)
    return found | {path: ends for path, ends in settings.ranges if path in found}


def with_range(settings: SynthesisSettings, path: str, ends: Range) -> SynthesisSettings:
    """Return settings with another range."""
    kept = tuple(item for item in settings.ranges if item[0] != path)
    return replace(settings, ranges=(*kept, (path, ends)))


def case_of(
    settings: SynthesisSettings, design: Design, requirements: Requirements
) -> SynthesisCase:
    """Return the case of a search.

    Raises:
        InvalidInput: If it is not possible; says what is missing.
    """
    ranges = ranges_of(settings, design, requirements)
    sizes = settings.objective == "volume" or settings.against == "volume"
    ranges = {path: ends for path, ends in ranges.items() if sizes or path not in DIMENSIONS}
    held = {
        path: low for path, (low, high) in ranges.items() if low == high and path not in DIMENSIONS
    }
    return SynthesisCase(
        requirements,
        tuple(SearchRange(path, *ends) for path, ends in ranges.items() if ends[0] != ends[1]),
        design.vary(dict(held)),
        objective=settings.objective,
        above_guides=settings.above_guides,
        regimes=REGIMES[settings.regimes],
        seed=settings.seed,
        effort=EFFORTS[settings.effort],
        name=design.name,
    )


@dataclass(frozen=True, eq=False)
class SynthesisJob:
    """A search with everything it depends on.

    Attributes:
        case: What is searched.
        against: Key of the second objective of a front; empty for none.
        reference: The design that it began with.
    """

    case: SynthesisCase
    against: str
    reference: Design


@dataclass(frozen=True, eq=False)
class BestSoFar:
    """How far a search is.

    Attributes:
        done: What part is done, 0 to 1.
        trials: Robots tried.
        cost: The best objective [SI]; NaN while no robot meets all requirements.
        feasible: Whether the best one meets all requirements.
        design: The best robot, or None.
        center: Center of its workspace [m].
    """

    done: float = 0.0
    trials: int = 0
    cost: float = float("nan")
    feasible: bool = False
    design: Design | None = None
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class SynthesisOutcome:
    """What came of a search.

    Attributes:
        job: The job.
        result: A `paminsa_viz.synthesis` result, or None.
        front: Designs of a Pareto front, or nothing.
        seconds: How long it took.
        problem: Why there is none.
        explanation: Which requirements contradict, and the nearest relaxation.
    """

    job: SynthesisJob
    result: Any = None
    front: Any = None
    seconds: float = 0.0
    problem: str = ""
    explanation: tuple[str, ...] = ()


@dataclass(frozen=True)
class Synthesizing:
    """What the tab *Synthesize* shows.

    Attributes:
        settings: What a person set.
        running: The job that runs, or None.
        best: How far it is.
        outcome: The last result, or None.
        point: Chosen point of the front.
    """

    settings: SynthesisSettings = SynthesisSettings()
    running: SynthesisJob | None = None
    best: BestSoFar | None = None
    outcome: SynthesisOutcome | None = None
    point: int = 0
