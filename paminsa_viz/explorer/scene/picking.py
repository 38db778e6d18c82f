"""Which part of the robot a click on one of its bodies means."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.explorer.state.inspector import PartKind, RobotPart
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematics import Configuration
from paminsa_viz.model.parameters import PANTOGRAPH

NEAR: Final = 0.022
"""A click this near to the center of a joint means the joint, for the prototype's bodies [m]."""

_JOINTS: Final[dict[str, tuple[int, ...]]] = {
    "b3": (4, 3, 7), "b4": (9, 4, 5), "b7": (8, 7), "b8": (8, 9), "shaft": (3, 2),
    "slider": (8,), "swivel": (5,),
}  # fmt: skip
"""Joints of the bodies of a leg."""

_BARS: Final = {bar: bar for bar in PANTOGRAPH} | {"shaft": "b2", "guide": "b10"}

PICKED: Final = ("m1", "m2", "m3", "m4", "carriage")
"""Bodies outside the legs that can be clicked."""


def can_be_picked(body: str) -> bool:
    """Whether a click on a body means a part."""
    return body in PICKED or body.rpartition("/")[2] in (*_BARS, *_JOINTS)


def picked(
    configuration: Configuration, body: str, origin: ArrayLike, direction: ArrayLike
) -> RobotPart | None:
    """Return the part that a click means.

    Args:
        configuration: Where the robot is, of shape ().
        body: What was hit, such as ``leg1/b4``.
        origin: (3,) where the ray begins [m].
        direction: (3,) where it goes.

    Returns:
        The joint that the ray passes near to, else the bar or motor that the body is; None if the
        body is none of them.
    """
    ray = np.asarray(origin, float), np.asarray(direction, float)
    if not np.isfinite(ray).all() or not ray[1].any() or not can_be_picked(body):
        return None
    points = configuration.points
    if body in ("m1", "m2", "m3"):
        return RobotPart(PartKind.MOTOR, body.upper(), int(body[1]) - 1)
    if body == "m4":
        return RobotPart(PartKind.MOTOR, "M4", None)
    if body == "carriage":  # it holds the arms B1, at whose tips the joints 2 are
        tips = points[2]
        centers = tips * [0.0, 0.0, 1.0]
        distance = [_distance(ray, (c + t) / 2) for c, t in zip(centers, tips, strict=True)]
        if _distance(ray, centers[0]) < min(distance):
            return RobotPart(PartKind.MOTOR, "M4", None)
        return RobotPart(PartKind.BAR, "b1", int(np.argmin(distance)))
    leg, kind = int(body[3]) - 1, body.rpartition("/")[2]
    reach = NEAR * configuration.geometry.body_scale
    near = {joint: _distance(ray, points[joint][leg]) for joint in _JOINTS.get(kind, ())}
    joint = min(near, key=near.__getitem__, default=None)
    if joint is not None and (kind not in _BARS or near[joint] < reach):
        return RobotPart(PartKind.JOINT, str(joint), leg)
    return RobotPart(PartKind.BAR, _BARS[kind], leg)


def _distance(ray: tuple[Array, Array], place: Array) -> float:
    """Return how far a place is from a ray's line [m]."""
    origin, direction = ray
    along = direction / np.linalg.norm(direction)
    away = place - origin
    return float(np.linalg.norm(away - along * (away @ along)))
