"""Errors of the platform from tolerances of the lengths and from clearances.

To first order: the drives are where the robot's own lengths ask them to be; then each of the 42
lengths is off by at most its tolerance t, and what a joint's clearance adds, c/2. With the
sensitivities s_i of a coordinate (`unequal_legs.sensitivities`) its worst error is the sum of
|s_i| (t_i + c_i/2), and its standard deviation the root of the sum of s_i^2 (t_i^2 + (c_i/2)^2)/3,
for independent errors of uniform distribution. A pin's clearance counts once for each of the six
bars' lengths, along the bar, and the guide's for its height. `monte_carlo` draws robots within
their tolerances and solves their poses by exact kinematics.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import require_seed, require_share
from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import kept
from paminsa_viz.model.accuracy import NO_TOLERANCES, Tolerances
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, in_blocks, own_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import check_reach
from paminsa_viz.model.status import WithStatus
from paminsa_viz.precision.leg_lengths import INDEX, LENGTHS, design_lengths
from paminsa_viz.precision.unequal_legs import (
    Closure,
    Sensitivities,
    UnequalPose,
    nominal_pose,
    sensitivities,
    solve_actuators,
    solve_pose,
)
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.units import counted

BAR_LENGTHS = ("bar_94", "bar_45", "bar_43", "bar_37", "bar_87", "bar_89")
"""Lengths that a pin's clearance changes."""

BLOCK = 2048
"""Poses worked on at a time."""

ROUNDING = 1e-12
"""Sensitivities below this share of a coordinate's largest are zero: no bar changes theta."""


def tolerance_widths(tolerances: Tolerances) -> Array:
    """Return the tolerance of each length, to either side, (3, 14) [m, rad]."""
    widths = [
        tolerances.bar if name in BAR_LENGTHS else getattr(tolerances, name) for name in INDEX
    ]
    return np.tile(widths, (3, 1))


def clearance_widths(tolerances: Tolerances) -> Array:
    """Return what clearances add to each length, to either side, (3, 14) [m]."""
    widths = np.zeros(len(LENGTHS))
    widths[[INDEX[name] for name in BAR_LENGTHS]] = tolerances.pin_clearance / 2
    widths[INDEX["guide_height"]] = tolerances.guide_clearance / 2
    return np.tile(widths, (3, 1))


@dataclass(frozen=True, eq=False)
class ToleranceErrors:
    """Errors at poses (...) in the order of `SIX_COORDINATES`; NaN where there are none.

    Attributes:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        worst: (..., 6) largest errors, by tolerances and clearances [m, m, rad, m, rad, rad].
        clearance: (..., 6) the part of the clearances in them.
        rms: (..., 6) standard deviations.
        horizontal, tilt: (...) largest distance in the plane [m] and largest tilt [rad].
        rms_horizontal, rms_tilt: (...) root mean squares of the same.
    """

    design: Design
    pose: Array
    worst: Array
    clearance: Array
    rms: Array
    horizontal: Array
    tilt: Array
    rms_horizontal: Array
    rms_tilt: Array

    @cached_property
    def shares(self) -> Array:
        """Share of each length, of all legs, in the variance, (..., 6, 14); they sum up to 1.

        They are worked out when asked for: over a map they take more memory than all else.
        """
        return in_blocks(lambda poses: [_shares(self.design, poses)], self.pose, BLOCK)[0]


