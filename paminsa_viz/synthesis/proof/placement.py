"""The place of a region whose center is free: where the largest one fits, as far as poses tell.

Positions are collected at which a requirement breaks, first the nodes around a coarse volume. The
largest region without any of them is a bound on every region, and is searched for new positions
that break one, until none is found (outer approximation).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, KneeBranch
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.resizing import plain_decimals
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.proof.bisection import Control, Gauge
from paminsa_viz.synthesis.proof.evidence import reach_scale
from paminsa_viz.synthesis.proof.families import groups
from paminsa_viz.synthesis.proof.regions import (
    FIRST,
    SEED,
    Grows,
    PoseRegion,
    freedom,
    from_unit,
    least_free,
)
from paminsa_viz.synthesis.volume.grid import Resolution, side_end
from paminsa_viz.synthesis.volume.margins import (
    Columns,
    heading_margins,
    headings,
    time_per_position,
)
from paminsa_viz.synthesis.volume.solve import solve_volume

RESOLUTION = Resolution(60_000, 9, 2.0)
"""Of the volume that the first positions come from."""

CANDIDATES = 600
"""Centers compared at a time."""

MOST_POSITIONS = 3000
"""Positions of the volume that are kept."""

_BUDGET, _LEAST_CENTERS = 0.3, 32
"""Time that costly quantities may take at the kept extents of centers [s], of so many at least."""

_RING = 4
"""Positions for every 120 degrees on the edge of kept extents."""

_SHARE = 0.4
"""Part of the time that the search may take."""

_ROUNDS = 100
_STEPS = 14
_ADDED = 32
_DESCENTS = 12
_KEPT = 32
_DIGITS = 26
_FOLLOWED = 400
_NEAR = 1e-3


@dataclass(frozen=True)
class PlacedCenter:
    """Where the largest region is, as far as poses tell.

    Attributes:
        center: Its center (x, y, z) [m].
        scale: No region of any center is known to be larger: its scale by the positions found. Zero
            if what is given and kept breaks a requirement about every center that was tried.
    """

    center: tuple[float, float, float]
    scale: float


class CenterSearch:
    """The search for the place of a region whose center is free.

    Args:
        design: The robot.
        requirements: What has to hold.
        region: Shape and extents at scale 1; its center where that is given.
        grows: Which extents grow.
        free: Which coordinates of the center are free.
        both_sides: Whether heights on the other side of the guides than home count.
    """

    def __init__(
        self,
        design: Design,
        requirements: Requirements,
        region: PoseRegion,
        grows: Grows,
        free: Sequence[bool],
        both_sides: bool,
    ) -> None:
        from scipy.ndimage import binary_dilation  # slow to load

        self._design, self._region, self._grows = design, region, grows
        self._requirements = requirements
        self._free = np.array(free)
        self._groups = groups(design, requirements)
        self._rng = np.random.default_rng(SEED)
        self._side, self._end = None, side_end(design.geometry)
        if not both_sides:
            self._side = 1.0 if design.geometry.knee is KneeBranch.LOWER else -1.0
        volume = solve_volume(design, requirements, resolution=RESOLUTION, both_sides=both_sides)
        axes = [np.pad(axis, 1, mode="reflect", reflect_type="odd") for axis in
                (volume.x, volume.y, volume.z)]  # fmt: skip
        inside = np.pad(volume.inside, 1)
        around: NDArray[np.bool_] = np.logical_and(binary_dilation(inside), ~inside)
        self._broken = self._chosen(axes, around, MOST_POSITIONS)
        self._inside = self._chosen(axes, inside, CANDIDATES)
        self._cell = volume.cell

    def _chosen(self, axes: list[Array], nodes: NDArray[np.bool_], most: int) -> Array:
        """Return positions of nodes (n, 3), of many some at random."""
        index = np.argwhere(nodes)
        if len(index) > most:
            index = index[np.sort(self._rng.choice(len(index), most, replace=False))]
        return np.column_stack([axis[index[:, i]] for i, axis in enumerate(axes)])

    def find(self, control: Control) -> PlacedCenter | None:
        """Return the place, None if no position meets all requirements."""
        if not len(self._inside):
            return None
        end = control.elapsed + _SHARE * control.left
        candidates = self._with_given(self._inside)
        holding = self._holding(candidates)
        if not len(holding):
            home = np.array(home_pose(self._design.geometry))[[0, 1, 3]]
            x, y, z = candidates[np.linalg.norm(candidates - home, axis=1).argmin()].tolist()
            return PlacedCenter((x, y, z), 0.0)
        center, scale = self._largest(holding)
        tried = np.empty((0, 3))
        while True:
            found = np.concatenate([self._searched(center, scale), self._beyond(center, scale)])
            self._broken = np.concatenate([self._broken, found])
            # positions that were found for one center count for all that were tried
            tried = np.concatenate([tried, [center]])
            held = self._scales(tried)
            best, reached = tried[np.argmax(held)], float(held.max())
            if not len(found) or scale <= (1.0 + _NEAR) * reached or len(tried) == _ROUNDS:
                break
            if control.over or control.elapsed > end:
                break
            center, scale = self._largest(np.concatenate([self._around(center), [best]]))
        # a plain place where it costs nothing
        decimals = plain_decimals(self._design.geometry)
        rounded = np.where(self._free, np.round(best, decimals), best)
        for plain in (self._on_axis(rounded), rounded):
            if reached > 0.0 and self._scales(plain[None])[0] >= (1.0 - _NEAR) * reached:
                best = plain
                break
        x, y, z = map(float, best + 0.0)  # no -0.0
        return PlacedCenter((x, y, z), scale)

    def _with_given(self, centers: Array) -> Array:
        """Return centers with the coordinates that are given, each once."""
        return np.unique(np.where(self._free, centers, self._region.center), axis=0)

    def _holding(self, centers: Array) -> Array:
        """Return the centers about which the kept extents alone break nothing, at samples (m, 3).

        Of costly quantities fewer centers are tried. Where all is free and grows all of them hold.
        """
        if self._free.all() and all(self._grows):
            return centers
        x, y, z = np.where(self._grows, 0.0, self._region.half)
        ring = self._region.shape.section.ring(_RING, third=False)
        plan = np.unique(np.concatenate([np.zeros((1, 2)), ring * [x, y]]), axis=0)
        heights, needed = np.unique([-z, 0.0, z]), self._requirements
        cost = time_per_position(self._design, needed, RESOLUTION.headings, len(heights))
        most = max(_LEAST_CENTERS, int(_BUDGET / max(cost * len(plan), 1e-9)))
        if len(centers) > most:
            centers = centers[np.linspace(0, len(centers) - 1, most).round().astype(int)]
        positions = (centers[:, None, :2] + plan).reshape(-1, 2)
        lift = np.repeat(centers[:, 2], len(plan))
        margins, _ = heading_margins(
            self._design, needed, positions, heights, RESOLUTION.headings, lift=lift
        )
        turns = headings(needed.theta, RESOLUTION.headings)
        poses = Columns.at(positions, turns, heights, lift).poses()
        free = freedom(self._design.geometry, poses.reshape(-1, 4)).min(axis=0)
        holds = (margins >= 0.0).all(axis=(0, 2)).reshape(len(centers), -1).all(axis=1)
        return centers[holds & (free.reshape(len(centers), -1) > 0.0).all(axis=1)]

    def _around(self, center: Array) -> Array:
        """Return centers near to one and far from it."""
        wide = self._rng.choice(self._inside, min(len(self._inside), CANDIDATES // 2))
        return self._with_given(np.concatenate([wide, [center, self._on_axis(center)]]))

    def _on_axis(self, center: Array) -> Array:
        """Return a center moved to the robot's own axis, where that is free."""
        return np.where(self._free, center * [0.0, 0.0, 1.0], center)

    def _scales(self, centers: Array) -> Array:
        """Return the scale of the largest region about each center without broken positions."""
        scales = []
        x, y, z = self._broken.T
        half, grows = self._region.half, self._grows
        gauge = self._region.shape.section.gauge_squared
        for part in np.array_split(centers, 1 + len(centers) * len(self._broken) // 200_000):
            u, v, w = part.T[..., None]
            plan = gauge(x - u, y - v, half)
            height = ((z - w) / half[2]) ** 2
            if grows[0] and grows[2]:
                square = np.maximum(plan, height)
            elif grows[0]:
                square = np.where(height <= 1.0, plan, np.inf)
            else:
                square = np.where(plan <= 1.0, height, np.inf)
            scales.append(np.sqrt(square.min(axis=1, initial=np.inf)))
        scale = np.concatenate(scales)
        if self._side is not None:
            room = self._side * (self._end - centers[:, 2])
            height = self._region.half[2]
            if self._grows[2]:
                scale = np.minimum(scale, np.maximum(room, 0.0) / height)
            else:
                scale = np.where(room >= height, scale, 0.0)
        return scale

    def _largest(self, centers: Array) -> tuple[Array, float]:
        """Return the center of the largest region without broken positions, and its scale."""
        scales = self._scales(centers)
        width = self._cell
        for _ in range(_STEPS):
            order = np.argsort(-scales, kind="stable")[:8]
            centers, scales = centers[order], scales[order]
            near = np.repeat(centers, 12, axis=0)
            near = near + self._free * width * self._rng.normal(size=near.shape)
            centers = np.concatenate([centers, near])
            scales = np.concatenate([scales, self._scales(near)])
            width *= 0.6
        index = int(np.argmax(scales))
        return centers[index], float(scales[index])

    def _searched(self, center: Array, scale: float) -> Array:
        """Return positions of a region that break a requirement, those near its center (n, 3)."""
        x, y, z = map(float, center)
        whole = replace(self._region, center=(x, y, z)).scaled(scale, self._grows)
        unit = 1.3 * self._rng.uniform(-1.0, 1.0, (FIRST // 2, 4))
        poses = from_unit(whole, unit)
        worst = self._margins(poses)
        width = 0.3
        for _ in range(8):
            order = np.argsort(worst, kind="stable")[:32]
            near = np.repeat(np.clip(unit[order], -1, 1), 16, axis=0)
            near = near + width * self._rng.normal(size=near.shape)
            unit = np.concatenate([unit, near])
            more = from_unit(whole, near)
            poses, worst = (
                np.concatenate([poses, more]),
                np.concatenate([worst, self._margins(more)]),
            )
            width *= 0.5
        poses = poses[np.argsort(worst, kind="stable")[:_FOLLOWED]]
        poses = poses[np.sort(worst)[:_FOLLOWED] < 0.0]
        if not len(poses):
            return np.empty((0, 3))
        gauge = Gauge(replace(self._region, center=(x, y, z)), self._grows)
        middle = np.array([x, y, 0.0, z])
        free = np.array([True, True, False, True])
        # back along the line from the center until the requirement holds
        low, high = np.zeros((len(poses), 1)), np.ones((len(poses), 1))
        for _ in range(_STEPS):
            half = 0.5 * (low + high)
            tried = np.where(free, middle + half * (poses - middle), poses)
            bad = self._margins(tried)[:, None] < 0.0
            low, high = np.where(bad, low, half), np.where(bad, half, high)
        poses = np.where(free, middle + high * (poses - middle), poses)
        first = poses
        # from there to nearer ones that break one
        width = 0.1
        sides = np.array([*whole.half[:2], 0.5 * (whole.theta[1] - whole.theta[0]), whole.half[2]])
        for _ in range(_DESCENTS):
            poses = poses[np.argsort(gauge.of_poses(poses), kind="stable")[:_KEPT]]
            near = np.repeat(poses, _KEPT, axis=0)
            near = near + width * sides * self._rng.normal(size=near.shape)
            near[:, 2] = np.clip(near[:, 2], *whole.theta)
            near = near[gauge.of_poses(near) < gauge.of_poses(poses[-1:])]
            near = near[self._margins(near) < 0.0]
            poses = np.concatenate([poses, near])
            width *= 0.7
        nearest = poses[np.argsort(gauge.of_poses(poses), kind="stable")[:_ADDED]]
        chosen = np.concatenate([nearest, first[:: len(first) // _ADDED + 1]])
        return chosen[:, [0, 1, 3]]

    def _beyond(self, center: Array, scale: float) -> Array:
        """Return a position of a region just beyond reach, (1, 3), or none (0, 3)."""
        x, y, z = map(float, center)
        region = replace(self._region, center=(x, y, z))
        most = reach_scale(self._design, self._requirements, region, self._grows, _DIGITS)
        if most >= scale:
            return np.empty((0, 3))
        whole = region.scaled(most * (1.0 + 0.2 * _NEAR), self._grows)
        pose, value, _ = least_free(self._design.geometry, whole)
        return pose[None, [0, 1, 3]] if value < 0.0 else np.empty((0, 3))

    def _margins(self, poses: Array) -> Array:
        """Return the least margin of what can be proven, as a share of its bound, (n,)."""
        worst = freedom(self._design.geometry, poses).min(axis=0)
        for group in self._groups:
            margins = group.pose_margins(poses)
            size = np.maximum(group.sizes, 1e-9)
            least = np.nan_to_num(margins / size, nan=-1.0).min(axis=1)
            theta, z = poses[:, 2], poses[:, 3]
            counts = (theta >= group.theta[0]) & (theta <= group.theta[1])
            counts &= (z >= group.z[0]) & (z <= group.z[1])
            worst = np.minimum(worst, np.where(counts, least, np.inf))
        return worst
