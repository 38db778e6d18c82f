"""Causes over the cells of a map: what breaks at one heading and height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.design import Design
from paminsa_viz.model.grid import xy_grid
from paminsa_viz.model.grids import Field, solve_field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.causes import (
    FIRST_REACH,
    FIRST_REQUIREMENT,
    INSIDE,
    SINGULAR,
    VolumeCause,
    causes_of,
)
from paminsa_viz.synthesis.reach_bounds import reach_bounds

_TURN_SLACK = 1e-9


@dataclass(frozen=True, eq=False)
class Slice:
    """Causes at the cells of a map, at its own heading and height.

    Attributes:
        cause: (y, x) codes, see `Volume.causes`; of several requirements that break, the one whose
            margin is the most negative part of its bound.
        broken: (requirements, y, x) where each requirement breaks.
        causes: What the codes mean.
    """

    cause: NDArray[np.uint8]
    broken: NDArray[np.bool_]
    causes: tuple[VolumeCause, ...]


def cause_slice(
    design: Design,
    requirements: Requirements,
    x: ArrayLike,
    y: ArrayLike,
    theta: float,
    z: float,
    *,
    field: Field | None = None,
) -> Slice:
    """Return what breaks at each cell of a map, at one heading and height.

    A requirement whose own range of headings or heights the map is not in does not count.

    Args:
        design: The robot.
        requirements: What has to hold.
        x, y: Positions of columns and rows [m].
        theta: Heading [rad].
        z: Height [m].
        field: The map as it is solved already, if it is.
    """
    grid = xy_grid(x, y, theta, z)
    if field is None:
        field = solve_field(design.geometry, grid)
    columns, rows = grid.axes[1][1], grid.axes[0][1]
    regular = reach_bounds(design.geometry, columns[None, :], rows[:, None], (theta, theta)).regular
    which = np.zeros(field.status.shape, np.uint8)
    reachable = (field.status == Limit.OK) | (field.status == Limit.SINGULAR)
    which[~reachable] = _tag(field)[~reachable]
    shape = (len(requirements.bounds), *field.status.shape)
    broken, worst = np.zeros(shape, np.bool_), np.full(shape, np.inf)
    for index, bound in enumerate(requirements.bounds):
        if not counts(requirements, bound, theta, z):
            continue
        with np.errstate(all="ignore"):
            margin = bound.margin(bound.entry.over(field, design))
        margin = np.where(np.isnan(margin), -np.inf, margin)
        broken[index] = (margin < 0.0) & reachable
        worst[index] = margin / _size(bound)
    cause = np.full(field.status.shape, INSIDE, np.uint8)
    if len(worst):
        cause = np.where(broken.any(axis=0), FIRST_REQUIREMENT + worst.argmin(axis=0), cause)
    cause = np.where(regular & (field.status != Limit.SINGULAR), cause, SINGULAR)
    cause = np.where(reachable, cause, FIRST_REACH + which).astype(np.uint8)
    return Slice(cause, broken, causes_of(requirements))


def counts(requirements: Requirements, bound: Requirement, theta: float, z: float) -> bool:
    """Say whether a requirement is about a heading [rad] and a height [m]."""
    low, high = requirements.headings(bound)
    turned = low - _TURN_SLACK <= theta <= high + _TURN_SLACK
    return turned and (bound.z is None or bound.z[0] <= z <= bound.z[1])


def _size(bound: Requirement) -> float:
    """Return the size of a bound, for comparison with those of others."""
    sizes = [abs(limit) for limit in (bound.low, bound.high) if limit]
    return min(sizes) if sizes else 1.0


def _tag(field: Field) -> NDArray[np.uint8]:
    """Return 4 * leg + limit of the least margin, see `model.measures.least_margin` (...)."""
    return np.nan_to_num(field.solve(LEAST_MARGIN)[1]).astype(np.uint8)
