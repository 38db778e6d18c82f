"""Errors of the platform's pose from errors of the drives: linear, and by exact kinematics.

With the actuators off by at most d_j (`DriveAccuracy.half_widths`), the linear estimate of an error
is the sum of |J_ij| d_j. It is finite where the robot may jump into another assembly mode, so the
exact error is worked out as well: forward kinematics in the corners of the box q +- d, in the
assembly mode that is connected with the pose (Briot and Bonev, Mech. Mach. Theory 43 (2008) 445).
Where the box holds a singular position of the actuators, or one without a platform, there is no
bound, whatever the linear estimate says (Tannous, Caro and Goldsztejn, Mech. Mach. Theory 71 (2014)
93).

Heights separate: z = k (Z - l_B2) - l_B5, so that its error is k d_4, and x, y and theta depend on
the eight corners of M1..M3 alone. Z counts for the reach of the legs only.

The closure equations of M1..M3 are a cos theta - b sin theta = (R_b/R_pl) a with a and b functions
of the angles beta_k (see `kinematics.forward_kinematics`): the two assembly modes are apart exactly
where b^2 > ((R_b/R_pl)^2 - 1) a^2 and (a, b) is not zero. `_regular` proves that for the whole box
by a Taylor expansion with a bound of its remainder.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model import backend
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.kinematics import AXIS_ANGLES, LEG_AXES, wrap
from paminsa_viz.model.leg import leg_vector, mechanism
from paminsa_viz.model.reach import LEAST_MARGIN, Limit, check_reach, decode

CORNERS: Array = np.array(list(product((-1.0, 1.0), repeat=3)))
"""Corners of the box of M1..M3, (8, 3); the opposite of corner i is corner 7 - i."""
CORNERS.setflags(write=False)


class Bound(IntEnum):
    """Whether the errors at a pose are bounded, or why not."""

    OK = 0
    UNREACHABLE = 1
    SINGULAR = 2
    NOT_ASSEMBLED = 3
    SINGULARITY = 4
    LIMIT = 5

    @property
    def word(self) -> str:
        """The name used in tables and files."""
        return self.name.lower().replace("_", "-")

    def reason(self, leg: int = -1) -> str:
        """Return why there is no bound; ``leg`` is the index of the leg, -1 for none."""
        return _REASONS[self].format(leg=f"leg {leg + 1}" if leg >= 0 else "a leg")


_REASONS = {
    Bound.OK: "bounded",
    Bound.UNREACHABLE: "the pose is out of reach of {leg}",
    Bound.SINGULAR: "the pose is singular",
    Bound.NOT_ASSEMBLED: "within the drives' errors the robot cannot be assembled",
    Bound.SINGULARITY: "a singularity lies within the drives' errors",
    Bound.LIMIT: "within the drives' errors {leg} passes a limit of its reach",
}


@dataclass(frozen=True, eq=False)
class DriveErrors:
    """Errors at poses of batch shape (...), in the order (x, y, theta, z) of a pose.

    Attributes:
        pose: (..., 4) [m, m, rad, m].
        accuracy: Accuracy of the drives.
        linear: (..., 4) sum of |J_ij| d_j [m, m, rad, m]; NaN where the pose is out of reach or
            singular.
        worst: (..., 4) largest errors in the corners, by exact kinematics [m, m, rad, m]; NaN
            where there is no bound.
        rms: (..., 4) standard deviations to first order, for independent uniform errors
            [m, m, rad, m]; NaN as ``linear``.
        linear_horizontal, horizontal, rms_horizontal: (...) the same of the distance in the plane
            [m].
        corners: (..., 8, 3) errors of x, y and theta in the corners `CORNERS` of M1..M3
            [m, m, rad]; NaN as ``worst``.
        bound: (...) values of `Bound`.
        leg: (...) index of the leg that is the reason, -1 for none.
    """

    pose: Array
    accuracy: DriveAccuracy
    linear: Array
    worst: Array
    rms: Array
    linear_horizontal: Array
    horizontal: Array
    rms_horizontal: Array
    corners: Array
    bound: NDArray[np.uint8]
    leg: NDArray[np.int8]

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Where the errors are bounded, (...)."""
        return self.bound == Bound.OK


