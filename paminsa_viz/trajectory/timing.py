"""The shortest duration of a motion within limits.

Stretched in time, a motion keeps its poses: speeds divide by the duration T, accelerations by T^2,
jerks by T^3. The actuators' torques are exactly

    Q(u; T) = gravity(u) + friction(u; T) + dynamic(u) / T^2,

where gravity includes the design's load, the dynamic part holds inertia and velocity terms, both of
second order in 1/T, and viscous friction is of first order. So with a given Coulomb friction every
instant u has its own shortest duration in closed form, and that of the motion is the largest of
them. Coulomb friction fades with the speed (`Friction.transition_speed`): where it adds to a torque
it is counted in full, where it takes some off, as much as there is in that duration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES, Drive
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.jacobians import actuator_acceleration, actuator_velocity
from paminsa_viz.model.load import NO_LOAD
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.trajectory.check import SINGULAR_CLEARANCE, check_path
from paminsa_viz.trajectory.limits import LIMITED, UNITS, MotionLimits
from paminsa_viz.trajectory.plan import Blend, Plan, UnitCurve
from paminsa_viz.trajectory.planners import PLACE
from paminsa_viz.trajectory.time_laws import TimeLaw, fit_law

# ------------------------------------------------------------------ the largest value along a curve

NODES = 480
"""Instants looked at first, shared between the pieces of a curve, some to each."""

LEAST_NODES = 24

GAP = 1e-12
"""How far from a break its two sides are looked at."""

_SLACK = 0.02  # local maxima this close to the largest are followed up
_PARTS = 16
_ROUNDS = 10


class Supremum(NamedTuple):
    """The largest value found, where, and in which column of the function's values."""

    value: float
    u: float
    column: int


