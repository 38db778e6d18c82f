"""Poses of a region at which a function is least, found by sampling: counterexamples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import LEAST_MARGIN
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.quantities.requirements import WorkspaceShape
from paminsa_viz.synthesis.proof.regions import PoseRegion

FIRST = 4096
"""Random poses looked at first."""

KEPT = 32
"""Best poses that are followed up, by as many others near to each."""

_ROUNDS = 24
_SHRINK = 0.6

SEED = 15
"""Seed of the random poses: an answer comes out the same again."""


def from_unit(region: PoseRegion, unit: Array) -> Array:
    """Return poses of a region, (n, 4), from numbers between -1 and 1, (n, 4).

    For a cylinder the first two are moved into the unit disc, along the line from its center.
    """
    share = np.clip(unit, -1.0, 1.0)
    plan = share[:, :2]
    if region.shape is WorkspaceShape.CYLINDER:
        plan = plan / np.maximum(1.0, np.hypot(*plan.T))[:, None]
    x, y, z = region.center
    low, high = region.theta
    return np.column_stack(
        [
            x + region.half[0] * plan[:, 0],
            y + region.half[1] * plan[:, 1],
            0.5 * (low + high) + 0.5 * (high - low) * share[:, 2],
            z + region.half[2] * share[:, 3],
        ]
    )


def lowest(value: Callable[[Array], Array], region: PoseRegion) -> tuple[Array, float]:
    """Return the pose of a region at which a function is least, as far as sampling finds it.

    Args:
        value: The function, of poses (n, 4), (n,); NaN counts as the least.
        region: The poses.
    """
    rng = np.random.default_rng(SEED)
    unit = 1.3 * rng.uniform(-1.0, 1.0, (FIRST, 4))

    def values(unit: Array) -> Array:
        return np.nan_to_num(value(from_unit(region, unit)), nan=-np.inf)

    found = values(unit)
    width = 0.3
    for _ in range(_ROUNDS):
        best = np.argsort(found)[:KEPT]
        unit, found = unit[best], found[best]
        near = np.repeat(unit, KEPT, axis=0)
        near = np.clip(near, -1.0, 1.0) + width * rng.normal(size=near.shape)
        unit = np.concatenate([unit, near])
        found = np.concatenate([found, values(near)])
        width *= _SHRINK
    best = int(np.argmin(found))
    return from_unit(region, unit[best : best + 1])[0], float(found[best])


def freedom(geometry: Geometry, poses: Array) -> Array:
    """Return how far poses (n, 4) are from limits of reach and from singular positions, (2, n) [m].

    The first is the least margin of reach. The second is the distance inside the singular circle or
    |R_b cos theta - R_pl|, with the sign that it has at theta = 0 counted positive.
    """
    margin = backend.over_list(LEAST_MARGIN, mechanism(geometry), poses)[:, 0]
    x, y, theta, _ = poses.T
    circle = singular_radius(geometry, theta) - np.hypot(x, y)
    difference = geometry.base_radius - geometry.platform_radius
    turn = geometry.base_radius * np.cos(theta) - geometry.platform_radius
    return np.stack([margin, np.minimum(circle, np.copysign(1.0, difference) * turn)])


def least_free(geometry: Geometry, region: PoseRegion) -> tuple[Array, float, str]:
    """Return the pose of a region with the least `freedom`, that [m], and what limits it."""
    pose, value = lowest(lambda poses: freedom(geometry, poses).min(axis=0), region)
    reach, singular = freedom(geometry, pose[None])[:, 0]
    return pose, value, "reach" if reach <= singular else "singularity"
