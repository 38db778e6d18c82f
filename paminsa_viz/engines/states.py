"""Random poses of the workspace, for checks that should leave no corner of it out."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.reach import check_reach, workspace_height, workspace_radius
from paminsa_viz.model.singularity import measure_singularity, singular_rotation

WORST_CONDITION = 10.0
"""Largest condition number of a drawn pose. Torques grow without bound toward a singularity, and
relative to the largest of them every difference would look small."""

ROOM = 0.1
"""Least distance from stretched, folded and on-axis legs, over R_b."""

_DRAWN = 4096
_ROUNDS = 200


def workspace_poses(geometry: Geometry, count: int, seed: int = 0) -> Array:
    """Draw poses from all of the workspace that the robot reaches without crossing a singularity.

    Uniform in x, y, theta and z, above and below the guides; clear of singularities, see
    `WORST_CONDITION` and `ROOM`. The same arguments give the same poses for both branches of the
    knee.

    Args:
        geometry: Lengths of the mechanism.
        count: How many.
        seed: Of the random numbers.

    Returns:
        (count, 4) [m, m, rad, m].

    Raises:
        InvalidInput: If count or seed is not possible, or the workspace is too small to find so
            many.
    """
    if count < 1:
        raise InvalidInput("poses", f"at least 1 is needed, not {count}")
    if seed < 0:
        raise InvalidInput("seed", f"a whole number of at least 0 is needed, not {seed}")
    rng = np.random.default_rng(seed)
    across, up = workspace_radius(geometry), workspace_height(geometry)
    turn = np.nan_to_num(singular_rotation(geometry), nan=np.pi)
    home = np.array([0.0, 0.0, 0.0, -0.5 * up - geometry.platform_joint_height])
    side = np.sign(measure_singularity(geometry, home).determinant)
    found = np.empty((0, 4))
    for _ in range(_ROUNDS):
        poses = rng.uniform(-1.0, 1.0, (_DRAWN, 4)) * [across, across, turn, up]
        poses[:, 3] -= geometry.platform_joint_height
        measured = measure_singularity(geometry, poses)
        good = check_reach(geometry, poses).ok & (measured.condition <= WORST_CONDITION)
        good &= measured.serial_distance >= ROOM * geometry.base_radius
        good &= np.sign(measured.determinant) == side
        found = np.concatenate([found, poses[good]])
        if len(found) >= count:
            return found[:count]
    raise InvalidInput(
        "poses",
        f"only {len(found)} of {count} found in a workspace this small; ask for fewer, or check "
        "the design's lengths",
    )
