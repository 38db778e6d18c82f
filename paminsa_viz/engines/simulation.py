"""Forward simulation in MuJoCo: what the robot does under given actuator forces.

This is the softer of the two comparisons. MuJoCo holds the loops together with stiff springs and
steps in time, so its motion differs from the exact one; and the robot is open-loop unstable, so
that any difference grows. The result therefore comes with what the loops opened to.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.mujoco_model import MujocoRobot, load_mujoco
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design


class Played(NamedTuple):
    """A simulated motion.

    Attributes:
        poses: Platform poses (n, 4) at the given times [m, m, rad, m]; NaN after it was stopped.
        drift: Poses minus the wanted ones (n, 4).
        stray: How far a joint 5 is from where it should be, at most (n,) [m].
        gap: Largest opening of any loop at the given times (n,) [m].
        until: Number of times before it was stopped or went out of bounds; n if neither.
    """

    poses: Array
    drift: Array
    stray: Array
    gap: Array
    until: int


def play(
    design: Design,
    times: ArrayLike,
    poses: ArrayLike,
    velocities: ArrayLike,
    torques: ArrayLike,
    *,
    step: float = 1e-4,
    limit: float = math.inf,
    loads: ArrayLike | None = None,
) -> Played:
    """Let the robot move under actuator forces alone, from the first state of a motion.

    Args:
        design: The robot.
        times: Times (n,), increasing [s].
        poses: Wanted platform poses (n, 4); the simulation starts at the first one.
        velocities: Wanted rates of the pose (n, 4); the simulation starts with the first one.
        torques: Actuator forces (n, 4) [N m, N m, N m, N], linear in between.
        step: Longest time step; it also sets how stiff the loops are [s].
        limit: Stop once the platform strays by more [m]: the robot is unstable, and the further it
            is off, the less its motion says.
        loads: Wrenches (n, 6) on top of the design's load, linear in between [N, N m].

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidInput: If shapes do not match or times do not increase.
        UnreachablePose: If the first pose has no configuration.
    """
    t, wanted, u, force = (np.asarray(a, float) for a in (times, poses, velocities, torques))
    for name, array in (("poses", wanted), ("velocities", u), ("torques", force)):
        if array.shape != (t.size, 4):
            raise InvalidInput(name, f"shape {array.shape} where {(t.size, 4)} is needed")
    if t.ndim != 1 or t.size < 1 or not np.all(np.diff(t) > 0):
        raise InvalidInput("times", "increasing numbers are needed")
    mujoco = load_mujoco()
    robot = MujocoRobot(design, xml=mjcf_text(design, pose=wanted[0].tolist()))
    model, data = robot.model, robot.data
    model.eq_solref[:] = (2 * step, 1)
    data.qpos[:], data.qvel[:] = robot.state(wanted[0], u[0])
    wrench = np.array(design.load.wrench) + np.zeros((t.size, 6))
    if loads is not None:
        wrench = wrench + np.asarray(loads, float)
    found, gap = np.full_like(wanted, np.nan), np.full(t.size, np.nan)
    stray, until = np.full(t.size, np.nan), 0
    for index, now in enumerate(t):
        if index:
            before = t[index - 1]
            count = max(1, int(np.ceil((now - before) / step - 1e-9)))
            model.opt.timestep = (now - before) / count
            for part in (np.arange(count) + 0.5) / count:
                data.ctrl[:] = (1 - part) * force[index - 1] + part * force[index]
                if wrench.any():
                    mujoco.mj_kinematics(model, data)
                    robot.push((1 - part) * wrench[index - 1] + part * wrench[index])
                mujoco.mj_step(model, data)
        mujoco.mj_fwdPosition(model, data)
        pose = robot.pose(data.qpos)
        off = _stray(pose - wanted[index], design.geometry.platform_radius)
        # After a warning it has started over by itself.
        if not np.isfinite(off) or any(warning.number for warning in data.warning):
            break
        found[index], stray[index] = pose, off
        gap[index] = np.abs(data.efc_pos).max()
        until = index + 1
        if off > limit:
            break
    return Played(found, found - wanted, stray, gap, until)


def _stray(drift: Array, radius: float) -> float:
    """Return how far points at a radius of a platform are off at most [m]; drift (4,) of a pose."""
    return float(np.linalg.norm(drift[[0, 1, 3]]) + radius * abs(drift[2]))
