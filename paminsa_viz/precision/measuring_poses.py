"""Poses to measure for a calibration: those that together show the legs' lengths best."""

from __future__ import annotations

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import check_reach, home_pose, workspace_height, workspace_radius
from paminsa_viz.model.singularity import measure_singularity, singular_rotation
from paminsa_viz.precision.calibration_problem import COUNT, GAP
from paminsa_viz.precision.leg_lengths import nominal_lengths
from paminsa_viz.precision.measurements import coordinate_scales, length_scales
from paminsa_viz.precision.unequal_legs import nominal_pose, sensitivities

MARGIN = 0.05
"""Least distance of a pose from the limits of reach, over R_b."""

WORST_CONDITION = 10.0
"""Largest condition number of a pose."""

MOST_POSES = 1000
_CANDIDATES = 800
_DRAWN = 8192
_ROUNDS = 20


def measuring_poses(design: Design, poses: int, *, coordinates: int = 6, seed: int = 0) -> Array:
    """Choose poses of which the calibration's intervals are small, (n, 4) [m, m, rad, m].

    Random poses on the natural side of the guides, away from limits and singularities, of which
    one after the other is taken that adds most to the determinant of the information about what
    can be seen at all.

    Args:
        design: The robot.
        poses: How many, at most `MOST_POSES`.
        coordinates: Measured coordinates of a pose, 6, or 4 without the tilt.
        seed: Of the random numbers.

    Raises:
        InvalidInput: If a number is not possible, or the workspace is too small.
    """
    if not 1 <= poses <= MOST_POSES:
        raise InvalidInput("poses", f"1 to {MOST_POSES} are possible, not {poses}")
    if coordinates not in (4, 6):
        raise InvalidInput("coordinates", f"4 or 6 are possible, not {coordinates}")
    found = _candidates(design, max(_CANDIDATES, 2 * poses), seed)
    geometry = design.geometry
    slopes = sensitivities(geometry, nominal_lengths(geometry), nominal_pose(geometry, found))
    rows = slopes.lengths[:, :coordinates] * coordinate_scales(design)[:coordinates, None, None]
    rows = (rows / length_scales(design)).reshape(len(found), coordinates, COUNT)
    _, singular, directions = np.linalg.svd(rows.reshape(-1, COUNT), full_matrices=False)
    seen = directions[singular > GAP * singular[0]]
    rows = rows @ seen.T / (singular[: len(seen)] / np.sqrt(len(found)))
    inverse = np.eye(len(seen)) * 1e6  # of the information: hardly any at first
    free = np.ones(len(found), np.bool_)
    chosen = []
    for _ in range(poses):
        spread = rows @ inverse @ np.swapaxes(rows, -1, -2) + np.eye(coordinates)
        gain = np.where(free, np.linalg.slogdet(spread)[1], -np.inf)
        best = int(np.argmax(gain))
        free[best] = False
        chosen.append(best)
        shown = rows[best] @ inverse
        inverse = inverse - shown.T @ np.linalg.solve(spread[best], shown)
    return found[chosen]


def _candidates(design: Design, count: int, seed: int) -> Array:
    """Draw reachable poses, uniform in x, y, theta and z, clear of limits and singularities."""
    geometry = design.geometry
    random = np.random.default_rng(seed)
    across, up = workspace_radius(geometry), workspace_height(geometry)
    turn = float(np.nan_to_num(singular_rotation(geometry), nan=np.pi))
    home = np.array(home_pose(geometry))
    side = np.sign(measure_singularity(geometry, home).determinant)
    found = np.empty((0, 4))
    for _ in range(_ROUNDS):
        drawn = random.uniform(-1.0, 1.0, (_DRAWN, 4)) * [across, across, turn, up]
        drawn[:, 3] = -geometry.knee.sign * np.abs(drawn[:, 3]) - geometry.platform_joint_height
        measured = measure_singularity(geometry, drawn)
        clear = check_reach(geometry, drawn).margins.min(axis=(-1, -2))
        good = (clear > MARGIN * geometry.base_radius) & (measured.condition < WORST_CONDITION)
        found = np.concatenate([found, drawn[good & (np.sign(measured.determinant) == side)]])
        if len(found) >= count:
            return found[:count]
    raise InvalidInput("poses", f"only {len(found)} of {count} poses found; check the lengths")
