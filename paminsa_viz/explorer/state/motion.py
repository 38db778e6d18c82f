"""A motion as plain data: what is possible, how it is saved, played and plotted."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from typing import Any, Literal

import msgspec

from paminsa_viz.explorer.state.settings import (
    MILLIMETERS,
    Settings,
    changed_data,
    followed,
    setting,
    setting_fields,
)
from paminsa_viz.model import Geometry, InvalidInput
from paminsa_viz.model.arrays import Pose
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.resizing import length_ratio, radius_ratio
from paminsa_viz.plots.series import FigureKind, SeriesKind
from paminsa_viz.trajectory import (
    PRESET,
    PRESETS,
    MotionLimits,
    Profile,
    Trajectory,
)

MOST_WAYPOINTS = 40
LENGTHS = (1e-4, 10.0)
"""Smallest and largest radius or height of a motion [m]."""

FARTHEST = 1e3
"""Largest coordinate of a pose of a motion [m, rad]."""

LARGEST_LIMIT = 1e6
"""Largest limit of a shortest duration, in its SI unit."""

MOST_SAMPLES = 20_000
"""Samples of one motion on the page; a longer motion is sampled less often."""


class Kind(Enum):
    """How a motion is made."""

    PRESET = "preset"
    MOVE = "move"
    LINE = "line"
    ARCH = "arch"
    WAYPOINTS = "waypoints"
    CIRCLE = "circle"
    TABLE = "table"

    @property
    def has_ends(self) -> bool:
        """Whether it runs from one pose to another."""
        return self in (Kind.MOVE, Kind.LINE, Kind.ARCH)

    @property
    def has_law(self) -> bool:
        """Whether a time law can be chosen for it."""
        return self.has_ends or self is Kind.CIRCLE

    @property
    def can_cross(self) -> bool:
        """Whether it can be planned through type-2 singularities."""
        return self in (Kind.MOVE, Kind.LINE, Kind.WAYPOINTS)


class Timing(Enum):
    """What decides on the duration of a planned motion."""

    OWN = "its own"
    """The preset's own duration; other motions take `Motion.duration`."""
    GIVEN = "given"
    SHORTEST = "shortest"
    """The time-optimal law on the path."""
    STRETCHED = "stretched"
    """The shortest that the motion's own law can be stretched to."""

    @property
    def keeps_limits(self) -> bool:
        """Whether the duration follows from limits."""
        return self in (Timing.SHORTEST, Timing.STRETCHED)


DEFAULT_LIMITS = MotionLimits(
    speed=1.0,
    turn_speed=math.radians(360.0),
    acceleration=10.0,
    turn_acceleration=math.radians(3600.0),
    torque=6.0,
    force=400.0,
)
"""Limits to begin with, within what Appendix 4's robot can do; none of them is the paper's. See
`sized_motion` for robots of other lengths."""


@dataclass(frozen=True)
class Motion:
    """A motion of the platform. Numbers of a kind that is not chosen are kept, not used.

    Attributes:
        kind: How it is made.
        preset: Key of the preset.
        start, goal: Ends of a move, a line (which keeps theta) or an arch; None for ends next to
            the middle of the workspace.
        waypoints: Poses to pass.
        center: Pose of a circle's center, or None for the middle of the workspace.
        timing: What decides on the duration.
        limits: What the shortest duration keeps.
        table: Samples from a file; compared by identity.
        height, radius, duration, deviation, rate: Of an arch and a circle [m], given [s], of the
            path for the crossing of singularities [m], and of samples [1/s].
    """

    kind: Kind = Kind.PRESET
    preset: str = PRESETS[0].key
    start: Pose | None = None
    goal: Pose | None = None
    height: float = setting(
        0.1, "Height [mm]", "How far the platform rises above the higher end",
        range=(0.0, LENGTHS[1]), unit=MILLIMETERS,
    )  # fmt: skip
    waypoints: tuple[Pose, ...] = ()
    center: Pose | None = None
    radius: float = setting(
        0.1, "Radius [mm]", "In the plane of x and y", range=LENGTHS, unit=MILLIMETERS
    )
    profile: Profile = setting(
        Profile.QUINTIC, "Time law", "How the motion runs in time",
        options={one.value.replace("s-c", "S-c"): one for one in Profile},
    )  # fmt: skip
    timing: Timing = Timing.OWN
    duration: float = setting(
        1.5, "T [s]", "One way, if the motion returns to its start", range=(0.05, 600.0),
        step=0.05,
    )  # fmt: skip
    limits: MotionLimits = field(default=DEFAULT_LIMITS)
    cross: bool = setting(
        False, "Pass singularities",
        "Plan the time law so that torques stay bounded where the path crosses a type-2 "
        "singularity, and within the limits",
    )  # fmt: skip
    deviation: float = setting(
        0.0, "Path may change by [mm]",
        "Along the escape twist, where no time law will do on the path itself; 0: not at all",
        range=(0.0, 0.1), unit=MILLIMETERS,
    )  # fmt: skip
    back: bool = setting(False, "Return to start", "A closed motion")
    table: Trajectory | None = None
    rate: float = setting(
        1000.0, "Samples [1/s]", "A motion has at most 20,000 samples here",
        range=(50.0, 10_000.0), step=50.0,
    )  # fmt: skip

    @property
    def crosses(self) -> bool:
        """Whether it is planned through singularities; not every kind can be."""
        return self.cross and self.kind.can_cross