def drive_errors(geometry: Geometry, accuracy: DriveAccuracy, pose: ArrayLike) -> DriveErrors:
    """Return the errors at poses.

    Args:
        geometry: Lengths of the mechanism.
        accuracy: Accuracy of its drives.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    pose = as_vectors(pose, "pose")
    flat, m = pose.reshape(-1, 4), mechanism(geometry)
    rows = backend.over_list(WRENCH_TORQUES, m, flat).T
    margin, which = backend.over_list(LEAST_MARGIN, m, flat).T
    status, leg = decode(margin, which)
    found = _errors(geometry, accuracy, flat, rows, margin, status, leg)
    return _shaped(found, accuracy, pose)


@lru_cache(maxsize=4)
def field_drive_errors(field: Field, accuracy: DriveAccuracy) -> DriveErrors:
    """Return the errors over a solved grid; those of the last few are kept."""
    pose = field.grid.poses()
    rows = field.solve(WRENCH_TORQUES).reshape(9, -1)
    status = np.where(field.status == Limit.SINGULAR, Limit.OK, field.status).astype(np.uint8)
    found = _errors(
        field.geometry, accuracy, pose.reshape(-1, 4), rows,
        field.margin.reshape(-1), status.reshape(-1), field.leg.reshape(-1),
    )  # fmt: skip
    return _shaped(found, accuracy, pose)


class _Flat(NamedTuple):
    """`DriveErrors` of a list of poses."""

    linear: Array
    worst: Array
    rms: Array
    linear_horizontal: Array
    horizontal: Array
    rms_horizontal: Array
    corners: Array
    bound: NDArray[np.uint8]
    leg: NDArray[np.int8]


def _shaped(found: _Flat, accuracy: DriveAccuracy, pose: Array) -> DriveErrors:
    shape = pose.shape[:-1]
    return DriveErrors(
        pose, accuracy, *(values.reshape((*shape, *values.shape[1:])) for values in found)
    )


@np.errstate(all="ignore")
def _errors(
    geometry: Geometry,
    accuracy: DriveAccuracy,
    pose: Array,
    rows: Array,
    margin: Array,
    status: NDArray[np.uint8],
    leg: NDArray[np.int8],
) -> _Flat:
    """Return the errors of a list of poses (n, 4) from J's rows (9, n) and the reach (n)."""
    half, deviation = np.array(accuracy.half_widths), np.array(accuracy.deviations)
    lift = geometry.magnification
    j = np.where(status == Limit.OK, rows, np.nan).reshape(3, 3, -1)
    singular = (status == Limit.OK) & ~np.isfinite(j).all(axis=(0, 1))
    j = np.where(singular, np.nan, j)
    shown = np.where(np.isnan(j[0, 0]), np.nan, 1.0)
    linear = np.stack([*np.einsum("ijn,j->in", np.abs(j), half[:3]), shown * lift * half[3]], -1)
    rms = np.sqrt(np.einsum("ijn,j->in", j**2, deviation[:3] ** 2))
    rms = np.stack([*rms, shown * lift * deviation[3]], -1)
    sideways = np.einsum("ijn,cj->inc", j[:2], CORNERS[4:] * half[:3])  # the others are opposite

    moved, assembled = _corner_errors(geometry, pose, half[:3])
    bound = np.where(_regular(geometry, pose, half[:3]), Bound.OK, Bound.SINGULARITY)
    bound[~assembled] = Bound.NOT_ASSEMBLED
    bound[singular] = Bound.SINGULAR
    bound[status != Limit.OK] = Bound.UNREACHABLE
    bound = bound.astype(np.uint8)
    why = np.where(bound == Bound.UNREACHABLE, leg, np.int8(-1))
    distance = np.hypot(moved[..., 0], moved[..., 1])
    turn = geometry.platform_radius * np.abs(moved[..., 2])
    # No margin shrinks by more than this: that of |85|, by k/(k-1) times joint 5's way.
    way = geometry.span_ratio * (distance + turn).max(axis=-1) + lift * half[3]
    near = (bound == Bound.OK) & ~(margin > way)
    if near.any():
        outside, which = _beyond_reach(geometry, pose[near], moved[near], lift * half[3])
        bound[near] = np.where(outside, Bound.LIMIT, Bound.OK)
        why[near] = np.where(outside, which, -1)
    kept = np.where(bound == Bound.OK, 1.0, np.nan)
    moved = kept[:, None, None] * moved
    return _Flat(
        linear,
        np.concatenate(
            [np.abs(moved).max(axis=-2), (kept * lift * half[3])[:, None]], axis=-1
        ),
        rms,
        np.hypot(sideways[0], sideways[1]).max(axis=-1),
        kept * distance.max(axis=-1),
        np.hypot(rms[:, 0], rms[:, 1]),
        moved,
        bound,
        why,
    )  # fmt: skip


