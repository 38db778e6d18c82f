"""Motions that cross type-2 singularities with bounded torques, in the shortest or a given time.

The path is given, its time law is found: z(s) = s'^2 is a cubic spline, so that the jerk is
continuous along the way and the torques are at the crossings. The condition of `crossing`, the
limits of torques (with rows multiplied by the determinant, nothing is divided by zero), the torque
in the limit and speeds are all linear in z. The shortest motion is the one with the largest z
wherever it can be (Bobrow, Dubowsky and Gibson 1985), so it is the optimum of one linear program;
where there is none, another one tells by what factor the torque limits are too low.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.reach import Limit, reach_status
from paminsa_viz.model.statics import static_torques
from paminsa_viz.trajectory.crossing import (
    Crossing,
    CrossingCondition,
    CrossingKind,
    crossing_condition,
    crossings,
    limit_torque_rows,
    path_coefficients,
)
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import Path, TimedPath
from paminsa_viz.trajectory.plan import Plan
from paminsa_viz.trajectory.planners import PLACE
from paminsa_viz.trajectory.sampled import Passage

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

INTERVALS = 80
"""Pieces of the spline."""

POINTS = 4
"""Points in each of them where limits are kept."""

_NEAR = 1e-4
"""Around a crossing the torque's limit stands for the limits of torques [1]."""

_SCALE = 0.02
"""Share of the largest determinant below which rows are multiplied by it."""

_WEAK = 1e-9
"""Least cosine between path and escape twist (by M) with which a time law can do something [1]."""


class CrossingRefused(PaminsaError):
    """A path that cannot be run through its singularities.

    Attributes:
        cause: ``"tangent"``, ``"double"``, ``"rest"`` (an end is singular), ``"hold"`` (an end
            cannot be held within the limits), ``"weak"`` (a is zero), ``"reach"`` or
            ``"infeasible"``.
        s: Where on the path, NaN for none.
    """

    def __init__(self, cause: str, problem: str, s: float = float("nan")) -> None:
        self.cause, self.s = cause, s
        super().__init__(problem)


@dataclass(frozen=True)
class PlannedCrossing:
    """A crossing that a motion makes.

    Attributes:
        crossing: Where.
        condition: What has to be satisfied there.
        t: When [s].
        residual: t_s^T F, zero but for rounding [N m].
        torque: (4,) torques in the limit [N m, N].
        speed: s' there [1/s].
        speed_range: Smallest and largest s' that the limits allow there [1/s].
    """

    crossing: Crossing
    condition: CrossingCondition
    t: float
    residual: float
    torque: tuple[float, ...]
    speed: float
    speed_range: tuple[float, float]

    @property
    def explanation(self) -> str:
        """Text of the crossing."""
        torques = ", ".join(f"{torque:.4g}" for torque in self.torque[:3])
        return (
            f"crosses the {self.crossing.locus.label} at {self.t:.4g} s, where M1 to M3 make "
            f"{torques} N m and M4 {self.torque[3]:.4g} N; actuators have no authority there along "
            "the escape twist"
        )


@dataclass(frozen=True, eq=False)
class CrossingPlan:
    """A motion through singularities.

    Attributes:
        plan: The motion.
        crossings: What it crosses, in its order.
        durations: Shortest and longest duration that the planner can give it [s].
    """

    plan: Plan
    crossings: tuple[PlannedCrossing, ...]
    durations: tuple[float, float]


def plan_crossing(
    design: Design,
    path: Path,
    limits: MotionLimits,
    duration: float | None = None,
    *,
    name: str = "crossing",
) -> CrossingPlan:
    """Return the shortest motion on a path, from rest to rest, or one of a given duration.

    Args:
        design: The robot; its friction at the actuators is not counted in the limits.
        path: The path; it may cross no singularity at all.
        limits: Of torque, force, speed and turn_speed; others are not supported here.
        duration: [s]; the shortest by default.
        name: What a person calls it.

    Raises:
        InvalidInput: If a limit is not supported, torques are not limited, or the duration is out
            of the range that the limits allow.
        CrossingRefused: If the path cannot be run, with the cause.
    """
    if not limits.needs_torques or np.isfinite(limits.rates[1:]).any():
        raise InvalidInput(
            "limits", "torque or force, and at most speed and turn_speed, are needed"
        )
    found = crossings(design.geometry, path)
    _check_path(design, path, found, limits)
    program = _Program(design, path, found, limits)
    fast = program.fastest()
    slow = program.slowest()

    def blend(share: float) -> TimedPath:
        return TimedPath(path, program.spline(share * fast + (1.0 - share) * slow))

    longest = blend(1e-3).duration
    curve = blend(1.0)
    shortest = curve.duration
    if duration is not None:
        if not shortest <= duration <= longest:
            raise InvalidInput(
                "duration", f"{shortest:.4g} s to {longest:.4g} s are possible, not {duration:g} s"
            )
        from scipy.optimize import brentq

        share: Any = brentq(lambda at: np.log(blend(at).duration / duration), 1e-3, 1.0, xtol=1e-12)
        curve = blend(share)
    planned = tuple(program.planned(curve, index) for index in range(len(found)))
    passages = tuple(Passage(p.t / curve.duration, p.crossing.locus) for p in planned)
    kind = "through singularities" if passages else "minimum time"
    notes = tuple(item.explanation for item in planned)
    plan = Plan(curve, curve.duration, name, kind, notes, passages)
    return CrossingPlan(plan, planned, (shortest, longest))