_LIMITS_FOLLOWING = {"torque": (4, (1e-30, LARGEST_LIMIT)), "force": (3, (1e-30, LARGEST_LIMIT))}
"""Powers of the lengths: torques and forces of robots of one density, at rest and at accelerations
beside gravity."""


def sized_motion(motion: Motion, was: Geometry, now: Geometry) -> Motion:
    """Return a motion whose height, radius and limits of actuators follow the robot's lengths.

    Those that a person has chosen stay. What `Motion` has at first would take a small robot out of
    its workspace, and a large one cannot even be held within it. A circle has room beside R_b, as
    that of the presets has.

    Args:
        motion: The motion.
        was: Lengths that it was for.
        now: Lengths that it is for.
    """
    first, ratios = Motion(), (length_ratio(was), length_ratio(now))
    across = (radius_ratio(was), radius_ratio(now))
    found = followed(motion, first, {"height": (1, LENGTHS)}, *ratios)
    found = followed(found, first, {"radius": (1, LENGTHS)}, *across)
    limits = followed(motion.limits, first.limits, _LIMITS_FOLLOWING, *ratios)
    return found if limits == found.limits else replace(found, limits=limits)


def require_possible(motion: Motion) -> None:
    """Check the numbers of a motion.

    Raises:
        InvalidInput: If one is out of its range.
    """
    for name, one in setting_fields(Motion).items():
        low, high = one.range
        value = getattr(motion, name)
        if low is not None and high is not None and not low <= value <= high:
            raise InvalidInput(name, f"{low:g} to {high:g} is possible, not {value:g}")
    if len(motion.waypoints) > MOST_WAYPOINTS:
        raise InvalidInput("waypoints", f"at most {MOST_WAYPOINTS} are possible")
    for pose in filter(None, (motion.start, motion.goal, motion.center, *motion.waypoints)):
        for name, value in zip(COORDINATES, pose, strict=True):
            if not abs(value) <= FARTHEST:
                problem = f"up to {FARTHEST:g} m or rad in size is possible, not {value:g}"
                raise InvalidInput(name, problem)
    for item in fields(motion.limits):
        value = getattr(motion.limits, item.name)
        if value is not None and not value <= LARGEST_LIMIT:
            raise InvalidInput(item.name, f"at most {LARGEST_LIMIT:g} is possible")


_FORMER_NAMES = {"centre": "center"}
"""Names that fields had when older states and share codes were saved."""


def motion_data(motion: Motion) -> dict[str, Any]:
    """Return what differs from the motion at the start; nothing for a motion from a file."""
    if motion.kind is Kind.TABLE:
        return {}
    return changed_data(replace(motion, table=None), Motion())


