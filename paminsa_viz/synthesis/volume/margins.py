"""Margins of requirements, the least over headings, at columns of positions and heights."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.grids import Field, Grid
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import LEAST_MARGIN, Limit, decode
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.quantities.requirements import Range, Requirement, Requirements


@dataclass(frozen=True)
class Columns(Grid):
    """Poses at positions that need not form a grid, with every heading and every height.

    The shape is (positions, headings, heights).

    Attributes:
        positions: (n, 2) x and y [m].
        lift: (n,) what is added to the heights at each position [m]; None for nothing.
    """

    positions: Array
    lift: Array | None

    @classmethod
    def at(cls, positions: Array, theta: Array, z: Array, lift: Array | None = None) -> Columns:
        """Return the poses at positions (n, 2) [m] with headings [rad] and heights [m]."""
        axes = (("x", positions[:, 0]), ("theta", theta), ("z", z))
        return cls(axes, np.zeros(4), positions, lift)

    def poses(self) -> Array:
        """Return every pose, (positions, headings, heights, 4) [m, m, rad, m]."""
        pose = np.empty((*self.shape, 4))
        pose[..., :2] = self.positions[:, None, None]
        pose[..., 2] = self.axes[1][1][:, None]
        pose[..., 3] = self.axes[2][1]
        if self.lift is not None:
            pose[..., 3] += self.lift[:, None, None]
        return pose


@dataclass(frozen=True, eq=False)
class ColumnField(Field):
    """What the geometry says about the poses of `Columns`; formulas are solved on demand."""

    grid: Columns

    def solve(self, formula: Formula) -> Array:
        """Return the results of a formula, (results, positions, headings, heights)."""
        found = self._solved.get(formula)
        if found is None:
            found = self._solved[formula] = _evaluate(formula, self.geometry, self.grid)
        return found


def solve_columns(geometry: Geometry, columns: Columns, *, status: bool = True) -> ColumnField:
    """Return a field of columns.

    Args:
        geometry: Lengths of the mechanism.
        columns: The poses.
        status: Whether to work out which poses can be taken. Without it all count as if they can;
            where no one reads what comes out of the others.
    """
    if not status:
        ok = np.full(columns.shape, Limit.OK, np.uint8)
        return ColumnField(columns, geometry, ok, np.full(columns.shape, -1, np.int8), 1, {})
    margin = _evaluate(LEAST_MARGIN, geometry, columns)
    found, leg = decode(*margin)
    return ColumnField(columns, geometry, found, leg, 1, {LEAST_MARGIN: margin})


def _evaluate(formula: Formula, geometry: Geometry, columns: Columns) -> Array:
    count, headings, heights = columns.shape
    if columns.lift is not None:
        found = backend.over_list(formula, mechanism(geometry), columns.poses().reshape(-1, 4))
        return found.T.reshape(formula.results, *columns.shape)
    outer = np.zeros((count, headings, 4))
    outer[..., :2] = columns.positions[:, None]
    outer[..., 2] = columns.axes[1][1]
    inner = np.zeros((heights, 4))
    inner[:, 3] = columns.axes[2][1]
    out = np.empty((count * headings, formula.results, heights))
    outer = outer.reshape(-1, 4)
    backend.over_grid(formula, mechanism(geometry), outer, inner)(slice(None), slice(None), out)
    return np.moveaxis(out, 1, 0).reshape(formula.results, *columns.shape)


BLOCK = 2**15
"""Poses worked on at a time, so that what a formula returns stays in the cache."""

CHEAP = 1e-6
"""Cost of a quantity [s a pose] up to which poses that cannot be taken are evaluated as well: most
of them are NaN there, and no one reads the others. What costs more skips such poses."""

_LONG_BARS = 100.0
"""Length of bars that reach wherever others do [m]; no longer ones are possible."""


def headings(limits: Range, count: int) -> Array:
    """Return headings over a range, its ends among them; one for a range of one [rad]."""
    return np.linspace(*limits, count) if limits[1] > limits[0] else np.array([limits[0]])


def time_per_position(
    design: Design, requirements: Requirements, count: int, heights: int
) -> float:
    """Return the time for the quantities of requirements at a position [s], compiled or not."""
    total = 0.0
    for (limits, flat), bounds in _groups(requirements, _without_reach(design)).items():
        cost = sum({bound.entry.formula: bound.entry.cost for _, bound in bounds}.values())
        total += cost * len(headings(limits, count)) * (1 if flat else heights)
    return total


def heading_margins(
    design: Design,
    requirements: Requirements,
    positions: Array,
    z: Array,
    count: int,
    progress: Progress = go_on,
    lift: Array | None = None,
) -> tuple[Array, Array]:
    """Evaluate every requirement at positions and heights.

    What does not depend on z is evaluated once a position.

    Args:
        design: The robot.
        requirements: What has to hold.
        positions: (n, 2) [m].
        z: (heights,) [m].
        count: Headings over a range; an odd number.
        progress: Is told what part is done, and may end it.
        lift: (n,) what is added to the heights at each position [m]; None for nothing.

    Returns:
        The least margins over the headings (requirements, positions, heights) [SI]: minus infinite
        where there is no value, plus infinite at heights over which a requirement does not hold;
        and the same over every second heading.

    Raises:
        Canceled: If ``progress`` says so.
    """
    shape = (len(requirements.bounds), len(positions), len(z))
    least, coarse = np.full(shape, np.inf), np.full(shape, np.inf)
    # A mechanism with long bars reaches every height, and has the same Jacobian.
    reaching = _without_reach(design)
    groups = _groups(requirements, reaching)
    work = {key: len(headings(key[0], count)) * (1 if key[1] else len(z)) for key in groups}
    done, total = 0, len(positions) * sum(work.values())
    for (limits, flat), bounds in groups.items():
        theta = headings(limits, count)
        heights = np.array([-design.geometry.platform_joint_height]) if flat else z
        cheap = all(bound.entry.cost <= CHEAP for _, bound in bounds)
        robot = reaching if flat and reaching is not None else design
        step = max(1, BLOCK // (theta.size * heights.size))
        for start in range(0, len(positions), step):
            part = slice(start, start + step)
            lifted = lift[part] if lift is not None and not flat else None
            columns = Columns.at(positions[part], theta, heights, lifted)
            field = solve_columns(robot.geometry, columns, status=not cheap)
            found: dict[str, Array] = {}
            for index, bound in bounds:
                if bound.quantity not in found:
                    with np.errstate(all="ignore"):
                        found[bound.quantity] = bound.entry.over(field, robot)
                margin = bound.margin(found[bound.quantity])
                every, second = margin.min(axis=1), margin[:, ::2].min(axis=1)
                least[index, part] = np.where(np.isnan(every), -np.inf, every)
                coarse[index, part] = np.where(np.isnan(second), -np.inf, second)
            done += columns.size
            keep_on(progress, done / total)
    for index, bound in enumerate(requirements.bounds):
        if bound.z is not None:
            level = z if lift is None else z + lift[:, None]
            free = np.broadcast_to((level < bound.z[0]) | (level > bound.z[1]), shape[1:])
            least[index][free] = coarse[index][free] = np.inf
    return least, coarse


def _groups(
    requirements: Requirements, reaching: Design | None
) -> dict[tuple[Range, bool], list[tuple[int, Requirement]]]:
    """Return requirements with their indices, by headings and by whether z has no influence."""
    found: dict[tuple[Range, bool], list[tuple[int, Requirement]]] = {}
    for index, bound in enumerate(requirements.bounds):
        key = (requirements.headings(bound), bound.entry.flat and reaching is not None)
        found.setdefault(key, []).append((index, bound))
    return found


def _without_reach(design: Design) -> Design | None:
    """Return the robot with bars that reach every position, None where there are none so long."""
    g = design.geometry
    if g.span_ratio * (g.base_radius + g.platform_radius) > 0.1 * _LONG_BARS:
        return None
    long = dict.fromkeys(("crank_length", "coupler_length", "guide_stroke"), _LONG_BARS)
    return replace(design, geometry=replace(g, **long))