def nodes(breaks: Array) -> Array:
    """Return instants between breaks, both sides of each among them, increasing."""
    each = max(LEAST_NODES, NODES // max(1, len(breaks) - 1))
    pieces = [
        np.linspace(begin + GAP, end - GAP, each)
        for begin, end in pairwise(breaks)
        if end - begin > 4 * GAP
    ]
    return np.concatenate([[breaks[0]], *pieces, [breaks[-1]]])


def supremum(function: Callable[[Array], Array], breaks: Array) -> Supremum:
    """Return the largest value of a function (n,) -> (n, columns) that is smooth between breaks.

    Brackets around every local maximum that may be the largest are cut into parts again and again,
    until they are a 1e-12th of a first step wide. Infinite values are fine, NaN are not.
    """
    u = nodes(breaks)
    values = function(u)
    top = values.max(axis=1)
    best = _best(values, u)
    if not np.isfinite(best.value) or best.value <= 0:
        return best
    high = top >= (1.0 - _SLACK) * best.value
    left = np.concatenate([[-np.inf], top[:-1]])
    right = np.concatenate([top[1:], [-np.inf]])
    peaks = np.flatnonzero(high & (top >= left) & (top >= right))
    low = u[np.maximum(peaks - 1, 0)]
    up = u[np.minimum(peaks + 1, len(u) - 1)]
    share = np.linspace(0.0, 1.0, _PARTS + 1)
    for _ in range(_ROUNDS):
        if low.size == 0:
            break
        inside = low[:, None] + (up - low)[:, None] * share
        values = function(inside.ravel())
        best = max(best, _best(values, inside.ravel()), key=lambda found: found.value)
        if not np.isfinite(best.value):
            break
        top = values.max(axis=1).reshape(inside.shape)
        which = np.argmax(top, axis=1)
        rows = np.arange(len(low))
        kept = top[rows, which] >= (1.0 - _SLACK) * best.value
        low = inside[rows, np.maximum(which - 1, 0)][kept]
        up = inside[rows, np.minimum(which + 1, _PARTS)][kept]
    return best


def _best(values: Array, u: Array) -> Supremum:
    row, column = divmod(int(np.argmax(values)), values.shape[1])
    return Supremum(float(values[row, column]), float(u[row]), column)


# -------------------------------------------------------------------------- durations within limits

_ROUNDING = 1e-12  # share by which a duration is longer than required, against rounding
_FADED = 8
"""Times that friction is worked out for the duration it leaves, the first without any."""

_RATES_DECIDE = 1e-9
"""Share by which a law may need more time than its rates do, and be the shortest nonetheless."""

_GENTLEST = 1e-3
"""Least acceleration of the ramps that are looked at, over that of the steepest."""

_SHORTEST_RAMP = 0.02
"""Share of the time of ramps below which none are looked at that limits of rates do not ask for."""

_RAMPS = 13
"""How many of them are looked at first."""

_SAME_RAMP = 1e-4
"""Share to which the best ramps are found."""

_INSTANT = 1e-300
"""Least duration that a speed is divided by."""


@dataclass(frozen=True)
class ShortestStretch:
    """A motion in its shortest duration.

    Attributes:
        plan: The motion.
        quantity: What reaches its limit, one of `limits.LIMITED`.
        limit: The limit that is reached.
        unit: Its unit.
        t: When it is reached [s].
    """

    plan: Plan
    quantity: str
    limit: float
    unit: str
    t: float

    @property
    def explanation(self) -> str:
        """What keeps the motion from being shorter, in words."""
        if not self.unit:
            return f"{self.plan.duration:.4g} s: {self.quantity} is reached at {self.t:.4g} s"
        return (
            f"{self.plan.duration:.4g} s: {self.quantity} reaches {self.limit:.4g} {self.unit} "
            f"at {self.t:.4g} s"
        )


class InfeasibleMotion(PaminsaError):
    """A motion that keeps its limits in no duration: an actuator is too weak even to creep.

    Attributes:
        actuator: Index of the actuator, 0 to 3.
        share: Where along the motion, 0 at its start and 1 at its end, in time.
        pose: The pose there (4,) [m, m, rad, m].
        needed: Required there by gravity, and by Coulomb friction where that adds [N m or N].
        limit: What the actuator may give [N m or N].
        friction: Whether Coulomb friction is part of what is needed.
    """

    def __init__(
        self,
        actuator: int,
        share: float,
        pose: tuple[float, ...],
        needed: float,
        limit: float,
        friction: bool = False,
    ) -> None:
        self.actuator = actuator
        self.share = share
        self.pose = pose
        self.needed = needed
        self.limit = limit
        self.friction = friction
        name, unit = LIMITED[6 + actuator], UNITS[6 + actuator]
        what = "gravity and Coulomb friction take" if friction else "gravity takes"
        super().__init__(
            f"no duration is long enough: at {100 * share:.3g} % of the motion {what} "
            f"{abs(needed):.4g} {unit}, and the {name} is limited to {limit:.4g} {unit}"
        )


@kinds_checked
def shortest_stretch(
    plan: Plan,
    limits: MotionLimits,
    design: Design | None = None,
    *,
    reshape: bool = True,
    drives: bool = True,
    misprints: Misprint = Misprint.NONE,
    clearance: float = SINGULAR_CLEARANCE,
) -> ShortestStretch:
    """Return a motion in the shortest duration that keeps all limits; every longer one does too.

    One of the limits is reached, to rounding, and none exceeded, at any instant. Where Coulomb
    friction adds to a torque it is counted in full, so that near a standstill the torque stays a
    little below its limit.

    Args:
        plan: The motion; its duration does not matter.
        limits: The limits.
        design: The robot. Needed for torque limits; where it is given, the path is checked.
        reshape: Whether a straight trapezoid or S-curve may change its ramps: to use the limits of
            speed, acceleration and jerk fully, or less of the acceleration where an actuator is too
            weak for it. Otherwise it is only stretched.
        drives: Whether to keep the torque-speed envelopes and top speeds of the design's drives and
            the peak torques of their gears, if it has any; their losses by the direction of the
            power.
        misprints: Misprints of the paper to reproduce.
        clearance: See `check_path`.

    Raises:
        InvalidInput: If nothing that moves is limited, torques are without a design, or a jerk is
            limited and the motion's acceleration jumps.
        ImpossibleTrajectory: If the robot cannot run the path.
        InfeasibleMotion: If gravity, with Coulomb friction where that adds, exceeds a torque limit.
    """
    if limits.needs_torques and design is None:
        raise InvalidInput("design", "limits of torque and force need a design")
    if design is not None:
        check_path(design.geometry, plan.lasting(1.0).sample(), clearance).require()
    if np.isfinite(limits.rates[2]).any() and not plan.curve.bounded_jerk:
        problem = "the acceleration of this motion jumps, so its jerk has no bound"
        raise InvalidInput("limits", problem)

    def needed_by(one: Plan) -> Callable[[Array], Array]:
        return needed_durations(one.curve, limits, design, drives, misprints)

    if reshape:
        plan = _reshaped(plan, limits, needed_by)
    curve = plan.curve
    needed = supremum(needed_by(plan), curve.breaks)
    if not np.isfinite(needed.value) and design is not None:
        at = np.array([needed.u])
        held = torque_parts(curve, design, misprints, at)[0][0]
        moved = held + coulomb_friction(curve, design, at)[0]
        adds = np.abs(moved) > np.abs(held)
        held = np.where(adds, moved, held)
        bounds = limits.actuators
        if needed.column >= FIRST_OF_DRIVES:
            bounds = np.array([one.peak for one in design.output_limits])
        worst = int(np.argmax(np.abs(held) / bounds))
        pose = tuple(map(float, curve(at)[0]))
        most = float(bounds[worst])
        raise InfeasibleMotion(
            worst, needed.u, pose, float(held[worst]), most, friction=bool(adds[worst])
        )
    if needed.value <= 0:
        raise InvalidInput("limits", "nothing that moves is limited")
    duration = needed.value * (1.0 + _ROUNDING)
    return ShortestStretch(
        plan.lasting(duration), LIMITED[needed.column], limit_of(needed.column, limits, design),
        UNITS[needed.column], needed.u * duration,
    )  # fmt: skip


def limit_of(column: int, limits: MotionLimits, design: Design | None) -> float:
    """Return a limit by its place in `limits.LIMITED`, in its unit."""
    rows = [
        *limits.rates.ravel(), *limits.actuators, *[1.0] * 4, *_motor_speeds(design),
        *_gear_peaks(design),
    ]  # fmt: skip
    return float(rows[column])


def needed_durations(
    curve: UnitCurve,
    limits: MotionLimits,
    design: Design | None,
    drives: bool,
    misprints: Misprint = Misprint.NONE,
) -> Callable[[Array], Array]:
    """Return what gives the durations that limits require at instants (n,), (n, columns) [s].

    The columns are those of `limits.LIMITED`, as far as a design is given and its drives are kept.
    """
    parts: list[Callable[[Array], Array]] = [partial(_rate_durations, curve, limits.rates)]
    driven = drives and design is not None and any(design.drives)
    if design is not None and (driven or limits.needs_torques):
        torques = partial(_torque_durations, curve, limits.actuators, design, misprints)
        parts.append(torques)
    if design is not None and driven:
        parts.append(_drive_durations(curve, design, misprints))
    return lambda u: np.concatenate([part(u) for part in parts], axis=1)


def _reshaped(
    plan: Plan, limits: MotionLimits, needed_by: Callable[[Plan], Callable[[Array], Array]]
) -> Plan:
    """Return a straight move with the ramps that make it shortest.

    They are those that use the limits of its rates fully. Where an actuator is too weak for them,
    stretching the motion would leave it at a crawl between two jerks: gentler ramps, and the
    motion's own, are then looked at as well.
    """
    curve = plan.curve
    if not (isinstance(curve, Blend) and len(curve.terms) == 1):
        return plan
    term = curve.terms[0]
    lengths = np.array([np.linalg.norm(term.shift[PLACE]), abs(term.shift[2])])
    with np.errstate(divide="ignore"):
        speed, acceleration, jerk = (limits.rates / lengths).min(axis=1).tolist()
    fitted = fit_law(term.law, speed, acceleration, jerk)
    if fitted is None:
        return plan

    def shaped(law: TimeLaw) -> Plan:
        return replace(plan, curve=replace(curve, terms=(replace(term, law=law),)))

    def needed(one: Plan) -> float:
        return float(needed_by(one)(nodes(one.curve.breaks)).max())

    law, alone = fitted
    steepest = shaped(law)
    least = needed(steepest)
    if least <= alone * (1.0 + _RATES_DECIDE) or not np.isfinite(least):
        return steepest
    if np.isfinite(jerk):  # from the acceleration that is reached to none, at the full jerk
        full = float(np.abs(law(np.array([law.ramp / 2.0]), 2))[0]) / alone**2
        ends = _GENTLEST * full, full
    else:  # a stretched law may have the shape of any ramps
        ends = min(law.ramp, _SHORTEST_RAMP), 0.5

    def gentler(logarithm: float) -> Plan:
        value = min(float(np.exp(logarithm)), ends[1])
        if np.isfinite(jerk):
            return shaped((fit_law(term.law, speed, value, jerk) or fitted)[0])
        return shaped(replace(law, ramp=value))

    grid = np.linspace(np.log(ends[0]), np.log(ends[1]), _RAMPS)
    best = int(np.argmin([needed(gentler(logarithm)) for logarithm in grid]))
    from scipy.optimize import minimize_scalar  # slow to load

    near = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    found: Any = minimize_scalar(
        lambda logarithm: needed(gentler(logarithm)),
        bounds=near, method="bounded", options={"xatol": _SAME_RAMP},
    )  # fmt: skip
    return min((steepest, gentler(float(found.x)), gentler(grid[best]), plan), key=needed)


def _rate_durations(curve: UnitCurve, limits: Array, u: Array) -> Array:
    """Return the durations that limits (3, 2) require at instants (n,), (n, 6) [s]."""
    found = []
    for order in (1, 2, 3):
        rate = curve(u, order)
        size = np.stack([np.linalg.norm(rate[:, PLACE], axis=1), abs(rate[:, 2])], axis=1)
        found.append((size / limits[order - 1]) ** (1.0 / order))
    return np.concatenate(found, axis=1)


def torque_parts(
    curve: Callable[[Array, int], Array], design: Design, misprints: Misprint, u: Array
) -> tuple[Array, Array, Array]:
    """Return the torques' parts of order 0, 1 and 2 in 1/T along a curve, each (n, 4).

    They are without Coulomb friction.
    """
    plain = design.without_friction()
    pose, rate, growth = curve(u, 0), curve(u, 1), curve(u, 2)
    still = np.zeros_like(pose)
    gravity = inverse_dynamics(plain, pose, still, still, misprints).torque
    weightless = replace(plain, gravity=0.0, load=NO_LOAD)
    dynamic = inverse_dynamics(weightless, pose, rate, growth, misprints).torque
    viscous = np.array(design.actuator_friction.viscous)
    return gravity, viscous * actuator_velocity(design, pose, rate), dynamic


def coulomb_friction(
    curve: Callable[[Array, int], Array], design: Design, u: Array, duration: Array | None = None
) -> Array:
    """Return Coulomb friction along a curve that takes durations (n, 1) or (n, 4), as (n, 4).

    Without a duration it is counted in full wherever an actuator moves.
    """
    friction = design.actuator_friction
    speed = actuator_velocity(design, curve(u, 0), curve(u, 1))
    return np.array(friction.coulomb) * coulomb_share(design, speed, duration)


def coulomb_share(design: Design, speed: Array, duration: Array | None) -> Array:
    """Return the share of Coulomb friction that acts, -1 to 1, see `coulomb_friction`."""
    if duration is None:
        return np.sign(speed)
    return np.tanh(speed / np.maximum(duration * design.friction.transition_speed, _INSTANT))


def _where_friction_fades(needed: Callable[[Array | None], Array], design: Design) -> Array:
    """Return the durations that are needed with the friction that there is in them.

    ``needed`` gives those (n, columns) with the friction of durations (n, 4); the first and the
    last four columns are those of torques of M1 to M4. A longer duration has less friction, so that
    from those without any on each is one that will do.
    """
    full = needed(None)
    if not any(design.actuator_friction.coulomb):
        return full
    longest = np.full_like(full, np.inf)
    for _ in range(_FADED):
        longest = np.maximum(full, needed(np.maximum(longest[:, :4], longest[:, -4:])))
    return longest


FIRST_OF_DRIVES = LIMITED.index("torque-speed envelope of M1")
"""Place of the drives' limits among the columns of durations."""


def _motor_speeds(design: Design | None) -> list[float]:
    """Return the top speeds of the drives' motors, (4,) [rad/s]; infinite where there is none."""
    if design is None:
        return [np.inf] * 4
    return [
        np.inf if drive is None else one.speed * drive.ratio
        for drive, one in zip(design.drives, design.output_limits, strict=True)
    ]


def _gear_peaks(design: Design | None) -> list[float]:
    """Return the peak loads of the drives' gears, at the actuators, (4,); infinite without one."""
    drives = NO_DRIVES if design is None else design.drives
    return [np.inf if drive is None else drive.gear_limits.peak for drive in drives]


def _drive_durations(
    curve: UnitCurve, design: Design, misprints: Misprint
) -> Callable[[Array], Array]:
    """Return the durations that the drives require, as a function (n,) -> (n, 12) [s].

    The columns are envelopes, speeds and gears of M1 to M4. With w = 1/T the load, the motor's own
    torque and its speed are polynomials in w, and so is each line of the envelope; see `_longest`.
    """
    plain = replace(design, drives=NO_DRIVES)
    speeds = np.array([one.speed for one in design.output_limits])

    def durations(u: Array) -> Array:
        still, *others = torque_parts(curve, plain, misprints, u)
        pose, rate, growth = curve(u), curve(u, 1), curve(u, 2)
        speed = actuator_velocity(design, pose, rate)
        turned = actuator_acceleration(design.geometry, pose, rate, growth)

        def needed(duration: Array | None) -> Array:
            load = (still + coulomb_friction(curve, plain, u, duration), *others)
            return with_friction(load, speed, turned, coulomb_share(design, speed, duration))

        return _where_friction_fades(needed, design)

    def with_friction(load: tuple[Array, ...], speed: Array, turned: Array, acting: Array) -> Array:
        found = np.zeros((len(speed), 12))
        found[:, 4:8] = np.abs(speed) / speeds
        for j, drive in enumerate(design.drives):
            if drive is None:
                continue
            viscous, coulomb = drive.reflected_friction
            inertia = drive.reflected_inertia * turned[:, j]
            own = (coulomb * acting[:, j], viscous * speed[:, j], inertia)
            for limit, fall, lossy, counted in drive_lines(drive, speed[:, j]):
                for sign in (1.0, -1.0):
                    needed = []
                    for share in lossy:
                        constant, first, second = (
                            sign * (share * part[:, j] + counted * o)
                            for part, o in zip(load, own, strict=True)
                        )
                        first = first + fall * np.abs(speed[:, j])
                        needed.append(_longest(limit - constant, first, second))
                    # that is the larger of the two at a positive speed: below a limit if both are
                    along = sign * speed[:, j] > 0
                    least = np.where(along, np.max(needed, axis=0), np.min(needed, axis=0))
                    column = j if counted else 8 + j
                    found[:, column] = np.maximum(found[:, column], least)
        return found

    return durations


def drive_lines(
    drive: Drive, speed: Array
) -> Iterator[tuple[float, float, tuple[Array, ...], float]]:
    """Yield the limits of a drive, |share load + counted own| + fall |speed| <= limit.

    Args:
        drive: The drive.
        speed: (n,) of the actuator; its sign matters.

    Yields:
        Limit and fall at the actuator, the shares (n,) of which the larger one counts at a positive
        speed and the smaller one at a negative, and whether the motor's own torque counts.
    """
    # behind the gear the load is T/eta where the motor drives and T eta where the load does
    eta = np.where(speed == 0, 1.0, drive.total_efficiency)
    shares = (1 / eta, eta) if drive.total_efficiency < 1 else (eta,)
    lines = [(a * drive.ratio, s * drive.ratio**2, shares, 1.0) for a, s in drive.lines]
    lines.append((drive.gear_limits.peak, 0.0, (np.ones_like(eta),), 0.0))
    yield from (line for line in lines if not np.isinf(line[0]))


def _longest(room: Array, first: Array, second: Array) -> Array:
    """Return 1/w for the smallest w > 0 with first w + second w^2 = room; infinite without room."""
    with np.errstate(all="ignore"):
        square = first**2 + 4.0 * second * room
        needed = np.where(square >= 0, (first + np.sqrt(square)) / (2.0 * room), 0.0)
    return np.where(room > 0, np.maximum(needed, 0.0), np.inf)


def _torque_durations(
    curve: UnitCurve, limits: Array, design: Design, misprints: Misprint, u: Array
) -> Array:
    """Return the durations that limits (4,) require at instants (n,), (n, 4) [s].

    With w = 1/T a torque is constant + first w + second w^2. It starts within its limit at w = 0
    and first leaves it at the smallest positive root w of limit -+ torque = 0; T = 1/w.
    """
    still, first, second = torque_parts(curve, design, misprints, u)

    def needed(duration: Array | None) -> Array:
        constant = still + coulomb_friction(curve, design, u, duration)
        longest = np.zeros_like(constant)
        for sign in (1.0, -1.0):
            each = _longest(limits - sign * constant, sign * first, sign * second)
            longest = np.maximum(longest, np.where(np.isinf(limits), 0.0, each))
        return longest

    return _where_friction_fades(needed, design)
