"""Extreme values over poses of one trial robot, compiled.

The formulas are those of the model. Unlike the kernels of `model.compiled` these keep to the
order of the operations, so that a search has the same numbers in every process.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from paminsa_viz.interrupts import import_whole
from paminsa_viz.model import kinematic_formulas, leg, measures, robot

TORQUE_COLUMNS = ("tau_1", "tau_2", "tau_3", "f_4", "max_torque", "rms_torque")
"""Quantities whose extremes `torques` returns."""


@cache
def load() -> tuple[Any, Any, Any, Any]:
    """Compile the kernels, or load them from disk: conditions, torques, radii, plate."""
    import_whole("paminsa_viz.model.compiled")  # slow to load: Numba comes with it
    from paminsa_viz.model.compiled import OPTIONS, kernel, register

    strict = kernel(**{key: value for key, value in OPTIONS.items() if key != "fastmath"})
    return (
        _conditions(strict, register), _torques(strict, register), _radii(strict, register),
        _plate(strict, register),
    )  # fmt: skip


def _conditions(strict: Any, register: Any) -> Any:
    digest = register(measures.dexterity)

    @strict
    def conditions(m, xy, turns, z):
        """Return the least and largest condition number over all xy (n, 2) and turns (k, 2)."""
        _ = digest
        least, most = np.inf, 0.0
        for i in range(len(xy)):
            for j in range(len(turns)):
                _, value = measures.dexterity(m, xy[i, 0], xy[i, 1], turns[j, 0], turns[j, 1], z)
                if not value < np.inf:  # also where there is none
                    return least, np.inf
                least, most = min(least, value), max(most, value)
        return least, most

    return conditions


def _torques(strict: Any, register: Any) -> Any:
    digest = register(robot.unit_torques, kinematic_formulas.wrench_torques)

    @strict
    def torques(m, imbalance, lift, wrench, xy, turns, z, out):
        """Fill ``out`` (2, 6) with the least and largest of `TORQUE_COLUMNS` over all poses.

        Args: M_p2, the constant part of F_4, the load's (f_x, f_y, m_z) at each turn (k, 3),
        positions (n, 2), cosines and sines of theta (k, 2), heights.
        """
        _ = digest
        out[0, :], out[1, :] = np.inf, -np.inf
        loaded = np.any(wrench != 0.0)
        for i in range(len(xy)):
            x, y = xy[i, 0], xy[i, 1]
            for j in range(len(turns)):
                c, s = turns[j, 0], turns[j, 1]
                a1, a2, a3 = 0.0, 0.0, 0.0
                if loaded:
                    w = kinematic_formulas.wrench_torques(m, x, y, c, s, z[0])
                    fx, fy, ft = wrench[j, 0], wrench[j, 1], wrench[j, 2]
                    a1 = -(w[0] * fx + w[3] * fy + w[6] * ft)
                    a2 = -(w[1] * fx + w[4] * fy + w[7] * ft)
                    a3 = -(w[2] * fx + w[5] * fy + w[8] * ft)
                for n in range(len(z)):
                    g = robot.unit_torques(m, x, y, c, s, z[n])
                    t1 = imbalance * g[0] + a1
                    t2 = imbalance * g[1] + a2
                    t3 = imbalance * g[2] + a3
                    f4 = imbalance * g[3] + lift
                    if not abs(t1 + t2 + t3 + f4) < np.inf:
                        out[0, :], out[1, :] = -np.inf, np.inf
                        return
                    most = max(abs(t1), abs(t2), abs(t3))
                    rms = np.sqrt((t1 * t1 + t2 * t2 + t3 * t3) / 3.0)
                    for k, value in enumerate((t1, t2, t3, f4, most, rms)):
                        out[0, k] = min(out[0, k], value)
                        out[1, k] = max(out[1, k], value)

    return torques


def _radii(strict: Any, register: Any) -> Any:
    digest = register(leg.leg_position)
    axes = tuple(zip(robot.AXIS_X, robot.AXIS_Y, strict=True))

    @strict
    def radii(m, guide, xy, turns, z, out):
        """Fill ``out`` (4,) with the largest radii about z of joints 5, 8, 9 and the guide's end.

        Squares of them [m^2].
        """
        _ = digest
        out[:] = 0.0
        for i in range(len(xy)):
            for j in range(len(turns)):
                for k in range(3):
                    bx, by = m.base_radius * axes[k][0], m.base_radius * axes[k][1]
                    for n in range(len(z)):
                        g = leg.leg_position(
                            m, axes[k][0], axes[k][1], xy[i, 0], xy[i, 1],
                            turns[j, 0], turns[j, 1], z[n],
                        )  # fmt: skip
                        values = (g.rho, -m.guide_ratio * g.rho, g.r9, -guide)
                        for p, r in enumerate(values):
                            px, py = bx + r * g.ux, by + r * g.uy
                            value = px * px + py * py
                            out[p] = max(out[p], value)
                            if not value < np.inf:
                                out[p] = np.inf

    return radii


NARROWED = 24
"""Times that the place on B4 that is nearest to the plate is narrowed down, each time by 0.62."""


def plate_distance(corners: Any, low: Any, top: Any, x: Any, y: Any, z: Any) -> Any:
    """Return the distance of a point from a prism over a convex polygon, negative inside [m].

    Args:
        corners: Its corners (n, 2), counterclockwise [m].
        low, top: Its heights [m].
        x, y, z: The point [m].
    """
    inside, nearest = -np.inf, np.inf
    count = corners.shape[0]
    for i in range(count):
        px, py = corners[i, 0], corners[i, 1]
        ex, ey = corners[(i + 1) % count, 0] - px, corners[(i + 1) % count, 1] - py
        length = np.sqrt(ex * ex + ey * ey)
        dx, dy = x - px, y - py
        inside = max(inside, (ey * dx - ex * dy) / length)
        along = min(max((ex * dx + ey * dy) / (length * length), 0.0), 1.0)
        dx, dy = dx - along * ex, dy - along * ey
        nearest = min(nearest, dx * dx + dy * dy)
    above = max(low - z, z - top)
    if inside <= 0.0:
        return max(inside, above)
    above = max(above, 0.0)
    return np.sqrt(nearest + above * above)


def _plate(strict: Any, register: Any) -> Any:
    digest = register(leg.leg_position, plate_distance)
    axes = tuple(zip(robot.AXIS_X, robot.AXIS_Y, strict=True))
    golden = 0.5 * (np.sqrt(5.0) - 1.0)

    @strict
    def plate(m, layer, radius, corners, low, top, enough, xy, turns, z):
        """Return the least distance of B4's tube from the platform's plate over all poses [m].

        Negative where they overlap; ``enough`` where it is more than that.

        Args: the lengths, offset of B4 across the leg plane and its radius, the plate's corners
        (n, 2), its heights from joint 5, positions (i, 2), cosines and sines of theta (j, 2),
        heights.
        """
        _ = digest
        least = enough
        for i in range(len(xy)):
            for j in range(len(turns)):
                c, s = turns[j, 0], turns[j, 1]
                for k in range(3):
                    bx, by = (
                        m.base_radius * axes[k][0] - xy[i, 0],
                        (m.base_radius * axes[k][1] - xy[i, 1]),
                    )
                    for n in range(len(z)):
                        g = leg.leg_position(
                            m, axes[k][0], axes[k][1], xy[i, 0], xy[i, 1], c, s, z[n]
                        )
                        down = g.z9 - g.zeta
                        if not min(down, 0.0) - top - radius < least:
                            continue
                        # B4's middle line in the platform's frame, from joint 5
                        px, py = bx + g.rho * g.ux - layer * g.uy, by + g.rho * g.uy + layer * g.ux
                        qx, qy = (g.r9 - g.rho) * g.ux, (g.r9 - g.rho) * g.uy
                        px, py = c * px + s * py, c * py - s * px
                        qx, qy = c * qx + s * qy, c * qy - s * qx
                        first, last = 0.0, 1.0
                        a, b = 1.0 - golden, golden
                        fa = plate_distance(corners, low, top, px + a * qx, py + a * qy, a * down)
                        fb = plate_distance(corners, low, top, px + b * qx, py + b * qy, b * down)
                        for _ in range(NARROWED):
                            if fa < fb:
                                last, b, fb = b, a, fa
                                a = last - golden * (last - first)
                                fa = plate_distance(
                                    corners, low, top, px + a * qx, py + a * qy, a * down
                                )
                            else:
                                first, a, fa = a, b, fb
                                b = first + golden * (last - first)
                                fb = plate_distance(
                                    corners, low, top, px + b * qx, py + b * qy, b * down
                                )
                        # any place on the line is a bound from above
                        least = min(least, min(fa, fb) - radius)
        return least

    return plate
