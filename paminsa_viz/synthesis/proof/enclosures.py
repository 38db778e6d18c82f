"""Ranges of the condition number and of static torques over boxes of poses.

The torques are the model's own formulas, evaluated on `affine.Affine` instead of numbers. The
condition number is the ratio of two singular values of G, the inverse Jacobian in (x, y,
R_pl theta). With U and V those of G at a box's center, B = U^T G V is nearly diagonal over the box.
Blocks give the largest singular value,

    |B| <= norm of [[B11, |(B12, B13)|], [|(B21, B31)|, |C|]],   C the rest,

and the smallest. Let P be the upper left 2x2 block, q and r the rest of the last column and row,
and s' = B33 - r P^-1 q. Then B^-1 has the blocks P^-1 + a b^T/s', a/s', b^T/s', 1/s', where
a = -P^-1 q and b = -P^-T r, and the norm of B^-1 is that of the 2x2 matrix of their norms at most.
What is not diagonal so counts squared, and B11 and s' linearly, with their place in the box.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model import leg, robot
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg import Mechanism, mechanism
from paminsa_viz.model.load import wrench_at_center
from paminsa_viz.model.robot import AXIS_X, AXIS_Y, where
from paminsa_viz.model.statics import lift_constant, static_imbalance
from paminsa_viz.synthesis.proof.affine import box_variables, lower, radius, upper

SKEW = 1e-13
"""Bound on what rounding in U and V adds to a condition number, as a share of it.

Both are orthogonal to a few units of the last place.
"""


class StaticTerms(NamedTuple):
    """What static torques depend on besides the pose and the geometry.

    Attributes:
        imbalance: M_p2 [N].
        constant: Part of F_4 that is the same everywhere [N].
        load: The load, as `load.wrench_at_center` takes it.
    """

    imbalance: float
    constant: float
    load: tuple[float, ...]


def static_terms(design: Design) -> StaticTerms:
    """Return what a design's static torques depend on besides the pose and the geometry."""
    load = design.load
    numbers = (*load.wrench, *load.point, load.turns)
    return StaticTerms(static_imbalance(design), lift_constant(design), numbers)


def _leg_vectors(m: Mechanism, x: Any, y: Any, c: Any, s: Any) -> list[Any]:
    axes = zip(AXIS_X, AXIS_Y, strict=True)
    return [leg.leg_vector(m, ax, ay, x, y, c, s) for ax, ay in axes]


def static_ranges(m: Mechanism, q: StaticTerms, x: Any, y: Any, c: Any, s: Any, z: Any) -> Any:
    """Return static torques of M1..M3, F_4, and the mean square of the former.

    A plain formula, see `statics.static_torques`: of numbers, or of ranges.
    """
    zeta = z + m.joint_height
    v1, v2, v3 = _leg_vectors(m, x, y, c, s)
    (_, f1, h1), (_, f2, h2), (_, f3, h3) = (
        leg.knee_height(m, leg.pantograph(m, v.rho2, zeta), zeta) for v in (v1, v2, v3)
    )
    wx, wy, wz, _, _, wt = wrench_at_center(*[*q.load, c, s])
    fx = (f1 * v1.dx + f2 * v2.dx + f3 * v3.dx) * q.imbalance - wx
    fy = (f1 * v1.dy + f2 * v2.dy + f3 * v3.dy) * q.imbalance - wy
    ft = (
        f1 * (v1.px * v1.dy - v1.py * v1.dx)
        + f2 * (v2.px * v2.dy - v2.py * v2.dx)
        + f3 * (v3.px * v3.dy - v3.py * v3.dx)
    ) * q.imbalance - wt
    turn, place = robot.determinant_factors(m, x, y, c)
    determinant = turn * place * (-3.0 * robot.HALF_ROOT_3 * m.platform_radius)
    t = robot.solve_wrench(determinant, v1, v2, v3, fx, fy, ft)
    tau1, tau2, tau3 = t.t1 * v1.rho2, t.t2 * v2.rho2, t.t3 * v3.rho2
    f4 = (h1 + h2 + h3) * (m.k * q.imbalance) + (q.constant - m.k * wz)
    return tau1, tau2, tau3, f4, (tau1 * tau1 + tau2 * tau2 + tau3 * tau3) * (1.0 / 3.0)


def determinant_range(m: Mechanism, x: Any, y: Any, c: Any, s: Any) -> Any:
    """Return the determinant of the rows (w_k, p_k x w_k), see `singularity.Singularity` [m]."""
    r1, r2, r3 = (v.rho2 for v in _leg_vectors(m, x, y, c, s))
    turn, place = robot.determinant_factors(m, x, y, c)
    factor = -3.0 * robot.HALF_ROOT_3 * m.platform_radius
    return turn * place * factor / (np.sqrt(r1) * np.sqrt(r2) * np.sqrt(r3))


def inverse_jacobian_rows(m: Mechanism, x: Any, y: Any, c: Any, s: Any) -> Any:
    """Return G for (x, y, R_pl theta) and M1..M3, row by row [1/m], (9 values)."""
    first, second, third = (_row(m, v) for v in _leg_vectors(m, x, y, c, s))
    return (*first, *second, *third)


def _row(m: Mechanism, v: Any) -> Any:
    inverse = 1.0 / v.rho2
    lever = (v.px * v.dx + v.py * v.dy) * (1.0 / m.platform_radius)
    return -(v.dy * inverse), v.dx * inverse, lever * inverse


