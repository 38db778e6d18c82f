"""The formulae of `leg.py`, `leg_forces.py` and `robot.py` compiled into loops by Numba.

Nothing of the mechanics stands here: the functions registered below are the same source that runs
on NumPy arrays. Each kernel runs on columns (one array a quantity) and releases the GIL.

Numba keeps compiled code on disk and looks only at the file of the kernel to see whether it is
stale. The formulae live in other files, so a digest of their source is woven into the kernels.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload, register_jitable

from paminsa_viz.model import leg, leg_forces, measures, robot

_FORMULAE = (
    leg.pantograph,
    leg.knee_height,
    leg.knee_radius,
    leg.leg_vector,
    leg.leg_position,
    leg.leg_motion,
    leg_forces.leg_forces,
    leg_forces.leg_inertia,
    leg_forces.leg_regressor,
    robot.platform_determinant,
    robot.solve_wrench,
    robot._slope,
    robot._usable,
    robot.unit_torques,
    robot._vector,
    robot.inverse_dynamics_kernel,
    robot._leg_mass,
    robot.mass_matrix,
    measures.leg_margins,
    measures._lesser,
    measures.least_margin,
    measures._largest_eigenvalue,
    measures._lever,
    measures.dexterity,
)

# LLVM vectorizes a loop only if the whole formula is inlined into it.
for _formula in _FORMULAE:
    register_jitable(forceinline=True)(_formula)


@overload(robot.where, jit_options={"forceinline": True})
def _where(condition: Any, yes: Any, no: Any) -> Any:
    def implementation(condition: Any, yes: Any, no: Any) -> Any:
        return yes if condition else no

    return implementation


def _digest() -> int:
    """Return a number that changes with the source of the formulae."""
    files = (leg.__file__, leg_forces.__file__, measures.__file__, robot.__file__)
    text = b"".join(Path(name).read_bytes() for name in files)
    return int.from_bytes(hashlib.sha256(text).digest()[:7], "big")


# `contract` lets the compiler fuse a product and a sum, which is faster and rounds once less.
OPTIONS: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
}


def _over_poses(formula: Callable[..., Any], count: int, digest: int) -> tuple[Any, Any]:
    """Compile a formula of a pose with ``count`` results, over a grid and over a list.

    ``digest`` is used for its being a closure variable, and so part of Numba's cache key.
    """

    @njit(**OPTIONS)
    def over_grid(m, outer, inner, along_x, out):  # type: ignore[no-untyped-def]
        """Poses outer[i] + inner[:, j]; theta is the outer's alone, so its part is hoisted.

        ``along_x`` says that x alone varies in the inner part: then most of the formula's parts in
        y and z are the same for a whole row as well.
        """
        if digest < 0:
            return
        x, y, z = inner[0], inner[1], inner[2]
        for i in range(outer.shape[0]):
            ox, oy, oz, c, s = outer[i, 0], outer[i, 1], outer[i, 2], outer[i, 3], outer[i, 4]
            if along_x:
                for j in range(x.size):
                    values = formula(m, ox + x[j], oy, c, s, oz)
                    for n in range(count):
                        out[i, n, j] = values[n]
            else:
                for j in range(x.size):
                    values = formula(m, ox + x[j], oy + y[j], c, s, oz + z[j])
                    for n in range(count):
                        out[i, n, j] = values[n]

    @njit(**OPTIONS)
    def over_list(m, pose, c, s, out):  # type: ignore[no-untyped-def]
        if digest < 0:
            return
        for j in range(c.size):
            values = formula(m, pose[j, 0], pose[j, 1], c[j], s[j], pose[j, 3])
            for n in range(count):
                out[j, n] = values[n]

    return over_grid, over_list


_BLOCK = 128
"""States worked on at a time: their columns lie in one small buffer that stays in the L1 cache.

With a score of arrays LLVM would give up proving that none overlaps another, and not vectorize.
"""


def _motion_kernels(digest: int) -> tuple[Any, Any]:
    """Compile inverse dynamics and the mass matrix over lists of states."""

    @njit(**OPTIONS)
    def inverse_dynamics_kernel(m, e, gravity, pose, c, s, velocity, acceleration, out):  # type: ignore[no-untyped-def]
        if digest < 0:
            return
        w = np.empty((22, _BLOCK))
        for start in range(0, c.size, _BLOCK):
            size = min(_BLOCK, c.size - start)
            for j in range(size):
                for i in range(4):
                    w[i, j] = pose[start + j, i]
                    w[6 + i, j] = velocity[start + j, i]
                    w[10 + i, j] = acceleration[start + j, i]
                w[4, j] = c[start + j]
                w[5, j] = s[start + j]
            for j in range(size):
                values = robot.inverse_dynamics_kernel(
                    m, e, gravity, w[0, j], w[1, j], w[4, j], w[5, j], w[3, j],
                    w[6, j], w[7, j], w[8, j], w[9, j], w[10, j], w[11, j], w[12, j], w[13, j],
                )  # fmt: skip
                for i in range(8):
                    w[14 + i, j] = values[i]
            for j in range(size):
                for i in range(8):
                    out[start + j, i] = w[14 + i, j]

    @njit(**OPTIONS)
    def mass_matrix(m, e, pose, c, s, out):  # type: ignore[no-untyped-def]
        if digest < 0:
            return
        w = np.empty((16, _BLOCK))
        for start in range(0, c.size, _BLOCK):
            size = min(_BLOCK, c.size - start)
            for j in range(size):
                for i in range(4):
                    w[i, j] = pose[start + j, i]
                w[4, j] = c[start + j]
                w[5, j] = s[start + j]
            for j in range(size):
                values = robot.mass_matrix(m, e, w[0, j], w[1, j], w[4, j], w[5, j], w[3, j])
                for i in range(10):
                    w[6 + i, j] = values[i]
            for j in range(size):
                for i in range(10):
                    out[start + j, i] = w[6 + i, j]

    return inverse_dynamics_kernel, mass_matrix


DIGEST = _digest()
"""Number that changes with the source of the formulae; kernels elsewhere weave it in as well."""
_POSE_FORMULAE: dict[str, tuple[Callable[..., Any], int]] = {
    "rotary_torques": (robot.unit_torques, 3),
    "unit_torques": (robot.unit_torques, 4),
    "least_margin": (measures.least_margin, 2),
    "dexterity": (measures.dexterity, 2),
}
COUNTS = {name: count for name, (_, count) in _POSE_FORMULAE.items()}
"""How many results each formula of a pose has."""
OVER_POSES = {
    name: _over_poses(formula, count, DIGEST) for name, (formula, count) in _POSE_FORMULAE.items()
}
"""Kernels over grids and over lists of poses: ``(over_grid, over_list)``."""

inverse_dynamics_kernel, mass_matrix = _motion_kernels(DIGEST)


def warm_up() -> None:
    """Compile every kernel, or load it from disk, by a call on nothing."""
    m = leg.Mechanism(*[1.0] * len(leg.Mechanism._fields))
    e = robot.EnergyTerms(*[1.0] * len(robot.EnergyTerms._fields))
    none, pose = np.zeros(0), np.zeros((0, 4))
    for name, (over_grid, over_list) in OVER_POSES.items():
        count = COUNTS[name]
        over_grid(m, np.zeros((0, 5)), np.zeros((3, 0)), True, np.zeros((0, count, 0)))
        over_list(m, pose, none, none, np.zeros((0, count)))
    inverse_dynamics_kernel(m, e, 1.0, pose, none, none, pose, pose, np.zeros((0, 8)))
    mass_matrix(m, e, pose, none, none, np.zeros((0, 10)))
