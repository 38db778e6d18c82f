"""Forces of the energies of one leg: Lagrange's left side, the regressor, the inertia.

The same source serves NumPy and the compiler; see `leg.py` for notation and conventions.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from paminsa_viz.model.leg import LegMotion, LegPosition, Mechanism
from paminsa_viz.model.lumped import EnergyTerms


class LegForces(NamedTuple):
    """d/dt(dL/dq') - dL/dq of one leg, before it is mapped to x, y, theta, z, theta_k, Z."""

    radial: Any  # on point 5, along u [N]
    tangential: Any  # on point 5, along w [N]
    vertical: Any  # on point 5 [N]
    torque: Any  # on theta_k [N m]
    lift: Any  # on Z [N]


def leg_forces(m: Mechanism, e: EnergyTerms, g: LegPosition, q: LegMotion) -> LegForces:
    """Return Lagrange's left side of one leg (Eqs. 11-15) in the eight coordinates [N, N m].

    As in the paper, rho follows x, y and theta, beta follows theta_k, and both meet only through
    the closure equations; so the tangential pull of the knee is felt by theta_k alone.
    """
    lift_acc = m.inverse_k * q.zeta_acc
    f5r = 2.0 * e.xy5 * q.a5r + e.xy59 * q.a9r
    f5t = 2.0 * e.xy5 * q.a5t + e.xy59 * q.a9t
    f9r = 2.0 * e.p9 * q.a9r + e.xy59 * q.a5r
    f9t = 2.0 * e.p9 * q.a9t + e.xy59 * q.a5t
    f5z = 2.0 * e.z5 * q.zeta_acc + e.z59 * q.z9_acc + e.z5_lift * lift_acc + e.v5
    f9z = 2.0 * e.p9 * q.z9_acc + e.z59 * q.zeta_acc + e.v9
    lift = 2.0 * e.lift * lift_acc + e.z5_lift * q.zeta_acc + e.vz

    spin2 = q.beta_rate * q.beta_rate
    # half the derivative of theta_k's inertia by psi and by phi
    by_psi = g.sin_psi * g.cos_psi * (e.spin_sin_psi - e.spin_cos_psi)
    by_phi = g.sin_phi * g.cos_phi * (e.spin_sin_phi - e.spin_cos_phi)
    spin = (
        e.spin
        + e.spin_sin_psi * g.sin_psi * g.sin_psi
        + e.spin_cos_psi * g.cos_psi * g.cos_psi
        + e.spin_sin_phi * g.sin_phi * g.sin_phi
        + e.spin_cos_phi * g.cos_phi * g.cos_phi
    )
    on_psi = 2.0 * (e.psi * q.psi_acc - by_psi * spin2)
    on_phi = 2.0 * (e.phi * q.phi_acc - by_phi * spin2)
    torque = (
        2.0 * spin * q.beta_acc
        + 4.0 * q.beta_rate * (by_psi * q.psi_rate + by_phi * q.phi_rate)
        + g.r9 * f9t
    )
    on_rho = f9r * g.r9_rho + f9z * g.z9_rho + on_psi * g.psi_rho + on_phi * g.phi_rho
    on_zeta = f9r * g.r9_zeta + f9z * g.z9_zeta + on_psi * g.psi_zeta + on_phi * g.phi_zeta
    return LegForces(f5r + on_rho, f5t, f5z + on_zeta, torque, lift)


def leg_regressor(
    m: Mechanism, g: LegPosition, q: LegMotion
) -> tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]]:
    """Return the generalized forces of unit energy terms on rho, zeta, theta_k and Z.

    Each of the four tuples has one entry for every field of `EnergyTerms` but the last two, which
    belong to the platform. Here theta_k, rho and zeta are independent coordinates of the leg, so
    that this is a derivation independent of `leg_forces`.
    """
    zero = 0.0 * g.rho
    one = zero + 1.0
    lift_acc = m.inverse_k * q.zeta_acc
    spin2 = q.beta_rate * q.beta_rate
    two_spin = 2.0 * q.beta_acc
    sin2_psi = 2.0 * g.sin_psi * g.cos_psi
    sin2_phi = 2.0 * g.sin_phi * g.cos_phi
    swing_psi = 2.0 * q.beta_rate * sin2_psi * q.psi_rate
    swing_phi = 2.0 * q.beta_rate * sin2_phi * q.phi_rate
    on_rho = (
        zero, g.z9_rho, zero,
        2.0 * q.a5r,
        zero,
        2.0 * (q.a9r * g.r9_rho + q.z9_acc * g.z9_rho),
        q.a9r + q.a5r * g.r9_rho,
        q.zeta_acc * g.z9_rho,
        zero, zero, zero,
        2.0 * q.psi_acc * g.psi_rho,
        2.0 * q.phi_acc * g.phi_rho,
        -spin2 * sin2_psi * g.psi_rho, spin2 * sin2_psi * g.psi_rho,
        -spin2 * sin2_phi * g.phi_rho, spin2 * sin2_phi * g.phi_rho,
        zero, zero,
    )  # fmt: skip
    on_zeta = (
        one, g.z9_zeta, zero,
        zero,
        2.0 * q.zeta_acc,
        2.0 * (q.a9r * g.r9_zeta + q.z9_acc * g.z9_zeta),
        q.a5r * g.r9_zeta,
        q.z9_acc + q.zeta_acc * g.z9_zeta,
        zero, lift_acc, zero,
        2.0 * q.psi_acc * g.psi_zeta,
        2.0 * q.phi_acc * g.phi_zeta,
        -spin2 * sin2_psi * g.psi_zeta, spin2 * sin2_psi * g.psi_zeta,
        -spin2 * sin2_phi * g.phi_zeta, spin2 * sin2_phi * g.phi_zeta,
        zero, zero,
    )  # fmt: skip
    on_beta = (
        zero, zero, zero,
        2.0 * g.rho * q.a5t,
        zero,
        2.0 * g.r9 * q.a9t,
        g.rho * q.a9t + g.r9 * q.a5t,
        zero, zero, zero,
        two_spin,
        zero, zero,
        two_spin * g.sin_psi * g.sin_psi + swing_psi, two_spin * g.cos_psi * g.cos_psi - swing_psi,
        two_spin * g.sin_phi * g.sin_phi + swing_phi, two_spin * g.cos_phi * g.cos_phi - swing_phi,
        zero, zero,
    )  # fmt: skip
    on_lift = (
        zero, zero, one,
        zero, zero, zero, zero, zero,
        2.0 * lift_acc, q.zeta_acc,
        zero, zero, zero, zero, zero, zero, zero, zero, zero,
    )  # fmt: skip
    return on_rho, on_zeta, on_beta, on_lift


