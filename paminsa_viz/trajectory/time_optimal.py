"""Motions that cross type-2 singularities with bounded torques, in the shortest or a given time.

The path is given, its time law is found: z(s) = s'^2 is a cubic spline, so that the jerk is
continuous along the way and the torques are at the crossings. The condition of `crossing`, the
limits of torques (with rows multiplied by the determinant, nothing is divided by zero), the torque
in the limit and speeds are all linear in z. The shortest motion is the one with the largest z
wherever it can be (Bobrow, Dubowsky and Gibson 1985), so it is the optimum of one linear program;
where there is none, another one tells by what factor the torque limits are too low.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from paminsa_viz.checks import require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import friction_torque
from paminsa_viz.model.jacobians import actuator_velocity
from paminsa_viz.model.reach import Limit, reach_status
from paminsa_viz.model.singularity import escape_twist
from paminsa_viz.model.statics import static_torques
from paminsa_viz.trajectory.crossing import (
    Crossing,
    CrossingCondition,
    CrossingKind,
    CrossingRefused,
    crossing_condition,
    crossings,
)
from paminsa_viz.trajectory.crossing_program import (
    INTERVALS,
    REFINEMENTS,
    STEEP,
    STEEP_INTERVALS,
    STEEP_REFINEMENTS,
    CrossingProgram,
    influence,
)
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import Path, TimedPath
from paminsa_viz.trajectory.plan import Plan
from paminsa_viz.trajectory.sampled import Passage
from paminsa_viz.units import format_value, rounded_to_side

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

TIGHTENED = 4
"""How often limits that are exceeded between the points are added at most."""

STANDSTILL = 1e-9
"""Share of the largest s'^2 below which a motion counts as standing still on its way."""

LEAST_SHARE = 1e-3
"""Least share of the largest s'^2 in a motion of a given duration; that of the least s'^2 alone may
take for ever."""


LOOKED_AT = 1001
"""Instants of a motion at which its friction is looked at."""


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
        return (
            f"It crosses the {self.crossing.locus.label} at {self.t:.4g} s; actuators have no "
            "authority there along the escape twist."
        )


@dataclass(frozen=True, eq=False)
class TimeOptimalPlan:
    """A motion through singularities.

    Attributes:
        plan: The motion.
        curve: Its path with the time law.
        crossings: What it crosses, in its order.
        durations: Shortest and longest duration that the planner can give it [s].
        slowest, fastest: The least and the largest s'^2 by s that the limits allow [1/s^2]: every
            motion that keeps them is between.
    """

    plan: Plan
    curve: TimedPath
    crossings: tuple[PlannedCrossing, ...]
    durations: tuple[float, float]
    slowest: BSpline
    fastest: BSpline

    @property
    def path(self) -> Path:
        """The motion's path."""
        return self.curve.path


