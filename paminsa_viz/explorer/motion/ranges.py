"""How large the numbers of a motion may be on the page."""

from __future__ import annotations

from dataclasses import fields

from paminsa_viz.explorer.motion.description import DURATIONS, MOST_WAYPOINTS, RATES, Motion
from paminsa_viz.model import InvalidInput

LENGTHS = (1e-4, 10.0)
"""Smallest and largest radius or height of a motion [m]."""

FARTHEST = 1e3
"""Largest coordinate of a pose of a motion [m, rad]."""

LARGEST_LIMIT = 1e6
"""Largest limit of a shortest duration, in its SI unit."""


def require_possible(motion: Motion) -> None:
    """Check the numbers of a motion.

    Raises:
        InvalidInput: If one is out of its range.
    """
    for name, (low, high) in (
        ("duration", DURATIONS),
        ("rate", RATES),
        ("radius", LENGTHS),
        ("height", (0.0, LENGTHS[1])),
    ):
        value = getattr(motion, name)
        if not low <= value <= high:
            raise InvalidInput(name, f"{low:g} to {high:g} is possible, not {value:g}")
    if len(motion.waypoints) > MOST_WAYPOINTS:
        raise InvalidInput("waypoints", f"at most {MOST_WAYPOINTS} are possible")
    for pose in filter(None, (motion.start, motion.goal, motion.center, *motion.waypoints)):
        if not all(abs(value) <= FARTHEST for value in pose):
            raise InvalidInput("pose", "it is too far away")
    for item in fields(motion.limits):
        value = getattr(motion.limits, item.name)
        if value is not None and not value <= LARGEST_LIMIT:
            raise InvalidInput(item.name, f"at most {LARGEST_LIMIT:g} is possible")
