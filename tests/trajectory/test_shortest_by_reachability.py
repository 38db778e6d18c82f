"""The time-optimal law against reachability analysis on a grid, which needs no start and no solver.

With b = s'^2 linear between nodes of the path s, torques are linear in b at both ends of a cell.
Backward, the largest b from which the rest of the path can be run is a linear program of two
numbers a cell; forward, each b is then the largest that can be reached (Pham and Pham, IEEE
Transactions on Robotics 34 (2018) 645). No law on the grid is faster.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import linprog

from paminsa_viz.model import APPENDIX_4, Design, KneeBranch, inverse_dynamics
from paminsa_viz.model.arrays import Array
from paminsa_viz.trajectory import MotionLimits, circle, point_to_point, shortest_motion
from tests.trajectory.plans import A, B, C

CELLS = 200
RADIUS = 0.06
LIMITS = MotionLimits(torque=7.0, force=450.0)

Path = Callable[[Array], tuple[Array, Array, Array]]
"""Poses at places 0 to 1, and their first and second derivatives by the place, (n, 4) each."""


def straight(knee: KneeBranch) -> Path:
    start, goal = of_knee(A, knee), of_knee(B, knee)
    way = goal - start

    def path(s: Array) -> tuple[Array, Array, Array]:
        ways = np.tile(way, (len(s), 1))
        return start + s[:, None] * way, ways, np.zeros_like(ways)

    return path


def round_about(knee: KneeBranch) -> Path:
    def path(s: Array) -> tuple[Array, Array, Array]:
        turn = 2 * np.pi
        c, zero = np.cos(turn * s), np.zeros_like(s)
        sine = np.sin(turn * s)
        around = np.stack([c, sine, zero, zero], axis=1)
        along = np.stack([-sine, c, zero, zero], axis=1)
        place = of_knee(C, knee) + RADIUS * around
        return place, turn * RADIUS * along, -(turn**2) * RADIUS * around

    return path


def of_knee(pose: Array, knee: KneeBranch) -> Array:
    return pose * [1.0, 1.0, 1.0, knee.sign]


def shortest_time(design: Design, path: Path) -> float:
    """Return the shortest time within `LIMITS` from rest to rest on the grid [s]."""
    s = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, CELLS + 1)))  # close where a law starts
    step = np.diff(s)
    pose, along, bend = path(0.5 * (s[1:] + s[:-1]))
    still = np.zeros_like(pose)
    held = inverse_dynamics(design, pose, still, still).torque
    by_growth = inverse_dynamics(design, pose, still, along).torque - held  # of s''
    by_square = inverse_dynamics(design, pose, along, bend).torque - held  # of s'^2
    ends = [by_square / 2 + sign * by_growth / (2 * step[:, None]) for sign in (-1.0, 1.0)]
    both = np.stack(ends, axis=-1) / LIMITS.actuators[:, None]
    rows = np.concatenate([both, -both], axis=1)
    room = np.concatenate([1.0 - held / LIMITS.actuators, 1.0 + held / LIMITS.actuators], axis=1)

    largest = np.zeros(CELLS + 1)
    for i in reversed(range(CELLS)):
        best = linprog([-1.0, 0.0], rows[i], room[i], bounds=[(0.0, None), (0.0, largest[i + 1])])
        largest[i] = best.x[0]
    square = np.zeros(CELLS + 1)
    for i in range(CELLS):
        rises = rows[i, :, 1] > 0
        most = (room[i] - rows[i, :, 0] * square[i])[rises] / rows[i, rises, 1]
        square[i + 1] = min(most.min(), largest[i + 1])
    return float((2.0 * step / (np.sqrt(square[1:]) + np.sqrt(square[:-1]))).sum())


@pytest.mark.slow
@pytest.mark.parametrize("knee", KneeBranch)
def test_shortest_time_is_that_of_reachability_on_a_grid(knee: KneeBranch) -> None:
    """Of a straight move with the lower knee, and of a circle with the upper one."""
    design = APPENDIX_4.with_knee(knee)
    if knee is KneeBranch.LOWER:
        plan, path = point_to_point(of_knee(A, knee), of_knee(B, knee)), straight(knee)
    else:
        plan, path = circle(of_knee(C, knee), RADIUS), round_about(knee)
    found, best = shortest_motion(plan, LIMITS, design), shortest_time(design, path)
    # its pieces cost up to 0.4 %, as documented
    assert best * (1 - 1e-3) < found.plan.duration < best * 1.004
    assert found.plan.duration < 0.97 * found.stretched