@of_design
def time_optimal(
    design: Design,
    path: Path,
    limits: MotionLimits,
    duration: float | None = None,
    *,
    name: str = "crossing",
) -> TimeOptimalPlan:
    """Return the shortest motion on a path, from rest to rest, or one of a given duration.

    It may cross singularities. On a path without, `shortest_motion` keeps every other limit, too.

    Args:
        design: The robot; its friction at the actuators is not counted in the limits, and the
            plan's notes say how much it adds. Limits of its drives are not kept, as they say too.
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
            "limits",
            "torque or force, and at most speed and turn_speed, are needed; shortest_motion keeps "
            "the others, on a path without singularities",
        )
    found = crossings(design.geometry, path)
    _check_path(design, path, found, limits)
    program, fast, slow = _program(design, path, found, limits)

    def blend(share: float) -> TimedPath:
        return TimedPath(path, program.spline(share * fast + (1.0 - share) * slow))

    longest = blend(LEAST_SHARE).duration
    curve = blend(1.0)
    shortest = curve.duration
    if duration is not None:
        if not shortest <= duration <= longest:
            least = rounded_to_side(shortest, 4, up=True)
            most = rounded_to_side(longest, 4, up=False)
            problem = f"{least:.4g} s to {most:.4g} s are possible, not {duration:g} s"
            raise InvalidInput("duration", problem)
        from scipy.optimize import brentq

        share: Any = brentq(
            lambda at: np.log(blend(at).duration / duration), LEAST_SHARE, 1.0, xtol=1e-12
        )
        curve = blend(share)
    planned = tuple(_planned(program, curve, *item) for item in enumerate(found))
    passages = tuple(Passage(p.t / curve.duration, p.crossing.locus) for p in planned)
    kind = "through singularities" if passages else "minimum time"
    notes = tuple(item.explanation for item in planned)
    plan = Plan(curve, curve.duration, name, kind, notes, passages)
    plan = replace(plan, notes=(*notes, *_friction_notes(design, plan), *_drive_notes(design)))
    return TimeOptimalPlan(
        plan, curve, planned, (shortest, longest), program.spline(slow), program.spline(fast)
    )


def _friction_notes(design: Design, plan: Plan) -> tuple[str, ...]:
    """Return how much friction adds to the torques that were limited; nothing without friction."""
    friction = design.actuator_friction
    if friction.zero:
        return ()
    motion = plan.at(np.linspace(0.0, plan.duration, LOOKED_AT))
    speed = actuator_velocity(design, motion.pose, motion.velocity)
    added = np.abs(friction_torque(friction, speed)).max(axis=0)
    rotary, linear = format_value(added[:3].max(), "N m"), format_value(added[3], "N")
    return (
        "Friction at the actuators is not counted in the limits: it adds up to "
        f"{rotary} to M1 to M3 and {linear} to M4.",
    )


def _drive_notes(design: Design) -> tuple[str, ...]:
    if not any(design.drives):
        return ()
    return ("Limits of the design’s drives are not kept: check them on the motion.",)


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
            worst = int(np.argmax(over))
            needed = rounded_to_side(float(abs(torque[worst])), 4, up=True)
            problem = (
                f"the {end} cannot be held: M{worst + 1} needs {needed:.4g} of "
                f"{limits.actuators[worst]:.4g} {'N' if worst == 3 else 'N·m'}"
            )
            to_raise = "force" if worst == 3 else "torque"
            raise CrossingRefused("hold", problem, float(s[at]), to_raise)


def _program(
    design: Design, path: Path, found: tuple[Crossing, ...], limits: MotionLimits
) -> tuple[CrossingProgram, Array, Array]:
    """Return a program with motions that do not stop, its fastest and its slowest.

    It is the first of `REFINEMENTS`, or where a crossing is steep of `STEEP_REFINEMENTS`.

    Raises:
        CrossingRefused: If there is none: that a motion would stop, or the least that is needed.
    """
    refusals: list[CrossingRefused] = []
    steep = any(
        influence(design, path, item, crossing_condition(design, path, item.s)) < STEEP
        for item in found
    )
    intervals, refinements = INTERVALS, REFINEMENTS if found else (0,)
    if steep:
        intervals, refinements = STEEP_INTERVALS, STEEP_REFINEMENTS
    for refinement in refinements:
        program = CrossingProgram(design, path, found, limits, refinement, intervals)
        try:
            fast, slow = program.fastest(), program.slowest()
            for _ in range(TIGHTENED):
                if not program.tighten(fast, slow):
                    break
                fast, slow = program.fastest(), program.slowest()
        except CrossingRefused as infeasible:
            refusals.append(infeasible)
            continue
        s = np.linspace(0.0, 1.0, 2001)[1:-1]
        z = program.spline(fast)(s)
        if z.min() > STANDSTILL * z.max():
            return program, fast, slow
        stop = float(s[np.argmin(z)])
        problem = (
            "the conditions at the crossings can be met only by a motion that stops at "
            f"s = {stop:.4g}; change the path"
        )
        refusals.append(CrossingRefused("weak", problem, stop))
    # of a motion that would stop no limit is too low
    raise min(refusals, key=lambda refusal: (refusal.cause != "weak", refusal.factor))


def _planned(
    program: CrossingProgram, curve: TimedPath, index: int, item: Crossing
) -> PlannedCrossing:
    condition = program.conditions[index]
    z = np.array([float(curve.z(item.s, order)) for order in range(3)])
    torque = program.limit_torques[index] @ np.append(z, 1.0)
    speed = float(np.sqrt(z[0]))
    return PlannedCrossing(
        item, condition, curve.time_at(item.s), condition.residual(speed, 0.5 * z[1]),
        tuple(torque.tolist()), speed, program.speed_range(index),
    )  # fmt: skip


# ------------------------------------------------------------- paths changed along the escape twist
# Near a crossing s* the path is displaced by W(s) t_s. The window W leaves the pose at s*, the ends
# and all outside of it as they are. An odd one, W = s - s* to first order, adds t_s^T M t_s to the
# factor a of the condition for a unit of its slope; an even one, W = (s - s*)^2 / 2, the same to b.

WIDEST = 0.25
"""Half of the widest window, in s."""

_BELL = np.polynomial.Polynomial([1.0, 0.0, -1.0]) ** 4  # three derivatives are zero at its ends
_ODD = np.polynomial.Polynomial([0.0, 1.0]) * _BELL
_EVEN = np.polynomial.Polynomial([0.0, 0.0, 0.5]) * _BELL


@dataclass(frozen=True, eq=False)
class DeformationWindow:
    """A displacement of a path near one of its points.

    Attributes:
        at: The point's s.
        half: Half of the window's width, in s.
        shift: (4,) displacement where the window's shape is one [m, m, rad, m].
        shape: Polynomial over -1 to 1.
    """

    at: float
    half: float
    shift: Array
    shape: np.polynomial.Polynomial


@dataclass(frozen=True, eq=False)
class DeformedPath:
    """A path with displacements near some of its points."""

    path: Path
    windows: tuple[DeformationWindow, ...]

    def __call__(self, s: Array, order: int = 0) -> Array:
        s = np.asarray(s, dtype=np.float64)
        value = self.path(s, order)
        for window in self.windows:
            x = (s - window.at) / window.half
            part = window.shape.deriv(order)(x) if order else window.shape(x)
            inside = np.where(np.abs(x) < 1.0, part / window.half**order, 0.0)
            value = value + inside[..., None] * window.shift
        return value


@dataclass(frozen=True, eq=False)
class DeformedPlan:
    """A motion on a path that was changed so that it can cross singularities.

    Attributes:
        found: The motion; its `path` is the changed one.
        deviation: Bound of the displacement of the platform's center and joints 5 from the given
            path [m]; zero if nothing had to be changed.
    """

    found: TimeOptimalPlan
    deviation: float


@of_design
def plan_deformed(
    design: Design,
    path: Path,
    limits: MotionLimits,
    duration: float | None = None,
    *,
    most: float = 0.02,
    name: str = "crossing",
) -> DeformedPlan:
    """Return a motion as `time_optimal` does, on a path changed along t_s if it has to be.

    Windows of both shapes and signs are tried, the same at every crossing, and the first deviation
    of a rising series at which one of them can be run is taken.

    Args:
        design: The robot.
        path: The path.
        limits: See `time_optimal`.
        duration: [s]; the shortest by default.
        most: Largest deviation [m].
        name: What a person calls it.

    Raises:
        InvalidInput: As `time_optimal`, or if the largest deviation is not above zero.
        CrossingRefused: If no such path can be run either: the cause on the given path.
    """
    require_positive(most, "most", "a length above 0 m")
    try:
        return DeformedPlan(time_optimal(design, path, limits, duration, name=name), 0.0)
    except CrossingRefused as refusal:
        if refusal.cause not in ("weak", "infeasible"):
            raise
        cause = refusal
    met = crossings(design.geometry, path)
    if not met:  # nothing of the path is changed but near crossings
        raise cause
    for deviation in most * 2.0 ** np.arange(-5, 1):
        for shape in (_ODD, _EVEN):
            for sign in (1.0, -1.0):
                changed = _deformed(design, path, met, shape, sign * float(deviation))
                try:
                    found = time_optimal(design, changed, limits, duration, name=name)
                except CrossingRefused:
                    continue
                if len(found.crossings) == len(met):
                    return DeformedPlan(found, float(deviation))
    problem = f"{cause}; nor on a path up to {1e3 * most:.3g} mm from it"
    raise CrossingRefused(cause.cause, problem, cause.s, cause.to_raise, cause.factor)


def _deformed(
    design: Design,
    path: Path,
    met: tuple[Crossing, ...],
    shape: np.polynomial.Polynomial,
    deviation: float,
) -> DeformedPath:
    """Return a path that is displaced by a signed deviation near each crossing."""
    places = [-met[0].s, *(item.s for item in met), 2.0 - met[-1].s]  # ends, mirrored
    halves = [min(WIDEST, 0.5 * (b - a)) for a, b in pairwise(places)]
    peak = float(shape(np.linspace(0.0, 1.0, 10_001)).max())
    windows = []
    for item, before, after in zip(met, halves[:-1], halves[1:], strict=True):
        twist = escape_twist(design.geometry, item.pose)
        size = float(np.hypot(*twist[:2])) + design.geometry.platform_radius
        shift = twist * deviation / (size * peak)
        windows.append(DeformationWindow(item.s, min(before, after), shift, shape))
    return DeformedPath(path, tuple(windows))
