"""Sideways forces at the joints of a leg at rest, which elasticity decides and not equilibrium.

Across its plane a leg has five constraints more than it needs. What loads it there is the force of
the platform on joint 5, the shaft's force and moment on the arm, and the arm's own weight, as the
arm does not lie in the plane; all three follow from equilibrium (`joint_forces`). The redundants
are then X = -f_XX^-1 (f_Xw t + f_Xa), with the flexibilities of `leg_loads`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS, JointForces, joint_forces
from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.leg_loads import (
    APPLIED,
    COLUMNS,
    FORCE_W,
    M2,
    S2,
    carried,
    leg_rows,
)
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import Limit

_ALL = (1.0, 1.0, 1.0)

_SECTIONS: dict[str, tuple[int, float, tuple[float, float, float]]] = {
    "m": (0, -1.0, (1.0, 1.0, 0.0)),
    "guide": (8, -1.0, (1.0, 1.0, 0.0)),
    "8_b8": (8, -1.0, _ALL),
    "8_b7": (8, 1.0, (0.0, 0.0, 1.0)),
    "9": (9, -1.0, _ALL),
    "4": (4, 1.0, (0.0, 1.0, 1.0)),
    "7": (7, 1.0, (0.0, 0.0, 1.0)),
    "3": (3, 1.0, (0.0, 1.0, 0.0)),
    "2": (2, 1.0, (0.0, 1.0, 0.0)),
    "5": (5, -1.0, (1.0, 0.0, 0.0)),
}
"""By joint: where it is, the sign of the force on its first body, and which of the loads at 5, 2
and 7 it carries."""


@dataclass(frozen=True, eq=False)
class SidewaysForces:
    """Forces and moments across the planes of the legs, at rest; batch shape (...).

    NaN where the pose cannot be taken.

    Attributes:
        plane: Forces in the planes of the legs, with the status of each pose.
        force: (..., 3 legs, 10 joints) along w = z x u, on the first body of each of `JOINTS` [N].
        moment: (..., 3 legs, 10 joints, 2) about u (radial) and z, on the same body [N m]. About z
            at M_k it is what the drive holds.
    """

    plane: JointForces
    force: Array
    moment: Array

    @property
    def whole(self) -> Array:
        """Forces at the joints, (..., 3 legs, 10 joints, 3): radial, tangential, vertical [N]."""
        found = self.plane.force.copy()
        found[..., 1] = self.force
        return found


@of_design
def sideways_forces(
    design: Design, pose: ArrayLike, *, load: ArrayLike | None = None, shear: bool = False
) -> SidewaysForces:
    """Return the sideways forces at all joints at rest, under weight, payload and load.

    Args:
        design: The robot with its elastic data.
        pose: (..., 4) [m, m, rad, m].
        load: (..., 6) a wrench on top of the design's load [N, N m].
        shear: Whether bars deform by shear as well (Timoshenko).
    """
    plane = joint_forces(design, pose, load=load)
    frame = leg_frame(design.geometry, pose)
    tangential = -plane.force[..., JOINT_INDEX["5"], 1]
    redundant = _redundants(design, frame, plane, tangential, shear)
    loads = {FORCE_W: tangential} | {
        APPLIED + i: redundant[..., i] for i in range(COLUMNS - APPLIED)
    }
    points = {joint: (p[..., 0], p[..., 1]) for joint, p in frame.points.items()}
    points[0] = (np.zeros_like(frame.rho), np.zeros_like(frame.rho))
    force = np.zeros((*frame.rho.shape, len(JOINTS)))
    moment = np.zeros((*force.shape, 2))
    for key, (place, sign, shares) in _SECTIONS.items():
        parts = carried(points, *points[place], shares)
        values = [sum(factor * loads[column] for column, factor in p.items()) for p in parts]
        index = JOINT_INDEX[key]
        force[..., index] = sign * values[0]
        moment[..., index, 0], moment[..., index, 1] = sign * values[1], sign * values[2]
    bad = plane.status != Limit.OK
    force[bad], moment[bad] = np.nan, np.nan
    return SidewaysForces(plane, force, moment)


def _redundants(
    design: Design, frame: LegFrame, plane: JointForces, tangential: Array, shear: bool
) -> Array:
    """Return S and M_u at joint 2, and f, m_u, m_z at joint 7, (..., 3 legs, 5) [N, N m]."""
    f = np.zeros((*frame.rho.shape, COLUMNS, COLUMNS))
    for row in leg_rows(frame, design.elastic, shear=shear):
        for column, value in row.loads.items():
            for other, factor in row.loads.items():
                f[..., column, other] += row.flexibility * value * factor
    right = f[..., APPLIED:, FORCE_W] * tangential[..., None]
    right[..., [S2 - APPLIED, M2 - APPLIED]] += _arm(design, frame, plane, shear)
    good = np.all(np.isfinite(f), axis=(-1, -2)) & np.isfinite(right).all(axis=-1)
    inner = np.where(good[..., None, None], f[..., APPLIED:, APPLIED:], np.eye(COLUMNS - APPLIED))
    found = -np.linalg.solve(inner, np.where(good[..., None], right, 0.0)[..., None])[..., 0]
    return np.where(good[..., None], found, np.nan)


def _arm(design: Design, frame: LegFrame, plane: JointForces, shear: bool) -> Array:
    """Return what S and M_u share with the known loads of the arm, (..., 3 legs, 2).

    Those are the shaft's force along u and z and its moment about w, and the arm's weight.
    """
    elastic, length = design.elastic, design.geometry.arm_length
    section = elastic.section("b1")
    au, aw = np.moveaxis(frame.arm, -1, 0)
    radial, _, vertical = np.moveaxis(-plane.of("2"), -1, 0)
    turn = plane.moment[..., JOINT_INDEX["2"]]  # about w, on the arm
    weight = design.links.b1 * design.gravity
    young, half = elastic.young_modulus, 0.5 * length
    flexible = length / (young * section.inertia_in)
    sideways = length / (young * section.inertia_out)
    sheared = length / (elastic.shear_modulus * section.area * section.shear) if shear else 0.0
    across = -radial * aw  # along b = z x a
    # S causes the forces -au along b and -aw along a, M_u the moments -au about a and aw about b
    s = -au * across * (sideways * half**2 + sideways * length**2 / 12 + sheared)
    s += -aw * radial * au * length / (young * section.area)
    bend = turn * au - half * vertical + weight * length / 6
    m = aw * flexible * bend - au * (turn * aw) * length / (elastic.shear_modulus * section.torsion)
    return np.stack([s, m], axis=-1)
