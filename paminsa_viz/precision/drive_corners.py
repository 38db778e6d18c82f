"""The corners of the box of the drives' errors, by exact forward kinematics, and what is between.

Arrays have the legs first, (3, n) and (3, n, 8 corners). See `drive_errors` for the mechanics.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.grids import WRENCH_TORQUES
from paminsa_viz.model.kinematics import AXIS_ANGLES, LEG_AXES, wrap
from paminsa_viz.model.leg import leg_vector, mechanism
from paminsa_viz.model.reach import check_reach

CORNERS: Array = np.array(list(product((-1.0, 1.0), repeat=3)))
"""Corners of the box of M1..M3, (8, 3); the opposite of corner i is corner 7 - i."""
CORNERS.setflags(write=False)

_SIN_AXIS, _COS_AXIS = np.sin(AXIS_ANGLES), np.cos(AXIS_ANGLES)
_BEFORE, _AFTER = [2, 0, 1], [1, 2, 0]


class _Angles(NamedTuple):
    """Sines and cosines of beta_k, of gamma_k = beta_k - alpha_k, and of differences, (3, ...).

    ``sine`` and ``cosine`` are those of beta_{k+1} - beta_{k+2}.
    """

    sin_b: Array
    cos_b: Array
    sin_g: Array
    cos_g: Array
    sine: Array
    cosine: Array

    @property
    def modes(self) -> tuple[Array, Array]:
        """a and b of the closure equations, (...)."""
        return (self.sine * self.sin_g).sum(axis=0), (self.sine * self.cos_g).sum(axis=0)


def _per_leg(values: Array, like: Array) -> Array:
    """Return a number of each leg (3,) that broadcasts along (3, ...)."""
    return values.reshape(3, *[1] * (like.ndim - 1))


def _angles(sin_b: Array, cos_b: Array) -> _Angles:
    sin_a, cos_a = _per_leg(_SIN_AXIS, sin_b), _per_leg(_COS_AXIS, sin_b)
    s1, s2, c1, c2 = sin_b[_AFTER], sin_b[_BEFORE], cos_b[_AFTER], cos_b[_BEFORE]
    return _Angles(
        sin_b,
        cos_b,
        sin_b * cos_a - cos_b * sin_a,
        cos_b * cos_a + sin_b * sin_a,
        s1 * c2 - c1 * s2,
        c1 * c2 + s1 * s2,
    )


@np.errstate(all="ignore")
def corner_errors(
    geometry: Geometry, pose: Array, half: Array
) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the corners of the box of M1..M3 about poses (n, 4) that can be taken.

    Args:
        geometry: Lengths of the mechanism.
        pose: (n, 4) [m, m, rad, m].
        half: (3,) half widths of the box [rad].

    Returns:
        Errors of x, y and theta in the corners (n, 8, 3) [m, m, rad], each in the assembly mode on
        the pose's side of the fold; where all corners can be assembled (n); and where the whole
        box is free of singularities, as far as that is proven (n).
    """
    x, y, theta = (np.ascontiguousarray(pose[:, i]) for i in range(3))
    v = leg_vector(
        mechanism(geometry), LEG_AXES[:, :1], LEG_AXES[:, 1:], x, y, np.cos(theta), np.sin(theta)
    )
    rho = np.sqrt(v.rho2)
    here = _angles(v.dy / rho, v.dx / rho)
    a, b = here.modes
    side = np.sign(np.sin(theta + np.arctan2(b, a)))
    sin_d, cos_d = (CORNERS * np.sin(half)).T[:, None], np.cos(half)[:, None, None]
    s, c = here.sin_b[..., None], here.cos_b[..., None]
    turned = _angles(s * cos_d + c * sin_d, c * cos_d - s * sin_d)
    moved, assembled = _platform(geometry, turned, side[:, None], x[:, None], y[:, None])
    moved[..., 2] = wrap(moved[..., 2] - theta[:, None])
    return moved, assembled, _regular(geometry, here, half)


