"""The MJCF model that a person takes away: it stands held in a pose, with servos to move it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from paminsa_viz.engines.mjcf import Servos, mjcf_text
from paminsa_viz.engines.placing import start_pose
from paminsa_viz.model.design import Assembly, Design
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.jacobian import jacobian
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques

WORST_CONDITION = 1e4
"""Condition number from which a pose counts as singular; gains would be as large as its square."""


def exported_mjcf(
    design: Design,
    assembly: Assembly = Assembly.PRINTED,
    *,
    pose: Sequence[float] | None = None,
    servos: bool = True,
) -> str:
    """Return a design's MJCF text; MuJoCo's viewer opens it standing still.

    It needs no engine: the holding forces and the servos' gains are the model's.

    Args:
        design: The robot.
        assembly: How its pantographs are put together.
        pose: Start pose [m, m, rad, m]; default `start_pose`.
        servos: Position servos about the start pose; otherwise plain motors.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If the start pose is singular: nothing could hold it.
        UnreachablePose: If the robot can not stand in the start pose.
    """
    start = start_pose(design, assembly) if pose is None else np.asarray(pose, float)
    require_reachable(design.geometry, start)
    if not measure_singularity(design.geometry, start).condition < WORST_CONDITION:
        raise InvalidInput("pose", "it is singular, so that nothing holds the platform there")
    holding = static_torques(design, start, assembly)
    j = jacobian(design.geometry, start)
    inertia = j.T @ mass_matrix(design, start, assembly) @ j
    return mjcf_text(
        design, assembly, pose=start.tolist(), holding=holding.tolist(),
        servos=Servos.critical(inertia) if servos else None,
    )  # fmt: skip
