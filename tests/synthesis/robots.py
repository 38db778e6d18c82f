"""Requirements that the tests of this folder share, and what any list of poses says of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import check_reach
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape

TURN = math.radians(30.0)


def needs(*texts: str, theta: tuple[float, float] = (-TURN, TURN)) -> Requirements:
    """Return requirements by their texts."""
    return Requirements(tuple(map(parse_requirement, texts)), theta)


NEEDED = needs("condition <= 10", "max_torque <= 15 N m", "f_4 <= 450 N")


def cylinder(diameter: float, height: float, z: float | None = -0.6) -> Workspace:
    """Return an upright cylinder about the z-axis [m]."""
    return Workspace(WorkspaceShape.CYLINDER, (diameter, diameter, height), (0.0, 0.0, z))


def met(
    design: Design, poses: Array, condition: float, torque: float, lift: float
) -> NDArray[np.bool_]:
    """Say from the pointwise functions where three bounds hold, and no singularity is passed."""
    found = measure_singularity(design.geometry, poses)
    torques = static_torques(design, poses)
    with np.errstate(invalid="ignore"):
        return (
            check_reach(design.geometry, poses).ok
            & (found.rotation_distance > 0.0)
            & (found.condition <= condition)
            & (np.abs(torques[..., :3]).max(axis=-1) <= torque)
            & (torques[..., 3] <= lift)
        )
