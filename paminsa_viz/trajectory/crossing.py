"""Where a path crosses type-2 singularities, and what a motion has to satisfy there.

At a type-2 singular pose the actuators cannot make a wrench that does work on the escape twist t_s
(`model.escape_twist`). So the torques are bounded there only if the platform's motion asks for none
(Briot and Arakelian, IJRR 27 (2008) 967-983): t_s^T F = 0 with F = M x'' + h + g - w. On a path
x(s) run with s(t) that is

    a s'' + b s'^2 + c = 0,   a = t_s^T M dx,   b = t_s^T (M ddx + h(x, dx)),   c = t_s^T (g - w).

With z = s'^2, s'' = dz/2, it is linear in z and its derivative by s, and so is the torque in the
limit. Friction at the actuators does no work on t_s and is left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arguments import of_design, of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.dynamics import platform_wrench
from paminsa_viz.model.jacobians import inverse_jacobian, inverse_jacobian_rate
from paminsa_viz.model.resizing import radius_ratio
from paminsa_viz.model.singularity import escape_twist
from paminsa_viz.trajectory.paths import Path
from paminsa_viz.trajectory.sampled import Locus

NODES = 4001
"""Points of a path at which its distance to the loci is looked at first."""

ON_LOCUS = 1e-9
"""Distance below which a pose counts as on a locus, at Appendix 4's R_b [m]; a turn is the path of
the joints 5."""

SLOPE = 1e-6
"""Change of the distance along the whole path, in proportion, below which a crossing is tangent."""

TOGETHER = 1e-6
"""Share of a path below which crossings of both loci count as one."""

_NEAR = 1e-6  # step by which a distance is differentiated along a path
_STEP = 1e-4  # step by which coefficients are differentiated along a path, to the fourth order


class CrossingKind(Enum):
    """How a path meets a locus."""

    SIMPLE = "simple"
    TANGENT = "tangent"
    DOUBLE = "double"


@dataclass(frozen=True)
class Crossing:
    """A point of a path on a type-2 locus.

    Attributes:
        s: Where, 0 at the path's start and 1 at its end.
        locus: Which locus.
        kind: Whether the path passes through it, touches it, or meets both loci at once.
        pose: The pose there (4,) [m, m, rad, m].
    """

    s: float
    locus: Locus
    kind: CrossingKind
    pose: tuple[float, ...]


@dataclass(frozen=True)
class CrossingCondition:
    """a s'' + b s'^2 + c = 0, with what it follows from.

    Attributes:
        a: Factor of s'' [kg m^2].
        b: Factor of s'^2 [kg m^2].
        c: Constant, of weights and load [N m].
        twist: t_s (4,).
        growth: (4,) torque of each actuator times (s - s*) for a residual of 1 N m [1]: a motion
            that does not satisfy the condition needs residual * growth / (s - s*).
    """

    a: float
    b: float
    c: float
    twist: tuple[float, ...]
    growth: tuple[float, ...]

    def residual(self, rate: float, growth: float) -> float:
        """Return t_s^T F for s' and s'' [1/s, 1/s^2] in N m."""
        return self.a * growth + self.b * rate**2 + self.c


class PathOnLocus(InvalidInput):
    """A path of which a part lies on a type-2 locus."""

    def __init__(self, s: float, locus: Locus) -> None:
        self.s, self.locus = s, locus
        super().__init__("path", f"from s = {s:.4g} on it runs along the {locus.label}")


class CrossingRefused(PaminsaError):
    """A path that cannot be run through its singularities.

    Attributes:
        cause: ``"tangent"``, ``"double"``, ``"rest"`` (an end is singular), ``"hold"`` (an end
            cannot be held within the limits), ``"weak"`` (a is zero), ``"reach"`` or
            ``"infeasible"``.
        s: Where on the path, NaN for none.
        to_raise: The field of `MotionLimits` that is too low; empty if no limit helps.
        factor: By what it is too low if no time law keeps the limits; infinite otherwise.
    """

    def __init__(
        self,
        cause: str,
        problem: str,
        s: float = float("nan"),
        to_raise: str = "",
        factor: float = float("inf"),
    ) -> None:
        self.cause, self.s, self.to_raise, self.factor = cause, s, to_raise, factor
        super().__init__(problem)


@of_geometry
def crossings(geometry: Geometry, path: Path) -> tuple[Crossing, ...]:
    """Return where a path meets type-2 loci, in its order.

    Raises:
        PathOnLocus: If a part of it lies on one.
    """
    from scipy.optimize import minimize_scalar  # slow to load

    s = np.linspace(0.0, 1.0, NODES)
    found: list[tuple[float, Locus, bool]] = []
    near = ON_LOCUS * radius_ratio(geometry)
    all_distances = locus_distances(geometry, path(s))
    for locus in Locus:

        def distance(at: float, column: int = locus.value) -> float:
            return float(locus_distances(geometry, path(np.array([at])))[0, column])

        d = all_distances[:, locus.value]
        on = np.abs(d) <= near
        along = np.flatnonzero(on[:-1] & on[1:])
        if along.size:
            raise PathOnLocus(float(s[along[0]]), locus)
        for i in np.flatnonzero(on):
            passes = i in (0, NODES - 1) or bool(d[i - 1] * d[i + 1] < 0)
            found.append((float(s[i]), locus, passes))
        passed = d[:-1] * d[1:] < 0
        change = np.flatnonzero(passed & ~on[:-1] & ~on[1:])
        found += [(_root(distance, s[i], s[i + 1]), locus, True) for i in change]
        size = np.abs(d)
        dips = np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:])) + 1
        for i in dips[~passed[dips - 1] & ~passed[dips] & ~on[dips]]:
            low = minimize_scalar(
                lambda at: abs(distance(at)), bounds=(s[i - 1], s[i + 1]), method="bounded",
                options={"xatol": 1e-12},
            )  # fmt: skip
            if low.fun <= near:
                found.append((float(low.x), locus, False))
    found.sort(key=lambda item: item[0])
    return tuple(_crossing(geometry, path, *item, found) for item in found)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    root: Any = brentq(function, low, high, xtol=1e-15)
    return float(root)


