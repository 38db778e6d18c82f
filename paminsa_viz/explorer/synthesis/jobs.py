"""The search for a robot on the page: settings, job, progress and outcome, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from paminsa_viz.model import Design

if TYPE_CHECKING:
    from paminsa_viz.synthesis.case import SynthesisCase
    from paminsa_viz.synthesis.robustness import BuildYield
    from paminsa_viz.synthesis.search import SynthesisResult

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
        regimes: Which of base and platform may be larger, a key of `cases.REGIMES`.
        above_guides: Whether heights above the guides count.
        effort: How long to search.
        seed: The same seed gives the same result.
        shown: How the best so far is shown.
    """

    ranges: tuple[tuple[str, Range], ...] = ()
    objective: str = "footprint"
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
    """

    case: SynthesisCase
    effort: EffortChoice
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
        result: What was found, or None.
        built: Robots built within tolerances, or None.
        seconds: How long it took.
        problem: Why there is none.
    """

    job: SynthesisJob
    result: SynthesisResult | None = None
    built: BuildYield | None = None
    seconds: float = 0.0
    problem: str = ""


@dataclass(frozen=True)
class Synthesizing:
    """What the tab *Synthesize* shows.

    Attributes:
        settings: What a person set.
        running: The job that runs, or None.
        best: How far it is.
        outcome: The last result, or None.
    """

    settings: SynthesisSettings = SynthesisSettings()
    running: SynthesisJob | None = None
    best: BestSoFar | None = None
    outcome: SynthesisOutcome | None = None