def motion_from_data(data: dict[str, Any]) -> Motion:
    """Read what `motion_data` returned.

    Raises:
        PaminsaError: If a value is not possible.
        msgspec.ValidationError, TypeError, AttributeError: If it is something else.
    """
    data = {_FORMER_NAMES.get(name, name): value for name, value in data.items()}
    limits = msgspec.convert(data.pop("limits", vars(DEFAULT_LIMITS)), dict[str, float | None])
    motion = replace(msgspec.convert(data, Motion), limits=MotionLimits(**limits))
    if motion.preset not in PRESET or motion.kind is Kind.TABLE:
        raise InvalidInput("saved state", "there is no such motion")
    require_possible(motion)
    return motion


SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0)
"""How many times as fast as true time a motion can be played."""


PLOTS: dict[str, SeriesKind] = {
    "torques and force": "torques",
    "difference to engine": "differences",
    "parts of one actuator": "breakdown",
    "power": "power",
    "energy": "energy",
    "joint forces": "loads",
    "clearance": "clearance",
    "pose": "pose",
    "speed": "speed",
    "acceleration": "acceleration",
    "simulation: error": "errors",
    "simulation: torques": "commands",
}
"""What can be plotted, by what a person reads."""

FIGURE_OF: dict[SeriesKind, FigureKind] = {
    "differences": "comparison",
    "speed": "pose",
    "acceleration": "pose",
    "errors": "tracking",
    "commands": "tracking",
}
"""The figure that holds what is plotted, where it has another name."""

SIMULATED: tuple[SeriesKind, ...] = ("errors", "commands")
"""What is plotted of a simulation."""

Engine = Literal["MuJoCo", "Pinocchio"]

COMPARED: tuple[SeriesKind, ...] = ("torques", "power", "energy")
"""What is plotted of a reference and of the formulas as published as well."""


@dataclass(frozen=True)
class Playback:
    """The instant that is shown, and whether it moves on.

    Attributes:
        time: Since the motion's start [s].
        playing: Whether it moves on.
        following: Whether the robot is where the motion is at ``time``; it does not once a
            person has moved it, until the motion is played or scrubbed again.
        speed: Times as fast as true time.
        loop: Whether the motion starts again at its end.
        piece: The piece of time that the motion plots show (from, to) [s], None for all of it.
    """

    time: float = 0.0
    playing: bool = False
    following: bool = False
    speed: float = 1.0
    loop: bool = False
    piece: tuple[float, float] | None = None


def advanced(playback: Playback, passed: float, duration: float) -> Playback:
    """Return a playback after some time has passed.

    Args:
        playback: A playback.
        passed: True time [s].
        duration: Of the motion [s]; without a loop, it stops there.
    """
    if not playback.playing:
        return playback
    time = playback.time + passed * playback.speed
    if time < duration:
        return replace(playback, time=time)
    if playback.loop and duration > 0:
        return replace(playback, time=time % duration)
    return replace(playback, time=duration, playing=False)


def started(playback: Playback, duration: float) -> Playback:
    """Return a playback that runs: from where it is, or from the start if it is at the end."""
    time = playback.time if playback.time < duration else 0.0
    return replace(playback, time=time, playing=True, following=True)


@dataclass(frozen=True)
class PlotView(Settings):
    """How a motion is shown.

    Attributes:
        plot: What the curves show.
        actuator: Index 0 to 3 of the actuator whose parts are plotted.
        published: Whether the formulas as published are plotted next to the corrected ones.
        engine: Whether an engine's torques are plotted on the formulas'.
        checker: Which engine's.
        color: Index 0 to 3 of the actuator by whose torque the path is colored.
    """

    plot: SeriesKind = "torques"
    actuator: int = 0
    published: bool = False
    engine: bool = False
    checker: Engine = "MuJoCo"
    color: int = 0

    @property
    def possible(self) -> bool:
        return 0 <= self.actuator < 4 and 0 <= self.color < 4

    @property
    def needs_engine(self) -> bool:
        """Whether an engine's torques are part of what is shown."""
        return self.plot == "differences" or (self.plot == "torques" and self.engine)


@dataclass(frozen=True)
class PointEditing:
    """Which pose of a motion is edited, and how.

    Attributes:
        selected: Its place in the list of `points`; beyond the end, the last one.
        drawing: Whether a click on a map adds a waypoint, where it otherwise moves the robot.
    """

    selected: int = 0
    drawing: bool = False
