"""Runs the formulas: compiled where Numba is ready, on NumPy arrays otherwise, from one source.

The first compilation takes seconds, and loading it from disk most of one later. So the kernels of
motions, and those of a formula, are loaded only once enough of their work has been requested to pay
for it; small jobs never wait. A page calls `compile_later`, then `compile_in_background`, and works
on NumPy until the kernels are there. Where Numba is not installed all runs on NumPy.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from contextlib import ContextDecorator
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.interrupts import import_whole
from paminsa_viz.model import leg, robot
from paminsa_viz.model.arrays import Array, as_kernels_take
from paminsa_viz.model.lumped import EnergyTerms

Loops = tuple[Callable[..., None], Callable[..., None]]
"""Compiled loops of a formula, over a grid and over a list, see `compiled.over_poses`."""


class Formula(NamedTuple):
    """A formula of a pose, written once: it runs on arrays, and on numbers in compiled loops.

    Attributes:
        function: ``function(m, x, y, c, s, z)`` of a `Mechanism`, a position [m], cosine and sine
            of theta, and z [m]. It returns a tuple, calls NumPy's elementwise functions and other
            such formulas by their names in its module, and chooses by `robot.where`.
        results: How many of the returned values are kept, from the first one on.
    """

    function: Callable[..., tuple[Any, ...]]
    results: int


WORTH_LOADING = 100_000
"""Number of poses from which NumPy would take longer than loading the kernels does."""

LEAST_WORK = 50
"""What a call on few poses counts as: on NumPy its overhead is that of some fifty more."""

_REGRESSOR_WORTH = 20
"""Poses that a state of the regressor counts as: on NumPy it takes about as long."""


class _Loading(threading.local):
    """Context in which kernels are compiled or loaded: how long each thread has waited there [s].

    Attributes:
        seconds: That time, so far.
    """

    def __init__(self) -> None:
        self.seconds, self._depth, self._since = 0.0, 0, 0.0

    def __enter__(self) -> None:
        if self._depth == 0:
            self._since = time.perf_counter()
        self._depth += 1

    def __exit__(self, *_: object) -> None:
        self._depth -= 1
        if self._depth == 0:
            self.seconds += time.perf_counter() - self._since


loading = _Loading()


class WorkClock:
    """Time of work in one thread, which a limit counts: that of loading kernels is none of it.

    Compiling takes many seconds, once after installing, and more on a busy machine; with it work
    would end undecided at the first run, and decided at the second.
    """

    def __init__(self) -> None:
        self._start, self._loaded = time.perf_counter(), loading.seconds

    @property
    def elapsed(self) -> float:
        """Time since the start, without that in which the thread waited for kernels [s]."""
        return time.perf_counter() - self._start - (loading.seconds - self._loaded)


class _Avoided(threading.local):
    """How many of `use_numpy` each thread is in."""

    depth = 0


class _Kernels:
    """The compiled kernels: those of motions, and of each formula, loaded once that pays."""

    def __init__(self) -> None:
        self.module: ModuleType | None = None
        self.loops: dict[Formula, Loops] = {}
        self.deferred = os.environ.get("PAMINSA_VIZ_BACKEND", "") == "numpy"
        self.worth = WORTH_LOADING
        self.requested: dict[Formula | None, int] = {}
        self.lock = threading.Lock()
        self.avoided = _Avoided()

    @property
    def allowed(self) -> bool:
        """Whether this thread may use what is compiled."""
        return not self.avoided.depth

    def pays(self, size: int, formula: Formula | None = None) -> bool:
        """Count ``size`` more poses of motions, or of a formula; whether to load its kernels."""
        work = self.requested.get(formula, 0) + max(size, LEAST_WORK)
        self.requested[formula] = work
        return self.allowed and not self.deferred and work >= self.worth

    def get(self, size: int) -> ModuleType | None:
        """Return the kernels of motions if it pays to use them for ``size`` more poses."""
        if self.pays(size) and self.module is None:
            self.load()
        return self.module if self.allowed else None

    def get_loops(self, formula: Formula, size: int) -> Loops | None:
        """Return the loops of a formula if it pays to use them for ``size`` more poses."""
        if self.pays(size, formula) and formula not in self.loops:
            self.load(formula, motions=False)
        return self.loops.get(formula) if self.in_use() else None

    def in_use(self) -> bool:
        """Whether what is compiled is used: not before a page has loaded all, nor on NumPy."""
        known = self.module is not None or (not self.deferred and bool(self.loops))
        return known and self.allowed

    def compiler(self) -> ModuleType | None:
        """Return what compiles; without Numba None, and from then on all runs on NumPy."""
        try:
            with loading:
                return import_whole("paminsa_viz.model.compiled")
        except (ModuleNotFoundError, OSError) as error:  # of LLVM, which the system cannot load
            if isinstance(error, ModuleNotFoundError) and error.name != "numba":
                raise
            self.deferred = True  # whatever the size
            return None

    def load(self, *formulas: Formula, motions: bool = True) -> None:
        with loading, self.lock:
            compiled = self.compiler()
            if compiled is None:
                return
            if motions and self.module is None:
                compiled.warm_up()
            for formula in formulas:
                if formula not in self.loops:
                    self.loops[formula] = compiled.over_poses(formula.function, formula.results)
            if motions:
                self.module = compiled


_kernels = _Kernels()


def compile_later() -> None:
    """Run on NumPy until `compile_in_background` has ended: nothing waits for a compilation."""
    _kernels.deferred = True


def compile_in_background(*formulas: Formula) -> threading.Thread:
    """Load the kernels and those of formulas in a thread; until it ends all runs on NumPy."""
    compile_later()
    thread = threading.Thread(
        target=_kernels.load, args=formulas, name="paminsa-compile", daemon=True
    )
    thread.start()
    return thread


def compile_now() -> None:
    """Load the kernels, and wait for it; from now on each formula is compiled on its first use."""
    _kernels.worth, _kernels.deferred = 0, False
    _kernels.load()


def can_compile() -> bool:
    """Whether Numba is there to compile with."""
    return _kernels.compiler() is not None


def compiles() -> bool:
    """Whether work with kernels of its own may compile them now; those of here are not loaded."""
    return is_compiled() or (_kernels.allowed and not _kernels.deferred and can_compile())


def is_compiled() -> bool:
    """Whether compiled kernels are in use."""
    return _kernels.in_use()


class use_numpy(ContextDecorator):
    """Context in which all that its thread computes runs on NumPy, to the same bits every time."""

    def __enter__(self) -> None:
        _kernels.avoided.depth += 1

    def __exit__(self, *_: object) -> None:
        _kernels.avoided.depth -= 1


def _cos_sin(angle: Array) -> tuple[Array, Array]:
    """Return cosine and sine; NaN for an infinite angle."""
    with np.errstate(invalid="ignore"):
        return np.cos(angle), np.sin(angle)


def over_list(formula: Formula, m: leg.Mechanism, pose: Array) -> Array:
    """Evaluate a formula of a pose on a list.

    Args:
        formula: What to evaluate.
        m: The mechanism.
        pose: (n, 4) [m, m, rad, m].

    Returns:
        (n, results of the formula).
    """
    loops = _kernels.get_loops(formula, len(pose))
    if loops is not None:
        out = np.empty((len(pose), formula.results))
        loops[1](m, as_kernels_take(pose), out)
        return out
    x, y, theta, z = pose.T
    c, s = _cos_sin(theta)
    return np.stack(on_arrays(formula, m, x, y, c, s, z), axis=-1)


def on_arrays(
    formula: Formula, m: leg.Mechanism, x: Array, y: Array, c: Array, s: Array, z: Array
) -> list[Array]:
    """Evaluate a formula on NumPy arrays that broadcast, never compiled: one array a result."""
    with np.errstate(all="ignore"):
        values = formula.function(m, x, y, c, s, z)[: formula.results]
    shape = np.broadcast_shapes(*(np.shape(part) for part in (x, y, c, s, z)))
    return [np.broadcast_to(value, shape) for value in values]


def over_grid(
    formula: Formula, m: leg.Mechanism, outer: Array, inner: Array
) -> Callable[[slice, slice, Array], None]:
    """Prepare a formula for all sums of an outer and an inner pose; theta is the outer's alone.

    Args:
        formula: What to evaluate.
        m: The mechanism.
        outer: (rows, 4) parts of poses [m, m, rad, m].
        inner: (columns, 4) parts of poses; the third column is not used.

    Returns:
        ``fill(rows, columns, out)``, which evaluates a block into a contiguous array (rows,
        results of the formula, columns). It may be called from several threads.
    """
    c, s = _cos_sin(outer[:, 2])
    loops = _kernels.get_loops(formula, len(outer) * len(inner))
    if loops is not None:
        table = np.column_stack([outer[:, 0], outer[:, 1], outer[:, 3], c, s])
        parts = np.ascontiguousarray(inner[:, [0, 1, 3]].T)
        along_x = not parts[1:].any()

        def compiled(rows: slice, columns: slice, out: Array) -> None:
            loops[0](m, table[rows], np.ascontiguousarray(parts[:, columns]), along_x, out)

        return compiled

    def on_numpy(rows: slice, columns: slice, out: Array) -> None:
        x, y, _, z = np.moveaxis(outer[rows, None, :] + inner[None, columns, :], -1, 0)
        values = on_arrays(formula, m, x, y, c[rows, None], s[rows, None], z)
        out[:] = np.stack(values, axis=1)

    return on_numpy


def inverse_dynamics_kernel(
    m: leg.Mechanism,
    e: EnergyTerms,
    gravity: float,
    pose: Array,
    velocity: Array,
    acceleration: Array,
) -> Array:
    """Evaluate `robot.inverse_dynamics_kernel` on (n, 4); return torques, multipliers (n, 8)."""
    pose, velocity, acceleration = map(as_kernels_take, (pose, velocity, acceleration))
    c, s = _cos_sin(pose[:, 2])
    kernels = _kernels.get(len(pose))
    if kernels is not None:
        out = np.empty((len(pose), 8))
        kernels.inverse_dynamics_kernel(m, e, gravity, pose, c, s, velocity, acceleration, out)
        return out
    x, y, _, z = pose.T
    with np.errstate(all="ignore"):
        values = robot.inverse_dynamics_kernel(
            m, e, gravity, x, y, c, s, z, *velocity.T, *acceleration.T
        )
    return np.stack(np.broadcast_arrays(*values), axis=-1)


def mass_matrix(m: leg.Mechanism, e: EnergyTerms, pose: Array) -> Array:
    """Evaluate `robot.mass_matrix` on a list (n, 4); returns the upper triangles, (n, 10)."""
    pose = as_kernels_take(pose)
    c, s = _cos_sin(pose[:, 2])
    kernels = _kernels.get(len(pose))
    if kernels is not None:
        out = np.empty((len(pose), 10))
        kernels.mass_matrix(m, e, pose, c, s, out)
        return out
    with np.errstate(all="ignore"):
        values: tuple[Any, ...] = robot.mass_matrix(m, e, pose[:, 0], pose[:, 1], c, s, pose[:, 3])
    return np.stack(np.broadcast_arrays(*values), axis=-1)


def regressor(
    m: leg.Mechanism,
    gravity: float,
    pose: Array,
    velocity: Array,
    acceleration: Array,
    terms: Array,
) -> Array | None:
    """Evaluate the regressor on lists (n, 4) if it is compiled, (n, 4, 18); otherwise None.

    ``terms`` (21, 18) maps the lumped coefficients to the energy terms.
    """
    kernels = _kernels.get(_REGRESSOR_WORTH * len(pose))
    if kernels is None:
        return None
    pose, velocity, acceleration = map(as_kernels_take, (pose, velocity, acceleration))
    c, s = _cos_sin(pose[:, 2])
    rows, columns = map(np.ascontiguousarray, np.nonzero(terms))
    y = np.empty((len(pose), 4, terms.shape[1]))
    kernels.regressor(
        m, gravity, pose, c, s, velocity, acceleration, rows, columns, terms[rows, columns], y
    )
    return y