def _crossing(
    geometry: Geometry, path: Path, s: float, locus: Locus, crosses: bool,
    found: list[tuple[float, Locus, bool]],
) -> Crossing:  # fmt: skip
    at = np.array([s])
    near = path(at) + [[-_NEAR], [_NEAR]] * path(at, 1)  # straight on, at the path's ends as well
    rise = np.diff(locus_distances(geometry, near)[:, locus.value])[0] / (2.0 * _NEAR)
    kind = CrossingKind.SIMPLE
    if not crosses or abs(rise) < SLOPE * geometry.base_radius:
        kind = CrossingKind.TANGENT
    if any(other is not locus and abs(at - s) < TOGETHER for at, other, _ in found):
        kind = CrossingKind.DOUBLE
    return Crossing(s, locus, kind, tuple(path(np.array([s]))[0].tolist()))


def locus_distances(geometry: Geometry, pose: Array) -> Array:
    """Return smooth signed distances of poses (n, 4) to both loci, (n, 2) [m].

    By the values of `Locus`: r_s - |(x, y)| to first order, and R_pl times the turn; the
    second is far where R_pl > R_b.
    """
    rb, rp = geometry.base_radius, geometry.platform_radius
    x, y, theta, _ = pose.T
    cos = np.cos(theta)
    radius = np.hypot(rb - rp * cos, rp * np.sin(theta))
    least = ON_LOCUS * radius_ratio(geometry)
    circle = (radius**2 - x**2 - y**2) / (2 * np.maximum(radius, least))
    if rp >= rb:
        return np.stack([circle, np.full_like(circle, rb + rp)], axis=1)
    turn = rp * (rb * cos - rp) / np.sqrt(rb**2 - rp**2)
    return np.stack([circle, turn], axis=1)


def path_coefficients(design: Design, path: Path, s: Array) -> tuple[Array, Array, Array]:
    """Return A, B and C of F = A s'' + B s'^2 + C along a path, each (n, 4) [N, N, N m, N]."""
    pose, along, bend = (path(s, order) for order in range(3))
    still = np.zeros_like(pose)
    by_growth, by_rate, constant = platform_wrench(
        design, [pose] * 3, [still, along, still], [along, bend, still]
    )
    return by_growth - constant, by_rate - constant, constant


@of_design
def crossing_condition(design: Design, path: Path, s: float) -> CrossingCondition:
    """Return the condition that a motion on a path has to satisfy where it crosses a locus.

    Args:
        design: The robot.
        path: The path.
        s: Where it crosses, see `crossings`.

    Raises:
        InvalidInput: If the path is not on a type-2 locus there.
    """
    at = np.array([float(s)])
    twist = escape_twist(design.geometry, path(at))[0]
    if not np.isfinite(twist).all():
        raise InvalidInput("s", f"the path is not at a type-2 singularity at s = {s:.6g}")
    a, b, c = (float(twist @ part[0]) for part in path_coefficients(design, path, at))
    growth = torque_growth(twist, *_jacobians(design.geometry, path, at))
    return CrossingCondition(a, b, c, tuple(twist.tolist()), tuple(growth.tolist()))


def torque_growth(twist: Array, g: Array, rate: Array) -> Array:
    """Return the torques times the distance from a crossing that a residual of 1 N m needs, (4,).

    Args:
        twist: t_s (4,).
        g, rate: (4, 4) G there and its derivative by what the distance is measured in.
    """
    null = np.linalg.svd(g.T)[2][-1]  # G^T n = 0
    return null / (twist @ rate.T @ null)


def limit_torques(twist: Array, g: Array, rate: Array, force: Array, force_rate: Array) -> Array:
    """Return the solution of [G^T; t_s^T dG^T] tau = [F; t_s^T dF], for each column of F and dF."""
    left = np.vstack([g.T, twist @ rate.T])
    right = np.concatenate([force, [twist @ force_rate]])
    return np.asarray(np.linalg.lstsq(left, right, rcond=None)[0], dtype=np.float64)


def limit_torque_rows(design: Design, path: Path, s: float) -> Array:
    """Return how the torques in the limit at a crossing follow from the motion, (4, 4).

    They solve [G^T; t_s^T dG^T] tau = [F; t_s^T dF], d by s, which has rank 4 and is consistent
    where the condition is satisfied. Columns: factors of z = s'^2, dz, ddz, and the constant.
    """
    at = np.array([float(s)])
    twist = escape_twist(design.geometry, path(at))[0]
    g, rate = _jacobians(design.geometry, path, at)
    a, b, c = (part[0] for part in path_coefficients(design, path, at))
    around = at + _STEP * np.array([-2.0, -1.0, 1.0, 2.0])
    weights = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * _STEP)
    da, db, dc = (weights @ part for part in path_coefficients(design, path, around))
    force = np.stack([b, 0.5 * a, np.zeros(4), c], axis=1)  # F by z, dz, ddz, 1
    force_rate = np.stack([db, b + 0.5 * da, 0.5 * a, dc], axis=1)
    return limit_torques(twist, g, rate, force, force_rate)


def _jacobians(geometry: Geometry, path: Path, at: Array) -> tuple[Array, Array]:
    """Return G and its derivative by s at one point of a path, (4, 4) each."""
    pose, along = path(at), path(at, 1)
    return inverse_jacobian(geometry, pose)[0], inverse_jacobian_rate(geometry, pose, along)[0]
