"""The time-optimal law of a motion on its own path: as fast as the limits allow everywhere.

See `law_program` for the program. It starts from the motion's own law, stretched, and the law that
is found is stretched in the end by what it lacks between the points of the program, so that every
limit holds at every instant. What is not part of a convex program is the jerk.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.resizing import turn_length
from paminsa_viz.trajectory.durations import limit_of, needed_durations
from paminsa_viz.trajectory.law_program import LawProgram
from paminsa_viz.trajectory.limits import LIMITED, UNITS, MotionLimits
from paminsa_viz.trajectory.paths import TimedPath, TracedPath
from paminsa_viz.trajectory.plan import Plan
from paminsa_viz.trajectory.timing import ShortestStretch, shortest_stretch

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

PIECES = 100
"""Pieces of the law, besides those that the breaks of the motion make."""

LEAST = 24
"""Least number of them between two stops."""

ROUNDS = 12
"""Programs that are solved at most."""

SETTLED = 2e-4
"""Share of the duration that another program has to save to be worth it."""

EXCEEDED = 1e-3
"""Share of the duration by which a law may be too fast between the points of its program."""

FINE = 62
"""Points of a piece at which the law is looked at in the end."""

_CLOSE = 0.05
"""Share of a piece below which two knots are one."""


@dataclass(frozen=True)
class ShortestMotion(ShortestStretch):
    """A motion in its shortest duration by the best law.

    Attributes:
        plan, quantity, limit, unit, t: See `ShortestStretch`.
        stretched: Duration of the motion's own law, only stretched [s].
        note: Why the law is the motion's own, if it is.
    """

    stretched: float = np.nan
    note: str = ""

    @property
    def explanation(self) -> str:
        """What keeps the motion from being shorter, and what the stretched law would take."""
        after = self.note or f"its own law, stretched, takes {self.stretched:.4g} s"
        return f"{super().explanation}; {after}"


@kinds_checked
def shortest_motion(
    plan: Plan,
    limits: MotionLimits,
    design: Design | None = None,
    *,
    drives: bool = True,
    clearance: float | None = None,
) -> ShortestMotion:
    """Return a motion with the time-optimal law on its own path, within all limits.

    The path, and where the motion stops on it, stay. The acceleration of the best law jumps, so
    where a jerk is limited the motion's own law is stretched instead (`shortest_stretch`), also
    where speeds alone are; `ShortestMotion.note` says so. Coulomb friction that adds to a torque is
    counted in full; of one that takes some off, as much as there is at the speed of the law.

    Args:
        plan: The motion; its duration does not matter.
        limits: The limits.
        design: The robot. Needed for torque limits; where it is given, the path is checked.
        drives: Whether to keep the limits of the design's drives, see `shortest_stretch`. With
            them, or with viscous friction, the program is not convex: the law is one that cannot be
            bettered by small changes.
        clearance: See `check_path`.

    Returns:
        The motion. Between the points of its program limits hold to 0.5 % of the duration. It is up
        to 0.4 % longer than with twelve times as many pieces, on the presets.

    Raises:
        InvalidInput, ImpossibleTrajectory, InfeasibleMotion: As `shortest_stretch`.
        LawProgramFailed: If the conic solver fails.

    Source:
        Bobrow, Dubowsky and Gibson 1985; Verscheure, Demeulenaere, Swevers, De Schutter and Diehl,
        IEEE Transactions on Automatic Control 54 (2009) 2318-2327.
    """
    from scipy.interpolate import BSpline  # slow to load

    own = shortest_stretch(plan, limits, design, drives=drives, clearance=clearance)
    note = ""
    if np.isfinite(limits.rates[2]).any():
        note = "a limit of the jerk is not convex in the law: the motion's own one is stretched"
    elif not _accelerations_are_limited(own.plan, limits, design, drives):
        note = "limits of speeds alone leave its acceleration free: its own law is stretched"
    if note:
        return ShortestMotion(**vars(own), stretched=own.plan.duration, note=note)
    robot = APPENDIX_4 if design is None else design  # without one, no limit looks at it
    path = TracedPath(own.plan.curve, turn_length(robot.geometry))
    knots, bends = law_knots(path)
    rests = tuple(path.place(path.rests).tolist())
    unit = own.plan.duration
    program = LawProgram(path, knots, bends, limits, robot, unit, drives=drives)
    z, before = program.solve(path.law), np.inf
    curve = TimedPath(path, BSpline(z.t, z.c / unit**2, z.k), rests)
    for _ in range(ROUNDS):
        exceeded = program.tighten(curve, EXCEEDED)
        if not exceeded and curve.duration > (1.0 - SETTLED) * before:
            break
        z, before = program.solve(partial(_law_of, z)), curve.duration
        curve = TimedPath(path, BSpline(z.t, z.c / unit**2, z.k), rests)
    u, needed, column = program.needed(curve, FINE)
    worst = np.unravel_index(int(np.argmax(needed)), needed.shape)
    duration = float(curve.duration * needed[worst])
    if duration >= own.plan.duration:  # by rounding: the motion's own law is the best one
        return ShortestMotion(**vars(own), stretched=own.plan.duration)
    best = Plan(curve, duration, plan.name, f"{plan.kind}, time-optimal", plan.notes)
    which = int(column[worst])
    return ShortestMotion(
        best, LIMITED[which], limit_of(which, limits, design), UNITS[which],
        float(u[worst]) * duration, stretched=own.plan.duration,
    )  # fmt: skip


def _accelerations_are_limited(
    plan: Plan, limits: MotionLimits, design: Design | None, drives: bool
) -> bool:
    """Whether a limit that is not one of a speed leaves a motion less than any acceleration."""
    needed = needed_durations(plan.curve, limits, design, drives)(np.linspace(0.0, 1.0, 101))
    return any(
        needed[:, column].any()
        for column in range(needed.shape[1])
        if not LIMITED[column].endswith("speed") and "motor speed" not in LIMITED[column]
    )


def _law_of(z: BSpline, s: Array) -> tuple[Array, Array]:
    return z(s), z(s, 1)


def law_knots(path: TracedPath) -> tuple[Array, NDArray[np.bool_]]:
    """Return places s, close together at stops, and at breaks of the motion; which those are."""
    at = path.place(path.breaks)
    at[[0, -1]] = 0.0, 1.0
    parts = []
    for begin, end in pairwise(path.place(path.rests)):
        count = max(LEAST, round(PIECES * (end - begin)))
        parts.append(
            begin + (end - begin) * 0.5 * (1.0 - np.cos(np.pi * np.arange(1, count) / count))
        )
    s = np.concatenate(parts)
    apart = np.abs(s[:, None] - at).min(axis=1) > _CLOSE * np.diff(s, prepend=0.0)
    s = np.concatenate([s[apart], at])
    bends = np.arange(len(s)) >= apart.sum()
    order = np.argsort(s)
    return s[order], bends[order]
