"""Natural frequencies with elastic drives alone: bars, joints and guides rigid, motors locked.

The motors stand still, so that their inertia has no part in the mass matrix; it is the model's for
the robot without drives.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.drive_stiffness import drive_stiffness
from paminsa_viz.elastostatics.modes import Modes, natural_modes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES
from paminsa_viz.model.dynamics import mass_matrix


@np.errstate(all="ignore")
def drive_modes(design: Design, pose: ArrayLike) -> Modes:
    """Return frequencies and modes of the robot whose drives alone are elastic, held at rest.

    Shapes are in (x, y, theta, z). NaN where a pose cannot be taken, is singular, or where weight
    or load push the platform away harder than the drives hold it. A load that turns with the
    platform has no potential; the symmetric part of its stiffness counts.

    Args:
        design: The robot with its drives' stiffness.
        pose: (..., 4) [m, m, rad, m].
    """
    stiffness = _symmetric(drive_stiffness(design, pose))
    return natural_modes(stiffness, mass_matrix(replace(design, drives=NO_DRIVES), pose))


@np.errstate(all="ignore")
def geometric_stiffness(design: Design, pose: ArrayLike) -> Array:
    """Return what weight, payload and load add to the stiffness, (..., 4, 4) [N/m, N, N m/rad].

    In (x, y, theta, z), symmetric; see `drive_stiffness`. Not finite where a pose cannot be taken
    or is singular.
    """
    loaded = drive_stiffness(design, pose)
    return _symmetric(loaded - drive_stiffness(design, pose, loaded=False))


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + np.swapaxes(matrix, -1, -2))