class LegInertia(NamedTuple):
    """Twice the kinetic energy of a leg as a quadratic form of rho', zeta' and theta_k'."""

    rho: Any  # [kg]
    cross: Any  # between rho' and zeta' [kg]
    zeta: Any  # [kg]
    beta: Any  # [kg m^2]


def leg_inertia(m: Mechanism, e: EnergyTerms, g: LegPosition) -> LegInertia:
    """Return the inertia of one leg in its own coordinates [kg, kg m^2] (Eqs. 13 and 14)."""
    knee_rho = g.r9_rho * g.r9_rho + g.z9_rho * g.z9_rho
    knee_zeta = g.r9_zeta * g.r9_zeta + g.z9_zeta * g.z9_zeta
    knee_cross = g.r9_rho * g.r9_zeta + g.z9_rho * g.z9_zeta
    rho = (
        e.xy5
        + e.p9 * knee_rho
        + e.xy59 * g.r9_rho
        + e.psi * g.psi_rho * g.psi_rho
        + e.phi * g.phi_rho * g.phi_rho
    )
    cross = (
        2.0 * e.p9 * knee_cross
        + e.xy59 * g.r9_zeta
        + e.z59 * g.z9_rho
        + 2.0 * e.psi * g.psi_rho * g.psi_zeta
        + 2.0 * e.phi * g.phi_rho * g.phi_zeta
    )
    zeta = (
        e.z5
        + e.p9 * knee_zeta
        + e.z59 * g.z9_zeta
        + e.lift * m.inverse_k * m.inverse_k
        + e.z5_lift * m.inverse_k
        + e.psi * g.psi_zeta * g.psi_zeta
        + e.phi * g.phi_zeta * g.phi_zeta
    )
    beta = (
        e.xy5 * g.rho * g.rho
        + e.p9 * g.r9 * g.r9
        + e.xy59 * g.rho * g.r9
        + e.spin
        + e.spin_sin_psi * g.sin_psi * g.sin_psi
        + e.spin_cos_psi * g.cos_psi * g.cos_psi
        + e.spin_sin_phi * g.sin_phi * g.sin_phi
        + e.spin_cos_phi * g.cos_phi * g.cos_phi
    )
    return LegInertia(2.0 * rho, cross, 2.0 * zeta, 2.0 * beta)
