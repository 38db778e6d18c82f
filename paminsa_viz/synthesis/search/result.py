"""The answer of a synthesis."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on, of_part
from paminsa_viz.quantities.requirements import Requirement, Workspace
from paminsa_viz.synthesis.masses.program import InnerSolution
from paminsa_viz.synthesis.proof.evidence import Proof
from paminsa_viz.synthesis.search.buildability import Buildability, best_height, buildability
from paminsa_viz.synthesis.search.case import CLEARANCE, ObjectiveLimit, Regime, SynthesisCase
from paminsa_viz.synthesis.search.evaluation import TrialEvaluation
from paminsa_viz.synthesis.search.outer import RegimeState

ACTIVE = 0.005
"""Margin below which a bound is active, as a share of the bound."""

NEAR = 5e-4
"""The same of the bound on clearance, whose own size says nothing, at the prototype's size of the
bodies [m]."""


@dataclass(frozen=True)
class BoundOutcome:
    """A bound or a limit, and how the answer meets it.

    Attributes:
        bound: What is bounded.
        value: The value closest to the bound over the workspace [SI]; NaN if it is not known.
        margin: How far it is inside the bound, negative outside [SI].
        active: Whether the bound decides: the margin is below 0.5 % of it, of clearance below
            0.5 mm in proportion to the bodies.
    """

    bound: Requirement | ObjectiveLimit
    value: float
    margin: float
    active: bool


@dataclass(frozen=True)
class RelaxedBound:
    """What a bound or a limit would have to be for the others to be met.

    Attributes:
        bound: What is bounded; of a range the one side that would be relaxed.
        nearest: The nearest value that was found [SI]; NaN if the others contradict as well.
        change: By how much that is farther, as a share of the bound.
    """

    bound: Requirement | ObjectiveLimit
    nearest: float
    change: float


@dataclass(frozen=True, eq=False)
class SynthesisResult:
    """Answer of a synthesis.

    Attributes:
        case: The question.
        design: The best robot; the reference where there is none at all.
        workspace: Its workspace, with its height.
        regime: Which of base and platform is larger.
        feasible: Whether it meets all requirements, on the finer poses.
        objective: What was minimized [SI]; NaN if it is not feasible.
        outcomes: How it meets each bound, and each limit.
        states: Where the search of each regime ended, for another one to go on from.
        refused: Regimes that were excluded before the search, and why.
        relaxed: For each bound and limit, if nothing meets all of them, what its nearest value is
            that the others leave possible.
        canceled: Whether it was ended by the progress function.
        poses: Over how many poses the answer was verified.
        inner: The best masses and springs for its lengths, with their certificate; None if none
            are free.
        proof: What is proven of it over the whole workspace; None if no proof was asked for.
    """

    case: SynthesisCase
    design: Design
    workspace: Workspace
    regime: Regime | None
    feasible: bool
    objective: float
    outcomes: tuple[BoundOutcome, ...]
    states: tuple[RegimeState, ...] = field(repr=False)
    refused: dict[Regime, str]
    relaxed: tuple[RelaxedBound, ...]
    canceled: bool
    poses: int
    inner: InnerSolution | None = None
    proof: Proof | None = None

    @property
    def trials(self) -> int:
        """Robots tried."""
        return sum(state.trials for state in self.states)

    @cached_property
    def buildability(self) -> tuple[Buildability, Buildability] | None:
        """Whether the robot can be built as drawn, and the reference; None without a robot.

        Of the reference in the same workspace, at its own best height where that is free. It is
        worked out when it is first asked for, which takes about a second, or before that by
        `check_buildability`.
        """
        return self._buildability(go_on)

    def check_buildability(self, progress: Progress) -> None:
        """Work out `buildability`.

        Raises:
            Canceled: If ``progress`` ends it.
        """
        vars(self)["buildability"] = self._buildability(progress)  # where `cached_property` looks

    def _buildability(self, progress: Progress) -> tuple[Buildability, Buildability] | None:
        if not self.poses:
            return None
        theta, held, space = self.case.requirements.theta, self.case.reference, self.workspace
        if self.case.workspace.center[2] is None:
            space = best_height(held, space, theta)
        own, rest = of_part(progress, 0.0, 0.5), of_part(progress, 0.5, 1.0)
        return (
            buildability(self.design, self.workspace, theta, progress=own),
            buildability(held, space, theta, progress=rest),
        )


def limit_of(bound: Requirement | ObjectiveLimit, value: float = math.nan) -> float:
    """Return the bound that counts: that nearer to a value, the largest if there is none [SI]."""
    if isinstance(bound, ObjectiveLimit):
        return bound.most
    sides = [side for side in (bound.high, bound.low) if side is not None]
    return sides[0] if math.isnan(value) else min(sides, key=lambda side: abs(value - side))


def outcomes_of(case: SynthesisCase, found: TrialEvaluation) -> tuple[BoundOutcome, ...]:
    """Return how an evaluation meets each bound and each limit of a case."""
    bounds = (*case.requirements.bounds, *case.limits)
    rows = []
    for bound, value in zip(bounds, found.values.tolist(), strict=True):
        margin = float(bound.margin(value))
        near = ACTIVE * abs(limit_of(bound, value))
        if isinstance(bound, Requirement) and bound.quantity == CLEARANCE:
            near = NEAR * case.reference.geometry.body_scale
        rows.append(BoundOutcome(bound, value, margin, abs(margin) <= near))
    return tuple(rows)
