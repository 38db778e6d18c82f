"""Formulas compiled into loops by Numba.

Nothing of the mechanics is here: a formula and the functions that it calls are the same source
that runs on NumPy arrays. Each kernel runs on columns (one array a quantity) and releases the GIL.

Numba keeps compiled code on disk and looks only at the file of the kernel to see whether it is
stale. The formulas live in other files, so each kernel names a digest of their source, which as a
variable of its closure is part of the key that Numba looks for.
"""

from __future__ import annotations

import hashlib
import inspect
import logging
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import FunctionType
from typing import Any

import numba
import numpy as np
from llvmlite.binding import add_symbol
from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.runtime import _nrt_python  # type: ignore[attr-defined]
from numba.extending import overload, register_jitable

from paminsa_viz.model import leg, leg_forces, robot
from paminsa_viz.model.arrays import as_kernels_take


@overload(robot.where, jit_options={"forceinline": True})
def _where(condition: Any, yes: Any, no: Any) -> Any:
    def implementation(condition: Any, yes: Any, no: Any) -> Any:
        return yes if condition else no

    return implementation


_registered: set[FunctionType] = {robot.where}


_CALLED_BY_KERNELS = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Options that spare a tenth of the time to compile: neither C nor Python calls what is called."""


def register(*formulas: Callable[..., Any], inline: bool = True) -> str:
    """Let Numba compile formulas and all that they call.

    LLVM vectorizes a loop only if the whole formula is inlined into it.

    Returns:
        A digest, which changes with the source of what was registered.
    """
    found: list[FunctionType] = []
    pending: list[Any] = list(formulas)
    while pending:
        function = pending.pop()
        if not isinstance(function, FunctionType) or function in found:
            continue
        found.append(function)
        names = inspect.getclosurevars(function)
        pending += [*names.globals.values(), *names.nonlocals.values()]
    for function in found:
        if function not in _registered:
            register_jitable(**_CALLED_BY_KERNELS, forceinline=inline)(function)
            _registered.add(function)
    files = sorted({function.__code__.co_filename for function in found})
    text = b"".join(Path(name).read_bytes() for name in files if Path(name).is_file())
    code = b"".join(function.__code__.co_code for function in found)
    return hashlib.sha256(text + code).hexdigest()


# `contract` lets the compiler fuse a product and a sum, which is faster and rounds once less.
OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
}


NEWEST_NUMBA = (0, 68)
"""The newest release whose compiled code was tried without all that compiles it."""

log = logging.getLogger(__name__)

_is_tried = tuple(map(int, numba.__version__.split(".")[:2])) <= NEWEST_NUMBA
if _is_tried:
    for _name, _address in _nrt_python.c_helpers.items():
        add_symbol(_name if _name.startswith("_") else f"NRT_{_name}", _address)


class _Files(IndexDataCacheFile):
    """A file for each kernel, named by all that its code depends on.

    Numba itself numbers the files and writes first into an index which of them is whose: of two
    processes that compile at once, or of one that ends between the two writes, a kernel may be
    left with the code of another one.
    """

    def save(self, key: Any, data: Any) -> None:
        self._save_data(self._name(key), data)

    def load(self, key: Any) -> Any:
        with suppress(FileNotFoundError):
            return self._load_data(self._name(key))
        return None

    def _name(self, key: Any) -> str:
        depends_on = repr((self._version, self._source_stamp, key)).encode()
        return self._data_name(int.from_bytes(hashlib.sha256(depends_on).digest()[:8]))


class _Cache(FunctionCache):
    """Numba's compiled code on disk, which helps where it can be read and written.

    Numba itself loads all that it compiles with before it looks for compiled code: 200 modules,
    0.3 s and 50 MB, of which the code needs nothing but the addresses of the array functions.
    """

    def __init__(self, function: FunctionType) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        load = self._load_overload if _is_tried else super().load_overload
        # A file that something else has damaged may raise anything; then it is written anew.
        with suppress(Exception):
            if (loaded := load(sig, target_context)) is not None:
                return loaded
        log.info("%s is compiled", self._name)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError):  # a full disk, a limit on files' sizes, a folder that has gone
            super().save_overload(sig, data)


def kernel(**options: Any) -> Callable[[FunctionType], Any]:
    """Compile a function by Numba, or load it from disk, where a disk is.

    Unlike Numba's own cache this one never decides whether the program runs: without any folder
    that can be written to, and on a full disk, the function is compiled at each start.
    """

    def compiled(function: FunctionType) -> Any:
        dispatcher: Any = njit(**options)(function)
        try:
            dispatcher._cache = _Cache(function)
        except RuntimeError:  # there is no folder for it
            log.info("%s is compiled at each start", function.__name__, extra={"kept": False})
        return dispatcher

    return compiled


_BLOCK = 128
"""States worked on at a time: their columns lie in one small buffer that stays in the L1 cache.

