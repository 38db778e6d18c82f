"""Synthesis: the robot that meets requirements over a workspace and minimizes an objective."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arrays import Array
from paminsa_viz.progress import Canceled, Progress, go_on
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.proof.certificate import prove as prove_workspace
from paminsa_viz.synthesis.proof.evidence import Proof, Verdict
from paminsa_viz.synthesis.search.case import ObjectiveLimit, Regime, SynthesisCase
from paminsa_viz.synthesis.search.evaluation import Evaluator, TrialEvaluation
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.outer import ROUND, RegimeState, cloud, search_round
from paminsa_viz.synthesis.search.refusals import refusal
from paminsa_viz.synthesis.search.region import TRIAL
from paminsa_viz.synthesis.search.result import RelaxedBound, SynthesisResult, limit_of, outcomes_of

FINER = 4
"""How many times closer the poses of the verification lie."""

REPAIRS = 8
"""Times that the search goes on with tighter bounds until its answer holds on the finer poses."""

REPAIR_ROUND = 40
"""Generations that it goes on for."""

CLOUD = 0.01
"""Spread of the trials that it goes on from, about the best, as a share of the ranges."""

SLACK = 1.05
"""By how much more than what the finer poses exceed a bound is tightened."""


@dataclass(frozen=True, eq=False)
class _Answer:
    state: RegimeState
    found: TrialEvaluation
    proof: Proof | None = None


@dataclass(frozen=True)
class _Run:
    """What the searches of one synthesis share."""

    case: SynthesisCase
    workers: Workers
    progress: Progress
    relaxed: int | None = None
    prove: float | None = None

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
        """Return the best trial as the finer poses see it, searched on until it holds there.

        And, where a proof is wanted, until none finds a pose that breaks a requirement.
        """
        bounds = (*self.case.requirements.bounds, *self.case.limits)
        plain = Evaluator(self.case, state.regime, relaxed=self.relaxed)
        finer = replace(plain, density=TRIAL.finer(FINER))
        tighter = np.zeros(len(bounds))
        answer = self._answer(finer, state)
        if not state.feasible or not repair:
            return answer
        for _ in range(REPAIRS):
            excess = self._refuted(answer)
            if answer.found.feasible and not excess.any():
                break
            seen, found = plain.evaluate(np.array([state.best]))[0], answer.found
            for index, bound in enumerate(bounds):
                values = seen.values[index], found.values[index]
                if np.isfinite(values).all():
                    before, after = map(bound.margin, values)
                    excess[index] = max(excess[index], before - after)
            tighter = np.maximum(tighter, SLACK * excess)
            evaluator = replace(plain, tighter=tuple(tighter.tolist()))
            near = cloud(
                self.case, [state.best], CLOUD, count=len(state.population), turn=state.generation
            )
            state = replace(state, population=near, history=())
            try:
                state = search_round(
                    evaluator, state, self.workers, self.progress, generations=REPAIR_ROUND
                )
            except Canceled:
                break
            answer = self._answer(finer, state)
        return answer

    def _refuted(self, answer: _Answer) -> Array:
        """Return by how much a pose of the proof breaks each bound and limit [SI], zero if none."""
        bounds = self.case.requirements.bounds
        excess = np.zeros(len(answer.found.values))
        for item in () if answer.proof is None else answer.proof.evidence:
            if item.verdict is Verdict.REFUTED and item.requirement in bounds:
                excess[bounds.index(item.requirement)] = max(0.0, -item.margin)
        return excess

    def _answer(self, finer: Evaluator, state: RegimeState) -> _Answer:
        """Evaluate the best trial on the finer poses, and prove it if it holds there."""
        found = finer.evaluate(np.array([state.best]))[0]
        proof = None
        trial = found.trial
        sprung = trial is not None and trial.inner is not None and bool(trial.inner.springs)
        if self.prove is not None and found.feasible and trial is not None and not sprung:
            required = replace(self.case.requirements, workspace=trial.workspace)
            proof = prove_workspace(trial.design, required, time_limit=self.prove)
        return _Answer(state, found, proof)


@kinds_checked
def synthesize(
    case: SynthesisCase,
    *,
    workers: Workers = here,
    progress: Progress = go_on,
    states: tuple[RegimeState, ...] = (),
    checkpoint: Callable[[tuple[RegimeState, ...]], None] | None = None,
    relax: bool = True,
    prove: float | None = None,
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
        progress: Called after each generation with the ``state`` of the regime that is searched,
            its best robot so far; true ends the search with it.
        states: Where an earlier search of the same case was; it goes on from there.
        checkpoint: Called after each round with where the search is.
        relax: Whether to look for relaxations where there is no answer.
        prove: Time for a proof of the answer over the whole workspace [s]; None for no proof. A
            pose that it finds to break a requirement tightens its bound, too. It knows of no
            springs: there is none with them.
    """
    latest: dict[Regime, RegimeState] = {}

    def watch(done: float, /, *, state: RegimeState, **_: Any) -> bool | None:
        latest[state.regime] = state
        turn = case.regimes.index(state.regime)
        return progress((turn + done) / len(case.regimes), state=state)

    run = _Run(case, workers, watch, prove=prove)
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
        best = latest.get(regime) if canceled else reached[regime]
        if best is not None:
            answers.append(run.verify(best, repair=not canceled))
    found = any(answer.found.feasible for answer in answers)
    searched = tuple(regime for regime in case.regimes if regime not in refused)
    relaxed: tuple[RelaxedBound, ...] = ()
    if relax and searched and not found and not canceled:
        relaxed = relaxations(case, searched, workers, progress)
    return _result(case, answers, tuple(reached.values()), refused, relaxed, canceled)


@kinds_checked
def relaxations(
    case: SynthesisCase,
    regimes: tuple[Regime, ...],
    workers: Workers = here,
    progress: Progress = go_on,
) -> tuple[RelaxedBound, ...]:
    """Return for each bound and limit the nearest value at which the others can be met.

    Of a range, each side by itself, while the other one is kept; a bound on a magnitude has one.
    The one that changes least comes first. A single search each, so that a still nearer value may
    exist.
    """
    split = tuple(side for bound in case.requirements.bounds for side in sides(bound))
    case = replace(case, requirements=replace(case.requirements, bounds=split))
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
        limit = limit_of(bound)
        low = isinstance(bound, Requirement) and bound.high is None
        maximized = isinstance(bound, ObjectiveLimit) and find_objective(bound.objective).largest
        nearest = limit + (-least if low or maximized else least)
        nearest = nearest if np.isfinite(nearest) else float("nan")
        found.append(RelaxedBound(bound, float(nearest), float(least / (abs(limit) or 1.0))))
    return tuple(sorted(found, key=lambda item: item.change))


def sides(bound: Requirement) -> tuple[Requirement, ...]:
    """Return the sides of a range as bounds; what has one side, or is on a magnitude, is one."""
    if bound.low is None or bound.high is None or bound.low == -bound.high:
        return (bound,)
    return replace(bound, high=None), replace(bound, low=None)


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
        design=case.reference if trial is None else replace(trial.design, name=case.title),
        workspace=case.workspace if trial is None else trial.workspace,
        regime=best and best.state.regime,
        feasible=best is not None and best.found.feasible,
        objective=best.found.objective if best else float("nan"),
        outcomes=outcomes_of(case, best.found) if best else (),
        states=states,
        refused=refused,
        relaxed=relaxed,
        canceled=canceled,
        poses=0 if trial is None else trial.poses.over(case.requirements.theta).poses,
        inner=trial and trial.inner,
        proof=best and best.proof,
    )
