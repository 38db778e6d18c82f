"""Solids that stand for drawn bodies, and the bodies they belong to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Final

import numpy as np

from paminsa_viz.clearance.nearest import BOX, CAPSULE, CYLINDER, PRISM
from paminsa_viz.model.arrays import Array

WORLD: Final = "world"
"""Frame of the bodies that do not move; the other frames are `placement.BODIES`."""

FIXED: Final = np.eye(3)
ALONG_X: Final = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Turns a solid's z axis to x."""

ALONG_Y: Final = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Turns a solid's z axis to y."""

OVER: Final = np.diag([1.0, -1.0, -1.0])
"""Turns a solid over, about x."""


@dataclass(frozen=True, eq=False)
class Primitive:
    """A capsule, box, cylinder or prism in the frame of its body; axis along its own z.

    Attributes:
        kind: `CAPSULE`, `BOX`, `CYLINDER` or `PRISM` of `nearest`.
        size: Half extents (3,) [m]: 0, 0 and half the length of a capsule's core; half sides of a
            box; radius twice and half height of a cylinder; half extents of a prism.
        radius: Radius of a capsule, 0 for others [m].
        corners: Corners of a prism, counter-clockwise, (n, 2) [m]; (0, 2) for others.
        rotation: (3, 3) turns its own axes into its body's.
        center: (3,) in its body's frame [m].
        joint: The paper's number of the joint that the solid goes around, 0 for none.
    """

    kind: int
    size: Array
    radius: float
    corners: Array
    rotation: Array
    center: Array
    joint: int = 0

    def moved(self, place: Array, rotation: Array = FIXED) -> Primitive:
        """Return the solid after a turn about its body's origin and a shift [m]."""
        return Primitive(
            self.kind, self.size, self.radius, self.corners, rotation @ self.rotation,
            rotation @ self.center + place, self.joint,
        )  # fmt: skip

    def times(self, scale: float) -> Primitive:
        """Return the solid enlarged about its body's origin."""
        return Primitive(
            self.kind, scale * self.size, scale * self.radius, scale * self.corners, self.rotation,
            scale * self.center, self.joint,
        )  # fmt: skip

    @cached_property
    def extent(self) -> Array:
        """Least and largest coordinates of the solid in its body's frame, (2, 3) [m]."""
        size = self.size
        if self.kind == CYLINDER:
            across = np.hypot(self.rotation[:, 0], self.rotation[:, 1])
            half = size[0] * across + size[2] * np.abs(self.rotation[:, 2])
        elif self.kind == PRISM:
            flat = self.corners @ self.rotation[:, :2].T
            ends = size[2] * np.abs(self.rotation[:, 2])
            return np.stack([flat.min(axis=0) - ends, flat.max(axis=0) + ends]) + self.center
        else:
            half = np.abs(self.rotation) @ size + self.radius
        return np.stack([self.center - half, self.center + half])

    @cached_property
    def rod(self) -> Array:
        """A capsule about the solid: two ends in the body's frame, and its radius (7,) [m]."""
        half = self.size.copy()
        axis = int(np.argmax(half))
        rest = np.delete(half, axis)
        along = half[axis] * self.rotation[:, axis]
        radius = float(np.hypot(rest[0], rest[1]))
        if self.kind == CAPSULE:
            radius = self.radius
        elif self.kind == CYLINDER:
            if axis == 2:
                radius = float(half[0])
            else:
                along, radius = np.zeros(3), float(np.hypot(half[0], half[2]))
        return np.array([*(self.center - along), *(self.center + along), radius])


NO_CORNERS: Final = np.zeros((0, 2))


def capsule(
    start: Sequence[float] | Array, end: Sequence[float] | Array, radius: float
) -> Primitive:
    """Return a capsule about the segment between two points of its body [m]."""
    first, second = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(second - first))
    axis = (second - first) / length if length > 0 else np.array([0.0, 0.0, 1.0])
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    rotation = np.stack([side, np.cross(axis, side), axis], axis=1).astype(np.float64)
    middle = (first + second) / 2
    return Primitive(
        CAPSULE,
        np.array([0.0, 0.0, length / 2]),
        radius,
        NO_CORNERS,
        rotation.astype(np.float64),
        middle,
    )


def box(
    low: Sequence[float] | Array, high: Sequence[float] | Array, rotation: Array = FIXED
) -> Primitive:
    """Return a box between two corners, turned about its body's origin [m]."""
    first, second = np.asarray(low, float), np.asarray(high, float)
    middle = rotation @ (first + second) / 2
    return Primitive(BOX, (second - first) / 2, 0.0, NO_CORNERS, rotation, middle)


def cylinder(
    radius: float,
    low: float,
    high: float,
    place: Sequence[float] | Array = (0.0, 0.0, 0.0),
    rotation: Array = FIXED,
    joint: int = 0,
) -> Primitive:
    """Return a cylinder from ``low`` to ``high`` along its axis through a place [m]."""
    middle = np.asarray(place, float) + rotation @ [0.0, 0.0, (low + high) / 2]
    size = np.array([radius, radius, (high - low) / 2])
    return Primitive(CYLINDER, size, 0.0, NO_CORNERS, rotation, middle, joint)


def prism(corners: Array, low: float, high: float, rotation: Array = FIXED) -> Primitive:
    """Return a prism over a convex polygon (n, 2), counter-clockwise, between two heights [m]."""
    flat = np.asarray(corners, float)
    half = np.array([*np.abs(flat).max(axis=0), (high - low) / 2])
    middle = rotation @ [0.0, 0.0, (low + high) / 2]
    return Primitive(PRISM, half, 0.0, flat, rotation, middle)


class BodyPart(Enum):
    """What a body belongs to; it decides which group a pair of bodies is in."""

    LEG = "leg"
    COUNTERWEIGHT = "counterweight"
    CARRIAGE = "carriage"
    PLATFORM = "platform"
    PAYLOAD = "payload"
    FRAME = "frame"


@dataclass(frozen=True, eq=False)
class Body:
    """A body that a person knows by name, made of solids in one frame.

    Attributes:
        key: Short name, the same for the three legs, such as ``"b4"``.
        name: Name for people, such as "B4 of leg 2".
        frame: Name of its frame, of `placement.BODIES`, or `WORLD`.
        part: What it belongs to.
        leg: Number of its leg, 0 for none.
        solids: What it is made of.
        carrier: Key of the body that it is mounted on, or "".
        joints: Joints around which solids of other bodies may overlap with it: it is mounted
            around them, or their pins.
    """

    key: str
    name: str
    frame: str
    part: BodyPart
    leg: int
    solids: tuple[Primitive, ...]
    carrier: str = ""
    joints: tuple[int, ...] = ()
