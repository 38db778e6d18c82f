"""Planners: motions of the platform that start and end at rest.

Each takes a duration; `timing.shortest_stretch` finds the shortest one within limits. Poses are
(x, y, theta, z) [m, m, rad, m] in the base frame.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import kinds_checked, require_at_least, require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import geometry_of
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.resizing import TURN_LENGTH, turn_length
from paminsa_viz.trajectory.plan import Arc, Blend, Chain, Displacement, Plan, Spline
from paminsa_viz.trajectory.sampled import Passage
from paminsa_viz.trajectory.time_laws import TimeLaw

PLACE = [0, 1, 3]
"""Columns of a pose that are lengths."""

PLANES = {"xy": (0, 1), "xz": (0, 3), "yz": (1, 3)}
"""Columns of a pose along which a circle may lie."""


@kinds_checked
def point_to_point(
    start: ArrayLike,
    goal: ArrayLike,
    duration: float = 1.0,
    law: TimeLaw | None = None,
    *,
    name: str = "move",
) -> Plan:
    """Return a move from pose to pose (4,): all coordinates together, by one law (a quintic).

    The platform runs straight and turns in proportion.

    Args:
        start, goal: (4,) poses [m, m, rad, m].
        duration: [s].
        law: Its law; a quintic by default.
        name: Its name.

    Raises:
        InvalidInput: If a pose is not finite or the duration not positive.
    """
    law = law or TimeLaw()
    begin, end = _pose(start, "start"), _pose(goal, "goal")
    curve = Blend(begin, (Displacement(end - begin, law),))
    return Plan(curve, duration, name, f"move, {law.profile.value}")


@kinds_checked
def line(
    start: ArrayLike,
    point: ArrayLike,
    duration: float = 1.0,
    law: TimeLaw | None = None,
    *,
    name: str = "line",
) -> Plan:
    """Return a straight line from a pose (4,) to a point (3,) = (x, y, z), theta held.

    Args:
        start: (4,) pose [m, m, rad, m].
        point: (3,) place of the platform's center at the end, in the base frame [m].
        duration, law, name: As in `point_to_point`.

    Raises:
        InvalidInput: If a number is not finite or the duration not positive.
    """
    begin = _pose(start, "start")
    x, y, z = _finite(as_vectors(point, "point", 3), "point", (3,))
    law = law or TimeLaw()
    plan = point_to_point(begin, [x, y, begin[2], z], duration, law, name=name)
    return Plan(plan.curve, duration, name, f"straight line, {law.profile.value}")


@kinds_checked
def circle(
    center: ArrayLike,
    radius: float,
    duration: float = 1.0,
    law: TimeLaw | None = None,
    *,
    plane: str = "xy",
    begin: float = 0.0,
    angle: float = 2 * np.pi,
    name: str = "circle",
) -> Plan:
    """Return a run along a circle, theta held.

    Args:
        center: (4,) pose of the center [m, m, rad, m].
        radius: [m].
        duration: [s].
        law: How the angle grows in time; a quintic by default.
        plane: ``"xy"``, ``"xz"`` or ``"yz"``.
        begin: Where on the circle it starts, from the plane's first axis toward its second [rad].
        angle: How far it goes, negative for the other direction [rad].
        name: Its name.

    Raises:
        InvalidInput: If the plane is unknown, a number is not finite, or the radius not positive.
    """
    law = law or TimeLaw()
    middle = _pose(center, "center")
    if plane not in PLANES:
        raise InvalidInput("plane", f"one of {', '.join(PLANES)} is needed, not {plane!r}")
    require_positive(radius, "radius", "a length above 0 m")
    for argument, value in (("begin", begin), ("angle", angle)):
        if not np.isfinite(value):
            raise InvalidInput(argument, f"a finite number is needed, not {value!r}")
    axes = np.zeros((2, 4))
    axes[[0, 1], PLANES[plane]] = radius
    first = axes[0] * np.cos(begin) + axes[1] * np.sin(begin)
    second = axes[1] * np.cos(begin) - axes[0] * np.sin(begin)
    curve = Arc(middle, first, second, float(angle), law)
    return Plan(curve, duration, name, f"circle, {law.profile.value}")


@kinds_checked
def arch(
    start: ArrayLike,
    goal: ArrayLike,
    height: float,
    duration: float = 1.0,
    law: TimeLaw | None = None,
    *,
    lift_share: float = 0.4,
    overlap: float = 0.5,
    name: str = "arch",
) -> Plan:
    """Return a pick-and-place arch: up, across, down, the three overlapping in time.

    Args:
        start, goal: (4,) poses [m, m, rad, m].
        height: How far the platform rises above the higher of the two [m].
        duration: [s].
        law: Time law of each of the three; a quintic by default.
        lift_share: Share of the time spent going up, and as much going down; at most 1/2.
        overlap: Share of the lift during which the crossing already runs, from 0 to 1; with 0 the
            arch has corners, and stops there.
        name: Its name.

    Raises:
        InvalidInput: If a pose is not finite, the height negative, or a share out of its range.
    """
    law = law or TimeLaw()
    begin, end = _pose(start, "start"), _pose(goal, "goal")
    require_at_least(height, "height", what="a length of at least 0 m")
    if not 0 < lift_share <= 0.5:
        raise InvalidInput("lift_share", f"above 0 and up to 1/2 is needed, not {lift_share!r}")
    if not 0 <= overlap <= 1:
        raise InvalidInput("overlap", f"0 to 1 is needed, not {overlap!r}")
    corner = lift_share * (1.0 - overlap)
    if 1.0 - 2.0 * corner < 1e-6:
        raise InvalidInput("overlap", "no time is left for the crossing; overlap more, lift less")
    top = max(begin[3], end[3]) + height
    up, across, down = np.zeros(4), end - begin, np.zeros(4)
    up[3], across[3], down[3] = top - begin[3], 0.0, end[3] - top
    terms = (
        Displacement(up, law, 0.0, lift_share),
        Displacement(across, law, corner, 1.0 - corner),
        Displacement(down, law, 1.0 - lift_share, 1.0),
    )
    return Plan(Blend(begin, terms), duration, name, f"arch, {law.profile.value}")


@kinds_checked
def via_points(
    poses: ArrayLike,
    duration: float | None = None,
    *,
    times: ArrayLike | None = None,
    name: str = "waypoints",
    geometry: Geometry | Design | None = None,
) -> Plan:
    """Return a motion through waypoints whose velocity, acceleration and jerk are continuous.

    It is the spline of fifth degree through the poses that starts and ends at rest.

    Args:
        poses: (n, 4), at least two [m, m, rad, m]; neighbors have to differ.
        duration: [s]; by default 1 s, or the span of ``times``.
        times: (n,) when each is passed, in any unit. By default each stretch gets time by the
            square root of its length, the first and the last a little more.
        name: Its name.
        geometry: The robot, of whose size a turn counts as a length; Appendix 4's without one.

    Raises:
        InvalidInput: If there are fewer than two poses, two neighbors are the same, or times do
            not increase.
    """
    waypoints = as_vectors(poses, "poses")
    if waypoints.ndim != 2 or len(waypoints) < 2:
        raise InvalidInput("poses", f"at least two poses (n, 4) are needed; got {waypoints.shape}")
    waypoints = _finite(waypoints, "poses", waypoints.shape)
    if times is None:
        ends = shared_time(waypoints, geometry)
    else:
        given = _finite(as_numbers(times, "times"), "times", (len(waypoints),))
        if not (np.diff(given) > 0).all():
            raise InvalidInput("times", "the times have to increase")
        duration = float(given[-1] - given[0]) if duration is None else duration
        ends = (given - given[0]) / (given[-1] - given[0])
    curve = Spline.through(waypoints, ends, (1, 2))
    return Plan(curve, 1.0 if duration is None else duration, name, "waypoints, quintic spline")


@kinds_checked
def chain(*plans: Plan, name: str = "") -> Plan:
    """Return plans run after each other, with a stop in between; each in its duration.

    Raises:
        InvalidInput: If there is none, or one does not start where the one before it ends.
    """
    if not plans:
        raise InvalidInput("plans", "at least one plan is needed")
    zero, one = np.zeros(1), np.ones(1)
    for number, (before, after) in enumerate(pairwise(plans), 2):
        if not np.allclose(before.curve(one), after.curve(zero), rtol=0.0, atol=1e-9):
            raise InvalidInput("plans", f"plan {number} does not start where the one before ends")
    ends = np.cumsum([0.0, *(plan.duration for plan in plans)])
    curve = Chain(tuple(plan.curve for plan in plans), ends / ends[-1])
    notes = tuple(dict.fromkeys(note for plan in plans for note in plan.notes))
    passages = tuple(
        Passage((begin + passage.t * plan.duration) / ends[-1], passage.locus)
        for plan, begin in zip(plans, ends, strict=False)
        for passage in plan.passages
    )
    name = name or " + ".join(dict.fromkeys(plan.name for plan in plans))
    kind = ", then ".join(dict.fromkeys(plan.kind for plan in plans))
    return Plan(curve, float(ends[-1]), name, kind, notes, passages)


@kinds_checked
def round_trip(plan: Plan) -> Plan:
    """Return a plan followed by itself run backwards: a closed motion of twice the duration."""
    curve = Chain((plan.curve,) * 2, np.array([0.0, 0.5, 1.0]), (False, True))
    there = [Passage(0.5 * passage.t, passage.locus) for passage in plan.passages]
    back = [Passage(1.0 - passage.t, passage.locus) for passage in reversed(there)]
    passages = (*there, *back)
    name = f"{plan.name}, there and back"
    return Plan(curve, 2 * plan.duration, name, plan.kind, plan.notes, passages)


def shared_time(waypoints: Array, geometry: Geometry | Design | None = None) -> Array:
    """Return instants in [0, 1] for waypoints (n, 4), by the roots of their distances.

    A turn counts as a length by `model.resizing.turn_length` of a robot, Appendix 4's for None.

    Raises:
        InvalidInput: If two waypoints in a row are the same.
    """
    steps = np.diff(waypoints, axis=0)
    turn = TURN_LENGTH if geometry is None else turn_length(geometry_of(geometry))
    length = np.hypot(np.linalg.norm(steps[:, PLACE], axis=1), turn * steps[:, 2])
    if not length.all():
        number = int(np.argmin(length)) + 1
        raise InvalidInput("poses", f"waypoints {number} and {number + 1} are the same")
    # By the root of the length the spline swings out least; its ends also have to come to rest.
    share = np.sqrt(length)
    if len(share) > 1:
        share[[0, -1]] *= 1.3
    ends = np.concatenate([[0.0], np.cumsum(share)])
    return ends / ends[-1]


def _pose(values: ArrayLike, argument: str) -> Array:
    return _finite(as_vectors(values, argument), argument, (4,))


def _finite(values: Array, argument: str, shape: tuple[int, ...]) -> Array:
    if values.shape != shape:
        raise InvalidInput(argument, f"the shape has to be {shape}, not {values.shape}")
    if not np.isfinite(values).all():
        raise InvalidInput(argument, "all numbers have to be finite")
    return np.array(values)
