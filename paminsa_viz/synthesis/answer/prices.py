"""What each requirement costs: by how much the optimum falls where a requirement is relaxed.

Masses, counterweights and springs have exact shadow prices, the multipliers of their convex
program (`InnerSolution.active`). For what lengths have to meet, the case is solved again near the
answer with the requirement tightened and relaxed by a step; the price is the slope between the two.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.progress import Canceled, Progress, go_on, keep_on, of_part
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.search.case import SynthesisCase
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.outer import numbers_of, refined
from paminsa_viz.synthesis.search.result import SynthesisResult

STEP = 0.02
"""Step of a requirement, as a share of its bound."""

AT_END = 2e-3
"""A number is at an end of its range within this share of the range."""

STILL = 2e-4
"""Change of the objective, as a share of it, below which a requirement counts as free: what the
search leaves open."""


class Requirable(NamedTuple):
    """Something that a case asks for and that can be moved.

    Attributes:
        label: What it is.
        unit: Its SI unit.
        bound: Its value [SI].
        tighter: Which way it is tightened: +1 up, -1 down.
        moved: ``moved(value)`` is the case with another value.
    """

    label: str
    unit: str
    bound: float
    tighter: float
    moved: Callable[[float], SynthesisCase]


@dataclass(frozen=True)
class RequirementPrice:
    """What a requirement costs.

    Attributes:
        label: What is required.
        unit: Its SI unit.
        bound: Its bound [SI].
        step: By how much it was moved to either side [SI].
        tightened, relaxed: The optimum with the bound so [SI]; NaN where nothing was found.
        price: What the optimum improves by for one unit of relaxation [SI]; zero within what the
            search leaves open, NaN if it is not known.
    """

    label: str
    unit: str
    bound: float
    step: float
    tightened: float
    relaxed: float
    price: float


def requirement_prices(
    result: SynthesisResult,
    *,
    step: float = STEP,
    rounds: int = 4,
    workers: Workers = here,
    progress: Progress = go_on,
) -> tuple[RequirementPrice, ...]:
    """Return what the active requirements of an answer cost, and what its workspace does.

    Args:
        result: An answer that meets its requirements.
        step: How far each is moved to either side, as a share of its bound.
        rounds: Most rounds of each search, see `search.outer.refined`.
        workers: Where trials are computed; the result is the same.
        progress: Called after each requirement, and while each is searched; true ends it with
            those done.

    Returns:
        The prices, those first whose step changes the optimum most.
    """
    if not result.feasible or result.regime is None:
        return ()
    case, regime = result.case, result.regime
    numbers = numbers_of(case, result.design, result.workspace)
    sign = find_objective(case.objective).sign

    items = list(_requirables(result, numbers))
    total = 1 + 2 * len(items)

    def best(trial: SynthesisCase, before: int) -> float:
        near = np.clip(numbers, *trial.bounds.T)
        part = of_part(progress, before / total, (before + 1) / total)
        found = refined(trial, regime, near.tolist(), rounds=rounds, workers=workers, progress=part)
        return sign * found.objective

    prices = []
    with suppress(Canceled):
        base = best(case, 0) if items else np.nan
        for before, item in zip(range(1, total, 2), items, strict=True):
            size = step * (abs(item.bound) or 1.0)
            ends = []
            for turn, side in enumerate((item.tighter, -item.tighter)):
                try:
                    ends.append(best(item.moved(item.bound + side * size), before + turn))
                except ValueError:  # no such case: an empty range, a workspace of no size
                    ends.append(np.nan)
            high, low = (base if np.isnan(end) else end for end in ends)
            width = size * np.count_nonzero(~np.isnan(ends))
            still = abs(high - low) <= STILL * abs(base)
            price = np.nan if not width else 0.0 if still else (high - low) / width
            tightened, relaxed = (sign * end for end in ends)
            prices.append(
                RequirementPrice(
                    item.label, item.unit, item.bound, size, tightened, relaxed, float(price)
                )
            )
            keep_on(progress, (before + 2) / total)
    return tuple(sorted(prices, key=lambda p: -abs(np.nan_to_num(p.price)) * p.step))


def _requirables(result: SynthesisResult, numbers: Sequence[float]) -> Iterator[Requirable]:
    case = result.case
    bounds = case.requirements.bounds
    for index, outcome in enumerate(result.outcomes):
        if outcome.active and index < len(bounds):
            yield _bound(case, index, outcome.value)
        elif outcome.active:
            yield _limit(case, index - len(bounds))
    for index, (item, value) in enumerate(zip(case.ranges, numbers, strict=True)):
        near = AT_END * (item.high - item.low)
        for end, word, tighter in (("low", "least", 1.0), ("high", "largest", -1.0)):
            at = getattr(item, end)
            if abs(value - at) <= near:
                yield Requirable(
                    f"{word} {item.path.partition('.')[2]}",
                    "" if item.path == "geometry.magnification" else "m", at, tighter,
                    partial(_with_range, case, index, end),
                )  # fmt: skip
    (width, depth, height), (low, high) = case.workspace.size, case.requirements.theta
    if "workspace.width" not in case.paths:
        yield Requirable(
            "width of the workspace", "m", width, 1.0,
            lambda v: _with_size(case, (v, depth * v / width, height)),
        )  # fmt: skip
    if "workspace.height" not in case.paths:
        yield Requirable(
            "height of the workspace", "m", height, 1.0,
            lambda v: _with_size(case, (width, depth, v)),
        )  # fmt: skip
    if low < high:
        yield Requirable("range of theta", "rad", high - low, 1.0, partial(_with_turn, case))


def _bound(case: SynthesisCase, index: int, value: float) -> Requirable:
    bound = case.requirements.bounds[index]
    both = bound.low is not None and bound.high is not None and bound.low == -bound.high
    upper = bound.low is None or (
        bound.high is not None and (both or abs(value - bound.high) <= abs(value - bound.low))
    )

    def moved(at: float) -> SynthesisCase:
        ends = {"high": at, "low": -at} if both else {"high" if upper else "low": at}
        bounds = _replaced(case.requirements.bounds, index, **ends)
        return replace(case, requirements=replace(case.requirements, bounds=bounds))

    at = bound.high if upper else bound.low
    assert at is not None
    return Requirable(bound.entry.title, bound.entry.unit, at, -1.0 if upper else 1.0, moved)


def _limit(case: SynthesisCase, index: int) -> Requirable:
    limit = case.limits[index]
    objective = find_objective(limit.objective)

    def moved(at: float) -> SynthesisCase:
        return replace(case, limits=_replaced(case.limits, index, most=at))

    return Requirable(objective.title, objective.unit, limit.most, -objective.sign, moved)


def _replaced(items: Sequence[Any], index: int, **changes: float) -> tuple[Any, ...]:
    """Return items with changes in one of them."""
    return (*items[:index], replace(items[index], **changes), *items[index + 1 :])


def _with_range(case: SynthesisCase, index: int, end: str, value: float) -> SynthesisCase:
    return replace(case, ranges=_replaced(case.ranges, index, **{end: value}))


def _with_size(case: SynthesisCase, size: tuple[float, float, float]) -> SynthesisCase:
    workspace = replace(case.workspace, size=size)
    return replace(case, requirements=replace(case.requirements, workspace=workspace))


def _with_turn(case: SynthesisCase, width: float) -> SynthesisCase:
    middle = 0.5 * sum(case.requirements.theta)
    theta = (middle - 0.5 * width, middle + 0.5 * width)
    return replace(case, requirements=replace(case.requirements, theta=theta))