@of_design
def tolerance_errors(design: Design, pose: ArrayLike) -> ToleranceErrors:
    """Return the errors by a design's tolerances at poses (..., 4); NaN out of reach.

    They are of first order, about the design's own legs, with locked actuators.

    Args:
        design: The robot, its deviations and tolerances.
        pose: (..., 4) [m, m, rad, m].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    pose = own_vectors(pose, "pose")
    return ToleranceErrors(design, pose, *in_blocks(partial(_errors, design), pose, BLOCK))


def field_tolerance_errors(field: Field, design: Design) -> ToleranceErrors:
    """Return the errors over a grid; those of the last few are kept.

    Masses, load and drives do not count.
    """
    return _field_errors(field, _lengths_alone(field, design, design.tolerances))


@kept(4)
def _field_errors(field: Field, design: Design) -> ToleranceErrors:
    return tolerance_errors(design, field.grid.poses())


@of_design
def manufactured_pose(design: Design, pose: ArrayLike) -> UnequalPose:
    """Return where a design's legs put the platform if the controller takes all legs as equal.

    The actuators are those of the nominal robot at the poses; NaN where it has none.

    Args:
        design: The robot, with the deviations of its legs.
        pose: (..., 4) poses that the controller is asked for [m, m, rad, m].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    nominal = nominal_pose(design.geometry, pose)
    if equal_legs(design):
        return nominal
    found = solve_pose(design.geometry, design_lengths(design), nominal.actuators, nominal.pose)
    return replace(found, status=np.where(nominal.ok, found.status, nominal.status))


def field_manufactured_pose(field: Field, design: Design) -> UnequalPose:
    """Return `manufactured_pose` over a grid; those of the last few are kept."""
    return _field_poses(field, _lengths_alone(field, design, NO_TOLERANCES))


@kept(4)
def _field_poses(field: Field, design: Design) -> UnequalPose:

    def solved(poses: Array) -> Iterable[Any]:
        return vars(manufactured_pose(design, poses)).values()

    return UnequalPose(*in_blocks(solved, field.grid.poses(), BLOCK))


def _lengths_alone(field: Field, design: Design, tolerances: Tolerances) -> Design:
    """Return what of a design decides over a grid's errors."""
    return Design(
        geometry=field.geometry, leg1=design.leg1, leg2=design.leg2, leg3=design.leg3,
        tolerances=tolerances,
    )  # fmt: skip


@of_design
def design_sensitivities(design: Design, pose: ArrayLike) -> Sensitivities:
    """Return the derivatives of the platform's coordinates with a design's own legs.

    Args:
        design: The robot, with the deviations of its legs.
        pose: (..., 4) [m, m, rad, m].

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
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
    n, slopes = len(pose), _slopes(design, pose)
    tolerance = tolerance_widths(design.tolerances)
    clearance = clearance_widths(design.tolerances)
    sizes = np.abs(slopes).reshape(n, 6, tolerance.size)
    total = _variance(design, slopes).sum(axis=(2, 3))
    generators = (slopes * (tolerance + clearance)).reshape(n, 6, tolerance.size)
    return (
        sizes @ (tolerance + clearance).ravel(),
        sizes @ clearance.ravel(),
        np.sqrt(total),
        longest_sum(generators[:, 0], generators[:, 1]),
        longest_sum(generators[:, 4], generators[:, 5]),
        np.sqrt(total[:, 0] + total[:, 1]),
        np.sqrt(total[:, 4] + total[:, 5]),
    )


@np.errstate(all="ignore")
def _shares(design: Design, pose: Array) -> Array:
    """Return `ToleranceErrors.shares` at poses (n, 4)."""
    variance = _variance(design, _slopes(design, pose))
    total = variance.sum(axis=(2, 3))
    return variance.sum(axis=2) / np.where(total > 0, total, 1.0)[..., None]


def _slopes(design: Design, pose: Array) -> Array:
    """Return the derivatives by each leg's lengths at poses (n, 4), (n, 6, 3, 14)."""
    slopes = design_sensitivities(design, pose).lengths
    slopes = np.where(check_reach(design.geometry, pose).ok[:, None, None, None], slopes, np.nan)
    sizes = np.abs(slopes)
    return np.where(sizes < ROUNDING * sizes.max(axis=(2, 3), keepdims=True), 0.0, slopes)


def _variance(design: Design, slopes: Array) -> Array:
    """Return the variance by each leg's lengths, shape of ``slopes``."""
    tolerance = tolerance_widths(design.tolerances)
    clearance = clearance_widths(design.tolerances)
    return slopes**2 * ((tolerance**2 + clearance**2) / 3)


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


MOST_SAMPLES = 1_000_000
"""Most robots times poses: their errors take 48 MB."""

ROBOTS_BLOCK = 4096
"""Robots times poses solved at a time."""


