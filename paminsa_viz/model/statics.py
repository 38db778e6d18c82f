"""Torques that hold the robot's weight (Eqs. 1-8, Appendix 2) and load.

Sign: a torque is what the actuator has to deliver, Q_j = dV/dq_j; positive along theta_k and up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model import backend, robot
from paminsa_viz.model.arguments import of_design, of_geometry
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import PARAMETER, Design, Geometry
from paminsa_viz.model.jacobians import jacobian
from paminsa_viz.model.kinematics import inverse_kinematics, leg_states
from paminsa_viz.model.leg import LegPosition, mechanism
from paminsa_viz.model.leg_points import counterweight_point
from paminsa_viz.model.load import LoadCase, generalized_force
from paminsa_viz.model.lumped import (
    MASS_PATHS,
    lumped_coefficients,
    lumped_matrix,
    mass_vector,
    point_mass_column,
)

UNIT_TORQUES = backend.Formula(robot.unit_torques, 4)
"""Gamma of M1..M4, see `unit_torques`."""


@of_geometry
def unit_torques(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return Gamma, (..., 4): static torques [m] and force [1] of M1..M4 for M_p2 = 1 N.

    It depends on the geometry alone: Q_j = M_p2 Gamma_j for j = 1, 2, 3. For M4 the constant
    `lift_constant` comes on top. NaN where the pose cannot be taken, not finite at singularities.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    pose = as_vectors(pose, "pose")
    gamma = backend.over_list(UNIT_TORQUES, mechanism(geometry), pose.reshape(-1, 4))
    return gamma.reshape(pose.shape)


@of_design
def lift_constant(design: Design) -> float:
    """Return the part of F_4 that does not depend on the pose [N].

    It is dV/dZ of everything but the knees: k (m_pl g + 3 M_p1) + 3 M_p3.
    """
    c = lumped_coefficients(design)
    k = design.geometry.magnification
    return float(k * (c[16] * design.gravity + 3 * c[0]) + 3 * c[2])


@of_design
@np.errstate(invalid="ignore")
def static_torques(design: Design, pose: ArrayLike) -> Array:
    """Return Q^st, the torques of M1..M3 [N m] and the force of M4 [N] that hold the robot.

    Its weight (Eqs. 1-6 with Appendix 2) and the design's load; (..., 4). NaN where the pose cannot
    be taken, not finite in singular poses; see `check_reach` and `measure_singularity`.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    torque = unit_torques(design.geometry, pose)
    torque *= static_imbalance(design)
    torque[..., 3] += lift_constant(design)
    if design.load.acts:
        torque += load_torques(design.geometry, design.load, pose)
    return torque


