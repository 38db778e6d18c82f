"""Errors from the drives at the robot's pose, for the panel and the scene alike."""

from __future__ import annotations

from functools import lru_cache

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion.description import Pose
from paminsa_viz.model import DriveAccuracy, Geometry
from paminsa_viz.precision.drive_errors import Bound, DriveErrors, drive_errors


def shown_errors(frame: Frame) -> DriveErrors:
    """Return the errors at the pose where the robot is shown."""
    x, y, theta, z = frame.configuration.pose.tolist()
    design = frame.shown_design
    return _errors(design.geometry, design.accuracy, (x, y, theta, z))


@lru_cache(maxsize=8)
def _errors(geometry: Geometry, accuracy: DriveAccuracy, pose: Pose) -> DriveErrors:
    return drive_errors(geometry, accuracy, pose)


def no_bound(found: DriveErrors) -> str:
    """Return why the errors at a pose have no bound, or an empty text."""
    bound = Bound(int(found.bound))
    return "" if bound is Bound.OK else bound.reason(int(found.leg))
