"""Sweeps over grids of any size, piece by piece, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import COORDINATES, Field, Grid, solve_field
from paminsa_viz.model.reach import Limit
from paminsa_viz.quantities import find


@dataclass(frozen=True)
class SweepSummary:
    """What a sweep found, by the key of each quantity; only poses that can be taken count.

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


def sweep_blocks(
    design: Design,
    grid: Grid,
    quantities: tuple[str, ...],
    *,
    block: int = 2**20,
    threads: int | None = None,
) -> Iterator[tuple[tuple[slice, ...], Field, dict[str, Array]]]:
    """Go through a grid of any size in pieces of at most ``block`` poses.

    Yields:
        The piece's index in the whole grid, its field, and the values by quantity.

    Raises:
        InvalidInput: If there is no such quantity.
    """
    found = find(quantities)
    for part, piece in grid.split(block):
        field = solve_field(design.geometry, piece, threads=threads)
        yield part, field, {q.key: q.over(field, design) for q in found}


def sweep(
    design: Design,
    grid: Grid,
    quantities: tuple[str, ...] = ("max_torque",),
    *,
    block: int = 2**20,
    threads: int | None = None,
) -> SweepSummary:
    """Summarize quantities over a grid of any size in bounded memory.

    Args:
        design: The robot.
        grid: The poses.
        quantities: Keys of `paminsa_viz.quantities.QUANTITIES`.
        block: Poses held at a time.
        threads: Threads to share the work; None for all cores.
    """
    counts: dict[Limit, int] = dict.fromkeys(Limit, 0)
    state: dict[str, dict[str, Any]] = {
        q: {"n": 0, "max": -np.inf, "min": np.inf, "sum": 0.0, "squares": 0.0, "at": (np.nan,) * 4}
        for q in quantities
    }
    for _, field, values in sweep_blocks(design, grid, quantities, block=block, threads=threads):
        for limit, number in enumerate(np.bincount(field.status.ravel(), minlength=len(Limit))):
            counts[Limit(limit)] += int(number)
        ok = field.status == Limit.OK
        for quantity, array in values.items():
            _accumulate(state[quantity], array, ok, field.grid)
    return SweepSummary(
        poses=grid.size,
        counts=counts,
        largest={q: s["max"] if s["n"] else np.nan for q, s in state.items()},
        smallest={q: s["min"] if s["n"] else np.nan for q, s in state.items()},
        mean={q: s["sum"] / s["n"] if s["n"] else np.nan for q, s in state.items()},
        rms={
            q: float(np.sqrt(s["squares"] / s["n"])) if s["n"] else np.nan for q, s in state.items()
        },
        largest_at={q: s["at"] for q, s in state.items()},
    )


def _accumulate(state: dict[str, Any], values: Array, ok: NDArray[np.bool_], grid: Grid) -> None:
    """Add one piece to the running figures of a quantity."""
    usable = ok & np.isfinite(values)
    chosen = values[usable]
    if chosen.size == 0:
        return
    state["n"] += chosen.size
    state["sum"] += float(chosen.sum())
    state["squares"] += float(np.vdot(chosen, chosen))
    state["min"] = min(state["min"], float(chosen.min()))
    top = float(chosen.max())
    if top > state["max"]:
        where = np.unravel_index(np.argmax(np.where(usable, values, -np.inf)), values.shape)
        pose = grid.fixed.copy()
        for (name, axis), i in zip(grid.axes, where, strict=True):
            pose[COORDINATES.index(name)] = axis[i]
        state["max"], state["at"] = top, tuple(map(float, pose))
