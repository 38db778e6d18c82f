"""Formulas over grids of any of the four coordinates.

What depends on the geometry alone is solved once (`solve_field`) and kept; the masses come in
afterwards as one factor, so that a mass slider rescales a map and solves nothing.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import size_of
from paminsa_viz.model import backend, robot
from paminsa_viz.model.arguments import of_design, of_geometry
from paminsa_viz.model.arrays import Array, as_numbers, as_pose
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematic_formulas import wrench_torques
from paminsa_viz.model.leg import Mechanism, mechanism
from paminsa_viz.model.load import LoadCase, generalized_force
from paminsa_viz.model.reach import LEAST_MARGIN, Limit, OfLimits, decode
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import UNIT_TORQUES, lift_constant, static_imbalance

# -------------------------------------------------------------------------- poses on a regular grid

COORDINATES = ("x", "y", "theta", "z")


@dataclass(frozen=True, eq=False)
class Grid:
    """Poses on a regular grid.

    Attributes:
        axes: Coordinates that vary, in the order of the result's axes, with their values, each
            (n,) [m or rad].
        fixed: (4,) pose that the other coordinates are taken from [m, m, rad, m].

    Raises:
        InvalidInput: If a coordinate is unknown, named twice, has no values, or is not
            one-dimensional.
    """

    axes: tuple[tuple[str, Array], ...]
    fixed: Array

    def __post_init__(self) -> None:
        made: dict[str, Array] = {}
        for name, values in self.axes:
            if name not in COORDINATES:
                raise InvalidInput(str(name), f"a grid varies {', '.join(COORDINATES)}")
            if name in made:
                raise InvalidInput(name, "a grid varies it along one axis; leave out the other")
            made[name] = as_numbers(values, name).copy()
            if made[name].ndim != 1 or made[name].size == 0:
                raise InvalidInput(name, f"one axis of values is needed; got {made[name].shape}")
        object.__setattr__(self, "axes", tuple(made.items()))
        object.__setattr__(self, "fixed", as_pose(self.fixed, "fixed").copy())

    @classmethod
    def over(cls, fixed: ArrayLike, **axes: ArrayLike) -> Grid:
        """Make a grid over named coordinates; the first one named is the result's first axis.

        Raises:
            InvalidInput: As of the grid itself.
        """
        return cls(cast(Any, tuple(axes.items())), cast(Any, fixed))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the result."""
        return tuple(values.size for _, values in self.axes)

    @property
    def size(self) -> int:
        """Number of poses."""
        return int(np.prod(self.shape, dtype=np.int64))

    def poses(self) -> Array:
        """Return every pose, (*shape, 4) [m, m, rad, m]."""
        pose = np.broadcast_to(self.fixed, (*self.shape, 4)).copy()
        mesh = np.meshgrid(*(values for _, values in self.axes), indexing="ij")
        for (name, _), values in zip(self.axes, mesh, strict=True):
            pose[..., COORDINATES.index(name)] = values
        return pose

    def split(self, poses: int) -> Iterator[tuple[tuple[slice, ...], Grid]]:
        """Cut the grid into pieces of at most ``poses`` poses, each with its index in the whole."""
        cuts = []
        for size in reversed(self.shape):
            step = max(1, min(size, poses))
            poses //= step
            cuts.append([slice(i, i + step) for i in range(0, size, step)])
        for index in itertools.product(*reversed(cuts)):
            axes = zip(self.axes, index, strict=True)
            yield index, Grid(tuple((name, v[part]) for (name, v), part in axes), self.fixed)


@kinds_checked
def xy_grid(x: ArrayLike, y: ArrayLike, theta: float, z: float) -> Grid:
    """Return the grid of Fig. 3: rows along y, columns along x, at one theta [rad] and z [m]."""
    return Grid.over((0.0, 0.0, theta, z), y=y, x=x)


# ---------------------------------------------------------------------------- what is known of them

ROTARY_TORQUES = Formula(robot.unit_torques, 3)
"""Gamma of M1..M3 alone, see `statics.unit_torques`."""

WRENCH_TORQUES = Formula(wrench_torques, 9)
"""Entries of J for x, y, theta and M1..M3, row by row, see `wrench_torques` [m, 1]."""

T = TypeVar("T")

BLOCK = 2**15
"""Poses worked on at a time: results of a block stay in the cache, and memory stays bounded."""