class _Angles(NamedTuple):
    """Sines and cosines of beta_k, of gamma_k = beta_k - alpha_k, and of differences.

    Each (..., 3): ``sine`` and ``cosine`` of beta_{k+1} - beta_{k+2}.
    """

    sin_b: Array
    cos_b: Array
    sin_g: Array
    cos_g: Array
    sine: Array
    cosine: Array


_SIN_AXIS, _COS_AXIS = np.sin(AXIS_ANGLES), np.cos(AXIS_ANGLES)


def _angles(sin_b: Array, cos_b: Array) -> _Angles:
    s1, s2 = sin_b[..., [1, 2, 0]], sin_b[..., [2, 0, 1]]
    c1, c2 = cos_b[..., [1, 2, 0]], cos_b[..., [2, 0, 1]]
    return _Angles(
        sin_b,
        cos_b,
        sin_b * _COS_AXIS - cos_b * _SIN_AXIS,
        cos_b * _COS_AXIS + sin_b * _SIN_AXIS,
        s1 * c2 - c1 * s2,
        c1 * c2 + s1 * s2,
    )


def _headings(geometry: Geometry, pose: Array) -> tuple[Array, Array]:
    """Return sines and cosines of beta_k at poses (n, 4), each (n, 3)."""
    x, y, theta, _ = np.moveaxis(pose, -1, 0)[..., None]
    v = leg_vector(
        mechanism(geometry), LEG_AXES[:, 0], LEG_AXES[:, 1], x, y, np.cos(theta), np.sin(theta)
    )
    rho = np.sqrt(v.rho2)
    return v.dy / rho, v.dx / rho


def _modes(angles: _Angles) -> tuple[Array, Array]:
    """Return a and b of the closure equations, (...); see the module."""
    return (angles.sine * angles.sin_g).sum(axis=-1), (angles.sine * angles.cos_g).sum(axis=-1)


