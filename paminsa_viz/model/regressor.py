"""Torques as a product Q = Y(q, q', q'') c, linear in the lumped coefficients.

A derivation independent of `dynamics`: by Jourdain's principle, with partial velocities of the
actuators and no multipliers. With Y kept for a trajectory, a change of masses costs one product.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model import backend
from paminsa_viz.model.arguments import of_geometry, require_gravity
from paminsa_viz.model.arrays import Array, as_numbers, together
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.jacobians import actuator_acceleration, jacobian
from paminsa_viz.model.kinematics import leg_states
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.leg_forces import leg_regressor
from paminsa_viz.model.lumped import Misprint, term_matrix
from paminsa_viz.model.reach import Limit, reach_status

BLOCK = 4096
"""States worked on at a time; bounds the memory of the intermediate terms to some 20 MB."""


@of_geometry
@np.errstate(invalid="ignore")
def torque_regressor(
    geometry: Geometry,
    pose: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    *,
    gravity: float = 9.81,
    misprints: Misprint = Misprint.NONE,
) -> Array:
    """Return Y, (..., 4 actuators, 18 coefficients of `lumped.COEFFICIENTS`).

    M_p1..3 are weights, so ``gravity`` [m/s^2] enters through the platform's mass alone. Friction
    is no part of it. NaN where the pose cannot be taken.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].
        gravity: Gravitational acceleration [m/s^2].
        misprints: Formulas to take as published. M_c4's misprint is one of c, not of Y.

    Raises:
        InvalidInput: If the shapes do not fit each other, or the gravity is none that a design has.
    """
    require_gravity(gravity)
    shape, (p, v, a) = together(pose=pose, velocity=velocity, acceleration=acceleration)
    terms = term_matrix(misprints)
    y = backend.regressor(mechanism(geometry), gravity, p, v, a, terms)
    if y is None:
        y = np.empty((len(p), 4, terms.shape[1]))
        for start in range(0, len(p), BLOCK):
            part = slice(start, start + BLOCK)
            y[part] = _unit_terms(geometry, p[part], v[part], a[part], gravity) @ terms
    status, _ = reach_status(geometry, p)
    y[status != Limit.OK] = np.nan
    return y.reshape(*shape, 4, terms.shape[1])


@of_geometry
def drive_regressor(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return the columns of the drives' inertias, (..., 4 actuators, 4 drives): Y_d.

    The torques are Y c + Y_d J with J = `Design.drive_inertia`; Y_d is diagonal, the actuators'
    accelerations. Arguments as in `torque_regressor`.
    """
    growth = actuator_acceleration(geometry, pose, velocity, acceleration)
    with np.errstate(invalid="ignore"):
        return growth[..., None] * np.eye(4)


def regressor_torques(y: Array, c: Array) -> Array:
    """Return Q = Y c, (..., 4) [N m, N], for Y of `torque_regressor` and c (18,)."""
    # Not `@`: threads of a BLAS that wait for each other on a busy machine cost 50 times as much.
    return np.einsum("...i,i->...", as_numbers(y, "y"), as_numbers(c, "c"))


def leg_unit_terms(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return the torques of unit energy terms of each leg, (..., 4 actuators, 3 legs, 19).

    The last axis has the fields of `EnergyTerms` but the last two, which are the platform's. Not
    finite where the pose cannot be taken. Arguments as in `torque_regressor`.
    """
    shape, (p, v, a) = together(pose=pose, velocity=velocity, acceleration=acceleration)
    with np.errstate(all="ignore"):
        terms = _leg_terms(geometry, p, v, a, jacobian(geometry, p))
    return terms.reshape(*shape, 4, 3, terms.shape[-1])


def _leg_terms(geometry: Geometry, p: Array, v: Array, a: Array, j: Array) -> Array:
    """Return the torques of unit energy terms of each leg, (n, 4, 3, 19), for the Jacobian J."""
    g, q = leg_states(geometry, p, v, a)
    kinds = leg_regressor(mechanism(geometry), g, q)
    # each (19, n, 3)
    on_rho, on_zeta, on_beta, on_lift = (np.stack(np.broadcast_arrays(*kind)) for kind in kinds)
    # rho_k' for theta_j' = 1
    turn = g.px * g.uy - g.py * g.ux
    radial = (
        g.ux[:, :, None] * j[:, None, 0, :3]
        + g.uy[:, :, None] * j[:, None, 1, :3]
        + turn[:, :, None] * j[:, None, 2, :3]
    )  # (n, leg, actuator)
    y = np.zeros((len(p), 4, 3, len(on_rho)))
    y[:, :3] = np.einsum("tnk,nkj->njkt", on_rho, radial)
    for leg in range(3):
        y[:, leg, leg] += on_beta[:, :, leg].T
    y[:, 3] = np.moveaxis(geometry.magnification * on_zeta + on_lift, 0, -1)
    return y


@np.errstate(all="ignore")
def _unit_terms(geometry: Geometry, p: Array, v: Array, a: Array, gravity: float) -> Array:
    """Return the torques of unit energy terms, (n, 4, 21), in the order of `EnergyTerms`."""
    j = jacobian(geometry, p)
    y = np.zeros((len(p), 4, 21))
    y[:, :, :19] = _leg_terms(geometry, p, v, a, j).sum(axis=2)
    # platform: turn (printed Eq. 13 only), mass, inertia
    y[:, :3, 18] += 6 * a[:, 2:3] * j[:, 2, :3]
    y[:, :3, 19] = a[:, 0:1] * j[:, 0, :3] + a[:, 1:2] * j[:, 1, :3]
    y[:, 3, 19] = geometry.magnification * (a[:, 3] + gravity)
    y[:, :3, 20] = a[:, 2:3] * j[:, 2, :3]
    return y
