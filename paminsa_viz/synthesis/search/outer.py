"""The outer search: differential evolution over lengths and heights, in rounds.

Each round is a run of SciPy's `differential_evolution` that starts from the population of the one
before, with random numbers of its own that follow from the seed and the round. So a search goes on
from a checkpoint as if it had not been stopped, and is the same wherever its trials are computed.
Near an answer it is made again for a case that has changed a little (`refined`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Canceled, Progress, go_on
from paminsa_viz.quantities.requirements import Workspace
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.search.case import Regime, SynthesisCase
from paminsa_viz.synthesis.search.evaluation import REFUSED, Evaluator, TrialEvaluation

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


def search_round(
    evaluator: Evaluator,
    state: RegimeState,
    workers: Workers = here,
    progress: Progress = go_on,
    *,
    generations: int = ROUND,
) -> RegimeState:
    """Return the state after one more round.

    Args:
        evaluator: Evaluates the trials.
        state: Where the search is.
        workers: Where trials are computed.
        progress: Called after each generation with the ``state`` that is reached; true ends the
            search.
        generations: Most generations of the round.

    Raises:
        Canceled: If the progress function ended it; the state at the round's start stays valid.
    """
    case = evaluator.case
    low, high = case.bounds.T
    history: list[float] = []
    # of the robot that each trial is to replace, or of one no better
    most: list[float] = []
    canceled = False

    def in_parts(_: object, trials: Iterable[Any]) -> list[float]:
        nonlocal most
        listed = [low + (high - low) * np.asarray(row) for row in trials]
        limits = most or [np.inf] * len(listed)
        starts = range(0, len(listed), PART)
        best = min(most, default=state.cost)
        parts = [(listed[n : n + PART], limits[n : n + PART], best) for n in starts]
        found = list(chain.from_iterable(workers.in_order(partial(_costs, evaluator), parts)))
        if not most:  # SciPy then exchanges the first of them with the best
            most = found.copy()
            most[int(np.argmin(found))] = found[0]
        return found

    def reached(found: OptimizeResult, generations: int) -> RegimeState:
        return replace(
            state,
            generation=state.generation + generations,
            trials=state.trials + int(found.nfev),
            best=tuple((low + (high - low) * found.x).tolist()),
            history=state.history + tuple(history),
        )

    def after_generation(intermediate_result: OptimizeResult) -> None:
        nonlocal canceled, most
        history.append(float(intermediate_result.fun))
        most = intermediate_result.population_energies.tolist()
        now = reached(intermediate_result, len(history))
        if progress(min(1.0, now.generation / case.effort.generations), state=now):
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
    population = tuple(map(tuple, found.population.tolist()))
    after = replace(reached(found, int(found.nit)), population=population)
    return replace(after, done=_has_ended(case, after, bool(found.success)))


def _costs(evaluator: Evaluator, part: tuple[list[Array], list[float], float]) -> list[float]:
    """Return the costs of a part of the trials, see `Evaluator.costs`."""
    return evaluator.costs(*part)


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


SPREAD = 0.02
"""Spread of the trials about the answer, as a share of the ranges."""

STEP = 15
"""Generations of a round."""


def cloud(
    case: SynthesisCase,
    answers: Sequence[Sequence[float]],
    spread: float = SPREAD,
    others: float = 0.0,
    *,
    count: int = 0,
    turn: int = 0,
) -> tuple[tuple[float, ...], ...]:
    """Return trials about some answers, for `RegimeState.population`; the answers are among them.

    Args:
        case: The case; its seed decides the trials.
        answers: Numbers in the order of the case's paths [SI].
        spread: Standard deviation, as a share of the ranges.
        others: Share of trials anywhere in the ranges.
        count: How many there are; 0 for as many as the effort of the case says.
        turn: Decides the trials with the seed; 0 for the number of answers.
    """
    low, high = case.bounds.T
    near = (np.atleast_2d(np.array(answers, np.float64)) - low) / (high - low)
    count = count or max(case.effort.population * len(low), 2 * len(near))
    rng = np.random.default_rng([case.seed, turn or len(near)])
    rows = near[np.arange(count) % len(near)] + rng.normal(0.0, spread, (count, len(low)))
    rows[: len(near)] = near
    anywhere = int(others * count)
    if anywhere:
        rows[count - anywhere :] = rng.uniform(0.0, 1.0, (anywhere, len(low)))
    return tuple(map(tuple, np.clip(rows, 0.0, 1.0).tolist()))


def refined(
    case: SynthesisCase,
    regime: Regime,
    numbers: Sequence[float],
    *,
    rounds: int = 4,
    workers: Workers = here,
    progress: Progress = go_on,
) -> TrialEvaluation:
    """Return the best robot near some numbers, by a few rounds of the same search.

    Args:
        case: The case.
        regime: The regime of the numbers.
        numbers: Where to start, in the order of the case's paths [SI].
        rounds: Most rounds of `STEP` generations; it ends when one makes no progress.
        workers: Where trials are computed.
        progress: Called after each generation.

    Raises:
        Canceled: If ``progress`` ends it.
    """

    def tell(_: float, /, *, state: RegimeState, **_known: Any) -> bool | None:
        return progress((state.generation - late) / (STEP * rounds))

    evaluator = Evaluator(case, regime)
    # as late in the search as trials are made from the best as well
    late = int(np.ceil(EXPLORE * case.effort.generations))
    state = RegimeState(regime, late, population=cloud(case, [numbers]))
    for _ in range(rounds):
        before = state.cost
        state = search_round(evaluator, state, workers, tell, generations=STEP)
        if before - state.cost <= 0.1 * PROGRESS * abs(state.cost):
            break
    return evaluator.evaluate(np.array([state.best]))[0]


def numbers_of(case: SynthesisCase, design: Design, workspace: Workspace) -> tuple[float, ...]:
    """Return a robot with its workspace as numbers of the search, in the order of the paths."""
    _, _, z = workspace.center
    places = {
        "workspace.z": z,
        "workspace.width": workspace.size[0],
        "workspace.height": workspace.size[2],
    }
    found = [places[p] if p in places else design.value(p) for p in case.paths]
    assert None not in found  # a workspace of an answer has a height
    return tuple(float(value) for value in found if value is not None)
