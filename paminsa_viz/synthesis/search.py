"""Synthesis: the robot that meets requirements over a workspace and minimizes an objective."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirements import Requirement, Workspace
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.case import Limit, Regime, SynthesisCase
from paminsa_viz.synthesis.evaluation import Evaluation, Evaluator
from paminsa_viz.synthesis.objectives import find_objective
from paminsa_viz.synthesis.outer import Canceled, Progress, RegimeState, search_round
from paminsa_viz.synthesis.samples import TRIAL

FINER = 4
"""How many times closer the poses of the verification lie."""

ACTIVE = 0.005
"""Margin below which a bound is active, as a share of the bound."""

ROUNDS_OF_REPAIR = 8
"""Times that the search goes on with tighter bounds until its answer holds on the finer poses."""

SLACK = 1.05
"""By how much more than what the finer poses exceed a bound is tightened."""


@dataclass(frozen=True)
class Outcome:
    """A bound or a limit, and how the answer meets it.

    Attributes:
        bound: What is bounded.
        value: The value closest to the bound over the workspace [SI]; NaN if it is not known.
        margin: How far it is inside the bound, negative outside [SI].
        active: Whether the bound decides: the margin is below 0.5 % of it.
    """

    bound: Requirement | Limit
    value: float
    margin: float
    active: bool


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
        canceled: Whether it was ended by the progress function.
        poses: Over how many poses the answer was verified.
    """

    case: SynthesisCase
    design: Design
    workspace: Workspace
    regime: Regime | None
    feasible: bool
    objective: float
    outcomes: tuple[Outcome, ...]
    states: tuple[RegimeState, ...]
    refused: dict[Regime, str]
    canceled: bool
    poses: int

    @property
    def trials(self) -> int:
        """Robots tried."""
        return sum(state.trials for state in self.states)


@dataclass(frozen=True, eq=False)
class _Answer:
    regime: Regime
    state: RegimeState
    found: Evaluation


def synthesize(
    case: SynthesisCase,
    *,
    workers: Workers = here,
    progress: Callable[[Progress], bool | None] | None = None,
    states: tuple[RegimeState, ...] = (),
    checkpoint: Callable[[tuple[RegimeState, ...]], None] | None = None,
) -> SynthesisResult:
    """Search for the robot that meets a case's requirements and minimizes its objective.

    Each regime is searched by differential evolution. The answer is then evaluated on poses four
    times as close; where it breaks a bound there, the bound is tightened by as much and the search
    goes on, until it holds. Not convex, so without a proof that there is none better.

    Args:
        case: The question.
        workers: Where trials are computed; the result is the same.
        progress: Called after each generation; true ends the search with the best so far.
        states: Where an earlier search of the same case was; it goes on from there.
        checkpoint: Called after each round with where the search is.

    Raises:
        InvalidInput: If an objective is unknown.
    """
    find_objective(case.objective)
    for limit in case.limits:
        find_objective(limit.objective)
    known = {state.regime: state for state in states}
    reached: dict[Regime, RegimeState] = {}
    answers: list[_Answer] = []
    canceled = False
    for regime in case.regimes:
        state = known.get(regime, RegimeState(regime))

        def note(state: RegimeState) -> None:
            reached[state.regime] = state
            if checkpoint is not None:
                rest = [known[r] for r in case.regimes if r in known and r not in reached]
                checkpoint((*reached.values(), *rest))

        try:
            state = _search(Evaluator(case, regime), state, workers, progress, note)
        except Canceled:
            canceled = True
        state = reached.get(regime, state)
        reached[regime] = state
        if state.best:
            answers.append(_verified(case, state, workers, None if canceled else progress))
        if canceled:
            break
    return _result(case, answers, tuple(reached.values()), canceled)


def _search(
    evaluator: Evaluator,
    state: RegimeState,
    workers: Workers,
    progress: Callable[[Progress], bool | None] | None,
    note: Callable[[RegimeState], None],
) -> RegimeState:
    while not state.done:
        state = search_round(evaluator, state, workers, progress)
        note(state)
    return state


def _verified(
    case: SynthesisCase,
    state: RegimeState,
    workers: Workers,
    progress: Callable[[Progress], bool | None] | None,
) -> _Answer:
    """Return the best trial as the finer poses see it, searched on until it holds there."""
    coarse = Evaluator(case, state.regime)
    finer = Evaluator(case, state.regime, TRIAL.finer(FINER))
    tighter = np.zeros(len(case.requirements.bounds))
    for _ in range(ROUNDS_OF_REPAIR):
        best = np.array([state.best])
        found = finer.evaluate(best)[0]
        if found.feasible or not state.feasible:
            break
        seen = coarse.evaluate(best)[0]
        for index, bound in enumerate(case.requirements.bounds):
            values = seen.worst[index], found.worst[index]
            if np.isfinite(values).all():
                before, after = bound.margin(values)
                tighter[index] = max(tighter[index], SLACK * (before - after))
        coarse = Evaluator(case, state.regime, tighter=tuple(tighter.tolist()))
        try:
            state = replace(search_round(coarse, state, workers, progress), done=True)
        except Canceled:
            break
    return _Answer(state.regime, state, found)


def _result(
    case: SynthesisCase,
    answers: list[_Answer],
    states: tuple[RegimeState, ...],
    canceled: bool,
) -> SynthesisResult:
    sign = find_objective(case.objective).sign
    best = min(answers, key=lambda answer: answer.found.cost(sign), default=None)
    trial = best and best.found.trial
    return SynthesisResult(
        case=case,
        design=case.reference if trial is None else replace(trial.design, name=case.name),
        workspace=case.workspace if trial is None else trial.workspace,
        regime=best and best.regime,
        feasible=best is not None and best.found.feasible,
        objective=best.found.objective if best else float("nan"),
        outcomes=_outcomes(case, best.found) if best else (),
        states=states,
        refused={},
        canceled=canceled,
        poses=0 if trial is None else trial.poses.over(case.requirements.theta).poses,
    )


def _outcomes(case: SynthesisCase, found: Evaluation) -> tuple[Outcome, ...]:
    rows = []
    for bound, value in zip(case.requirements.bounds, found.worst.tolist(), strict=True):
        margin = float(bound.margin(value))
        near = bound.high if bound.low is None or bound.high is not None else bound.low
        rows.append(Outcome(bound, value, margin, abs(margin) <= ACTIVE * abs(near or 1.0)))
    for limit, value in zip(case.limits, found.limits.tolist(), strict=True):
        margin = find_objective(limit.objective).sign * (limit.most - value)
        rows.append(Outcome(limit, value, margin, abs(margin) <= ACTIVE * abs(limit.most)))
    return tuple(rows)
