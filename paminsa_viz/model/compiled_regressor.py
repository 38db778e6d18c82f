"""The regressor compiled into a loop; the mechanics in it is that of `leg_forces.leg_regressor`.

Only the map from the legs to the actuators is written a second time here, as loops, beside the
array form in `regressor.py`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from paminsa_viz.model import leg, leg_forces, robot
from paminsa_viz.model.compiled import OPTIONS, register

_AXES = tuple(zip(robot.AXIS_X, robot.AXIS_Y, strict=True))
_LEG_TERMS = len(robot.EnergyTerms._fields) - 2  # the last two belong to the platform
_TURN, _MASS, _INERTIA = _LEG_TERMS - 1, _LEG_TERMS, _LEG_TERMS + 1


def _kernel(digest: int) -> Any:
    @njit(**OPTIONS)
    def regressor(m, gravity, pose, c, s, velocity, acceleration, terms, coefficients, factors, y):  # type: ignore[no-untyped-def]
        """Fill ``y`` (n, 4, coefficients).

        Energy term ``terms[i]`` adds ``factors[i]`` times its torque to ``coefficients[i]``.
        """
        if digest < 0:
            return
        forces = np.empty((3, 3, _LEG_TERMS))  # on rho, on theta_k, on Z; by leg
        v = np.empty((3, 6))  # the legs' vectors, see `leg.LegVector`, and 1/rho
        j = np.empty((3, 3))  # d (x, y, theta) / d theta_k, by coordinate and leg
        torque = np.empty((4, _LEG_TERMS + 2))
        for n in range(c.size):
            vx, vy, vt, vz = velocity[n, 0], velocity[n, 1], velocity[n, 2], velocity[n, 3]
            ax, ay, at, az = (
                acceleration[n, 0], acceleration[n, 1], acceleration[n, 2], acceleration[n, 3]
            )  # fmt: skip
            for k in range(3):
                g = leg.leg_position(
                    m, _AXES[k][0], _AXES[k][1], pose[n, 0], pose[n, 1], c[n], s[n], pose[n, 3]
                )
                q = leg.leg_motion(m, g, vx, vy, vt, vz, ax, ay, at, az)
                on_rho, on_zeta, on_beta, on_lift = leg_forces.leg_regressor(m, g, q)
                for t in range(_LEG_TERMS):
                    forces[0, k, t] = on_rho[t]
                    forces[1, k, t] = on_beta[t]
                    forces[2, k, t] = m.k * on_zeta[t] + on_lift[t]
                v[k, 0], v[k, 1], v[k, 4] = g.px, g.py, g.rho * g.rho
                v[k, 2], v[k, 3], v[k, 5] = g.ux * g.rho, g.uy * g.rho, g.inverse_rho
            det = robot.platform_determinant(m, pose[n, 0], pose[n, 1], c[n])
            v1 = leg.LegVector(v[0, 0], v[0, 1], v[0, 2], v[0, 3], v[0, 4])
            v2 = leg.LegVector(v[1, 0], v[1, 1], v[1, 2], v[1, 3], v[1, 4])
            v3 = leg.LegVector(v[2, 0], v[2, 1], v[2, 2], v[2, 3], v[2, 4])
            for i in range(3):
                fx, fy, ft = 1.0 * (i == 0), 1.0 * (i == 1), 1.0 * (i == 2)
                b = robot.solve_wrench(det, v1, v2, v3, fx, fy, ft)
                j[i, 0], j[i, 1], j[i, 2] = b.t1 * v1.rho2, b.t2 * v2.rho2, b.t3 * v3.rho2
            for t in range(_LEG_TERMS):
                torque[3, t] = forces[2, 0, t] + forces[2, 1, t] + forces[2, 2, t]
            for a in range(3):
                for t in range(_LEG_TERMS):
                    torque[a, t] = forces[1, a, t]
                for k in range(3):
                    cross = v[k, 0] * v[k, 3] - v[k, 1] * v[k, 2]
                    pull = v[k, 2] * j[0, a] + v[k, 3] * j[1, a] + cross * j[2, a]
                    radial = pull * v[k, 5]  # rho_k' for theta_a' = 1
                    for t in range(_LEG_TERMS):
                        torque[a, t] += radial * forces[0, k, t]
                torque[a, _TURN] = 6.0 * at * j[2, a]
                torque[a, _MASS] = ax * j[0, a] + ay * j[1, a]
                torque[a, _INERTIA] = at * j[2, a]
            torque[3, _TURN] = 0.0
            torque[3, _MASS] = m.k * (az + gravity)
            torque[3, _INERTIA] = 0.0
            y[n] = 0.0
            for a in range(4):
                for i in range(terms.size):
                    y[n, a, coefficients[i]] += factors[i] * torque[a, terms[i]]

    return regressor


regressor = _kernel(
    register(
        leg.leg_position,
        leg.leg_motion,
        leg_forces.leg_regressor,
        robot.platform_determinant,
        robot.solve_wrench,
    )
)


def warm_up() -> None:
    """Compile the kernel, or load it from disk, by a call on nothing."""
    m = leg.Mechanism(*[1.0] * len(leg.Mechanism._fields))
    none, state, index = np.zeros(0), np.zeros((0, 4)), np.zeros(0, np.int64)
    regressor(m, 1.0, state, none, none, state, state, index, index, none, np.zeros((0, 4, 18)))
