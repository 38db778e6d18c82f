"""The search for a robot on the page: settings, job, progress and outcome, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from paminsa_viz.model import Design

if TYPE_CHECKING:
    from paminsa_viz.synthesis.answer.checks import BuildYield
    from paminsa_viz.synthesis.answer.prices import RequirementPrice
    from paminsa_viz.synthesis.search.case import SynthesisCase
    from paminsa_viz.synthesis.search.front import DesignFront
    from paminsa_viz.synthesis.search.result import SynthesisResult

Range = tuple[float, float]


class EffortChoice(Enum):
    """How long a search looks; values are the labels."""

    QUICK = "quick"
    NORMAL = "normal"
    THOROUGH = "thorough"


BOTH = "R_pl < R_b and R_pl > R_b"
"""Both kinds of robots, a key of `cases.REGIMES`."""


class Shown(Enum):
    """How the best robot so far is shown while a search runs; values are the labels."""

    GHOST = "as a ghost"
    ROBOT = "as the robot"
    NOT = "not"


@dataclass(frozen=True)
class SynthesisSettings:
    """What a person set.

    Attributes:
        ranges: Least and largest value of what differs from `cases.default_ranges`, by path [SI]; a
            length is held where the two are equal.
        objective: Key of what is minimized.
        against: Key of a second objective, for a Pareto front of both; empty for none.
        regimes: Which of base and platform may be larger, a key of `cases.REGIMES`.
        above_guides: Whether heights above the guides count.
        effort: How long to search.
        seed: The same seed gives the same result.
        shown: How the best so far is shown.
    """

    ranges: tuple[tuple[str, Range], ...] = ()
    objective: str = "footprint"
    against: str = ""
    regimes: str = BOTH
    above_guides: bool = False
    effort: EffortChoice = EffortChoice.QUICK
    seed: int = 0
    shown: Shown = Shown.GHOST


@dataclass(frozen=True, eq=False)
class SynthesisJob:
    """A search with everything it depends on.

    Attributes:
        case: What is searched.
        effort: How long to search.
        reference: The design that it began with.
        against: Key of the second objective of a Pareto front; empty for none.
    """

    case: SynthesisCase
    effort: EffortChoice
    reference: Design
    against: str = ""


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
        result: What was found, or None.
        built: Robots built within tolerances, or None.
        front: The front of two objectives, or None.
        seconds: How long it took.
        problem: Why there is none.
    """

    job: SynthesisJob
    result: SynthesisResult | None = None
    built: BuildYield | None = None
    front: DesignFront | None = None
    seconds: float = 0.0
    problem: str = ""


@dataclass(frozen=True, eq=False)
class PriceJob:
    """What the requirements of an answer cost.

    Attributes:
        result: The answer.
        effort: How long its search looked.
    """

    result: SynthesisResult
    effort: EffortChoice


@dataclass(frozen=True, eq=False)
class PriceOutcome:
    """What came of it.

    Attributes:
        job: The job.
        prices: The prices, or nothing.
        problem: Why there are none.
    """

    job: PriceJob
    prices: tuple[RequirementPrice, ...] = ()
    problem: str = ""


@dataclass(frozen=True)
class Synthesizing:
    """What the tab *Synthesize* shows.

    Attributes:
        settings: What a person set.
        running: The job that runs, or None.
        best: How far it is.
        outcome: The last result, or None.
        point: Index of the chosen point of the front.
        pricing: The job on prices that runs, or None.
        priced: What part of it is done, 0 to 1.
        prices: The last prices, or None.
    """

    settings: SynthesisSettings = SynthesisSettings()
    running: SynthesisJob | None = None
    best: BestSoFar | None = None
    outcome: SynthesisOutcome | None = None
    point: int = 0
    pricing: PriceJob | None = None
    priced: float = 0.0
    prices: PriceOutcome | None = None

    @property
    def result(self) -> SynthesisResult | None:
        """The answer that is shown: of the chosen point of a front, else of the search."""
        outcome = self.outcome
        if outcome is None:
            return None
        points = () if outcome.front is None else outcome.front.points
        return points[self.point].result if 0 <= self.point < len(points) else outcome.result
