"""Errors of the platform from tolerances of the lengths and from clearances, to first order.

The drives are where the robot's own lengths ask them to be; then each of the 42 lengths is off by
at most its tolerance t, and what a joint's clearance adds, c/2. With the sensitivities s_i of a
coordinate (`unequal_legs.sensitivities`) its worst error is the sum of |s_i| (t_i + c_i/2), and its
standard deviation the root of the sum of s_i^2 (t_i^2 + (c_i/2)^2)/3, for independent errors of
uniform distribution. A pin's clearance counts once for each of the six bars' lengths, along the
bar, and the guide's for its height.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.accuracy import NO_TOLERANCES, Tolerances
from paminsa_viz.model.arrays import Array, as_vectors, in_blocks
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import check_reach
from paminsa_viz.precision.leg_lengths import INDEX, LENGTHS, design_lengths
from paminsa_viz.precision.unequal_legs import (
    Sensitivities,
    UnequalPose,
    nominal_pose,
    sensitivities,
    solve_actuators,
    solve_pose,
)

BARS = ("bar_94", "bar_45", "bar_43", "bar_37", "bar_87", "bar_89")
"""Lengths that a pin's clearance changes."""

BLOCK = 2048
"""Poses worked on at a time."""


def tolerance_widths(tolerances: Tolerances) -> Array:
    """Return the tolerance of each length, to either side, (3, 14) [m, rad]."""
    widths = np.zeros(len(LENGTHS))
    for name, place in INDEX.items():
        widths[place] = tolerances.bar if name in BARS else getattr(tolerances, name)
    return np.tile(widths, (3, 1))


def clearance_widths(tolerances: Tolerances) -> Array:
    """Return what clearances add to each length, to either side, (3, 14) [m]."""
    widths = np.zeros(len(LENGTHS))
    widths[[INDEX[name] for name in BARS]] = tolerances.pin_clearance / 2
    widths[INDEX["guide_height"]] = tolerances.guide_clearance / 2
    return np.tile(widths, (3, 1))


@dataclass(frozen=True, eq=False)
class ToleranceErrors:
    """Errors at poses (...) in the order of `unequal_legs.COORDINATES`; NaN where there are none.

    Attributes:
        pose: (..., 4) [m, m, rad, m].
        worst: (..., 6) largest errors, by tolerances and clearances [m, m, rad, m, rad, rad].
        clearance: (..., 6) the part of the clearances in them.
        rms: (..., 6) standard deviations.
        horizontal, tilt: (...) largest distance in the plane [m] and largest tilt [rad].
        rms_horizontal, rms_tilt: (...) root mean squares of the same.
        shares: (..., 6, 14) share of each length, of all legs, in the variance; they sum up to 1.
    """

    pose: Array
    worst: Array
    clearance: Array
    rms: Array
    horizontal: Array
    tilt: Array
    rms_horizontal: Array
    rms_tilt: Array
    shares: Array


def tolerance_errors(design: Design, pose: ArrayLike) -> ToleranceErrors:
    """Return the errors by a design's tolerances at poses (..., 4); NaN out of reach."""
    pose = as_vectors(pose, "pose")
    return ToleranceErrors(pose, *in_blocks(partial(_errors, design), pose, BLOCK))


def field_tolerance_errors(field: Field, design: Design) -> ToleranceErrors:
    """Return the errors over a grid; those of the last few are kept.

    Masses, load and drives do not count.
    """
    return _field_errors(field, _lengths_alone(field, design, design.tolerances))


@lru_cache(maxsize=4)
def _field_errors(field: Field, design: Design) -> ToleranceErrors:
    return tolerance_errors(design, field.grid.poses())


def manufactured_pose(design: Design, pose: ArrayLike) -> UnequalPose:
    """Return where a design's legs put the platform if the controller takes all legs as equal.

    The actuators are those of the nominal robot at poses (..., 4).
    """
    nominal = nominal_pose(design.geometry, pose)
    if equal_legs(design):
        return nominal
    return solve_pose(design.geometry, design_lengths(design), nominal.actuators, nominal.pose)


def field_manufactured_pose(field: Field, design: Design) -> UnequalPose:
    """Return `manufactured_pose` over a grid; those of the last few are kept."""
    return _field_poses(field, _lengths_alone(field, design, NO_TOLERANCES))


@lru_cache(maxsize=4)
def _field_poses(field: Field, design: Design) -> UnequalPose:
    poses = field.grid.poses()
    return UnequalPose(*in_blocks(partial(manufactured_pose, design), poses, BLOCK))


def _lengths_alone(field: Field, design: Design, tolerances: Tolerances) -> Design:
    """Return what of a design decides over a grid's errors."""
    return Design(
        geometry=field.geometry, leg1=design.leg1, leg2=design.leg2, leg3=design.leg3,
        tolerances=tolerances,
    )  # fmt: skip


def design_sensitivities(design: Design, pose: ArrayLike) -> Sensitivities:
    """Return the first-order errors of a design's own legs at poses (..., 4)."""
    lengths = design_lengths(design)
    if equal_legs(design):
        found = nominal_pose(design.geometry, pose)
    else:
        found = solve_actuators(design.geometry, lengths, pose)
    return sensitivities(design.geometry, lengths, found)


def equal_legs(design: Design) -> bool:
    """Whether a design has the same nominal lengths in all legs."""
    return all(leg.zero for leg in design.deviations)


@np.errstate(all="ignore")
def _errors(design: Design, pose: Array) -> tuple[Array, ...]:
    """Return the values of `ToleranceErrors` at poses (n, 4)."""
    n = len(pose)
    slopes = design_sensitivities(design, pose).lengths
    slopes = np.where(check_reach(design.geometry, pose).ok[:, None, None, None], slopes, np.nan)
    tolerance = tolerance_widths(design.tolerances)
    clearance = clearance_widths(design.tolerances)
    sizes = np.abs(slopes).reshape(n, 6, -1)
    variance = slopes**2 * ((tolerance**2 + clearance**2) / 3)
    total = variance.sum(axis=(-1, -2))
    generators = (slopes * (tolerance + clearance)).reshape(n, 6, -1)
    scale = np.where(total > 0, total, 1.0)
    return (
        sizes @ (tolerance + clearance).ravel(),
        sizes @ clearance.ravel(),
        np.sqrt(total),
        longest_sum(generators[:, 0], generators[:, 1]),
        longest_sum(generators[:, 4], generators[:, 5]),
        np.sqrt(total[:, 0] + total[:, 1]),
        np.sqrt(total[:, 4] + total[:, 5]),
        variance.sum(axis=-2) / scale[..., None],
    )


def longest_sum(x: Array, y: Array) -> Array:
    """Return the length of the longest sum of plane vectors (..., n), each taken plus or minus.

    Such sums fill a polygon whose edges are twice the vectors, in the order of their directions.
    """
    below = (y < 0) | ((y == 0) & (x < 0))
    x, y = np.where(below, -x, x), np.where(below, -y, y)
    order = np.argsort(np.arctan2(y, x), axis=-1)
    x, y = np.take_along_axis(x, order, axis=-1), np.take_along_axis(y, order, axis=-1)
    corner_x = 2 * np.cumsum(x, axis=-1) - x.sum(axis=-1, keepdims=True)
    corner_y = 2 * np.cumsum(y, axis=-1) - y.sum(axis=-1, keepdims=True)
    return np.hypot(corner_x, corner_y).max(axis=-1)
