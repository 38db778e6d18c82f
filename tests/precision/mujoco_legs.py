"""A MuJoCo model of the robot with unequal legs, written from the table of lengths alone."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from paminsa_viz.engines.mechanism import leg_name
from paminsa_viz.engines.poses import joint_values
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import HEADINGS, inverse_kinematics
from paminsa_viz.precision.leg_lengths import INDEX

MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
TURN = 'type="hinge" axis="0 -1 0"'


def model_text(lengths: Any) -> str:
    """Write legs (3, 14) as MJCF; the joint values are the mechanism's own."""
    bodies, sites, closures = "", "", ""
    for leg, row in enumerate(np.asarray(lengths)):
        of = {name: float(row[place]) for name, place in INDEX.items()}
        x, y = (of["axis_radius"] * f(of["axis_angle"]) for f in (math.cos, math.sin))
        px, py = (of["joint_radius"] * f(of["joint_angle"]) for f in (math.cos, math.sin))
        name = f"leg{leg + 1}_"
        heading = math.degrees(HEADINGS[leg] + of["actuator_zero"])
        bodies += f"""
<body pos="{x!r} {y!r} 0" euler="0 0 {heading!r}">{MASS}<joint name="{name}theta" axis="0 0 1"/>
 <body>{MASS}<joint name="{name}shaft" type="slide" axis="0 0 1"/>
  <site name="{name}3a" pos="0 0 {-of["shaft"]!r}"/></body>
 <body pos="0 0 {of["guide_height"]!r}">{MASS}<joint name="{name}slide" type="slide" axis="1 0 0"/>
  <body>{MASS}<joint name="{name}bar8" {TURN}/>
   <body pos="{of["bar_89"]!r} 0 0">{MASS}<joint name="{name}bar4" {TURN}/>
    <site name="{name}5a" pos="{of["bar_94"] + of["bar_45"]!r} 0 0"/>
    <body pos="{of["bar_94"]!r} 0 0">{MASS}<joint name="{name}bar3" {TURN}/>
     <site name="{name}3b" pos="{-of["bar_43"]!r} 0 0"/>
     <site name="{name}7a" pos="{-of["bar_43"] - of["bar_37"]!r} 0 0"/></body></body></body>
  <body>{MASS}<joint name="{name}bar7" {TURN}/>
   <site name="{name}7b" pos="{of["bar_87"]!r} 0 0"/></body></body></body>"""
        sites += f'<site name="{name}5b" pos="{px!r} {py!r} {of["joint_height"]!r}"/>'
        closures += "".join(
            f'<connect site1="{name}{j}a" site2="{name}{j}b"/>' for j in ("3", "5", "7")
        )
    platform = f'<body name="platform">{MASS}<freejoint name="platform"/>{sites}</body>'
    return f"""<mujoco><compiler angle="degree"/><option jacobian="dense"/>
<worldbody>{platform}{bodies}</worldbody><equality>{closures}</equality></mujoco>"""


def assemble(geometry: Geometry, lengths: Any, actuators: Any, near: Any) -> Any:
    """Return (x, y, theta, z, t_x, t_y) of legs (3, 14) with locked actuators (4,).

    Newton's method on MuJoCo's own gaps and their Jacobian, from the nominal pose ``near`` (4,).
    """
    model = mujoco.MjModel.from_xml_string(model_text(lengths))
    data = mujoco.MjData(model)
    start = joint_values(inverse_kinematics(geometry, near))
    x, y, theta, z = near
    data.qpos[:7] = [x, y, z, math.cos(theta / 2), 0, 0, math.sin(theta / 2)]
    free = np.ones(model.nv, bool)
    for leg in range(3):
        for joint in ("theta", "shaft", "slide", "bar8", "bar4", "bar3", "bar7"):
            name = leg_name(leg, joint)
            data.joint(name).qpos[0] = start[name]
        for joint, value in (("theta", actuators[leg]), ("shaft", actuators[3])):
            data.joint(leg_name(leg, joint)).qpos[0] = value
            free[model.joint(leg_name(leg, joint)).dofadr[0]] = False
    for _ in range(30):
        mujoco.mj_fwdPosition(model, data)
        step = np.zeros(model.nv)
        jacobian = data.efc_J.reshape(-1, model.nv)[:, free]
        step[free] = np.linalg.lstsq(jacobian, -data.efc_pos, rcond=1e-11)[0]
        mujoco.mj_integratePos(model, data.qpos, step, 1.0)
        if np.abs(step).max() < 1e-13:
            break
    mujoco.mj_fwdPosition(model, data)
    assert np.abs(data.efc_pos).max() < 1e-13
    w, _, _, qz = data.qpos[3:7]
    theta = 2 * math.atan2(qz, w)
    turned = Rotation.from_matrix(data.body("platform").xmat.reshape(3, 3))
    tilt = (Rotation.from_euler("z", -theta) * turned).as_rotvec()
    assert abs(tilt[2]) < 1e-12
    x, y, z = data.body("platform").xpos
    return np.array([x, y, theta, z, tilt[0], tilt[1]])
