"""Forward simulation in MuJoCo: what the robot does under given actuator forces.

This is the softer of the two comparisons. MuJoCo holds the loops together with stiff springs and
steps in time, so its motion differs from the exact one; and the robot is open-loop unstable, so
that any difference grows. The result therefore comes with what the loops opened to.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.mujoco_model import MujocoRobot, load_mujoco
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Assembly, Design
from paminsa_viz.model.errors import InvalidInput


class Played(NamedTuple):
    """A simulated motion.

    Attributes:
        poses: Platform poses (n, 4) at the given times [m, m, rad, m].
        drift: Poses minus the wanted ones (n, 4).
        gap: Largest opening of any loop at the given times (n,) [m].
    """

    poses: Array
    drift: Array
    gap: Array


def play(
    design: Design,
    assembly: Assembly,
    times: ArrayLike,
    poses: ArrayLike,
    velocities: ArrayLike,
    torques: ArrayLike,
    *,
    step: float = 1e-4,
) -> Played:
    """Let the robot move under actuator forces alone, from the first state of a motion.

    Args:
        design: The robot.
        assembly: How its pantographs are put together.
        times: Times (n,), increasing [s].
        poses: Wanted platform poses (n, 4); the simulation starts at the first one.
        velocities: Wanted rates of the pose (n, 4); the simulation starts with the first one.
        torques: Actuator forces (n, 4) [N m, N m, N m, N], linear in between.
        step: Longest time step; it also sets how stiff the loops are [s].

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidInput: If shapes do not match or times do not increase.
        UnreachablePose: If the first pose has no posture.
    """
    t, wanted, u, force = (np.asarray(a, float) for a in (times, poses, velocities, torques))
    for name, array in (("poses", wanted), ("velocities", u), ("torques", force)):
        if array.shape != (t.size, 4):
            raise InvalidInput(name, f"shape {array.shape} where {(t.size, 4)} is needed")
    if t.ndim != 1 or t.size < 1 or not np.all(np.diff(t) > 0):
        raise InvalidInput("times", "increasing numbers are needed")
    mujoco = load_mujoco()
    robot = MujocoRobot(design, assembly, xml=mjcf_text(design, assembly, pose=wanted[0].tolist()))
    model, data = robot.model, robot.data
    model.eq_solref[:] = (2 * step, 1)
    data.qpos[:], data.qvel[:] = robot.state(wanted[0], u[0])
    found, gap = np.empty_like(wanted), np.empty(t.size)
    for index, now in enumerate(t):
        if index:
            before = t[index - 1]
            count = max(1, int(np.ceil((now - before) / step - 1e-9)))
            model.opt.timestep = (now - before) / count
            for part in (np.arange(count) + 0.5) / count:
                data.ctrl[:] = (1 - part) * force[index - 1] + part * force[index]
                mujoco.mj_step(model, data)
        mujoco.mj_fwdPosition(model, data)
        found[index] = robot.pose(data.qpos)
        gap[index] = np.abs(data.efc_pos).max()
    return Played(found, found - wanted, gap)
