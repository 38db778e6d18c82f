"""Least values over a workspace of what has to be measured in single poses: clearance, stiffness.

Samples first; from the worst of them a pattern search goes on in x, y, theta and z, in steps that
become smaller, within the workspace. So the least value is found between the samples as well. Where
a value is the least of several, such as distances of pairs of bodies, the worst samples of all may
be those of one pair: the search goes on from the worst of each.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.clearance import clearance
from paminsa_viz.elastostatics import first_frequencies, platform_stiffness
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.quantities.requirements import Range, Workspace
from paminsa_viz.synthesis.search.region import SPARSE, Density, center, sample
from paminsa_viz.synthesis.volume.margins import Columns


class Valued(NamedTuple):
    """Values at poses.

    Attributes:
        value: (n,) [SI]; minus infinity where there is none, infinity where that does not count.
        kind: (n,) which of several a value is the least of, such as the index of a pair of bodies,
            each of which has a least value of its own; None where it is of one thing.
    """

    value: Array
    kind: NDArray[np.int64] | None = None


OverPoses = Callable[[Design, Array], Valued]
"""Values of a design at poses (n, 4)."""


def _held(values: Array, kind: NDArray[np.int64] | None = None) -> Valued:
    """Return values with minus infinity where there is none: nothing is worse."""
    return Valued(np.where(np.isnan(values), -np.inf, values), kind)


def _clearance(design: Design, pose: Array) -> Valued:
    found = clearance(design, pose)
    return _held(found.least, found.pair)


OVER_POSES: dict[str, OverPoses] = {
    "clearance": _clearance,
    "stiffness_x": lambda design, pose: _held(platform_stiffness(design, pose).along(0)),
    "stiffness_y": lambda design, pose: _held(platform_stiffness(design, pose).along(1)),
    "stiffness_z": lambda design, pose: _held(platform_stiffness(design, pose).along(2)),
    "stiffness_theta": lambda design, pose: _held(platform_stiffness(design, pose).along(5)),
    "stiffness_tilt": lambda design, pose: _held(platform_stiffness(design, pose).tilt),
    "stiffness_horizontal": lambda design, pose: _held(platform_stiffness(design, pose).horizontal),
    "frequency_1": lambda design, pose: _held(first_frequencies(design, pose)),
}
"""Quantities of the registry whose least value is looked for by samples and a pattern search."""

ROUNDS = 24
"""Rounds of the pattern search; the step of a start is halved where none of its poses is worse."""

STARTS = 6
"""Worst samples that it goes on from."""


@dataclass(frozen=True)
class Extent:
    """The poses of a required workspace.

    Attributes:
        workspace: The workspace, its height known.
        theta: Least and largest heading [rad].
    """

    workspace: Workspace
    theta: Range

    @property
    def heights(self) -> Range:
        """Least and largest height [m]."""
        middle, half = float(self.workspace.center[2] or 0.0), 0.5 * self.workspace.size[2]
        return middle - half, middle + half

    def within(self, z: Range | None) -> Extent | None:
        """Return the part between two heights; None if there is none."""
        if z is None:
            return self
        low, high = max(z[0], self.heights[0]), min(z[1], self.heights[1])
        if low >= high:
            return None
        x, y, _ = self.workspace.center
        size = (*self.workspace.size[:2], high - low)
        workspace = Workspace(self.workspace.shape, size, (x, y, 0.5 * (low + high)))
        return Extent(workspace, self.theta)

    def samples(self, density: Density) -> Array:
        """Return poses, the ends of all ranges among them (n, 4)."""
        found = sample(self.workspace, self.theta, density)
        xy = found.place(found.within, self.workspace)
        z = np.array([0.5 * sum(self.heights)]) + self.workspace.size[2] * found.share
        return Columns.at(xy, found.theta, z).poses().reshape(-1, 4)

    def random(self, count: int, seed: int = 0) -> Array:
        """Return poses anywhere, evenly distributed over the volume (count, 4)."""
        rng = np.random.default_rng(seed)
        share = rng.uniform(-0.5, 0.5, (count, 3))
        flat = self.workspace.shape.section.spread(share[:, :2])
        xy = center(self.workspace) + flat * self.workspace.size[:2]
        z = 0.5 * sum(self.heights) + share[:, 2] * self.workspace.size[2]
        return np.column_stack([xy, rng.uniform(*self.theta, count), z])

    def clipped(self, pose: Array) -> Array:
        """Return the poses, those outside moved to the boundary (..., 4)."""
        middle, half = center(self.workspace), 0.5 * np.array(self.workspace.size[:2])
        away = self.workspace.shape.section.clipped(pose[..., :2] - middle, half)
        theta = np.clip(pose[..., 2:3], *self.theta)
        return np.concatenate([middle + away, theta, np.clip(pose[..., 3:], *self.heights)], -1)

    @property
    def scale(self) -> Array:
        """Half extents along x, y, theta and z (4,) [m, m, rad, m]."""
        x, y, z = self.workspace.size
        return 0.5 * np.array([x, y, self.theta[1] - self.theta[0], z])


@dataclass(frozen=True, eq=False)
class Least:
    """The least value over a workspace.

    Attributes:
        value: The value [SI]; minus infinity where a pose has none.
        pose: Where it is (4,) [m, m, rad, m].
    """

    value: float
    pose: Array


def least_over(
    values: Callable[[Array], Valued],
    extent: Extent,
    density: Density,
    *,
    starts: int = STARTS,
    progress: Progress = go_on,
) -> Least:
    """Return the least value over a workspace, found by samples and a pattern search.

    Args:
        values: Values at poses (n, 4). Where they have kinds, the search goes on from the worst
            sample of each kind as well.
        extent: The poses.
        density: How close the samples lie.
        starts: Worst samples that the pattern search goes on from; 0 for samples alone.
        progress: Called before the samples and each round.

    Raises:
        Canceled: If ``progress`` ends it.
    """
    keep_on(progress, 0.0)
    pose = extent.samples(density)
    found, kind = values(pose)
    order = np.argsort(found, kind="stable")
    worst = order[: max(starts, 1)]
    if starts and kind is not None:
        first = order[np.unique(kind[order], return_index=True)[1]]
        worst = np.concatenate([worst, np.setdiff1d(first, worst)])
    pose, found = pose[worst], found[worst]
    if not starts or not np.isfinite(found[0]):
        return Least(float(found[0]), pose[0])
    rng = np.random.default_rng(0)
    turned = rng.normal(size=(8, 4))
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    directions = np.concatenate([np.eye(4), -np.eye(4), turned, -turned])
    # first as far as to the next sample
    scale = extent.scale / np.array([2.0, 2.0, density.theta - 1.0, density.z - 1.0]).clip(1.0)
    step, rows = np.ones((len(pose), 1, 1)), np.arange(len(pose))
    for turn in range(ROUNDS):
        keep_on(progress, (1 + turn) / (1 + ROUNDS))
        near = extent.clipped(pose[:, None, :] + step * directions * scale)
        tried = values(near.reshape(-1, 4)).value.reshape(len(pose), -1)
        best = np.argmin(tried, axis=1)
        better = tried[rows, best] < found
        pose = np.where(better[:, None], near[rows, best], pose)
        found = np.where(better, tried[rows, best], found)
        step = np.where(better[:, None, None], step, 0.5 * step)
        if np.isneginf(found).any():  # nothing is worse
            break
    index = int(np.argmin(found))
    return Least(float(found[index]), pose[index])


def least_of(
    quantity: str, design: Design, extent: Extent, density: Density, *, starts: int = STARTS
) -> Least:
    """Return the least value of one of `OVER_POSES`; arguments as in `least_over`."""
    return least_over(partial(OVER_POSES[quantity], design), extent, density, starts=starts)


@lru_cache(maxsize=4096)
def least_on_samples(quantity: str, design: Design, extent: Extent) -> float:
    """Return the least value of one of `OVER_POSES` on sparse samples.

    It is kept: a trial that stays in the population is asked for again in each round.
    """
    return least_of(quantity, design, extent, SPARSE, starts=0).value
