"""Least clearance between the robot's bodies, and which two are nearest."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.clearance import kernels
from paminsa_viz.clearance.shapes import ALL_PAIRS, FRAMES, PairGroup, Shapes, shapes_of
from paminsa_viz.dimensions.placement import BODIES, place_parts
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_pose, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.units import format_ascii

BLOCK = 4096
"""Poses that are placed at a time; it bounds the memory."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Least clearance of poses of batch shape (...).

    Attributes:
        shapes: The bodies and pairs that were checked.
        least: (...) least distance of two bodies, negative where they overlap [m]; NaN where the
            pose cannot be taken.
        pair: (...) index of the two bodies in ``shapes.pairs``; -1 where there is none.
        points: (..., 2, 3) the nearest points of the two bodies, in the world [m]; of bodies that
            overlap, the ends of a shift that parts them.
    """

    shapes: Shapes = field(repr=False)
    least: Array
    pair: NDArray[np.int64]
    points: Array

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of the two bodies of every pair."""
        return self.shapes.names

    def reason(self, index: tuple[int, ...] = (), required: float = 0.0) -> str:
        """Return why a pose has less clearance than required, "" if it has enough.

        Args:
            index: The pose in the batch.
            required: Least clearance that is required [m].
        """
        least, pair = float(self.least[index]), int(self.pair[index])
        return clearance_reason(least, self.pairs[pair] if pair >= 0 else ("", ""), required)


@kinds_checked
def clearance_reason(distance: float, names: tuple[str, str], required: float = 0.0) -> str:
    """Return by how much two bodies overlap or are too close, "" if they are not.

    Args:
        distance: Their distance, negative where they overlap [m]; NaN is no reason.
        names: Of the two bodies.
        required: Least clearance that is required [m].
    """
    one, other = names
    if distance < 0:
        return f"{one} and {other} overlap by {format_ascii(-distance, 'm')}"
    if distance < required:
        apart, least = format_ascii(distance, "m"), format_ascii(required, "m")
        return f"{one} and {other} are {apart} apart; {least} is required"
    return ""


@of_design
def clearance(
    design: Design,
    pose: ArrayLike,
    pairs: Iterable[PairGroup] = ALL_PAIRS,
    *,
    progress: Progress = go_on,
) -> Clearance:
    """Return the least clearance between the bodies of a design.

    Args:
        design: The robot; its geometry, payload mass and counterweights count.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].
        pairs: Groups of pairs that are checked; all by default.
        progress: Told what part of the poses is done before each block of them; may end the work.

    Raises:
        Canceled: If ``progress`` ends it.
        InvalidInput: If the pose has another shape or is not real, or a group is unknown.
    """
    shapes = shapes_of(design)
    chosen = shapes.of_groups(_known(pairs))
    one = np.zeros(len(chosen), int)
    distance, nearest, points = _search(design, pose, shapes, chosen, one, 1, progress)
    return Clearance(shapes, distance[..., 0], nearest[..., 0], points[..., 0, :, :])


@of_design
def group_clearance(
    design: Design, pose: ArrayLike, groups: Iterable[PairGroup] = tuple(PairGroup)
) -> Array:
    """Return the least clearance of each group of pairs, (..., groups) [m].

    NaN where the pose cannot be taken, and of groups without pairs. Arguments as in `clearance`.
    """
    shapes, order = shapes_of(design), _known(groups)
    chosen = shapes.of_groups(order)
    slots = np.array([order.index(shapes.groups[i]) for i in chosen], dtype=np.int64)
    return _search(design, pose, shapes, chosen, slots, len(order))[0]


@of_design
def pair_clearance(design: Design, pose: ArrayLike) -> Array:
    """Return the distance of every pair of ``shapes_of(design).pairs``, (..., pairs) [m]."""
    shapes = shapes_of(design)
    every = np.arange(len(shapes.pairs))
    return _search(design, pose, shapes, every, every, len(every))[0]


@dataclass(frozen=True, eq=False)
class NearestPoints:
    """The two nearest bodies in a pose.

    Attributes:
        names: Of the two bodies.
        frames: Names of the frames that they move with, see `dimensions.placement`.
        distance: Negative where they overlap [m].
        points: (2, 3) their nearest points, in the world [m].
    """

    names: tuple[str, str]
    frames: tuple[str, str]
    distance: float
    points: Array


@of_design
def nearest_points(
    design: Design, pose: ArrayLike, pairs: Iterable[PairGroup] = ALL_PAIRS
) -> NearestPoints | None:
    """Return the two nearest bodies in one pose (4,), None if it cannot be taken.

    Arguments as in `clearance`.

    Raises:
        InvalidInput: If the pose is not one of shape (4,) or not real, or a group is unknown.
    """
    found = clearance(design, as_pose(pose), pairs)
    if found.pair < 0:
        return None
    i, j = found.shapes.pairs[int(found.pair)]
    one, other = found.shapes.bodies[i], found.shapes.bodies[j]
    return NearestPoints(
        (one.name, other.name), (one.frame, other.frame), float(found.least), found.points
    )


def _known(groups: Iterable[PairGroup]) -> list[PairGroup]:
    chosen = list(dict.fromkeys(groups))
    for group in chosen:
        if not isinstance(group, PairGroup):
            known = ", ".join(group.name for group in PairGroup)
            raise InvalidInput("pairs", f"groups are {known}, not {group!r}")
    return chosen


def _search(
    design: Design,
    pose: ArrayLike,
    shapes: Shapes,
    chosen: NDArray[np.int64],
    slots: NDArray[np.int64],
    count: int,
    progress: Progress = go_on,
) -> tuple[Array, NDArray[np.int64], Array]:
    """Return least distances, indices of pairs and nearest points of slots of chosen pairs."""
    pose = as_vectors(pose, "pose")
    flat = pose.reshape(-1, 4)
    bodies = np.array(shapes.pairs, dtype=np.int64).reshape(-1, 2)[chosen]
    first, second = np.ascontiguousarray(bodies.T)
    distance, points = np.empty((len(flat), count)), np.empty((len(flat), count, 6))
    nearest = np.empty((len(flat), count), dtype=np.int64)
    search = kernels.least_distances(len(flat))
    for start in range(0, len(flat), BLOCK):
        keep_on(progress, start / len(flat))
        part = slice(start, start + BLOCK)
        position, quaternion = _placements(design, flat[part])
        search(
            shapes.arrays, position, quaternion, first, second, slots.astype(np.int64),
            distance[part], nearest[part], points[part],
        )  # fmt: skip
    nearest = np.where(nearest >= 0, chosen[nearest] if len(chosen) else -1, -1)
    shape = (*pose.shape[:-1], count)
    return distance.reshape(shape), nearest.reshape(shape), points.reshape(*shape, 2, 3)


@np.errstate(all="ignore")
def _placements(design: Design, pose: Array) -> tuple[Array, Array]:
    """Return positions (n, frames, 3) and quaternions (n, frames, 4); NaN of poses out of reach."""
    configuration = inverse_kinematics(design.geometry, pose)
    places = place_parts(configuration)
    position = np.zeros((len(pose), len(FRAMES), 3))
    quaternion = np.zeros((len(pose), len(FRAMES), 4))
    quaternion[:, -1, 0] = 1.0
    for i, body in enumerate(BODIES):
        position[:, i], quaternion[:, i] = places[body]
    position[~configuration.reach.ok] = np.nan
    return position, quaternion