def _platform(
    geometry: Geometry, v: _Angles, side: Array, x: Array, y: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return the platform's place beside (x, y), and theta, for headings (3, n, 8): (n, 8, 3).

    Second value: where it exists with every joint 5 before its leg axis in all corners (n).
    """
    a, b = v.modes
    ratio = geometry.base_radius / geometry.platform_radius
    angle = side * np.arccos(ratio * a / np.hypot(a, b)) - np.arctan2(b, a)
    cos, sin = geometry.platform_radius * np.cos(angle), geometry.platform_radius * np.sin(angle)
    cos_a, sin_a = _per_leg(_COS_AXIS, v.sin_b), _per_leg(_SIN_AXIS, v.sin_b)
    # s_k = sin b (x + p_x - e_x) - cos b (y + p_y - e_y) = 0 for the displacement of (x, y)
    px = cos * cos_a - sin * sin_a + (x - geometry.base_radius * cos_a)
    py = sin * cos_a + cos * sin_a + (y - geometry.base_radius * sin_a)
    s, c = v.sin_b, v.cos_b
    right = c * py - s * px
    ss, cc, sc = (s * s).sum(axis=0), (c * c).sum(axis=0), (s * c).sum(axis=0)
    rs, rc = (s * right).sum(axis=0), (c * right).sum(axis=0)
    det = ss * cc - sc * sc
    dx, dy = (cc * rs - sc * rc) / det, (sc * rs - ss * rc) / det
    moved = np.stack([dx, dy, angle], axis=-1)
    ahead = (c * (dx + px) + s * (dy + py) > 0).all(axis=(0, -1))
    return moved, ahead & np.isfinite(moved).all(axis=(-1, -2))


def _regular(geometry: Geometry, v: _Angles, half: Array) -> NDArray[np.bool_]:
    """Return where the two assembly modes are apart in the whole box of M1..M3, (n).

    Each term of a and b is a product of two sines, sin(beta_i - beta_j) sin(beta_k - alpha_k) or
    with a cosine, so its second derivative along a step d is at most (d_1 + d_2 + d_3)^2.
    """
    ratio = geometry.base_radius / geometry.platform_radius
    a, b = v.modes
    # d n_k / d beta_{k+1} = cos(beta_{k+1} - beta_{k+2}), and minus that by beta_{k+2}
    across, along = v.cosine * v.sin_g, v.cosine * v.cos_g
    slope_a = v.sine * v.cos_g + across[_BEFORE] - across[_AFTER]
    slope_b = -v.sine * v.sin_g + along[_BEFORE] - along[_AFTER]
    rest = 1.5 * half.sum() ** 2
    if ratio < 1.0:  # the modes meet only where a = b = 0
        weight = np.sqrt(1.0 - ratio**2)
        change_a, change_b = half @ np.abs(slope_a) + rest, half @ np.abs(slope_b) + rest
        return np.hypot(weight * a, b) > np.hypot(weight * change_a, change_b)
    weight = np.sqrt(ratio**2 - 1.0)
    apart = np.ones(a.shape, dtype=np.bool_)
    for sign in (1.0, -1.0):
        change = half @ np.abs(slope_b + sign * weight * slope_a) + (1 + weight) * rest
        apart &= np.abs(b + sign * weight * a) > change
    return apart


def beyond_reach(
    geometry: Geometry, pose: Array, moved: Array, lift: float
) -> tuple[NDArray[np.bool_], NDArray[np.int8]]:
    """Return where a corner of the whole box, M4's included, is out of reach (n), and its leg.

    Args:
        geometry: Lengths of the mechanism.
        pose: (n, 4) [m, m, rad, m].
        moved: (n, 8, 3) errors in the corners of M1..M3.
        lift: Error of z that M4 causes, to either side [m].
    """
    corners = np.repeat(pose[:, None, None, :], 2, axis=1).repeat(8, axis=2)
    corners[..., :3] += moved[:, None]
    corners[..., 3] += np.array([-lift, lift])[:, None]
    reach = check_reach(geometry, corners.reshape(len(pose), 16, 4))
    first = np.argmax(~reach.ok, axis=1)[:, None]
    return np.any(~reach.ok, axis=1), np.take_along_axis(reach.leg, first, axis=1)[:, 0]


_THIRD_ORDER = 1.5
"""What the second-order term is multiplied by, so that terms of higher order are covered as well.

Of 4000 boxes of random robots, up to 6 degrees wide to each side, 1.25 covered all but two.
"""


@np.errstate(all="ignore")
def beyond_corners(geometry: Geometry, pose: Array, moved: Array, half: Array) -> Array:
    """Return by how much errors between the corners may exceed those in them, (n, 4).

    Along an edge of length 2 d an error with slopes s_1 > 0 and s_2 < 0 inward and outward is, to
    second order, largest between the ends, and exceeds the higher one of slope s there by
    s^2 d/(s_1 - s_2). The largest such excess of each of the three directions counts.

    Args:
        geometry: Lengths of the mechanism.
        pose: (n, 4) [m, m, rad, m].
        moved: (n, 8, 3) errors of x, y and theta in the corners [m, m, rad].
        half: (3,) half widths of the box [rad].

    Returns:
        Of the sizes of the errors of x, y and theta, and of the distance in the plane
        [m, m, rad, m].
    """
    corners = np.repeat(pose[:, None], 8, axis=1)
    corners[..., :3] += moved
    rows = backend.over_list(WRENCH_TORQUES, mechanism(geometry), corners.reshape(-1, 4))
    slope = rows[:, :9].reshape(-1, 8, 3, 3)
    distance = np.hypot(moved[..., 0], moved[..., 1])
    away = np.einsum("nci,ncij->ncj", moved[..., :2], slope[:, :, :2]) / distance[..., None]
    value = np.concatenate([moved, -moved, distance[..., None]], axis=-1)
    slope = np.concatenate([slope, -slope, away[:, :, None]], axis=2)
    total = np.zeros((len(pose), 7))
    for j, d in enumerate(half):
        first, last = CORNERS[:, j] < 0, CORNERS[:, j] > 0  # the other two alike, in this order
        rise, fall = slope[..., j][:, first], slope[..., j][:, last]
        top = np.where(value[:, last] >= value[:, first], fall, rise)
        excess = np.where((rise > 0) & (fall < 0), top**2 * d / (rise - fall), 0.0)
        total += excess.max(axis=1)
    total *= _THIRD_ORDER
    return np.concatenate([np.maximum(total[:, :3], total[:, 3:6]), total[:, 6:]], axis=-1)