With a score of arrays LLVM would give up proving that none overlaps another, and not vectorize.
"""


def over_poses(formula: Callable[..., Any], count: int) -> tuple[Any, Any]:
    """Compile a formula of a pose, or load it from disk: loops over a grid and over a list.

    Args:
        formula: As `backend.Formula.function`.
        count: How many of its results to keep.
    """
    digest = register(formula)

    @kernel(**OPTIONS)
    def over_grid(m, outer, inner, along_x, out):
        """Poses outer[i] + inner[:, j]; theta is the outer's alone, so its part is hoisted.

        ``along_x`` says that x alone varies in the inner part: then most of the formula's parts in
        y and z are the same for a whole row as well.
        """
        _ = digest
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

    @kernel(**OPTIONS)
    def over_list(m, pose, out):
        _ = digest
        w = np.empty((5 + count, _BLOCK))
        for start in range(0, len(pose), _BLOCK):
            size = min(_BLOCK, len(pose) - start)
            for j in range(size):
                w[0, j] = pose[start + j, 0]
                w[1, j] = pose[start + j, 1]
                w[2, j] = np.cos(pose[start + j, 2])
                w[3, j] = np.sin(pose[start + j, 2])
                w[4, j] = pose[start + j, 3]
            for j in range(size):
                values = formula(m, w[0, j], w[1, j], w[2, j], w[3, j], w[4, j])
                for n in range(count):
                    w[5 + n, j] = values[n]
            for j in range(size):
                for n in range(count):
                    out[start + j, n] = w[5 + n, j]

    over_grid(_MECHANISM, nothing(2), nothing(2), True, nothing(3))
    over_list(_MECHANISM, as_kernels_take(nothing(2)), nothing(2))
    return over_grid, over_list


def nothing(dimensions: int) -> Any:
    """Return an array of so many dimensions without entries, for a call that compiles a kernel."""
    return np.empty((0,) * dimensions)


_MECHANISM = leg.Mechanism(*[1.0] * len(leg.Mechanism._fields))
"""Some mechanism, for such a call."""


def _motion_kernels(digest: str) -> tuple[Any, Any]:
    """Compile inverse dynamics and the mass matrix over lists of states."""

    @kernel(**OPTIONS)
    def inverse_dynamics_kernel(m, e, gravity, pose, c, s, velocity, acceleration, out):
        _ = digest
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

    @kernel(**OPTIONS)
    def mass_matrix(m, e, pose, c, s, out):
        _ = digest
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


_AXES = tuple(zip(robot.AXIS_X, robot.AXIS_Y, strict=True))
_LEG_TERMS = len(robot.EnergyTerms._fields) - 2  # the last two belong to the platform
_TURN, _MASS, _INERTIA = _LEG_TERMS - 1, _LEG_TERMS, _LEG_TERMS + 1


def _regressor_kernel(digest: str) -> Any:
    """Compile the regressor over lists of states.

    The mechanics in it is that of `leg_forces.leg_regressor`; the map from the legs to the
    actuators alone is written a second time, as loops; its array form is in `regressor.py`.
    """

    @kernel(**OPTIONS)
    def regressor(m, gravity, pose, c, s, velocity, acceleration, terms, coefficients, factors, y):
        """Fill ``y`` (n, 4, coefficients).

        Energy term ``terms[i]`` adds ``factors[i]`` times its torque to ``coefficients[i]``.
        """
        _ = digest
        forces = np.empty((3, 3, _LEG_TERMS))  # on rho, on theta_k, on Z; by leg
        v = np.empty((3, 6))  # the legs' vectors, see `leg.LegVector`, and 1/rho
        j = np.empty((3, 3))  # d (x, y, theta) / d theta_k, by coordinate and leg
        torque = np.zeros((4, _LEG_TERMS + 2))  # M4 keeps its 0 of the inertia
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
            torque[3, _MASS] = m.k * (az + gravity)
            y[n] = 0.0
            for a in range(4):
                for i in range(terms.size):
                    y[n, a, coefficients[i]] += factors[i] * torque[a, terms[i]]

    return regressor


regressor = _regressor_kernel(
    register(
        leg.leg_position,
        leg.leg_motion,
        leg_forces.leg_regressor,
        robot.platform_determinant,
        robot.solve_wrench,
    )
)


def warm_up() -> None:
    """Compile the kernels of motions, or load them from disk, by a call on nothing."""
    e = robot.EnergyTerms(*[1.0] * len(robot.EnergyTerms._fields))
    numbers, out = nothing(1), nothing(2)
    rows = as_kernels_take(nothing(2))
    inverse_dynamics_kernel(_MECHANISM, e, 1.0, rows, numbers, numbers, rows, rows, out)
    mass_matrix(_MECHANISM, e, rows, numbers, numbers, out)
    index = numbers.astype(np.int64)
    regressor(
        _MECHANISM, 1.0, rows, numbers, numbers, rows, rows, index, index, numbers, nothing(3)
    )
