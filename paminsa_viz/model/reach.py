"""Which poses the robot can take, and where not, which leg and which limit forbid it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import UnreachablePose
from paminsa_viz.model import backend, measures, robot
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, Pose, as_vectors
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.parameters import SMALLEST
from paminsa_viz.model.status import Status, WithStatus
from paminsa_viz.units import MM, format_pose

LEAST_MARGIN = backend.Formula(measures.least_margin, 2)
"""The least margin of all legs and limits [m], and which one it is."""


HOME_DROP = 0.5
"""How far below the guides the platform is at home, as a share of l_B4 + l_B8."""


class Limit(Status):
    """Why a pose cannot be taken, or a torque not be given.

    Attributes:
        label: Short name for the head of a column.
        noun: What a motion comes near to, such as "a stretched pantograph".
        explanation: What it means, as a clause.
    """

    label: str
    noun: str
    explanation: str

    OK = 0, "ok", "no limit", "the pose can be taken", "no value"
    NOT_FINITE = (
        1, "finite", "no number", "the pose is not finite, or too large to compute with",
        "out of reach",
    )  # fmt: skip
    STRETCHED = (
        2, "stretch", "a stretched pantograph",
        "the pantograph is over-stretched: joints 8 and 5 are too far apart",
        "out of reach: {leg} over-stretched",
    )  # fmt: skip
    FOLDED = (
        3, "fold", "a folded pantograph",
        "the pantograph is folded too far: joints 8 and 5 are too close together",
        "out of reach: {leg} folded too far",
    )  # fmt: skip
    GUIDE = (
        4, "guide", "the end of a guide", "joint 8 would leave its guide",
        "out of reach: joint 8 of {leg} would leave its guide",
    )  # fmt: skip
    AXIS = (
        5, "axis", "a leg axis", "joint 5 is on its leg axis",
        "out of reach: joint 5 of {leg} on its leg axis",
    )  # fmt: skip
    SINGULAR = (
        6, "singular", "a singular pose", "the pose is singular, torques have no bound there",
        "singular: no torque holds it",
    )  # fmt: skip

    def __new__(cls, code: int, label: str, noun: str, explanation: str, reason: str) -> Limit:
        found = int.__new__(cls, code)
        found._value_ = code
        found.label, found.noun, found.explanation = label, noun, explanation
        found._reason = reason
        return found


class OfLimits(WithStatus):
    """A result whose ``status`` is a `Limit`."""

    KINDS = Limit


MARGINS: tuple[Limit, ...] = (Limit.STRETCHED, Limit.FOLDED, Limit.GUIDE, Limit.AXIS)
"""Limits in the order of the last axis of `Reach.margins`."""


@dataclass(frozen=True, eq=False)
class Reach(OfLimits):
    """Whether poses of batch shape (...) can be taken.

    Attributes:
        status: (...) values of `Limit`.
        leg: (...) index of the leg that is worst off, 0 to 2; -1 where the pose can be taken.
        excess: (...) by how much that leg's limit is exceeded, 0 where it is not [m].
        margins: (..., 3 legs, 4 limits) distance to every limit, negative beyond it [m]; limits in
            the order of `MARGINS`: |85| below l_B4 + l_B8, |85| above |l_B4 - l_B8|, joint 8
            within its stroke, joint 5 off the leg axis.
    """

    status: NDArray[np.uint8]
    leg: NDArray[np.int8]
    excess: Array
    margins: Array

    def words(self) -> NDArray[np.str_]:
        """Return the status as words for tables, such as ``ok`` or ``stretched:leg2``, (...)."""
        return status_words(self.status, self.leg)

    def explanation(self, at: tuple[int, ...] = ()) -> str:
        """Return why the pose of an index cannot be taken: which limit, which leg, by how much."""
        text, leg = Limit(int(self.status[at])).explanation, int(self.leg[at])
        if leg < 0:
            return text
        return f"{text} (leg {leg + 1}, by {_millimeters(float(self.excess[at]))})"


def status_words(status: ArrayLike, leg: ArrayLike = -1) -> NDArray[np.str_]:
    """Return status codes as words; the leg is added, by the paper's number, where there is one."""
    words = np.array([limit.word for limit in Limit])[np.asarray(status)]
    legs = np.array([":leg1", ":leg2", ":leg3", ""])[np.asarray(leg)]
    return np.char.add(words, legs)


