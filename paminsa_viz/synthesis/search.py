"""Synthesis: the robot that meets requirements over a workspace and minimizes an objective."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirements import Requirement, Workspace
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.case import ObjectiveLimit, Regime, SynthesisCase
from paminsa_viz.synthesis.evaluation import Evaluation, Evaluator
from paminsa_viz.synthesis.inner import InnerSolution
from paminsa_viz.synthesis.margins import Canceled
from paminsa_viz.synthesis.objectives import find_objective
from paminsa_viz.synthesis.outer import ROUND, RegimeState, SearchProgress, search_round
from paminsa_viz.synthesis.refusals import refusal
from paminsa_viz.synthesis.samples import TRIAL

FINER = 4
"""How many times closer the poses of the verification lie."""

ACTIVE = 0.005
"""Margin below which a bound is active, as a share of the bound."""

REPAIRS = 8
"""Times that the search goes on with tighter bounds until its answer holds on the finer poses."""

REPAIR_ROUND = 40
"""Generations that it goes on for."""

CLOUD = 0.01
"""Spread of the trials that it goes on from, about the best, as a share of the ranges."""

SLACK = 1.05
"""By how much more than what the finer poses exceed a bound is tightened."""


@dataclass(frozen=True)
class BoundOutcome:
    """A bound or a limit, and how the answer meets it.

    Attributes:
        bound: What is bounded.
        value: The value closest to the bound over the workspace [SI]; NaN if it is not known.
        margin: How far it is inside the bound, negative outside [SI].
        active: Whether the bound decides: the margin is below 0.5 % of it.
    """

    bound: Requirement | ObjectiveLimit
    value: float
    margin: float
    active: bool


@dataclass(frozen=True)
class RelaxedBound:
    """What a bound or a limit would have to be for the others to be met.

    Attributes:
        bound: What is bounded.
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
    """

    case: SynthesisCase
    design: Design
    workspace: Workspace
    regime: Regime | None
    feasible: bool
    objective: float
    outcomes: tuple[BoundOutcome, ...]
    states: tuple[RegimeState, ...]
    refused: dict[Regime, str]
    relaxed: tuple[RelaxedBound, ...]
    canceled: bool
    poses: int
    inner: InnerSolution | None = None

    @property
    def trials(self) -> int:
        """Robots tried."""
        return sum(state.trials for state in self.states)


@dataclass(frozen=True, eq=False)
class _Answer:
    state: RegimeState
    found: Evaluation


@dataclass(frozen=True)
class _Run:
    """What the searches of one synthesis share."""

    case: SynthesisCase
    workers: Workers
    progress: Callable[[SearchProgress], bool | None] | None
    relaxed: int | None = None

    def search(
        self, state: RegimeState, note: Callable[[RegimeState], None] | None = None
    ) -> RegimeState:
        """Search one regime to its end.

        Raises:
            Canceled: If the progress function ended it.
        """
        evaluator = Evaluator(self.case, state.regime, relaxed=self.relaxed)
        while not state.done:
            count = min(ROUND, self.case.effort.generations - state.generation)
            state = search_round(
                evaluator, state, self.workers, self.progress, generations=max(1, count)
            )
            if note is not None:
                note(state)
        return state

    def verify(self, state: RegimeState, *, repair: bool = True) -> _Answer:
        """Return the best trial as the finer poses see it, searched on until it holds there."""
        bounds = self.case.requirements.bounds
        plain = Evaluator(self.case, state.regime, relaxed=self.relaxed)
        finer = replace(plain, density=TRIAL.finer(FINER))
        tighter = np.zeros(len(bounds))
        found = finer.evaluate(np.array([state.best]))[0]
        if not state.feasible or not repair:
            return _Answer(state, found)
        for _ in range(REPAIRS):
            if found.feasible:
                break
            seen = plain.evaluate(np.array([state.best]))[0]
            for index, bound in enumerate(bounds):
                values = seen.worst[index], found.worst[index]
                if np.isfinite(values).all():
                    before, after = bound.margin(values)
                    tighter[index] = max(tighter[index], SLACK * (before - after))
            evaluator = replace(plain, tighter=tuple(tighter.tolist()))
            state = replace(self._cloud(state), history=())
            try:
                state = search_round(
                    evaluator, state, self.workers, self.progress, generations=REPAIR_ROUND
                )
            except Canceled:
                break
            found = finer.evaluate(np.array([state.best]))[0]
        return _Answer(state, found)

    def _cloud(self, state: RegimeState) -> RegimeState:
        """Return a state with trials about its best one."""
        low, high = self.case.bounds.T
        best = (np.array(state.best) - low) / (high - low)
        rng = np.random.default_rng([self.case.seed, state.generation])
        spread = rng.normal(0.0, CLOUD, (len(state.population), len(low)))
        spread[0] = 0.0
        rows = np.clip(best + spread, 0.0, 1.0)
        return replace(state, population=tuple(map(tuple, rows.tolist())))


def synthesize(
    case: SynthesisCase,
    *,
    workers: Workers = here,
    progress: Callable[[SearchProgress], bool | None] | None = None,
    states: tuple[RegimeState, ...] = (),
    checkpoint: Callable[[tuple[RegimeState, ...]], None] | None = None,
    relax: bool = True,
) -> SynthesisResult:
    """Search for the robot that meets a case's requirements and minimizes its objective.

    Regimes that closed forms exclude are refused with the reason. Each other one is searched by
    differential evolution. The answer is then evaluated on poses four times as close; where it
    breaks a bound there, the bound is tightened by as much and the search goes on, until it holds.
    Not convex, so without a proof that there is none better. Where nothing meets all requirements,
    each bound in turn is left out and minimized instead, for the nearest relaxation.

    Args:
        case: The question.
        workers: Where trials are computed; the result is the same.
        progress: Called after each generation; true ends the search with the best so far.
        states: Where an earlier search of the same case was; it goes on from there.
        checkpoint: Called after each round with where the search is.
        relax: Whether to look for relaxations where there is no answer.
    """
    run = _Run(case, workers, progress)
    refused = {regime: reason for regime in case.regimes if (reason := refusal(case, regime))}
    reached = {state.regime: state for state in states if state.regime in case.regimes}
    answers: list[_Answer] = []
    canceled = False

    def note(state: RegimeState) -> None:
        reached[state.regime] = state
        if checkpoint is not None:
            checkpoint(tuple(reached.values()))

    for regime in case.regimes:
        if regime in refused or canceled:
            continue
        try:
            run.search(reached.get(regime, RegimeState(regime)), note)
        except Canceled:
            canceled = True
        if regime in reached:
            answers.append(run.verify(reached[regime], repair=not canceled))
    found = any(answer.found.feasible for answer in answers)
    searched = tuple(regime for regime in case.regimes if regime not in refused)
    relaxed: tuple[RelaxedBound, ...] = ()
    if relax and searched and not found and not canceled:
        relaxed = relaxations(case, searched, workers, progress)
    return _result(case, answers, tuple(reached.values()), refused, relaxed, canceled)


def relaxations(
    case: SynthesisCase,
    regimes: tuple[Regime, ...],
    workers: Workers = here,
    progress: Callable[[SearchProgress], bool | None] | None = None,
) -> tuple[RelaxedBound, ...]:
    """Return for each bound and limit the nearest value at which the others can be met.

    The one that changes least comes first. A single search each, so that a still nearer value may
    exist.
    """
    found = []
    for index, bound in enumerate((*case.requirements.bounds, *case.limits)):
        run = _Run(case, workers, progress, relaxed=index)
        least = np.inf
        for regime in regimes:
            try:
                answer = run.verify(run.search(RegimeState(regime)))
            except Canceled:
                return tuple(found)
            if answer.found.feasible:
                least = min(least, answer.found.objective)
        limit = _limit(bound)
        low = isinstance(bound, Requirement) and bound.high is None
        maximized = isinstance(bound, ObjectiveLimit) and find_objective(bound.objective).largest
        nearest = limit + (-least if low or maximized else least)
        nearest = nearest if np.isfinite(nearest) else float("nan")
        found.append(RelaxedBound(bound, float(nearest), float(least / (abs(limit) or 1.0))))
    return tuple(sorted(found, key=lambda item: item.change))


def _limit(bound: Requirement | ObjectiveLimit) -> float:
    """Return the bound that counts: the largest value, else the least one [SI]."""
    if isinstance(bound, ObjectiveLimit):
        return bound.most
    limit = bound.low if bound.high is None else bound.high
    assert limit is not None  # a requirement has one of them
    return limit


def _result(
    case: SynthesisCase,
    answers: list[_Answer],
    states: tuple[RegimeState, ...],
    refused: dict[Regime, str],
    relaxed: tuple[RelaxedBound, ...],
    canceled: bool,
) -> SynthesisResult:
    sign = find_objective(case.objective).sign
    best = min(answers, key=lambda answer: answer.found.cost(sign), default=None)
    trial = best and best.found.trial
    return SynthesisResult(
        case=case,
        design=case.reference if trial is None else replace(trial.design, name=case.name),
        workspace=case.workspace if trial is None else trial.workspace,
        regime=best and best.state.regime,
        feasible=best is not None and best.found.feasible,
        objective=best.found.objective if best else float("nan"),
        outcomes=_outcomes(case, best.found) if best else (),
        states=states,
        refused=refused,
        relaxed=relaxed,
        canceled=canceled,
        poses=0 if trial is None else trial.poses.over(case.requirements.theta).poses,
        inner=trial and trial.inner,
    )


def _outcomes(case: SynthesisCase, found: Evaluation) -> tuple[BoundOutcome, ...]:
    bounds = (*case.requirements.bounds, *case.limits)
    values = (*found.worst.tolist(), *found.limits.tolist())
    rows = []
    for bound, value in zip(bounds, values, strict=True):
        margin = float(bound.margin(value))
        rows.append(BoundOutcome(bound, value, margin, abs(margin) <= ACTIVE * abs(_limit(bound))))
    return tuple(rows)