def _check_path(
    design: Design, path: Path, found: tuple[Crossing, ...], limits: MotionLimits
) -> None:
    s = np.linspace(0.0, 1.0, 801)
    pose = path(s)
    for crossing in found:
        where = f"at s = {crossing.s:.6g}"
        if min(crossing.s, 1.0 - crossing.s) < 1e-6:
            problem = (
                f"the path begins or ends on the {crossing.locus.label}; no torque holds it there"
            )
            raise CrossingRefused("rest", problem, crossing.s)
        if crossing.kind is CrossingKind.DOUBLE:
            problem = f"{where} the path meets both loci at once; lead it past one of them"
            raise CrossingRefused("double", problem, crossing.s)
        if crossing.kind is CrossingKind.TANGENT:
            problem = f"{where} the path touches the {crossing.locus.label} without passing it"
            raise CrossingRefused("tangent", problem, crossing.s)
    status, _ = reach_status(design.geometry, pose)
    lost = np.flatnonzero((status != Limit.OK) & (status != Limit.SINGULAR))
    if lost.size:
        text = Limit(int(status[lost[0]])).explanation
        raise CrossingRefused("reach", f"at s = {s[lost[0]]:.4g}: {text}", float(s[lost[0]]))
    for end, at in (("start", 0), ("goal", -1)):
        torque = static_torques(design.without_friction(), pose[at])
        over = np.abs(torque) - limits.actuators
        if not (over <= 0).all():
            worst = int(np.nanargmax(np.where(np.isnan(over), -np.inf, over)))
            problem = (
                f"the {end} cannot be held: M{worst + 1} needs {abs(torque[worst]):.4g} of "
                f"{limits.actuators[worst]:.4g} {'N' if worst == 3 else 'N m'}"
            )
            raise CrossingRefused("hold", problem, float(s[at]))


