"""Reactions at the joints as MuJoCo and Pinocchio have them.

The engines' tree has its loops closed by ball joints. Their multipliers follow from the tree's
equations of motion with given accelerations, and as forces on the links they give the reactions of
the tree's own joints by the engine's recursive Newton-Euler algorithm. Out of a leg's plane the
multipliers of least norm are one choice of many.

In the engines the shaft is held by B10 and by the arm, and m_3 is on it; in the model the arm alone
holds it, and m_3 is on B3. Both differences are forces between the same bodies and are taken off by
the equilibrium of B10 and of the mass.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.elastostatics.joint_forces import JOINTS
from paminsa_viz.engines.closed_loop import ClosedLoopRobot
from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.engines.pinocchio_model import PinocchioRobot
from tests import oracle

TREE = {"8_b8": "B8", "8_b7": "B7", "9": "B4", "4": "B3", "guide": "slider", "m": "B10", "s": "B2"}
"""Links whose reaction from their parent is that of a joint; s is B2 in B10."""


def reactions(robot: ClosedLoopRobot, motion: tuple[Any, Any, Any]) -> tuple[Any, Any]:
    """Return force (n, 3 legs, 10 joints, 2) and moment (n, 3, 10) as `JointForces` has them.

    Forces are radial and vertical; joint 5 has its sideways force in the moment's place.
    """
    poses, rates, seconds = motion
    _, q = robot._place(poses)
    mass, spread, solve = robot._eliminate(q)
    v = (spread @ rates[..., None])[..., 0]
    wrench = np.array(robot.design.load.wrench)
    states = [robot._bias(*state, wrench) for state in zip(q, v, strict=True)]
    drift, bias = (np.stack([state[i] for state in states]) for i in (0, 1))
    a = (spread @ seconds[..., None] - solve(drift[..., None]))[..., 0]
    torque = robot.inverse_dynamics(poses, rates, seconds)
    force = np.full((len(q), 3, len(JOINTS), 2), np.nan)
    moment = np.zeros((len(q), 3, len(JOINTS)))
    for i in range(len(q)):
        closure = robot._tree(q[i])[0]
        right = mass[i] @ a[i] + bias[i]
        right[robot._actuated] -= torque[i]
        found = np.linalg.lstsq(closure.T, right, rcond=1e-12)[0]
        assert np.abs(closure.T @ found - right).max() < 1e-10 * np.abs(found).max()
        pins = dict(zip((p.name for p in robot.mechanism.pins), found.reshape(-1, 3), strict=True))
        links = _tree_reactions(robot, q[i], v[i], a[i], pins, wrench)
        for leg in range(3):
            _fill(robot, leg, motion, i, pins, links, force[i, leg], moment[i, leg])
    return force, moment


def _fill(
    robot: ClosedLoopRobot, leg: int, motion: Any, i: int, pins: Any, links: Any, force: Any,
    moment: Any,
) -> None:  # fmt: skip
    design, name = robot.design, f"leg{leg + 1}_"
    jets = oracle.jets(*(part[i] for part in motion))
    solved = oracle.leg(design, jets, leg)
    u, w = (np.array(oracle.value(part), float) for part in (solved.heading, solved.normal))

    def plane(vector: Any) -> Any:
        return np.array([vector @ u, vector[2]])

    at = {key: links[name + link] for key, link in TREE.items()}
    top, foot = (np.array(oracle.value(solved.points[2]), float) for _ in range(2))
    foot[2] = 0.0
    on_shaft, twist = at["s"]
    total = {key: value[0] for key, value in at.items()} | {
        "7": pins[f"{name}pin7"],
        "3": pins[f"{name}pin3"],
        "2": on_shaft - pins[f"{name}pin2"],
        "5": -pins[f"{name}pin5"],
        "m": at["m"][0] - on_shaft,
        "4": -at["4"][0],  # in the tree B4 carries B3
    }
    lift = design.gravity + oracle.second(solved.points[3])[2]
    total["3"] = total["3"] + [0, 0, design.joints.j3 * lift]
    for index, joint in enumerate(JOINTS):
        force[index] = plane(total[joint.key])
    keys = [joint.key for joint in JOINTS]
    moment[keys.index("2")] = -w @ twist
    moment[keys.index("m")] = -w @ (at["m"][1] - twist - np.cross(top - foot, on_shaft))
    moment[keys.index("guide")] = -w @ at["guide"][1]
    moment[keys.index("5")] = w @ total["5"]


def _tree_reactions(
    robot: ClosedLoopRobot, q: Any, v: Any, a: Any, pins: Any, wrench: Any
) -> dict[str, tuple[Any, Any]]:
    """Return force and moment on each link from its parent, at the link's origin, world axes."""
    if isinstance(robot, PinocchioRobot):
        return _pinocchio(robot, q, v, a, pins, wrench)
    assert isinstance(robot, MujocoRobot)
    return _mujoco(robot, q, v, a, pins, wrench)


def _pinocchio(robot: Any, q: Any, v: Any, a: Any, pins: Any, wrench: Any) -> Any:
    pin, model, data = robot._pin, robot.model, robot.data
    forces = robot._external_forces(q, wrench)
    pin.framesForwardKinematics(model, data, q)
    for closure, (first, second) in zip(robot.mechanism.pins, robot._pins, strict=True):
        for frame, sign in ((first, 1.0), (second, -1.0)):
            carrier = model.frames[frame].parentJoint
            local = data.oMi[carrier].rotation.T @ (sign * pins[closure.name])
            arm = model.frames[frame].placement.translation
            forces[carrier] += pin.Force(local, np.cross(arm, local))
    pin.rnea(model, data, q, v, a, forces)
    found = {}
    for link in robot.mechanism.links:
        index = model.getJointId(link.joints[-1].name)
        turn, force = data.oMi[index].rotation, data.f[index]
        found[link.name] = (turn @ force.linear, turn @ force.angular)
    return found


def _mujoco(robot: Any, q: Any, v: Any, a: Any, pins: Any, wrench: Any) -> Any:
    mujoco, model, data = robot._mujoco, robot.model, robot.data
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data.qpos[:], data.qvel[:] = q, v
    data.xfrc_applied[:] = 0.0
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    robot.push(wrench)
    for index, closure in enumerate(robot.mechanism.pins):
        for sites, sign in ((model.eq_obj1id, 1.0), (model.eq_obj2id, -1.0)):
            site = sites[index]
            body = model.site_bodyid[site]
            force = sign * pins[closure.name]
            arm = data.site_xpos[site] - data.xipos[body]
            data.xfrc_applied[body] += [*force, *np.cross(arm, force)]
    data.qacc[:] = a
    mujoco.mj_rnePostConstraint(model, data)
    found = {}
    for link in robot.mechanism.links:
        body = model.body(link.name).id
        torque, force = data.cfrc_int[body][:3], data.cfrc_int[body][3:]
        arm = data.subtree_com[model.body_rootid[body]] - data.xpos[body]
        found[link.name] = (force.copy(), torque + np.cross(arm, force))
    data.xfrc_applied[:] = 0.0
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    return found
