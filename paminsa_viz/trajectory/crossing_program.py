"""The linear program of a motion through singularities.

The unknowns are the coefficients of z(s) = s'^2, a cubic spline that is zero at both ends. The
condition of `crossing` is an equation, and the limits are inequalities at points along the path.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.trajectory.crossing import (
    Crossing,
    CrossingCondition,
    CrossingRefused,
    crossing_condition,
    limit_torque_rows,
    path_coefficients,
)
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import Path
from paminsa_viz.trajectory.planners import PLACE
from paminsa_viz.units import rounded_to_side

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

INTERVALS = 80
"""Pieces of the spline, where it is not refined."""

REFINEMENTS = (3, 6, 0)
"""How often the pieces next to crossings are halved, until a law is found that does not stop.

Pieces that are not halved cost up to 13 % of the duration where a crossing is near an end."""

STEEP = 0.1
"""Cosine between path and escape twist (by M) below which there are `STEEP_INTERVALS`.

s'^2 changes fast next to such a crossing, and coarse pieces cost up to a third of the duration."""

STEEP_INTERVALS, STEEP_REFINEMENTS = 160, (6, 3, 0)
"""The same as `INTERVALS` and `REFINEMENTS` where a crossing is steep."""

POINTS = 4
"""Points in each of them where limits are kept."""

FINE = 20
"""How many times finer the points are at which the limits are looked at afterwards."""

TOLERANCE = 2e-3
"""Share by which torques may exceed their limits there."""

_NEAR = 2e-5  # around a crossing the torque's limit stands for the limits of torques [1]

_SCALE = 0.02  # share of the largest determinant below which rows are multiplied by it

_WEAK = 1e-9
"""Least cosine between path and escape twist (by M) with which a time law can do something [1]."""


class Rows(NamedTuple):
    """Inequalities factors c + constant <= limit for the coefficients c of z.

    Attributes:
        factors: (n, coefficients).
        constant, limit: (n,).
        of_torque: (n,) whether it is a limit of a torque or force.
    """

    factors: Array
    constant: Array
    limit: Array
    of_torque: NDArray[np.bool_]