class _Program:
    """The constraints on the coefficients of z, (rows) c + constant <= limit, and their optima."""

    def __init__(
        self, design: Design, path: Path, found: tuple[Crossing, ...], limits: MotionLimits
    ) -> None:
        self._design, self._path, self._found = design, path, found
        self._knots = np.concatenate([[0.0] * 3, np.linspace(0.0, 1.0, INTERVALS + 1), [1.0] * 3])
        self._conditions = [crossing_condition(design, path, item.s) for item in found]
        self._limit_torques = [limit_torque_rows(design, path, item.s) for item in found]
        for item, condition in zip(found, self._conditions, strict=True):
            _require_influence(design, path, item, condition)
        self._equal, self._right = self._condition_rows()
        self._rows, self._constant, self._limit, self._scaled = self._limit_rows(limits)

    def spline(self, inner: Array) -> BSpline:
        """Return z from its coefficients but the first and the last, which are zero."""
        from scipy.interpolate import BSpline

        return BSpline(self._knots, np.concatenate([[0.0], np.maximum(inner, 0.0), [0.0]]), 3)

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
            for item, condition in zip(self._found, self._conditions, strict=True)
        ]
        right = [-condition.c for condition in self._conditions]
        return np.reshape(rows, (-1, INTERVALS + 1)), np.array(right)

    def _limit_rows(self, limits: MotionLimits) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
        """Return rows, constants and limits, and which of these are torques."""
        share = (np.arange(POINTS) + 0.5) / POINTS
        s = np.concatenate(
            [[0.0], ((np.arange(INTERVALS)[:, None] + share) / INTERVALS).ravel(), [1.0]]
        )
        for item in self._found:
            s = s[np.abs(s - item.s) > _NEAR]
        geometry, pose = self._design.geometry, self._path(s)
        g = inverse_jacobian(geometry, pose)
        det = np.abs(np.linalg.det(g[:, :3, :3]))
        weight = np.minimum(1.0, det / (_SCALE * det.max()))[:, None, None]
        solve = np.linalg.inv(np.swapaxes(g, 1, 2)) * weight / limits.actuators[:, None]
        a, b, c = (
            np.einsum("nij,nj->ni", solve, part)
            for part in path_coefficients(self._design, self._path, s)
        )
        z, dz = self._basis(s), self._basis(s, 1)
        torque = (b[..., None] * z[:, None] + 0.5 * a[..., None] * dz[:, None]).reshape(
            -1, z.shape[1]
        )
        constant, most = c.ravel(), np.repeat(weight.ravel(), 4)
        for item, found in zip(self._found, self._limit_torques, strict=True):
            scaled = found / limits.actuators[:, None]
            torque = np.concatenate([torque, scaled[:, :3] @ self._at(item.s)])
            constant = np.concatenate([constant, scaled[:, 3]])
            most = np.concatenate([most, np.ones(4)])
        limited = np.tile(np.isfinite(limits.actuators), len(most) // 4)
        torque, constant, most = torque[limited], constant[limited], most[limited]
        along = self._path(s, 1)
        sizes = np.stack([np.linalg.norm(along[:, PLACE], axis=1), np.abs(along[:, 2])], axis=1)
        speeds = [
            (size[:, None] / limit) ** 2 * z
            for size, limit in zip(sizes.T, limits.rates[0], strict=True)
            if np.isfinite(limit)
        ]
        fast = np.concatenate([np.zeros((0, z.shape[1])), *speeds])
        rows = np.concatenate([torque, -torque, fast])
        constants = np.concatenate([constant, -constant, np.zeros(len(fast))])
        ends = np.concatenate([most, most, np.ones(len(fast))])
        return rows, constants, ends, np.arange(len(rows)) < 2 * len(torque)

    def fastest(self) -> Array:
        """Return the coefficients of the shortest motion: the largest z wherever it can be.

        Raises:
            CrossingRefused: If no time law keeps the limits.
        """
        return self._optimum(-np.ones(INTERVALS + 1))

    def slowest(self) -> Array:
        """Return the coefficients of the slowest motion that satisfies the conditions."""
        return self._optimum(np.ones(INTERVALS + 1))

    def speed_range(self, index: int) -> tuple[float, float]:
        """Return the smallest and largest s' that the limits allow at a crossing [1/s]."""
        row = self._at(self._found[index].s)[0]
        low, high = (row @ self._optimum(sign * row) for sign in (1.0, -1.0))
        return float(np.sqrt(max(low, 0.0))), float(np.sqrt(max(high, 0.0)))

    def _optimum(self, cost: Array) -> Array:
        from scipy.optimize import linprog

        result = linprog(
            cost, self._rows, self._limit - self._constant,
            self._equal if len(self._equal) else None, self._right if len(self._right) else None,
            bounds=(0.0, None), method="highs",
        )  # fmt: skip
        if result.x is None:
            self._refuse()
        return result.x

    def _refuse(self) -> NoReturn:
        """Raise with the least factor of the torque limits that would be enough."""
        from scipy.optimize import linprog

        n = self._rows.shape[1]
        factor = np.where(self._scaled, self._limit, 0.0)
        rows = np.hstack([self._rows, -factor[:, None]])
        fixed = np.where(self._scaled, 0.0, self._limit) - self._constant
        equal = np.hstack([self._equal, np.zeros((len(self._equal), 1))])
        result = linprog(
            np.eye(n + 1)[-1], rows, fixed, equal if len(equal) else None,
            self._right if len(equal) else None, bounds=(0.0, None), method="highs",
        )  # fmt: skip
        if result.x is None:
            problem = "no time law satisfies the conditions at the crossings, whatever the torques"
        else:
            problem = (
                "no time law keeps the limits; torque and force limits would have to be at least "
                f"{result.x[-1]:.4g} times as large"
            )
        raise CrossingRefused("infeasible", problem)

    def planned(self, curve: TimedPath, index: int) -> PlannedCrossing:
        """Return what a motion does at a crossing."""
        item, condition = self._found[index], self._conditions[index]
        z = np.array([float(curve.z(item.s, order)) for order in range(3)])
        torque = self._limit_torques[index] @ np.append(z, 1.0)
        speed = float(np.sqrt(z[0]))
        return PlannedCrossing(
            item, condition, curve.time_at(item.s), condition.residual(speed, 0.5 * z[1]),
            tuple(torque.tolist()), speed, self.speed_range(index),
        )  # fmt: skip


def _require_influence(
    design: Design, path: Path, crossing: Crossing, condition: CrossingCondition
) -> None:
    at = np.array([crossing.s])
    matrix, along = mass_matrix(design, path(at))[0], path(at, 1)[0]
    twist = np.array(condition.twist)
    size = np.sqrt((twist @ matrix @ twist) * (along @ matrix @ along))
    if abs(condition.a) <= _WEAK * size:
        raise CrossingRefused(
            "weak",
            f"at s = {crossing.s:.6g} the time law has no influence on the condition (a = 0): the "
            "path is at right angles to the escape twist there; change it",
            crossing.s,
        )