@of_geometry
@np.errstate(invalid="ignore")
def load_torques(
    geometry: Geometry, load: LoadCase, pose: ArrayLike, extra: ArrayLike | None = None
) -> Array:
    """Return what the actuators need against a load, -J^T w, (..., 4) [N m, N].

    The principle of virtual work; w is the load's generalized force at the platform.

    Args:
        geometry: Lengths of the mechanism.
        load: The load.
        pose: (..., 4) [m, m, rad, m].
        extra: (..., 6) a further wrench, see `center_wrench` [N, N m].

    Returns:
        Not finite where the pose is singular. Limits of reach are not looked at.

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    pose = as_vectors(pose, "pose")
    w = generalized_force(load, pose[..., 2], extra)
    return -np.einsum("...ij,...i->...j", jacobian(geometry, pose), w)


@of_design
def static_imbalance(design: Design) -> float:
    """Return M_p2 [N]: zero means statically balanced: no torque of M1..M3 anywhere (Eq. 8)."""
    return float(lumped_coefficients(design)[1])


@of_design
def imbalance_parts(design: Design) -> dict[str, float]:
    """Return what each mass adds to M_p2 [N], by its path in the design; they add up to it."""
    parts = lumped_matrix(design.geometry, design.gravity)[1] * mass_vector(design)
    found = dict(zip(MASS_PATHS, parts.tolist(), strict=True))
    for number, weight in enumerate(design.counterweights):
        column = point_mass_column(counterweight_point(design.geometry, weight), design.gravity)
        found[f"counterweights.{number}.mass"] = float(weight.mass * column[1])
    return found


_ROUNDING = 2.0**-46
"""Share of what the masses add to M_p2 in which the sum of them is a rounding error."""


def shown_imbalance(design: Design) -> float:
    """Return M_p2 [N] for people: zero for a balanced robot, where the sum leaves 1e-15 N."""
    parts = imbalance_parts(design).values()
    imbalance = static_imbalance(design)
    return imbalance if abs(imbalance) > _ROUNDING * sum(map(abs, parts)) else 0.0


@dataclass(frozen=True, eq=False)
class StaticBreakdown:
    """Static torques, body by body; batch shape (...).

    Attributes:
        names: Paths of the bodies' masses in the design, such as ``"links.b3"``, counterweights
            last.
        per_leg: (..., 4 actuators, 3 legs, bodies) Q_ikj of Eq. 1 [N m, N].
        platform: (..., 4) torque for the platform's own weight; zero on M1..M3 (Eq. 4) [N m, N].
        payload: (..., 4) the same for the payload [N m, N].
        load: (..., 4) torque against the external load [N m, N].
    """

    names: tuple[str, ...]
    per_leg: Array
    platform: Array
    payload: Array
    load: Array

    @property
    def total(self) -> Array:
        """Sum of all parts, (..., 4) [N m, N]."""
        return self.per_leg.sum(axis=(-1, -2)) + self.platform + self.payload + self.load


BODIES: tuple[str, ...] = tuple(
    path for path in MASS_PATHS if PARAMETER[path].group in ("joints", "links")
)
"""Bodies of a leg that have weight."""


@of_design
@np.errstate(invalid="ignore")
def static_breakdown(design: Design, pose: ArrayLike) -> StaticBreakdown:
    """Split the static torques by body and leg (Eq. 1); arguments as in `static_torques`."""
    pose = as_vectors(pose, "pose")
    geometry = design.geometry
    reachable = np.where(inverse_kinematics(geometry, pose).reach.ok, 0.0, np.nan)
    share = lumped_matrix(geometry, design.gravity) * mass_vector(design)
    index = [MASS_PATHS.index(path) for path in BODIES]
    extra = [
        weight.mass * point_mass_column(counterweight_point(geometry, weight), design.gravity)
        for weight in design.counterweights
    ]
    mp1, mp2, mp3 = np.column_stack([share[:, index], *extra])[:3]
    gamma = unit_torques_by_leg(geometry, pose)
    per_leg = gamma[..., None] * mp2 + reachable[..., None, None, None]
    k = geometry.magnification
    per_leg[..., 3, :, :] += k * mp1 + mp3
    weight = k * design.gravity
    lift = np.array([0.0, 0.0, 0.0, 1.0])
    return StaticBreakdown(
        BODIES + tuple(f"counterweights.{number}.mass" for number in range(len(extra))),
        per_leg,
        lift * weight * design.platform.mass + reachable[..., None],
        lift * weight * design.payload.mass + reachable[..., None],
        (load_torques(geometry, design.load, pose) if design.load.acts else np.zeros_like(pose))
        + reachable[..., None],
    )


def unit_torques_by_leg(geometry: Geometry, pose: Array) -> Array:
    """Return (..., 4 actuators, 3 legs): Gamma, the knee of one leg at a time.

    Defined beyond the limits of reach as well, where the bars can close.
    """
    still = np.zeros_like(pose)
    g, _ = leg_states(geometry, pose, still, still)
    return torques_of_legs(geometry, pose, g, g.z9_rho, g.z9_zeta)


def torques_of_legs(
    geometry: Geometry, pose: Array, legs: LegPosition, by_rho: Array, by_zeta: Array
) -> Array:
    """Return the torques that hold an energy of each leg's own plane, (..., 4 actuators, 3 legs).

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        legs: The legs at these poses.
        by_rho, by_zeta: (..., 3) the energy's derivatives by X_1 and by z_5 [N].
    """
    j = jacobian(geometry, pose)[..., :3, :3]
    with np.errstate(all="ignore"):
        turn = legs.px * legs.uy - legs.py * legs.ux
        gradient = by_rho[..., None] * np.stack([legs.ux, legs.uy, turn], axis=-1)
        rotary = np.einsum("...ij,...ki->...jk", j, gradient)
        lift = geometry.magnification * by_zeta
    return np.concatenate([rotary, lift[..., None, :]], axis=-2)