@dataclass(frozen=True, eq=False)
class MonteCarlo(WithStatus):
    """Errors of n robots at poses (...).

    Attributes:
        pose: (..., 4) poses that the drives were set for [m, m, rad, m].
        seed: Of the random numbers.
        errors: (n, ..., 6) errors of `SIX_COORDINATES` [m, m, rad, m, rad, rad]; NaN where
            a robot has no solution.
        status: (n, ...) values of `Closure`.
        canceled: Whether it was ended early, with fewer robots than asked for.
    """

    pose: Array
    seed: int
    errors: Array
    status: NDArray[np.uint8]
    canceled: bool

    KINDS = Closure

    @property
    def solved(self) -> Array:
        """Share of the robots that have a solution, (...)."""
        return np.asarray(self.ok.mean(axis=0))

    @property
    def rms(self) -> Array:
        """Root mean square errors, (..., 6); NaN where a robot has no solution."""
        return np.sqrt((self.errors**2).mean(axis=0))

    def quantile(self, share: float) -> Array:
        """Return the sizes of errors that a share of the robots does not exceed, (..., 6).

        A robot without a solution counts as an infinite error.

        Raises:
            InvalidInput: If the share is not from 0 to 1.
        """
        require_share(share, "share")
        sizes = np.where(np.isnan(self.errors), np.inf, np.abs(self.errors))
        return np.quantile(sizes, share, axis=0, method="inverted_cdf")


@of_design
def monte_carlo(
    design: Design,
    pose: ArrayLike,
    *,
    robots: int = 1000,
    seed: int = 0,
    block: int = ROBOTS_BLOCK,
    progress: Progress = go_on,
) -> MonteCarlo:
    """Draw robots with lengths uniform within tolerances and clearances, and solve their poses.

    The drives are where the design's own lengths ask them to be. Robot i is the same whatever the
    number of robots or the block.

    Args:
        design: The robot, its deviations and tolerances.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].
        robots: How many.
        seed: Of the random numbers.
        block: Robots times poses solved at a time.
        progress: Called after each block; true ends it with the robots done.

    Raises:
        InvalidInput: If there are too many or no robots, or a pose cannot be taken.
    """
    pose = own_vectors(pose, "pose")
    flat = pose.reshape(-1, 4)
    if robots < 1 or robots * len(flat) > MOST_SAMPLES:
        most = MOST_SAMPLES // max(len(flat), 1)
        poses = counted(len(flat), "pose")
        raise InvalidInput("robots", f"1 to {most:,} are possible with {poses}, not {robots:,}")
    require_seed(seed)
    geometry, center = design.geometry, design_lengths(design)
    start = solve_actuators(geometry, center, flat)
    if not start.ok.all():
        first = int(np.argmin(start.ok))
        which = "a pose" if pose.ndim == 1 else f"pose {list(np.ndindex(pose.shape[:-1]))[first]}"
        raise InvalidInput("pose", f"{which} cannot be taken: {start.reason(first)}")
    tolerance, clearance = tolerance_widths(design.tolerances), clearance_widths(design.tolerances)
    random = np.random.default_rng(seed)
    errors = np.empty((robots, len(flat), 6))
    status = np.empty((robots, len(flat)), np.uint8)
    wanted = start.coordinates
    at_once, done, canceled = max(1, block // max(len(flat), 1)), 0, False
    while done < robots and not canceled:
        some = slice(done, min(done + at_once, robots))
        drawn = random.uniform(-1.0, 1.0, (some.stop - done, 2, 3, len(LENGTHS)))
        lengths = center + drawn[:, 0] * tolerance + drawn[:, 1] * clearance
        found = solve_pose(geometry, lengths[:, None], start.actuators, flat)
        errors[some], status[some] = found.coordinates - wanted, found.status
        done = some.stop
        canceled = bool(progress(done / robots))
    shape = pose.shape[:-1]
    return MonteCarlo(
        pose, seed,
        errors[:done].reshape(done, *shape, 6), status[:done].reshape(done, *shape),
        done < robots,
    )  # fmt: skip
