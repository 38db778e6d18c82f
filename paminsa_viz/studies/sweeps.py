"""Sweeps over grids of any size, block by block, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import COORDINATES, Field, Grid, solve_field
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.singular_limit import counting, require_condition
from paminsa_viz.quantities import find


@dataclass(frozen=True)
class SweepSummary:
    """Result of a sweep, by the key of each quantity, over the poses that count.

    Attributes:
        poses: Number of poses.
        counts: Number of poses by status.
        largest, smallest, mean, rms: Of the values [SI].
        largest_at: The pose (4,) of the largest value.
    """

    poses: int
    counts: dict[Limit, int]
    largest: dict[str, float]
    smallest: dict[str, float]
    mean: dict[str, float]
    rms: dict[str, float]
    largest_at: dict[str, tuple[float, ...]]


@of_design
def sweep_blocks(
    design: Design,
    grid: Grid,
    quantities: tuple[str, ...],
    *,
    block: int = 2**20,
    threads: int | None = None,
) -> Iterator[tuple[tuple[slice, ...], Field, dict[str, Array]]]:
    """Go through a grid of any size in blocks of at most ``block`` poses.

    Yields:
        The block's index in the whole grid, its field, and the values by quantity.

    Raises:
        InvalidInput: If there is no such quantity.
    """
    found = find(quantities)
    for part, each in grid.split(block):
        field = solve_field(design.geometry, each, threads=threads)
        yield part, field, {q.key: q.over(field, design) for q in found}


@of_design
def sweep(
    design: Design,
    grid: Grid,
    quantities: tuple[str, ...] = ("max_torque",),
    *,
    max_condition: float | None = None,
    block: int = 2**20,
    threads: int | None = None,
) -> SweepSummary:
    """Summarize quantities over a grid of any size in bounded memory.

    Args:
        design: The robot.
        grid: The poses.
        quantities: Keys of `paminsa_viz.quantities.QUANTITIES`.
        max_condition: If given, values count where a pose is not too close to a singularity, see
            `paminsa_viz.model.singular_limit`; else wherever it can be taken.
        block: Poses held at a time.
        threads: Threads to share the work; None for all cores.

    Raises:
        InvalidInput: If there is no such quantity, or no such condition number.
    """
    if max_condition is not None:
        require_condition(max_condition)
    counts = np.zeros(len(Limit), int)
    found = {quantity: _Figures() for quantity in quantities}
    for _, field, values in sweep_blocks(design, grid, quantities, block=block, threads=threads):
        counts += np.bincount(field.status.ravel(), minlength=len(Limit))
        ok = field.status == Limit.OK
        if max_condition is not None:
            ok = counting(field, max_condition)
        for quantity, array in values.items():
            found[quantity].add(array, ok & np.isfinite(array), field.grid)
    per = {
        name: {quantity: getattr(figures, name) for quantity, figures in found.items()}
        for name in ("largest", "smallest", "mean", "rms", "largest_at")
    }
    return SweepSummary(grid.size, {limit: int(counts[limit]) for limit in Limit}, **per)


@dataclass
class _Figures:
    """Running figures of a quantity."""

    count: int = 0
    largest: float = np.nan
    smallest: float = np.nan
    total: float = 0.0
    squares: float = 0.0
    largest_at: tuple[float, ...] = (np.nan,) * 4

    @property
    def mean(self) -> float:
        return self.total / self.count if self.count else np.nan

    @property
    def rms(self) -> float:
        return float(np.sqrt(self.squares / self.count)) if self.count else np.nan

    def add(self, values: Array, usable: NDArray[np.bool_], grid: Grid) -> None:
        """Count the usable values of a block."""
        chosen = values[usable]
        if chosen.size == 0:
            return
        self.count += chosen.size
        self.total += float(chosen.sum())
        self.squares += float(np.vdot(chosen, chosen))
        self.smallest = float(np.fmin(self.smallest, chosen.min()))
        if not chosen.max() <= self.largest:
            self.largest = float(chosen.max())
            where = np.unravel_index(np.argmax(np.where(usable, values, -np.inf)), values.shape)
            pose = grid.fixed.copy()
            for (name, axis), i in zip(grid.axes, where, strict=True):
                pose[COORDINATES.index(name)] = axis[i]
            self.largest_at = tuple(map(float, pose))
