"""The search again near an answer, for a case that has changed a little."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirements import Workspace
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.case import Regime, SynthesisCase
from paminsa_viz.synthesis.evaluation import Evaluator, TrialEvaluation
from paminsa_viz.synthesis.outer import (
    EXPLORE,
    PROGRESS,
    RegimeState,
    SearchProgress,
    search_round,
)
from paminsa_viz.synthesis.samples import Density

SPREAD = 0.02
"""Spread of the trials about the answer, as a share of the ranges."""

STEP = 15
"""Generations of a round."""


@dataclass(frozen=True, eq=False)
class LocalOptimum:
    """The best robot near an answer.

    Attributes:
        numbers: What is searched, in the order of the case's paths [SI].
        found: Its values.
    """

    numbers: tuple[float, ...]
    found: TrialEvaluation

    @property
    def objective(self) -> float:
        """What is minimized [SI]; NaN if the requirements are not met."""
        return self.found.objective


def cloud(
    case: SynthesisCase,
    answers: Sequence[Sequence[float]],
    spread: float = SPREAD,
    others: float = 0.0,
) -> tuple[tuple[float, ...], ...]:
    """Return trials about some answers, for `RegimeState.population`; the answers are among them.

    Args:
        case: The case; its seed decides the trials.
        answers: Numbers in the order of the case's paths [SI].
        spread: Standard deviation, as a share of the ranges.
        others: Share of trials anywhere in the ranges.
    """
    low, high = case.bounds.T
    near = (np.atleast_2d(np.array(answers, np.float64)) - low) / (high - low)
    count = max(case.effort.population * len(low), 2 * len(near))
    rng = np.random.default_rng([case.seed, len(near)])
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
    spread: float = SPREAD,
    density: Density | None = None,
    workers: Workers = here,
    progress: Callable[[SearchProgress], bool | None] | None = None,
) -> LocalOptimum:
    """Return the best robot near some numbers, by a few rounds of the same search.

    Args:
        case: The case.
        regime: The regime of the numbers.
        numbers: Where to start, in the order of the case's paths [SI].
        rounds: Most rounds of `STEP` generations; it ends when one makes no progress.
        spread: Of the first trials, as a share of the ranges.
        density: Of the poses; None for that of the search.
        workers: Where trials are computed.
        progress: Called after each generation; true ends it.

    Raises:
        Canceled: If the progress function ended it.
    """
    evaluator = Evaluator(case, regime) if density is None else Evaluator(case, regime, density)
    # as late in the search as trials are made from the best as well
    late = int(np.ceil(EXPLORE * case.effort.generations))
    state = RegimeState(regime, late, population=cloud(case, [numbers], spread))
    for _ in range(rounds):
        before = state.cost
        state = search_round(evaluator, state, workers, progress, generations=STEP)
        if before - state.cost <= 0.1 * PROGRESS * abs(state.cost):
            break
    found = evaluator.evaluate(np.array([state.best]))[0]
    return LocalOptimum(state.best, found)


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