def condition_bound(m: Mechanism, u: Any, v: Any, x: Any, y: Any, c: Any, s: Any) -> Any:
    """Return a number that the condition number is not above over a box; NaN or inf for none.

    Args:
        m: The mechanism.
        u, v: Singular vectors of G at the center, columns by falling value, row by row (9 each).
        x, y, c, s: Ranges of the position and of cosine and sine of theta.
    """
    g = inverse_jacobian_rows(m, x, y, c, s)
    h1 = _turned(v, g[0], g[1], g[2])
    h2 = _turned(v, g[3], g[4], g[5])
    h3 = _turned(v, g[6], g[7], g[8])
    b11, b21, b31 = _turned(u, h1[0], h2[0], h3[0])
    b12, b22, b32 = _turned(u, h1[1], h2[1], h3[1])
    b13, b23, b33 = _turned(u, h1[2], h2[2], h3[2])
    return block_condition(b11, b12, b13, b21, b22, b23, b31, b32, b33)


def block_condition(
    b11: Any, b12: Any, b13: Any, b21: Any, b22: Any, b23: Any, b31: Any, b32: Any, b33: Any
) -> Any:
    """Return a number that the condition number of a matrix is not above; NaN or inf for none.

    Args:
        b11 .. b33: Ranges of its entries, row by row. The bound is close where it is nearly
            diagonal, its diagonal positive and falling.
    """
    m12, m13, m21, m23 = _most(b12), _most(b13), _most(b21), _most(b23)
    m31, m32, m22, m33 = _most(b31), _most(b32), _most(b22), _most(b33)
    rest = _greater(m22, m33) + _greater(m23, m32)
    low = lower(b11)
    row, column = np.sqrt(m12 * m12 + m13 * m13), np.sqrt(m21 * m21 + m31 * m31)
    more = _norm(low, row, column, rest) - low
    # smallest: P^-1 by its diagonal, less what is off it
    least = -_greater(-low, -lower(b22)) - _greater(m12, m21)
    inverse = 1.0 / where((low > 0.0) & (least > 0.0), least, np.nan)
    q, r = np.sqrt(m13 * m13 + m23 * m23), np.sqrt(m31 * m31 + m32 * m32)
    schur = b33 - q * r * inverse
    a, b = q * inverse, r * inverse
    # times s', whose largest value makes the first entry largest
    norm = _norm(_most(schur) * inverse + a * b, a, b, 1.0)
    safe = where(lower(schur) > 0.0, norm, np.nan)
    return upper((b11 + more * (1.0 + SKEW)) * (1.0 / schur)) * safe * (1.0 + SKEW)


def _turned(v: Any, g1: Any, g2: Any, g3: Any) -> Any:
    """Return a row (g1, g2, g3) times a matrix that is given row by row."""
    return (
        g1 * v[0] + g2 * v[3] + g3 * v[6],
        g1 * v[1] + g2 * v[4] + g3 * v[7],
        g1 * v[2] + g2 * v[5] + g3 * v[8],
    )


def _greater(a: Any, b: Any) -> Any:
    return where(b > a, b, a)


def _norm(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Return the largest singular value of [[a, b], [c, d]], rounded up."""
    square = a * a + b * b + c * c + d * d
    determinant = a * d - b * c
    root = square * square - 4.0 * determinant * determinant
    return np.sqrt(0.5 * (square + np.sqrt(where(root > 0.0, root, 0.0)))) * (1.0 + SKEW)


def _most(a: Any) -> Any:
    """Return the largest size that a range can have, with what rounding may add."""
    return (np.abs(a.c) + (radius(a) + a.e)) * (1.0 + SKEW)


def center_vectors(m: Mechanism, middle: Array) -> tuple[Array, Array]:
    """Return U and V of `condition_bound` for boxes, each (9, n), from their centers (n, 4)."""
    x, y, theta, _ = middle.T
    rows = inverse_jacobian_rows(m, x, y, np.cos(theta), np.sin(theta))
    g = np.stack(np.broadcast_arrays(*rows)).reshape(3, 3, -1).transpose(2, 0, 1)
    finite = np.all(np.isfinite(g), axis=(1, 2))
    u, _, v = np.linalg.svd(np.where(finite[:, None, None], g, np.eye(3)))
    flat = [turn.reshape(9, -1) for turn in (u.transpose(1, 2, 0), v.transpose(2, 1, 0))]
    return np.ascontiguousarray(flat[0]), np.ascontiguousarray(flat[1])


def condition_bounds(design: Design, middle: Array, half: Array) -> Array:
    """Return numbers that the condition number is not above over boxes (n,), NaN or inf for none.

    Args:
        design: The robot.
        middle, half: (n, 4) centers and half widths of boxes of poses; z plays no part.
    """
    m = mechanism(design.geometry)
    with np.errstate(all="ignore"):
        x, y, c, s, _ = box_variables(middle, half)
        u, v = center_vectors(m, middle)
        return condition_bound(m, u, v, x, y, c, s)


def static_bounds(design: Design, middle: Array, half: Array) -> tuple[Array, Array]:
    """Return least and largest values of `static_ranges` over boxes, each (n, 5)."""
    m = mechanism(design.geometry)
    with np.errstate(all="ignore"):
        found = static_ranges(m, static_terms(design), *box_variables(middle, half))
        return np.stack([lower(a) for a in found], -1), np.stack([upper(a) for a in found], -1)


def determinant_bounds(design: Design, middle: Array, half: Array) -> tuple[Array, Array]:
    """Return least and largest values of the determinant over boxes, each (n, 1) [m]."""
    m = mechanism(design.geometry)
    with np.errstate(all="ignore"):
        found = determinant_range(m, *box_variables(middle, half)[:4])
        return lower(found)[:, None], upper(found)[:, None]
