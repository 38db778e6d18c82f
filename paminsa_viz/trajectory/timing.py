"""The shortest duration of a motion within limits: the largest of what its instants need.

What an instant needs is in `durations`. The motion keeps its poses, or changes its ramps for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.trajectory.check import check_path
from paminsa_viz.trajectory.durations import (
    FIRST_OF_DRIVES,
    coulomb_friction,
    limit_of,
    needed_durations,
    standstill_peaks,
    torque_parts,
)
from paminsa_viz.trajectory.limits import LIMITED, MOTOR_SPEEDS, UNITS, MotionLimits
from paminsa_viz.trajectory.plan import Blend, Plan
from paminsa_viz.trajectory.planners import PLACE
from paminsa_viz.trajectory.supremum import nodes, supremum
from paminsa_viz.trajectory.time_laws import TimeLaw, fit_law
from paminsa_viz.units import format_ascii

UNBOUNDED_JERK = "the acceleration of this motion jumps, so its jerk has no bound"
"""Why a motion keeps no limit of jerk."""

_ROUNDING = 1e-12
"""Share by which a duration is longer than required, against rounding."""

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

_MOTOR_SPEED = slice(LIMITED.index(MOTOR_SPEEDS[0]), LIMITED.index(MOTOR_SPEEDS[-1]) + 1)
"""Columns of the durations that the motors' top speeds need."""

_ROUNDS = 2
"""How often the best top speed and the best acceleration are looked for in turn."""


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
        unit = "rad/s:rpm" if self.quantity in MOTOR_SPEEDS else self.unit
        return (
            f"{self.plan.duration:.4g} s: {self.quantity} reaches "
            f"{format_ascii(self.limit, unit)} at {self.t:.4g} s"
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
        by_drive: Whether the limit is that of the design's drive, not one of `MotionLimits`.
    """

    def __init__(
        self,
        actuator: int,
        share: float,
        pose: tuple[float, ...],
        needed: float,
        limit: float,
        friction: bool = False,
        by_drive: bool = False,
    ) -> None:
        self.actuator = actuator
        self.share = share
        self.pose = pose
        self.needed = needed
        self.limit = limit
        self.friction = friction
        self.by_drive = by_drive
        name, unit = LIMITED[6 + actuator], UNITS[6 + actuator]
        what = "gravity and Coulomb friction take" if friction else "gravity takes"
        least = format_ascii(abs(needed), unit, up=True)
        super().__init__(
            f"no duration is long enough: at {100 * share:.3g} % of the motion {what} "
            f"{least}, and the {name} is limited to {format_ascii(limit, unit)}"
            f"{' by its drive' if by_drive else ''}"
        )

    @property
    def to_raise(self) -> str:
        """The field of `MotionLimits` that is too low; empty if no limit helps."""
        return "" if self.by_drive else "force" if self.actuator == 3 else "torque"


@kinds_checked
def shortest_stretch(
    plan: Plan,
    limits: MotionLimits,
    design: Design | None = None,
    *,
    reshape: bool = True,
    drives: bool = True,
    misprints: Misprint = Misprint.NONE,
    clearance: float | None = None,
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
            speed, acceleration and jerk fully, or less of them where an actuator is too weak or
            its motor too slow. Otherwise it is only stretched.
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
        raise InvalidInput("limits", UNBOUNDED_JERK)

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
        by_drive = needed.column >= FIRST_OF_DRIVES
        if by_drive:
            bounds = standstill_peaks(design)
        worst = int(np.argmax(np.abs(held) / bounds))
        pose = tuple(map(float, curve(at)[0]))
        most = float(bounds[worst])
        raise InfeasibleMotion(
            worst, needed.u, pose, float(held[worst]), most,
            friction=bool(adds[worst]), by_drive=by_drive,
        )  # fmt: skip
    if needed.value <= 0:
        raise InvalidInput("limits", "nothing that moves is limited")
    duration = needed.value * (1.0 + _ROUNDING)
    return ShortestStretch(
        plan.lasting(duration), LIMITED[needed.column], limit_of(needed.column, limits, design),
        UNITS[needed.column], needed.u * duration,
    )  # fmt: skip


def _reshaped(
    plan: Plan, limits: MotionLimits, needed_by: Callable[[Plan], Callable[[Array], Array]]
) -> Plan:
    """Return a straight move with the ramps that make it shortest.

    They are those that use the limits of its rates fully. Where an actuator is too weak for them,
    stretching the motion would leave it at a crawl between two jerks: gentler ramps, and the
    motion's own, are then looked at as well. So are lower top speeds where motors limit them and a
    limited jerk would leave no time at a constant speed; ramps of any share have them all.
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
    if not np.isfinite(jerk):  # a stretched law may have the shape of any ramps
        ends = min(law.ramp, _SHORTEST_RAMP), 0.5
        ramp = _best(lambda ramp: needed(shaped(replace(law, ramp=ramp))), *ends)
        return min((steepest, shaped(replace(law, ramp=ramp)), plan), key=needed)

    def limited(top: float, most: float) -> Plan:
        return shaped((fit_law(term.law, top, most, jerk) or fitted)[0])

    def time_of(top: float, most: float) -> float:
        return needed(limited(top, most))

    # from the acceleration and the speed that are reached to none, at the full jerk
    full = float(np.abs(law(np.array([law.ramp / 2.0]), 2))[0]) / alone**2
    accelerations = _GENTLEST * full, full
    found = [steepest, plan, limited(speed, _best(partial(time_of, speed), *accelerations))]
    if needed_by(steepest)(np.array([0.25, 0.5, 0.75]))[:, _MOTOR_SPEED].any():
        fastest, most = float(law(np.array([0.5]), 1)[0]) / alone, full
        for _ in range(_ROUNDS):
            top = _best(partial(time_of, most=most), _GENTLEST * fastest, fastest)
            most = _best(partial(time_of, top), *accelerations)
            found.append(limited(top, most))
    return min(found, key=needed)


def _best(needed: Callable[[float], float], low: float, high: float) -> float:
    """Return the value between two above 0 that needs the least time."""
    from scipy.optimize import minimize_scalar  # slow to load

    grid = np.geomspace(low, high, _RAMPS)
    grid[-1] = high
    times = [needed(float(value)) for value in grid]
    best = int(np.argmin(times))
    near = np.log(grid[[max(best - 1, 0), min(best + 1, len(grid) - 1)]])
    found: Any = minimize_scalar(
        lambda logarithm: needed(min(float(np.exp(logarithm)), high)),
        bounds=tuple(near), method="bounded", options={"xatol": _SAME_RAMP},
    )  # fmt: skip
    return float(np.exp(found.x)) if found.fun < times[best] else float(grid[best])
