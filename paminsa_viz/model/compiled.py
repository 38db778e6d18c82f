"""Formulae compiled into loops by Numba.

Nothing of the mechanics stands here: a formula and the functions that it calls are the same source
that runs on NumPy arrays. Each kernel runs on columns (one array a quantity) and releases the GIL.

Numba keeps compiled code on disk and looks only at the file of the kernel to see whether it is
stale. The formulae live in other files, so a digest of their source is woven into the kernels.
"""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload, register_jitable

from paminsa_viz.model import leg, robot


@overload(robot.where, jit_options={"forceinline": True})
def _where(condition: Any, yes: Any, no: Any) -> Any:
    def implementation(condition: Any, yes: Any, no: Any) -> Any:
        return yes if condition else no

    return implementation


_registered: set[FunctionType] = {robot.where}


def register(*formulae: Callable[..., Any], inline: bool = True) -> int:
    """Let Numba compile formulae and all that they call.

    LLVM vectorizes a loop only if the whole formula is inlined into it.

    Returns:
        A number that changes with the source of what was registered.
    """
    found: list[FunctionType] = []
    pending: list[Any] = list(formulae)
    while pending:
        function = pending.pop()
        if not isinstance(function, FunctionType) or function in found:
            continue
        found.append(function)
        names = inspect.getclosurevars(function)
        pending += [*names.globals.values(), *names.nonlocals.values()]
    for function in found:
        if function not in _registered:
            register_jitable(forceinline=inline)(function)
            _registered.add(function)
    files = sorted({function.__code__.co_filename for function in found})
    text = b"".join(Path(name).read_bytes() for name in files if Path(name).is_file())
    code = b"".join(function.__code__.co_code for function in found)
    return int.from_bytes(hashlib.sha256(text + code).digest()[:7], "big")


# `contract` lets the compiler fuse a product and a sum, which is faster and rounds once less.
OPTIONS: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
}


def over_poses(formula: Callable[..., Any], count: int) -> tuple[Any, Any]:
    """Compile a formula of a pose, or load it from disk: loops over a grid and over a list.

    Args:
        formula: As `backend.Formula.function`.
        count: How many of its results to keep.
    """
    digest = register(formula)  # a closure variable, and so part of Numba's cache key

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

    none = np.zeros(0)
    over_grid(_MECHANISM, np.zeros((0, 5)), np.zeros((3, 0)), True, np.zeros((0, count, 0)))
    over_list(_MECHANISM, np.zeros((0, 4)), none, none, np.zeros((0, count)))
    return over_grid, over_list


_MECHANISM = leg.Mechanism(*[1.0] * len(leg.Mechanism._fields))
"""Some mechanism, for a call on no poses that compiles a kernel."""

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


inverse_dynamics_kernel, mass_matrix = _motion_kernels(
    register(robot.inverse_dynamics_kernel, robot.mass_matrix)
)


def warm_up() -> None:
    """Compile the kernels of motions, or load it from disk, by a call on nothing."""
    e = robot.EnergyTerms(*[1.0] * len(robot.EnergyTerms._fields))
    none, pose = np.zeros(0), np.zeros((0, 4))
    inverse_dynamics_kernel(_MECHANISM, e, 1.0, pose, none, none, pose, pose, np.zeros((0, 8)))
    mass_matrix(_MECHANISM, e, pose, none, none, np.zeros((0, 10)))