def _stacked(parts: list[Rows]) -> Rows:
    return Rows(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _both_sides(factors: Array, constant: Array, limit: Array) -> Rows:
    """Return the rows that keep a torque above and below its limits."""
    rows = Rows(factors, constant, limit, np.ones(len(limit), dtype=bool))
    return _stacked([rows, rows._replace(factors=-factors, constant=-constant)])


class CrossingProgram:
    """The constraints on the coefficients of z, (rows) c + constant <= limit, and their optima."""

    def __init__(
        self,
        design: Design,
        path: Path,
        found: tuple[Crossing, ...],
        limits: MotionLimits,
        refinement: int,
        intervals: int,
    ) -> None:
        self._design, self._path, self._found, self._limits = design, path, found, limits
        self._pieces = _pieces(found, refinement, intervals)
        self._knots = np.concatenate([[0.0] * 3, self._pieces, [1.0] * 3])
        self.conditions = [crossing_condition(design, path, item.s) for item in found]
        self.limit_torques = [limit_torque_rows(design, path, item.s) for item in found]
        for item, condition in zip(found, self.conditions, strict=True):
            _require_influence(design, path, item, condition)
        self._equal, self._right = self._condition_rows()
        points = self._points(POINTS)
        self._regular = _SCALE * self._determinant(points).max()
        self._rows = _stacked(
            [self._torque_rows(points), *self._speed_rows(points), *map(self._crossing_rows, found)]
        )

    def spline(self, inner: Array) -> BSpline:
        """Return z from its coefficients but the first and the last, which are zero."""
        from scipy.interpolate import BSpline

        return BSpline(self._knots, np.concatenate([[0.0], inner, [0.0]]), 3)

    def _basis(self, s: Array, order: int = 0) -> Array:
        """Return z or a derivative by s at points (n,) as rows on the coefficients."""
        from scipy.interpolate import BSpline

        return BSpline(self._knots, np.eye(len(self._knots) - 4), 3)(s, order)[:, 1:-1]

    def _at(self, s: float) -> Array:
        """Return z, dz and ddz at a point as rows (3, coefficients)."""
        return np.concatenate([self._basis(np.array([s]), order) for order in range(3)])

    def _condition_rows(self) -> tuple[Array, Array]:
        rows = [
            condition.b * (at := self._at(item.s))[0] + 0.5 * condition.a * at[1]
            for item, condition in zip(self._found, self.conditions, strict=True)
        ]
        right = [-condition.c for condition in self.conditions]
        return np.reshape(rows, (-1, len(self._pieces))), np.array(right)

    def _points(self, count: int) -> Array:
        """Return points along the path, so many in each piece and both ends, off the crossings."""
        share = (np.arange(count) + 0.5) / count
        inner = self._pieces[:-1, None] + np.diff(self._pieces)[:, None] * share
        s = np.concatenate([[0.0], inner.ravel(), [1.0]])
        for item in self._found:
            s = s[np.abs(s - item.s) > _NEAR]
        return s

    def _determinant(self, s: Array) -> Array:
        g = inverse_jacobian(self._design.geometry, self._path(s))
        return np.abs(np.linalg.det(g[:, :3, :3]))

    def _torque_parts(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """Return factors of s'' and z, and constants, of torques over their limits, (n, 4) each.

        They are multiplied by the last result (n, 4), which is small near singularities.
        """
        g = inverse_jacobian(self._design.geometry, self._path(s))
        weight = np.minimum(1.0, self._determinant(s) / self._regular)[:, None]
        solve = np.linalg.inv(np.swapaxes(g, 1, 2)) * weight[..., None]
        solve /= self._limits.actuators[:, None]
        a, b, c = (
            np.einsum("nij,nj->ni", solve, part)
            for part in path_coefficients(self._design, self._path, s)
        )
        return a, b, c, np.broadcast_to(weight, a.shape)

    def _torque_rows(self, s: Array) -> Rows:
        a, b, c, weight = self._torque_parts(s)
        z, dz = self._basis(s), self._basis(s, 1)
        rows = b[..., None] * z[:, None] + 0.5 * a[..., None] * dz[:, None]
        limited = np.isfinite(self._limits.actuators)
        rows = rows[:, limited].reshape(-1, z.shape[1])
        constant, most = c[:, limited].ravel(), weight[:, limited].ravel()
        return _both_sides(rows, constant, most)

    def _crossing_rows(self, item: Crossing) -> Rows:
        """Return the limits of the torques in the limit at a crossing."""
        limited = np.isfinite(self._limits.actuators)
        torque = self.limit_torques[self._found.index(item)]
        scaled = (torque / self._limits.actuators[:, None])[limited]
        return _both_sides(scaled[:, :3] @ self._at(item.s), scaled[:, 3], np.ones(len(scaled)))

    def _speed_rows(self, s: Array) -> Iterator[Rows]:
        along, z = self._path(s, 1), self._basis(s)
        for size, limit in zip(
            (np.linalg.norm(along[:, PLACE], axis=1), along[:, 2]),
            self._limits.rates[0],
            strict=True,
        ):
            if np.isfinite(limit):
                rows = (size[:, None] / limit) ** 2 * z
                none = np.zeros(len(s))
                yield Rows(rows, none, none + 1.0, np.zeros(len(s), dtype=bool))

    def tighten(self, *laws: Array) -> bool:
        """Add limits where laws exceed those of torques by `TOLERANCE`; whether there are any."""
        s = self._points(FINE * POINTS)
        a, b, c, weight = self._fine
        excess = np.zeros(len(s))
        for law in laws:
            z = self.spline(law)
            torque = b * z(s)[:, None] + 0.5 * a * z(s, 1)[:, None] + c
            excess = np.maximum(excess, (np.abs(torque) / weight).max(axis=1) - 1.0)
        padded = np.concatenate([[0.0], excess, [0.0]])
        peak = (excess > TOLERANCE) & (excess >= padded[:-2]) & (excess >= padded[2:])
        if not peak.any():
            return False
        self._rows = _stacked([self._rows, self._torque_rows(s[peak])])
        return True

    @cached_property
    def _fine(self) -> tuple[Array, Array, Array, Array]:
        return self._torque_parts(self._points(FINE * POINTS))

    def fastest(self) -> Array:
        """Return the coefficients of the shortest motion: the largest z wherever it can be.

        Raises:
            CrossingRefused: If no time law keeps the limits.
        """
        return self._optimum(-np.ones(len(self._pieces)))

    def slowest(self) -> Array:
        """Return the coefficients of the slowest motion that satisfies the conditions."""
        return self._optimum(np.ones(len(self._pieces)))

    def speed_range(self, index: int) -> tuple[float, float]:
        """Return the smallest and largest s' that the limits allow at a crossing [1/s]."""
        row = self._at(self._found[index].s)[0]
        low, high = (row @ self._optimum(cost) for cost in (row, -row))
        return float(np.sqrt(low)), float(np.sqrt(high))

    def _optimum(self, cost: Array) -> Array:
        from scipy.optimize import linprog

        result = linprog(
            cost, self._rows.factors, self._rows.limit - self._rows.constant,
            self._equal if len(self._equal) else None, self._right if len(self._right) else None,
            bounds=(0.0, None), method="highs",
        )  # fmt: skip
        if result.x is None:
            self._refuse()
        return np.maximum(result.x, 0.0)  # which the solver keeps to its tolerance

    def _refuse(self) -> NoReturn:
        """Raise with the least factor of the limits that would be enough."""
        factors, constant, limit, of_torque = self._rows
        torque = self._least_factor(self._rows, of_torque)
        rates = ~of_torque
        speeds = Rows(factors[rates], constant[rates], limit[rates], of_torque[rates])
        problem = "no time law satisfies the conditions at the crossings, whatever the torques"
        to_raise, factor = "", math.inf
        if torque is not None:
            factor = torque
            problem = (
                "no time law keeps the limits; torque and force limits would have to be at least "
                f"{rounded_to_side(factor, 4, up=True):.4g} times as large"
            )
            to_raise = "force" if self._limits.torque is None else "torque"
        elif len(speeds.limit):
            squared = self._least_factor(speeds, ~speeds.of_torque)
            if squared is not None:
                factor = math.sqrt(squared)
                problem = (
                    "no time law satisfies the conditions at the crossings within the speed "
                    "limits, whatever the torques; speed limits would have to be at least "
                    f"{rounded_to_side(factor, 4, up=True):.4g} times as large"
                )
                to_raise = "turn_speed" if self._limits.speed is None else "speed"
        raise CrossingRefused("infeasible", problem, to_raise=to_raise, factor=factor)

    def _least_factor(self, kept: Rows, scaled: NDArray[np.bool_]) -> float | None:
        """Return by what limits have to be multiplied, the others being kept; None if no number."""
        from scipy.optimize import linprog

        factors, constant, limit, _ = kept
        rows = np.hstack([factors, -np.where(scaled, limit, 0.0)[:, None]])
        fixed = np.where(scaled, 0.0, limit) - constant
        equal = np.hstack([self._equal, np.zeros((len(self._equal), 1))])
        result = linprog(
            np.eye(factors.shape[1] + 1)[-1], rows, fixed, equal if len(equal) else None,
            self._right if len(equal) else None, bounds=(0.0, None), method="highs",
        )  # fmt: skip
        return None if result.x is None else float(result.x[-1])


def _pieces(found: tuple[Crossing, ...], refinement: int, intervals: int) -> Array:
    """Return the ends of the spline's pieces, from 0 to 1, halved so often next to crossings."""
    ends = np.linspace(0.0, 1.0, intervals + 1)
    halves = 0.5 ** np.arange(1, refinement + 1) / intervals
    for item in found:
        room = min(1.0, intervals * item.s, intervals * (1.0 - item.s))
        ends = np.concatenate([ends, item.s - room * halves, item.s + room * halves])
    ends = np.unique(ends)
    least = 0.1 * 0.5**refinement / intervals
    kept = np.concatenate([[True], np.diff(ends) > least])
    kept[-1] = True
    return ends[kept]


def influence(
    design: Design, path: Path, crossing: Crossing, condition: CrossingCondition
) -> float:
    """Return the cosine between path and escape twist by M: what a time law can do, 0 to 1."""
    at = np.array([crossing.s])
    matrix, along = mass_matrix(design, path(at))[0], path(at, 1)[0]
    twist = np.array(condition.twist)
    size = np.sqrt((twist @ matrix @ twist) * (along @ matrix @ along))
    return float(abs(condition.a) / size)


def _require_influence(
    design: Design, path: Path, crossing: Crossing, condition: CrossingCondition
) -> None:
    if influence(design, path, crossing, condition) <= _WEAK:
        raise CrossingRefused(
            "weak",
            f"at s = {crossing.s:.6g} the time law has no influence on the condition (a = 0): the "
            "path is at right angles to the escape twist there; change it",
            crossing.s,
        )