@of_geometry
def check_reach(geometry: Geometry, pose: ArrayLike) -> Reach:
    """Say for each pose whether the robot can take it, with either branch of the knee.

    Args:
        geometry: Lengths and limits.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    pose = as_vectors(pose, "pose")
    x, y, theta, z = np.moveaxis(pose, -1, 0)[..., None]
    with np.errstate(all="ignore"):
        legs = measures.leg_margins(
            mechanism(geometry),
            np.array(robot.AXIS_X), np.array(robot.AXIS_Y),
            x, y, np.cos(theta), np.sin(theta), z,
        )  # fmt: skip
    margins = np.stack(np.broadcast_arrays(*legs), axis=-1)
    flat = margins.reshape(*pose.shape[:-1], 12)
    which = np.argmin(flat, axis=-1)
    worst = np.take_along_axis(flat, which[..., None], axis=-1)[..., 0]
    status, leg = decode(np.asarray(worst), which)
    return Reach(status, leg, np.where(leg >= 0, 0.0 - worst, 0.0), margins)


def decode(worst: Array, which: ArrayLike) -> tuple[NDArray[np.uint8], NDArray[np.int8]]:
    """Turn the least margin and its tag (see `measures.least_margin`) into status and leg."""
    if (worst > 0).all():
        return np.zeros(worst.shape, np.uint8), np.full(worst.shape, -1, np.int8)
    tag = np.asarray(which).astype(np.uint8)
    # A guide may be used to its end; on the other limits the mechanism is singular.
    bad = (worst < 0) | ((worst == 0) & (tag % 4 != 2))
    finite = np.isfinite(worst)
    status = np.where(bad, _TAG_LIMIT[tag], np.uint8(Limit.OK))
    leg = np.where(bad & finite, _TAG_LEG[tag], np.int8(-1))
    status[~finite] = Limit.NOT_FINITE
    return status, leg


_TAG_LIMIT = np.array(MARGINS * 3, dtype=np.uint8)
_TAG_LEG = np.repeat(np.arange(3, dtype=np.int8), 4)


def reach_status(geometry: Geometry, pose: Array) -> tuple[NDArray[np.uint8], NDArray[np.int8]]:
    """Return status and leg alone for a list of poses (n, 4): the fast way for batches."""
    worst, which = backend.over_list(LEAST_MARGIN, mechanism(geometry), pose).T
    return decode(worst, which)


def workspace_radius(geometry: Geometry) -> float:
    """Return the radius of the smallest circle about the origin that holds every position [m]."""
    return float(measures.workspace_circle(mechanism(geometry)))


def workspace_height(geometry: Geometry) -> float:
    """Return the largest |z_5| that the platform reaches at the center [m]."""
    bars = geometry.crank_length + geometry.coupler_length
    return float(np.sqrt(bars**2 - geometry.home_span**2))


@of_geometry
def home_pose(geometry: Geometry) -> Pose:
    """Return a pose (x, y, theta, z) at the center, far from all limits [m, m, rad, m]."""
    bars = geometry.crank_length + geometry.coupler_length
    drop = min(HOME_DROP * bars, 0.75 * workspace_height(geometry))
    z5 = -drop if geometry.knee is KneeBranch.LOWER else drop
    # To a millimeter; finer where that would move it by more than a twentieth of its depth.
    digits = max(3, 1 - math.floor(math.log10(max(drop, SMALLEST))))
    return (0.0, 0.0, 0.0, round(z5 - geometry.platform_joint_height, digits))


@of_geometry
def require_reachable(geometry: Geometry, pose: ArrayLike) -> None:
    """Raise an error unless the robot can take every pose.

    Args:
        geometry: Lengths and limits.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].

    Raises:
        UnreachablePose: Of the first pose that the robot cannot take; says which leg, which limit,
            by how much.
        InvalidInput: If the pose has another shape or is not real.
    """
    result = check_reach(geometry, pose)
    if result.ok.all():
        return
    first = tuple(np.argwhere(~result.ok)[0].tolist())
    where = np.asarray(pose, dtype=float)[first]
    limit = Limit(int(result.status[first]))
    leg, excess = int(result.leg[first]) + 1, float(result.excess[first])
    shown = format_pose(where, 5, ascii_only=True)
    text = f"pose {shown} cannot be taken: {result.explanation(first)}"
    raise UnreachablePose(tuple(map(float, where)), leg, limit.word, excess, text)


def _millimeters(length: float) -> str:
    return f"{MM * length:.2f} mm" if abs(length) < 1e4 else f"{MM * length:.3g} mm"
