"""The search for a robot on the page: settings, jobs, progress and results, as plain data."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from paminsa_viz.explorer.state.outcome import Outcome, TaskState
from paminsa_viz.explorer.state.settings import Settings, setting
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


SMALLER, LARGER = "R_pl < R_b", "R_pl > R_b"
BOTH = f"{SMALLER} and {LARGER}"
REGIMES = {
    "platform smaller or larger": BOTH,
    "platform smaller than base": SMALLER,
    "platform larger than base": LARGER,
}
"""Which of base and platform may be larger, by labels: a list cannot typeset symbols."""


class Shown(Enum):
    """How the best robot so far is shown while a search runs; values are the labels."""

    GHOST = "as a ghost"
    ROBOT = "as the robot"
    NOT = "not"


@dataclass(frozen=True)
class SynthesisSettings(Settings):
    """What a person set.

    Attributes:
        ranges: Least and largest value of what differs from `cases.default_ranges`, by path [SI]; a
            length is held where the two are equal.
        objective: Key of what is minimized.
        against: Key of a second objective, for a Pareto front of both; empty for none.
        regimes: A value of `REGIMES`.
    """

    ranges: tuple[tuple[str, Range], ...] = ()
    objective: str = setting("footprint", "Objective", "What is minimized, or maximized")
    against: str = setting(
        "", "Against",
        "A second objective, for a Pareto front of robots; takes as many searches as it has points",
    )  # fmt: skip
    regimes: str = setting(
        BOTH, "Radii",
        "A robot whose platform is smaller than its base (R_pl < R_b) has a singular rotation, "
        "one with a larger platform has none: two different kinds, searched one after the other",
        options=REGIMES,
    )  # fmt: skip
    above_guides: bool = setting(
        False, "Above the guides", "Whether joints 5 may be above the guides"
    )
    allow_overlap: bool = setting(
        False, "Allow overlap",
        "Whether bodies may overlap as they are drawn: the robot need not be one that can be built",
    )  # fmt: skip
    tubes_grow: bool = setting(
        False, "Tubes grow", "Whether the diameters of bars grow in proportion to their lengths"
    )
    tube_masses: bool = setting(
        False, "Masses of tubes",
        "Whether bars weigh what their tubes do, by section and length, in place of the design’s "
        "masses in proportion to the length",
    )  # fmt: skip
    effort: EffortChoice = setting(
        EffortChoice.QUICK, "Effort",
        "How long to search; longer searches work in processes of their own",
    )  # fmt: skip
    seed: int = setting(0, "Seed", "The same seed gives the same result", range=(0.0, 1e6))
    shown: Shown = setting(
        Shown.GHOST, "Best so far", "How the best robot so far is shown while the search runs"
    )

    @property
    def possible(self) -> bool:
        if self == SynthesisSettings():
            return True
        # Late: a page that searches for nothing does without.
        from paminsa_viz.synthesis.search.objectives import OBJECTIVES

        known = {self.objective, self.against or self.objective} <= OBJECTIVES.keys()
        ends = [end for _, limits in self.ranges for end in limits]
        return known and all(map(math.isfinite, ends))


@dataclass(frozen=True)
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
        trials: Robots tried.
        cost: The best objective [SI]; NaN while no robot meets all requirements.
        feasible: Whether the best one meets all requirements.
        design: The best robot, or None.
        center: Center of its workspace [m].
    """

    trials: int = 0
    cost: float = float("nan")
    feasible: bool = False
    design: Design | None = None
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What a search found.

    Attributes:
        answer: The robot.
        built: Robots built within tolerances, or None.
        front: The front of two objectives, or None.
    """

    answer: SynthesisResult
    built: BuildYield | None = None
    front: DesignFront | None = None


SearchOutcome = Outcome[SynthesisJob, SearchResult]


@dataclass(frozen=True)
class PriceJob:
    """What the requirements of an answer cost.

    Attributes:
        answer: The answer.
        effort: How long its search looked.
    """

    answer: SynthesisResult
    effort: EffortChoice


@dataclass(frozen=True)
class SynthesisState(TaskState[SynthesisJob, SearchResult]):
    """What the tab *Synthesis* shows.

    Attributes:
        settings: What a person set.
        best: How far the search is.
        point: Index of the chosen point of the front.
        prices: The task that works out prices.
    """

    settings: SynthesisSettings = SynthesisSettings()
    best: BestSoFar | None = None
    point: int = 0
    prices: TaskState[PriceJob, tuple[RequirementPrice, ...]] = TaskState()

    @property
    def front(self) -> DesignFront | None:
        """The front that was found, or None."""
        return None if self.result is None else self.result.front

    @property
    def answers(self) -> tuple[SynthesisResult, ...]:
        """The answers that can be shown: of the points of a front, else the one of the search."""
        if self.result is None:
            return ()
        points = () if self.front is None else self.front.points
        return tuple(point.result for point in points) or (self.result.answer,)

    @property
    def answer(self) -> SynthesisResult | None:
        """The answer that is shown: of the chosen point of a front, else of the search."""
        return self.answers[self.point] if self.answers else None
