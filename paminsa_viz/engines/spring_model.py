"""Springs between links in MuJoCo: tendons of its own, to check `balancing.springs` against."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

import numpy as np

from paminsa_viz.balancing import Anchor, Spring
from paminsa_viz.engines.mechanism import leg_name
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.mujoco_model import MujocoRobot, load_mujoco
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import leg_states
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.robot import AXIS_X, AXIS_Y


class SprungMujocoRobot(MujocoRobot):
    """The robot in MuJoCo with springs on every leg; none of their formulas is used.

    Each anchor is a site, fixed to its link where it is at one pose; MuJoCo has the springs' forces
    from the distances of the sites.
    """

    def __init__(self, design: Design, springs: Sequence[Spring]) -> None:
        """Build MuJoCo's model.

        Args:
            design: The robot.
            springs: The springs of each leg.

        Raises:
            EngineMissing: If MuJoCo is not installed.
            InvalidDesign: If a bar's inertias belong to no rigid body.
            UnreachablePose: If the design cannot be in its start pose.
        """
        plain = MujocoRobot(design)
        pose = np.array(home_pose(design.geometry))
        q, _ = plain.state(pose, np.zeros(4))
        plain.data.qpos[:] = q
        load_mujoco().mj_fwdPosition(plain.model, plain.data)
        root = ElementTree.fromstring(mjcf_text(design))
        bodies = {body.get("name"): body for body in root.iter("body")}
        tendons = ElementTree.SubElement(root, "tendon")
        for number, spring in enumerate(springs):
            for leg in range(3):
                tendon = ElementTree.SubElement(
                    tendons, "spatial", name=f"spring{number}_{leg}",
                    stiffness=repr(spring.stiffness),
                    springlength=f"{spring.free_length!r} {spring.free_length!r}",
                )  # fmt: skip
                for end, anchor in (("a", spring.first), ("b", spring.second)):
                    body = leg_name(leg, _link(anchor))
                    frame = plain.data.body(body)
                    offset = _place(design, anchor, pose, leg) - frame.xpos
                    local = frame.xmat.reshape(3, 3).T @ offset
                    site = f"spring{number}_{leg}{end}"
                    at = " ".join(map(repr, local.tolist()))
                    ElementTree.SubElement(bodies[body], "site", name=site, pos=at)
                    ElementTree.SubElement(tendon, "site", site=site)
        super().__init__(design, xml=ElementTree.tostring(root, encoding="unicode"))

    def _bias(self, q: Array, v: Array, wrench: Array | None) -> tuple[Array, Array]:
        drift, bias = super()._bias(q, v, wrench)
        return drift, bias - self.data.qfrc_passive


def _link(anchor: Anchor) -> str:
    """Return the link that an anchor is fixed to."""
    if anchor.kind == "joint":
        return "slider" if anchor.joint == 8 else f"joint{anchor.joint}"
    return {"bar": anchor.bar.upper(), "guide": "B10", "slider": "slider"}[anchor.kind]


def _place(design: Design, anchor: Anchor, pose: Array, leg: int) -> Array:
    """Return where an anchor of a leg is at a pose (4,), (3,) [m]."""
    g, still = design.geometry, np.zeros(4)
    legs = leg_states(g, pose, still, still)[0]
    w = anchor.weights(g)
    out = w.r5 * legs.rho[leg] + w.r9 * legs.r9[leg] + w.r0
    up = w.z5 * legs.zeta[0] + w.r9 * legs.z9[leg] + w.z0
    axis = g.base_radius * np.array([AXIS_X[leg], AXIS_Y[leg]])
    x, y = axis + out * np.array([legs.ux[leg], legs.uy[leg]])
    return np.array([x, y, up])
