"""The robot in MuJoCo with springs in its actuated joints, linearized about a pose it is held in.

MuJoCo's passive and bias forces and its mass matrix, projected on what the closed loops allow. The
springs are set so that they hold the robot, weight and load included, at the pose.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design

STEP = 1e-5
"""Step of the central differences [m, rad]."""


def linearized(design: Design, pose: Array, springs: Sequence[float]) -> tuple[Array, Array]:
    """Return stiffness and mass matrix of the platform (4, 4) at a pose (4,).

    Args:
        design: The robot; its load is MuJoCo's ``xfrc_applied``.
        pose: [m, m, rad, m].
        springs: Stiffness at M1..M4 [N m/rad, N/m].
    """
    robot = MujocoRobot(design)
    wrench = np.zeros(6) if not design.load.acts else np.array(design.load.wrench)
    torque = robot.static_torques(pose)
    _, q = robot._place(pose.reshape(1, 4))
    model = robot.model
    for name, spring, held in zip(robot.mechanism.actuated, springs, torque, strict=True):
        joint = model.joint(name)
        model.jnt_stiffness[joint.id] = spring
        place = joint.qposadr[0]
        model.qpos_spring[place] = q[0, place] + held / spring

    def force(at: Array) -> Array:
        _, here = robot._place(at.reshape(1, 4))
        _, spread, _ = robot._eliminate(here)
        _, bias = robot._bias(here[0], np.zeros(model.nv), wrench)
        return spread[0].T @ (robot.data.qfrc_passive - bias)

    assert np.abs(force(pose)).max() < 1e-8 * max(springs)
    columns = [(force(pose - h) - force(pose + h)) / (2 * STEP) for h in STEP * np.eye(4)]
    mass, spread, _ = robot._eliminate(q)
    return np.stack(columns, axis=1), spread[0].T @ mass[0] @ spread[0]
