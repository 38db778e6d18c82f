"""Requirements that a robot cannot meet together, and the nearest bounds that it can.

A set of requirements that cannot be met together, while any of them left out the rest can, is
irreducible. `irreducible_set` finds one by the deletion filter (Chinneck and Dravnieks, ORSA J.
Computing 3, 1991); it is as certain as the answers of what it asks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Requirement, Workspace
from paminsa_viz.synthesis.volume.margins import headings
from paminsa_viz.synthesis.volume.solve import Volume
from paminsa_viz.synthesis.volume.workspace import (
    Center,
    Samples,
    center_at,
    least_within,
    sample_workspace,
    worst_over,
)

T = TypeVar("T")

_FEW = 12
"""Requirements up to which all sets are tried, the smallest first."""


def irreducible_set(
    items: Sequence[T], feasible: Callable[[tuple[T, ...]], bool], few: int = 0
) -> tuple[T, ...]:
    """Return an irreducible set of requirements, in their order; empty if all can be met together.

    Args:
        items: Requirements.
        feasible: Whether some of them can be met together. Where it may overlook a solution, as a
            search may, the set may be larger than need be, and requirements may seem to contradict.
        few: Number of requirements up to which every set is asked for in order of its size, up to
            2^n of them, for a set with the fewest members.
    """
    if feasible(tuple(items)):
        return ()
    if len(items) <= few:
        sets = (chosen for size in range(1, len(items)) for chosen in combinations(items, size))
        return next((chosen for chosen in sets if not feasible(chosen)), tuple(items))
    kept = list(items)
    for item in items:
        rest = [other for other in kept if other is not item]
        if not feasible(tuple(rest)):
            kept = rest
    return tuple(kept)


@dataclass(frozen=True)
class VolumeRelaxation:
    """The nearest bound of a requirement at which the others leave something.

    Attributes:
        requirement: Its index.
        by: By how much its bound has to be moved [SI]; None if no bound helps, as the others leave
            nothing, or it has no value anywhere.
        relaxed: The requirement with its bound moved; None likewise.
        center: The position and height where it then holds, or the workspace's center [m].
    """

    requirement: int
    by: float | None
    relaxed: Requirement | None
    center: Center | None


@dataclass(frozen=True)
class Conflict:
    """The fewest requirements that leave nothing.

    Attributes:
        requirements: Their indices; empty if nothing can be reached with every heading at all.
        relaxations: What would help, one for each of them.
    """

    requirements: tuple[int, ...]
    relaxations: tuple[VolumeRelaxation, ...]


@kinds_checked
def smallest_conflict(volume: Volume, workspace: Workspace | None = None) -> Conflict | None:
    """Return the fewest requirements that leave no volume, None if there is one.

    With a workspace: the fewest that leave no place for it. Exact for the volume's nodes and
    headings. A bound as it is relaxed lets one node, or one place, meet all other requirements.

    Args:
        volume: The volume, empty or not.
        workspace: A workspace that has to fit; its center may be free.
    """
    margins, reachable = _candidates(volume, workspace)
    if not reachable.any():
        return Conflict((), ())
    if not len(margins):
        return None
    held = margins[:, reachable]
    found = _conflict_of(held >= 0.0)
    if not found:
        return None
    places = np.flatnonzero(reachable)
    return Conflict(
        found, tuple(_relaxation(volume, workspace, held, places, index) for index in found)
    )


def _candidates(volume: Volume, workspace: Workspace | None) -> tuple[Array, NDArray[np.bool_]]:
    """Return margins (requirements, candidates), and where a candidate can be reached."""
    margins = volume.margins
    if workspace is None:
        return margins.reshape(len(margins), volume.reachable.size), volume.reachable.ravel()
    reachable = least_within(volume.reachable.astype(float), workspace, volume) > 0.5
    placed = [least_within(margin, workspace, volume).ravel() for margin in margins]
    return np.reshape(placed, (len(margins), reachable.size)), reachable.ravel()


def _conflict_of(met: NDArray[np.bool_]) -> tuple[int, ...]:
    """Return the fewest rows of which no column has all, empty if there is such a column."""
    # Each combination once: there are few, of columns by the hundred thousand.
    packed = np.ascontiguousarray(np.packbits(met, axis=0).T)
    combinations = packed.view(np.dtype((np.void, packed.shape[1]))).ravel()
    patterns = met[:, np.unique(combinations, return_index=True)[1]]

    def feasible(chosen: tuple[int, ...]) -> bool:
        return bool(patterns[list(chosen)].all(axis=0).any())

    return irreducible_set(range(len(met)), feasible, _FEW)


def _relaxation(
    volume: Volume,
    workspace: Workspace | None,
    margins: Array,
    places: NDArray[np.intp],
    index: int,
) -> VolumeRelaxation:
    others = np.delete(margins, index, axis=0) >= 0.0
    usable = others.all(axis=0) & np.isfinite(margins[index])
    if not usable.any():
        return VolumeRelaxation(index, None, None, None)
    best = int(np.where(usable, margins[index], -np.inf).argmax())
    by = -float(margins[index, best])
    bound = volume.requirements.bounds[index]
    if workspace is None:
        i, j, k = np.unravel_index(places[best], volume.cause.shape)
        center = float(volume.x[i]), float(volume.y[j]), float(volume.z[k])
        samples = Samples(np.array([center[:2]]), np.array([center[2]]))
    else:
        center = center_at(workspace, volume, int(places[best]))
        samples = sample_workspace(workspace, center, 4)
    return VolumeRelaxation(index, by, _moved(volume, bound, samples, by), center)


def _moved(volume: Volume, bound: Requirement, samples: Samples, by: float) -> Requirement:
    """Return a requirement with its bound moved outward, on the side that breaks."""
    low, high = bound.low, bound.high
    if low is not None and high is not None and low != -high:
        theta = headings(volume.requirements.headings(bound), volume.headings)
        value = worst_over(volume.design, bound, 0, samples, theta).value
        if value < low:
            return replace(bound, low=low - by)
        return replace(bound, high=high + by)
    return replace(
        bound, low=None if low is None else low - by, high=None if high is None else high + by
    )
