"""How well the legs pass motion and force on: transmission, pressure angles, directions.

The functions are plain formulas of a pose, see `model/leg.py` for notation.

The force that leg k passes to the platform is horizontal, across its plane, along w_k in joint 5.
With the other actuators locked the platform moves along column k of J, and joint 5 with it at
v_5k. The power coefficient of force and motion, over the largest that force and speed could have,
is the output transmission index |w_k . v_5k| / |v_5k| = cos(pressure angle) of Wang, Wu and Liu
(Mech. Mach. Theory 45 (2010) 1462). The input index of a leg is 1, as its actuator turns its plane
and so moves joint 5 along w_k, and so are both of M4, whose pantographs magnify by k everywhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.model.backend import Formula
from paminsa_viz.model.kinematic_formulas import speed_rows
from paminsa_viz.model.leg import LegVector, Mechanism, leg_vector
from paminsa_viz.model.robot import (
    AXIS_X,
    AXIS_Y,
    TangentialForces,
    platform_determinant,
    solve_wrench,
)


def _transmission(v: LegVector, along_x: Any, along_y: Any, turning: Any) -> Any:
    """Return the index of a leg [1]: rho_k over |v_5k| for a unit speed of M_k; not in the paper.

    ``along_x``, ``along_y``, ``turning`` times rho_k^2 are its column of J [m/rad, m/rad, 1].
    """
    vx = (along_x - turning * v.py) * v.rho2
    vy = (along_y + turning * v.px) * v.rho2
    return np.sqrt(v.rho2 / (vx * vx + vy * vy))


def transmission_indices(
    m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any
) -> tuple[Any, Any, Any]:
    """Return the output transmission index of the three legs, cosines of the pressure angles [1].

    1 where force and motion of joint 5 are parallel, 0 at a type-2 singularity. Not in the paper,
    but of Wang, Wu and Liu (Mech. Mach. Theory 45 (2010) 1462). Arguments are the platform's
    position [m], cos and sin theta.
    """
    v1 = leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s)
    v2 = leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s)
    v3 = leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s)
    det = platform_determinant(m, x, y, c)
    jx: TangentialForces = solve_wrench(det, v1, v2, v3, 1.0, 0.0, 0.0)
    jy: TangentialForces = solve_wrench(det, v1, v2, v3, 0.0, 1.0, 0.0)
    jt: TangentialForces = solve_wrench(det, v1, v2, v3, 0.0, 0.0, 1.0)
    return (
        _transmission(v1, jx.t1, jy.t1, jt.t1),
        _transmission(v2, jx.t2, jy.t2, jt.t2),
        _transmission(v3, jx.t3, jy.t3, jt.t3),
    )


TRANSMISSION = Formula(transmission_indices, 3)
"""Transmission index of the three legs."""

SPEED_ROWS = Formula(speed_rows, 9)
"""Rows of J^-1 for M1..M3, see `speed_rows`."""
