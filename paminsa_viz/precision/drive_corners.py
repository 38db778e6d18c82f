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


PIECES = 4
"""Pieces of an edge, alike in theta, in each of which the distance is bounded by a cubic."""

_STRAIGHT = 1e-7
"""Turn of the platform along an edge [rad] below which the edge counts as straight: an arc of turn
t and length l is off its chord by l t/8, and derivatives by theta would be rounding errors."""

_CLOSE = 1e-6
"""Share by which a bound by one piece may exceed the corners; beyond, there are `PIECES`."""


@np.errstate(all="ignore")
def beyond_corners(geometry: Geometry, pose: Array, moved: Array) -> Array:
    """Return by how much errors between the corners exceed those in them, (n, 4).

    x, y and theta have no extreme value inside the box, nor on a face: with leg m's heading kept
    the platform has theta and the way of joint 5 along the leg, and each direction of the plane
    changes with that way, unless the leg is at right angles to it, where it depends on theta alone.
    What is left are the edges. There two joints 5 stay on fixed lines, so that each point of the
    platform runs along an ellipse (the trammel of Archimedes, or Cardan's motion),

        x = x_0 + A cos theta + B sin theta,

    and theta is monotone: its largest error is in a corner. The largest x, or y, of such an arc
    follows from its slopes at both ends in closed form. The square of the distance is a
    trigonometric polynomial of second degree in theta; piece by piece it is bounded by the cubic of
    its values and slopes at the ends, and a remainder by the largest fourth derivative.

    Args:
        geometry: Lengths of the mechanism.
        pose: (n, 4) [m, m, rad, m], each with a box that is free of singularities.
        moved: (n, 8, 3) errors of x, y and theta in the corners [m, m, rad].

    Returns:
        Of the sizes of the errors of x, y and theta, and of the distance in the plane
        [m, m, rad, m].
    """
    corners = np.repeat(pose[:, None], 8, axis=1)
    corners[..., :3] += moved
    rows = backend.over_list(WRENCH_TORQUES, mechanism(geometry), corners.reshape(-1, 4))
    slope = rows.reshape(-1, 8, 3, 3)
    # Edges in the order of their actuator, the other two alike: (n, 12, ...)
    first, last = (
        np.concatenate([np.flatnonzero(CORNERS[:, j] == side) for j in range(3)])
        for side in (-1.0, 1.0)
    )
    edge = np.repeat(np.arange(3), 4)
    turn = moved[:, last, 2:] - moved[:, first, 2:]
    is_straight = np.abs(turn) < _STRAIGHT
    length = np.linalg.norm(moved[:, last, :2] - moved[:, first, :2], axis=-1, keepdims=True)
    off_chord = np.where(is_straight, length * np.abs(turn) / 8, 0.0).max(axis=(1, 2))

    def end(at: NDArray[np.intp]) -> _Ends:
        by_actuator = slope[:, at, :, edge].swapaxes(0, 1)
        by_turn = np.sign(turn) * by_actuator[..., :2] / by_actuator[..., 2:]
        # The ends of a straight edge are its extremes
        return _Ends(moved[:, at, :2], np.where(is_straight, 0.0, by_turn))

    low, high = end(first), end(last)
    turn = np.abs(turn)
    largest = np.maximum(_largest(low, high, turn), _largest(low.mirrored(), high.mirrored(), turn))
    beyond = largest.max(axis=1) - np.abs(moved[..., :2]).max(axis=1) + off_chord[:, None]
    distance = np.hypot(moved[..., 0], moved[..., 1]).max(axis=1)
    square = _largest_square(low, high, turn, 1)
    again = square > distance**2 * (1 + _CLOSE)
    square[again] = _largest_square(low.those(again), high.those(again), turn[again], PIECES)
    farther = np.maximum(np.sqrt(square) - distance, 0.0) + off_chord
    return np.column_stack([beyond, np.zeros(len(pose)), farther])


class _Ends(NamedTuple):
    """One end of each edge: errors of x and y [m], and their derivatives by theta, (n, 12, 2)."""

    place: Array
    slope: Array

    def mirrored(self) -> _Ends:
        """Return both with the other sign."""
        return _Ends(-self.place, -self.slope)

    def those(self, boxes: NDArray[np.bool_]) -> _Ends:
        """Return those of some boxes (n,)."""
        return _Ends(self.place[boxes], self.slope[boxes])


def _largest(low: _Ends, high: _Ends, turn: Array) -> Array:
    """Return the largest x and y of each edge, (n, 12, 2) [m].

    They are sinusoids of theta, whose amplitude is that of their slopes.
    """
    sine = np.sin(turn)
    size = low.slope**2 + high.slope**2 - 2 * low.slope * high.slope * np.cos(turn)
    steep = np.where(high.place >= low.place, high.slope, low.slope) ** 2
    top = steep * sine / (np.sqrt(size) + np.sqrt(np.maximum(size - steep * sine**2, 0.0)))
    ends = np.maximum(low.place, high.place)
    return ends + np.where((low.slope > 0) & (high.slope < 0), top, 0.0)


def _largest_square(low: _Ends, high: _Ends, turn: Array, pieces: int) -> Array:
    """Return a bound of the square of the distance along the edges of each box, (n,) [m^2]."""

    def dot(first: Array, second: Array) -> Array:
        return (first * second).sum(axis=-1)

    # Place low + slope sin t + bend (1 - cos t), t from 0 to the turn
    bend = (high.slope - low.slope * np.cos(turn)) / np.sin(turn)
    bend = np.where(np.isfinite(bend), bend, 0.0)
    middle = low.place + bend
    once = 2 * np.hypot(dot(middle, low.slope), dot(middle, bend))
    twice = np.hypot(dot(bend, bend) - dot(low.slope, low.slope), 2 * dot(low.slope, bend)) / 2
    piece = turn / pieces
    # By the share u of a piece; its largest fourth derivative:
    fourth = (once + 16 * twice)[..., None] * piece**4
    t = (piece * np.arange(pieces + 1))[..., None]
    slope, bend = low.slope[..., None, :], bend[..., None, :]
    place = low.place[..., None, :] + slope * np.sin(t) + 2 * bend * np.sin(t / 2) ** 2
    along = piece[..., None] * (slope * np.cos(t) + bend * np.sin(t))
    d, s = dot(place, place), 2 * dot(place, along)
    d_0, d_1, s_0, s_1 = d[..., :-1], d[..., 1:], s[..., :-1], s[..., 1:]
    # d_0 + s_0 u + c_2 u^2 + c_3 u^3, beside which u^2 (1 - u)^2 / 24 of the fourth derivative
    c_2, c_3 = 3 * (d_1 - d_0) - 2 * s_0 - s_1, s_0 + s_1 - 2 * (d_1 - d_0)
    vertex = -c_2 / (3 * c_3)
    inside = s_0 + np.where((vertex > 0) & (vertex < 1), c_2 * vertex, 0.0)
    rises = np.stack([s_0, s_1, inside])
    monotone = np.abs(rises).min(axis=0) > fourth / (72 * np.sqrt(3))
    monotone &= np.abs(np.sign(rises).sum(axis=0)) == 3
    at = s_0 / (np.sqrt(c_2**2 - 3 * c_3 * s_0) - c_2)  # where the cubic is largest
    top = np.where((at > 0) & (at < 1), d_0 + at * (s_0 + at * (c_2 + at * c_3)), 0.0)
    ends = np.maximum(d_0, d_1)
    bound = np.where(monotone, ends, np.maximum(ends, top) + fourth / 384)
    return bound.max(axis=(-1, -2))
