"""Search for lengths: the robot that does best over a box of poses that it has to reach.

A global search by differential evolution (SciPy). Not convex, so without a proof: it finds good
lengths, and the same ones for the same seed, whatever it runs on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.resizing import resized
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.studies.requirements import BoxRequirements, Measures, measure

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

DEFAULT_PATHS = (
    "geometry.base_radius", "geometry.platform_radius", "geometry.magnification",
    "geometry.crank_length", "geometry.coupler_length",
)  # fmt: skip
"""Lengths searched by default: R_b, R_pl, k, and the bars B3 and B8, B4."""

REFUSED = 1e9
"""Cost from which a trial breaks a requirement; below it, all are met."""

PART = 8
"""Trials handed to a worker at a time."""


@dataclass(frozen=True)
class Weights:
    """Weights of the sum that the search minimizes.

    Attributes:
        torque: Of the peak static torque of M1..M3 over the box [1/(N m)].
        condition: Of the largest condition number over the box.
        size: Of R_b + l_B8 + l_B4 [1/m].
    """

    torque: float = 1.0
    condition: float = 0.0
    size: float = 0.0

    def of(self, measures: Measures) -> float:
        """Return the weighted sum; a weight of zero leaves out what may be infinite."""
        names = [name for name in ("size", "torque", "condition") if getattr(self, name)]
        return float(sum(getattr(self, name) * getattr(measures, name) for name in names))


@dataclass(frozen=True)
class GeometryCost:
    """The cost of a list of lengths; can be sent to another process.

    Lengths that break a requirement cost `REFUSED` and more, the more they break it.
    """

    design: Design
    paths: tuple[str, ...]
    needs: BoxRequirements
    weights: Weights
    scale_bars: bool

    def robot(self, lengths: Array) -> Design:
        """Return the design with these lengths.

        Raises:
            InvalidDesign: If there is none.
        """
        values = dict(zip(self.paths, map(float, lengths), strict=True))
        return resized(self.design, values, scale_bars=self.scale_bars)

    def __call__(self, lengths: Array) -> float:
        """Return the cost."""
        try:
            found = measure(self.robot(lengths), self.needs)
        except InvalidDesign:
            return 1e3 * REFUSED
        broken = found.broken(self.needs)
        cost = REFUSED * (1.0 + broken) if broken > 0 else self.weights.of(found)
        return float(cost) if np.isfinite(cost) else 1e3 * REFUSED

    def of_all(self, trials: Iterable[Array]) -> list[float]:
        """Return the costs of some lengths."""
        return [self(lengths) for lengths in trials]


@dataclass(frozen=True)
class SearchProgress:
    """How far a search is.

    Attributes:
        generation: Generations done.
        trials: Robots tried.
        cost: The best cost.
        feasible: Whether the best is a robot that meets the requirements.
    """

    generation: int
    trials: int
    cost: float
    feasible: bool


@dataclass(frozen=True, eq=False)
class SearchResult:
    """Result of a search.

    Attributes:
        design: The best robot.
        before, after: Measures of the first design and of the best, over the finer box.
        feasible: Whether it meets the requirements, also on the finer box.
        cost: Its weighted sum, or more than `REFUSED`.
        history: Best cost after each generation.
        trials: Robots tried.
        canceled: Whether it was ended by the progress function.
    """

    design: Design
    before: Measures
    after: Measures
    feasible: bool
    cost: float
    history: tuple[float, ...]
    trials: int
    canceled: bool


def search_geometry(
    design: Design,
    needs: BoxRequirements,
    weights: Weights | None = None,
    *,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    scale_bars: bool = True,
    seed: int = 0,
    generations: int = 60,
    population: int = 12,
    workers: Workers = here,
    progress: Callable[[SearchProgress], bool | None] | None = None,
) -> SearchResult:
    """Search for the lengths that minimize a weighted sum and meet requirements over a box.

    Args:
        design: Where the other numbers come from.
        needs: The box, and what has to hold over it.
        weights: What to minimize; default the peak static torque.
        ranges: Least and largest value of each path searched; default half to twice the design's
            own for `DEFAULT_PATHS` (k from 1.5).
        scale_bars: Whether bars gain mass and inertia with their length, see `resized`.
        seed: The same seed gives the same result.
        generations: Most generations.
        population: Trials in a generation for each path.
        workers: Where the trials are computed; the result is the same.
        progress: Called after each generation; true ends the search with the best so far.

    Raises:
        InvalidInput: If a range is empty, or a path is no length.
    """
    chosen = _default_ranges(design) if ranges is None else _checked(ranges)
    trial = GeometryCost(design, tuple(chosen), needs, weights or Weights(), scale_bars)
    history: list[float] = []
    canceled = False

    def in_parts(_: object, trials: Iterable[Any]) -> list[float]:
        listed = list(trials)
        parts = (listed[start : start + PART] for start in range(0, len(listed), PART))
        return list(chain.from_iterable(workers.in_order(trial.of_all, parts)))

    def after_generation(intermediate_result: OptimizeResult) -> None:
        nonlocal canceled
        best = float(intermediate_result.fun)
        history.append(best)
        state = SearchProgress(len(history), int(intermediate_result.nfev), best, best < REFUSED)
        if progress is not None and progress(state):
            canceled = True
            raise StopIteration

    from scipy.optimize import differential_evolution  # slow to load

    found = differential_evolution(
        trial, list(chosen.values()), maxiter=generations, popsize=population,
        rng=np.random.default_rng(seed), callback=after_generation, polish=False,
        updating="deferred", workers=cast(Any, in_parts), tol=1e-6,
    )  # fmt: skip
    try:
        best = trial.robot(found.x)
    except InvalidDesign:
        best = design
    finer = needs.finer()
    after = measure(best, finer)
    return SearchResult(
        design=replace(best, name=design.name),
        before=measure(design, finer),
        after=after,
        feasible=bool(found.fun < REFUSED) and after.broken(needs) <= 0,
        cost=float(found.fun),
        history=tuple(history),
        trials=int(found.nfev),
        canceled=canceled,
    )


def _default_ranges(design: Design) -> dict[str, tuple[float, float]]:
    least = {"geometry.magnification": 1.5}
    held = {path: design.value(path) for path in DEFAULT_PATHS}
    return {path: (max(0.5 * v, least.get(path, 0.0)), 2.0 * v) for path, v in held.items()}


def _checked(ranges: Mapping[str, tuple[float, float]]) -> Mapping[str, tuple[float, float]]:
    for path, (low, high) in ranges.items():
        if not path.startswith("geometry."):
            raise InvalidInput(path, "only lengths of the geometry can be searched")
        if not (np.isfinite([low, high]).all() and low < high):
            raise InvalidInput(path, f"a range with low < high is needed, not {low!r} to {high!r}")
    if not ranges:
        raise InvalidInput("ranges", "at least one length has to be searched")
    return ranges