WORTH_THREADS = 4
"""Number of blocks from which the work is shared between cores."""


@dataclass(frozen=True, eq=False)
class Field(OfLimits):
    """What the geometry says about every pose of a grid; arrays have the grid's shape.

    Attributes:
        grid, geometry: What it was solved for.
        status: (...) values of `Limit`.
        leg: (...) index of the leg that is the reason, -1 for none.
        threads: Threads that share the work; None for all cores where the grid is large enough.
    """

    grid: Grid
    geometry: Geometry
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]
    threads: int | None
    _solved: dict[Formula, Array] = field(repr=False)
    _kept: dict[str, tuple[Any, Any, int]] = field(default_factory=dict, repr=False)

    def solve(self, formula: Formula) -> Array:
        """Return the results of a formula, (results, ...); solved at the first call and kept."""
        found = self._solved.get(formula)
        if found is None:
            m = mechanism(self.geometry)
            found = self._solved[formula] = _evaluate(formula, m, self.grid, self.threads)
        return found

    def keep(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        """Return what ``make`` returns, made again only when ``key`` has changed.

        For what follows from more than the geometry, and is used by several quantities. The last
        result of each name is kept.
        """
        found = self._kept.get(name)
        if found is None or found[0] != key:
            value = make()
            found = self._kept[name] = (key, value, size_of(value))
        return found[1]

    @property
    def nbytes(self) -> int:
        """Memory of what is known by now [bytes]."""
        arrays = [self.status, self.leg, *self._solved.values()]
        return sum(array.nbytes for array in arrays) + sum(
            size for _, _, size in list(self._kept.values())
        )

    @property
    def gamma(self) -> Array:
        """Unit torques (4, ...), see `statics.unit_torques`; NaN where status is not OK."""
        return self.solve(UNIT_TORQUES)

    @property
    def margin(self) -> Array:
        """Least distance to a limit (...), negative beyond it [m]."""
        return self.solve(LEAST_MARGIN)[0]

    @property
    def determinant(self) -> Array:
        """Determinant (...) as in `Singularity` [m]."""
        return self.solve(DEXTERITY)[0]

    @property
    def condition(self) -> Array:
        """Condition number (...) as in `Singularity`."""
        return self.solve(DEXTERITY)[1]

    def torques(self, design: Design) -> Array:
        """Return the static torques for the masses and the load of a design, (4, ...) [N m, N]."""
        torque = static_imbalance(design) * self.gamma
        torque[3] += lift_constant(design)
        return torque + self.load_torques(design) if design.load.acts else torque

    @kinds_checked
    def load_torques(self, design: Design) -> Array:
        """Return what the actuators need against the design's load, (4, ...) [N m, N]."""
        against = np.empty((4, *self.status.shape))
        against[:3] = _load_torques(self.solve(WRENCH_TORQUES), self.grid, design.load)
        against[3] = -self.geometry.magnification * design.load.force_z
        return against


@of_geometry
def solve_field(geometry: Geometry, grid: Grid, *, threads: int | None = None) -> Field:
    """Solve reach and unit torques on a grid; what else the geometry decides is solved on demand.

    Args:
        geometry: Lengths of the mechanism.
        grid: The poses.
        threads: Threads to share the work; None for all cores where the grid is large enough.
    """
    m = mechanism(geometry)
    gamma = _evaluate(UNIT_TORQUES, m, grid, threads)
    margin = _evaluate(LEAST_MARGIN, m, grid, threads)
    status, leg = decode(*margin)
    finite = np.isfinite(gamma).all(axis=0)
    status[(status == Limit.OK) & ~finite] = Limit.SINGULAR
    gamma[:, status != Limit.OK] = np.nan
    solved = {UNIT_TORQUES: gamma, LEAST_MARGIN: margin}
    return Field(grid, geometry, status, leg, threads, solved)


@of_design
def rotary_torques(design: Design, grid: Grid, threads: int | None = None) -> Array:
    """Return the static torques of M1..M3 alone, (3, ...) [N m]; the fastest way to a map.

    NaN where the pose cannot be taken, and no reason for it; `solve_field` gives that.

    Args:
        design: The robot; its weight and its load count.
        grid: The poses; the result has its shape behind the three actuators.
        threads: Threads to share the work; None for all cores where the grid is large enough.
    """
    factor, m = static_imbalance(design), mechanism(design.geometry)
    torque = _evaluate(ROTARY_TORQUES, m, grid, threads, factor)
    if design.load.acts:
        torque += _load_torques(_evaluate(WRENCH_TORQUES, m, grid, threads), grid, design.load)
    return torque


def _load_torques(entries: Array, grid: Grid, load: LoadCase) -> Array:
    """Return what M1..M3 need against a load, (3, ...) [N m], from `WRENCH_TORQUES`."""
    names = [name for name, _ in grid.axes]
    theta = grid.fixed[2]
    if "theta" in names:
        index = names.index("theta")
        theta = grid.axes[index][1].reshape(-1, *[1] * (len(names) - index - 1))
    fx, fy, moment, _ = np.moveaxis(generalized_force(load, theta), -1, 0)
    j = entries.reshape(3, 3, *grid.shape)
    with np.errstate(invalid="ignore"):  # at singular poses, where a force may be zero
        return -(j[0] * fx + j[1] * fy + j[2] * moment)


def _evaluate(
    formula: Formula, m: Mechanism, grid: Grid, threads: int | None, factor: float | None = None
) -> Array:
    """Evaluate a formula over a grid, (results, ...), in blocks, on as many cores as pay.

    The results are multiplied by the factor, if there is one, while they are in the cache.
    """
    # theta has to be in the outer part, where its sine and cosine are taken once a row
    order = sorted(range(len(grid.axes)), key=lambda i: grid.axes[i][0] != "theta")
    axes = [grid.axes[i] for i in order]
    last_theta = not axes or axes[-1][0] == "theta"
    inner = _parts([] if last_theta else axes[-1:], np.zeros(4))
    outer_axes = axes if last_theta else axes[:-1]
    outer_shape = tuple(values.size for _, values in outer_axes)
    rows, columns = int(np.prod(outer_shape, dtype=np.int64)), len(inner)
    moving = {name for name, _ in axes}
    base = np.where([name in moving for name in COORDINATES], 0.0, grid.fixed)
    row_step = max(1, BLOCK // columns)
    pieces = [
        (slice(r, r + row_step), slice(c, c + BLOCK))
        for r in range(0, rows, row_step)
        for c in range(0, columns, BLOCK)
    ]
    result = np.empty((rows, formula.results, columns))
    fill = backend.over_grid(formula, m, _parts(outer_axes, base), inner)

    def work(piece: tuple[slice, slice]) -> None:
        r, c = piece
        part = result[r, :, c]
        filled = part if part.flags.c_contiguous else np.empty(part.shape)
        fill(r, c, filled)
        if factor is not None:
            np.multiply(filled, factor, out=filled)
        if filled is not part:
            part[:] = filled

    count = threads or (usable_cores() if len(pieces) >= WORTH_THREADS else 1)
    _share(work, pieces, count)
    # back to the order of the grid's axes, the results of the formula first
    shape = (*outer_shape, *(() if last_theta else (columns,)))
    return np.moveaxis(
        np.moveaxis(result, 1, 0).reshape(result.shape[1], *shape),
        1 + np.arange(len(order)),
        1 + np.array(order, dtype=int),
    )


def usable_cores() -> int:
    """Return how many cores this process may use."""
    # so does os.process_cpu_count from Python 3.13 on
    affinity: Any = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(usable_cores(), thread_name_prefix="paminsa-grid")


def _share(
    work: Callable[[tuple[slice, slice]], None], pieces: list[tuple[slice, slice]], threads: int
) -> None:
    """Do all pieces; the calling thread begins at once, others of the pool help as they come."""
    pending = iter(pieces)

    def drain() -> None:
        for piece in pending:
            work(piece)

    helpers = [_pool().submit(drain) for _ in range(threads - 1)]
    drain()
    for helper in helpers:
        if not helper.cancel():
            helper.result()


def _parts(axes: list[tuple[str, Array]], base: Array) -> Array:
    """Return the parts of poses that some axes decide, in their order, (n, 4); (1, 4) for none."""
    shape = tuple(values.size for _, values in axes)
    parts = np.tile(base, (*shape, 1))
    for i, (name, values) in enumerate(axes):
        parts[..., COORDINATES.index(name)] = values.reshape(-1, *[1] * (len(axes) - i - 1))
    return parts.reshape(-1, 4)
