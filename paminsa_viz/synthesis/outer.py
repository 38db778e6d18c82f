"""The outer search: differential evolution over lengths and heights, in rounds.

Each round is a run of SciPy's `differential_evolution` that starts from the population of the one
before, with random numbers of its own that follow from the seed and the round. So a search goes on
from a checkpoint as if it had not been stopped, and is the same wherever its trials are computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.case import Regime, SynthesisCase
from paminsa_viz.synthesis.evaluation import REFUSED, Evaluator
from paminsa_viz.synthesis.margins import Canceled

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

EXPLORE = 0.6
"""Share of the generations in which trials are made from any others; then from the best as well."""

EXPLORING: dict[str, Any] = {
    "strategy": "rand1bin", "mutation": (0.4, 0.8), "recombination": 0.9
}  # fmt: skip
CONVERGING: dict[str, Any] = {"strategy": "currenttobest1bin", "recombination": 0.9}

ROUND = 10
"""Generations of a round."""

PART = 24
"""Trials handed to a worker at a time."""

STILL = 3
"""Rounds without progress after which a search ends."""

PROGRESS = 2e-4
"""What counts as progress, as a share of the objective."""


@dataclass(frozen=True)
class RegimeState:
    """How far the search of one regime is; all that it goes on from.

    Attributes:
        regime: The regime.
        generation: Generations done.
        trials: Robots tried.
        population: Numbers of the last trials, rows by trial, from 0 to 1 within the ranges;
            empty at the start.
        best: Numbers of the best trial [SI].
        history: Best cost after each generation.
        done: Whether the search has ended.
    """

    regime: Regime
    generation: int = 0
    trials: int = 0
    population: tuple[tuple[float, ...], ...] = ()
    best: tuple[float, ...] = ()
    history: tuple[float, ...] = ()
    done: bool = False

    @property
    def cost(self) -> float:
        """Best cost, infinite at the start."""
        return self.history[-1] if self.history else np.inf

    @property
    def feasible(self) -> bool:
        """Whether the best trial meets all requirements."""
        return self.cost < REFUSED


@dataclass(frozen=True)
class SearchProgress:
    """How far a search is.

    Attributes:
        regime: What is searched.
        generation: Generations done in this regime.
        trials: Robots tried in this regime.
        cost: Its best cost; the objective, with its sign turned where it is maximized.
        feasible: Whether the best trial meets all requirements.
        best: Numbers of the best trial, for `SynthesisCase.design` [SI].
    """

    regime: Regime
    generation: int
    trials: int
    cost: float
    feasible: bool
    best: tuple[float, ...]


def search_round(
    evaluator: Evaluator,
    state: RegimeState,
    workers: Workers = here,
    progress: Callable[[SearchProgress], bool | None] | None = None,
    *,
    generations: int = ROUND,
) -> RegimeState:
    """Return the state after one more round.

    Args:
        evaluator: Evaluates the trials.
        state: Where the search is.
        workers: Where trials are computed.
        progress: Called after each generation; true ends the search.
        generations: Most generations of the round.

    Raises:
        Canceled: If the progress function ended it; the state at the round's start stays valid.
    """
    case = evaluator.case
    low, high = case.bounds.T
    history: list[float] = []
    canceled = False

    def in_parts(_: object, trials: Iterable[Any]) -> list[float]:
        listed = [low + (high - low) * np.asarray(row) for row in trials]
        parts = [listed[start : start + PART] for start in range(0, len(listed), PART)]
        return list(chain.from_iterable(workers.in_order(evaluator.costs, parts)))

    def after_generation(intermediate_result: OptimizeResult) -> None:
        nonlocal canceled
        cost = float(intermediate_result.fun)
        history.append(cost)
        if progress is None:
            return
        best = tuple((low + (high - low) * intermediate_result.x).tolist())
        trials = state.trials + int(intermediate_result.nfev)
        count = state.generation + len(history)
        if progress(SearchProgress(evaluator.regime, count, trials, cost, cost < REFUSED, best)):
            canceled = True
            raise StopIteration

    from scipy.optimize import differential_evolution  # slow to load

    regimes = list(Regime)
    seed = [case.seed, regimes.index(evaluator.regime), state.generation]
    # SciPy never calls the function itself where the map is given.
    found = differential_evolution(
        evaluator.costs, [(0.0, 1.0)] * len(low), maxiter=generations,
        popsize=case.effort.population, rng=np.random.default_rng(seed),
        init=cast(Any, np.array(state.population) if state.population else "sobol"),
        callback=after_generation, polish=False, updating="deferred",
        workers=cast(Any, in_parts), tol=1e-6,
        **(EXPLORING if state.generation < EXPLORE * case.effort.generations else CONVERGING),
    )  # fmt: skip
    if canceled:
        raise Canceled
    after = replace(
        state,
        generation=state.generation + int(found.nit),
        trials=state.trials + int(found.nfev),
        population=tuple(map(tuple, found.population.tolist())),
        best=tuple((low + (high - low) * found.x).tolist()),
        history=state.history + tuple(history),
    )
    return replace(after, done=_has_ended(case, after, bool(found.success)))


def _has_ended(case: SynthesisCase, state: RegimeState, converged: bool) -> bool:
    if converged or state.generation >= case.effort.generations:
        return True
    back = STILL * ROUND
    if len(state.history) <= back:  # it started late, near an answer
        return False
    if not state.feasible or state.generation < EXPLORE * case.effort.generations + back:
        return False
    before, now = state.history[-back - 1], state.history[-1]
    return before < REFUSED and before - now <= PROGRESS * abs(now)