def _corner_errors(geometry: Geometry, pose: Array, half: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return errors of x, y and theta in the corners (n, 8, 3), and where all are assembled (n).

    In a corner the assembly mode is the one on the pose's side of the fold between the two.
    """
    ratio = geometry.base_radius / geometry.platform_radius
    sin_b, cos_b = _headings(geometry, pose)
    a, b = _modes(_angles(sin_b, cos_b))
    theta = pose[:, 2]
    side = np.sign(np.sin(theta + np.arctan2(b, a)))[:, None]

    sin_d, cos_d = CORNERS * np.sin(half), np.cos(half)
    s, c = sin_b[:, None, :], cos_b[:, None, :]
    turned = _angles(s * cos_d + c * sin_d, c * cos_d - s * sin_d)
    s, c = turned.sin_b, turned.cos_b
    a, b = _modes(turned)
    angle = side * np.arccos(ratio * a / np.hypot(a, b)) - np.arctan2(b, a)
    # s_k = sin b (x + p_x - e_x) - cos b (y + p_y - e_y) = 0 for the displacement of (x, y)
    p = angle[..., None] + AXIS_ANGLES
    px = pose[:, None, None, 0] + geometry.platform_radius * np.cos(p)
    py = pose[:, None, None, 1] + geometry.platform_radius * np.sin(p)
    px -= geometry.base_radius * LEG_AXES[:, 0]
    py -= geometry.base_radius * LEG_AXES[:, 1]
    right = c * py - s * px
    ss, cc, sc = (s * s).sum(axis=-1), (c * c).sum(axis=-1), (s * c).sum(axis=-1)
    rs, rc = (s * right).sum(axis=-1), (c * right).sum(axis=-1)
    det = ss * cc - sc * sc
    x, y = (cc * rs - sc * rc) / det, (sc * rs - ss * rc) / det
    along = c * (x[..., None] + px) + s * (y[..., None] + py)
    moved = np.stack([x, y, wrap(angle - theta[:, None])], axis=-1)
    return moved, np.isfinite(moved).all(axis=(-1, -2)) & (along > 0).all(axis=(-1, -2))


def _regular(geometry: Geometry, pose: Array, half: Array) -> NDArray[np.bool_]:
    """Return where the two assembly modes are apart in the whole box of M1..M3, (n).

    Each term of a and b is a product of two sines, sin(beta_i - beta_j) sin(beta_k - alpha_k) or
    with a cosine, so its second derivative along a step d is at most (d_1 + d_2 + d_3)^2.
    """
    ratio = geometry.base_radius / geometry.platform_radius
    v = _angles(*_headings(geometry, pose))
    a, b = _modes(v)
    before, after = [2, 0, 1], [1, 2, 0]
    # d n_{k} / d beta_{k+1} = cos(beta_{k+1} - beta_{k+2}), and minus that by beta_{k+2}
    slope_a = v.sine * v.cos_g + (v.cosine * v.sin_g)[:, before] - (v.cosine * v.sin_g)[:, after]
    slope_b = -v.sine * v.sin_g + (v.cosine * v.cos_g)[:, before] - (v.cosine * v.cos_g)[:, after]
    rest = 1.5 * half.sum() ** 2
    if ratio < 1.0:  # the modes meet only where a = b = 0
        weight = np.sqrt(1.0 - ratio**2)
        change_a, change_b = np.abs(slope_a) @ half + rest, np.abs(slope_b) @ half + rest
        return np.hypot(weight * a, b) > np.hypot(weight * change_a, change_b)
    weight = np.sqrt(ratio**2 - 1.0)
    apart = np.ones(len(pose), dtype=np.bool_)
    for sign in (1.0, -1.0):
        value = np.abs(b + sign * weight * a)
        change = np.abs(slope_b + sign * weight * slope_a) @ half + (1 + weight) * rest
        apart &= value > change
    return apart


def _beyond_reach(
    geometry: Geometry, pose: Array, moved: Array, lift: float
) -> tuple[NDArray[np.bool_], NDArray[np.int8]]:
    """Return where a corner of the whole box, M4's included, is out of reach (n), and its leg."""
    corners = np.repeat(pose[:, None, None, :], 2, axis=1).repeat(8, axis=2)
    corners[..., :3] += moved[:, None]
    corners[..., 3] += np.array([-lift, lift])[:, None]
    reach = check_reach(geometry, corners.reshape(len(pose), 16, 4))
    first = np.argmax(~reach.ok, axis=1)[:, None]
    return ~reach.ok.all(axis=1), np.take_along_axis(reach.leg, first, axis=1)[:, 0]
