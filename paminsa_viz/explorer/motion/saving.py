"""A described motion as plain data for the tab's store and share codes, read with every check."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any

from paminsa_viz.explorer.motion.description import MOST_WAYPOINTS, Kind, Motion, Pose, Timing
from paminsa_viz.explorer.motion.ranges import require_possible
from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import PRESET, MotionLimits, Profile

_POSES = ("start", "goal", "center")
_NUMBERS = ("height", "radius", "duration", "rate")
_DEFAULT = Motion()


def described(motion: Motion) -> dict[str, Any]:
    """Return what differs from the motion at the start; nothing for a motion from a file."""
    if motion.kind is Kind.TABLE:
        return {}
    found: dict[str, Any] = {}
    for item in fields(Motion):
        value = getattr(motion, item.name)
        if item.name == "table" or value == getattr(_DEFAULT, item.name):
            continue
        if isinstance(value, Kind | Profile | Timing):
            value = value.value
        elif isinstance(value, MotionLimits):
            value = {limit.name: getattr(value, limit.name) for limit in fields(value)}
        found[item.name] = value
    return found


def motion_of(data: dict[str, Any]) -> Motion:
    """Read what `described` returned.

    Raises:
        PaminsaError: If a value is not possible.
        ValueError, LookupError, TypeError, AttributeError: If it is something else.
    """
    known: dict[str, Any] = {name: _number(data[name]) for name in _NUMBERS if name in data}
    known |= {name: _pose(data[name]) for name in _POSES if data.get(name) is not None}
    for name, kind in (("kind", Kind), ("profile", Profile), ("timing", Timing)):
        if name in data:
            known[name] = kind(data[name])
    if "preset" in data:
        known["preset"] = str(data["preset"])
    if "back" in data:
        known["back"] = data["back"] is True
    if "waypoints" in data:
        known["waypoints"] = tuple(_pose(pose) for pose in data["waypoints"][: MOST_WAYPOINTS + 1])
    if "limits" in data:
        limits = data["limits"].items()
        known["limits"] = MotionLimits(**{k: None if v is None else _number(v) for k, v in limits})
    motion = Motion(**known)
    if motion.preset not in PRESET or motion.kind is Kind.TABLE:
        raise InvalidInput("saved state", "there is no such motion")
    require_possible(motion)
    return motion


def _pose(values: Any) -> Pose:
    x, y, theta, z = (_number(value) for value in values)
    return (x, y, theta, z)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InvalidInput("saved state", "a number is needed where there is none")
    return float(value)
