"""Measured poses of the robot, and how well legs with given deviations predict them.

They may be those of a robot that is not there: its legs are off at random, and so is the device.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import require_at_least, require_seed
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_numbers, own_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.precision.leg_lengths import (
    INDEX,
    LENGTHS,
    as_lengths,
    deviation_array,
    nominal_lengths,
)
from paminsa_viz.precision.unequal_legs import UnequalPose, solve_pose


class InvalidMeasurement(InvalidInput):
    """A measurement that no robot near the design can have made.

    Attributes:
        index: Which one, from 0.
        problem: What is wrong with it.
    """

    def __init__(self, index: int, problem: str) -> None:
        self.index = index
        super().__init__("measured", problem)


@dataclass(frozen=True, eq=False)
class Measurements:
    """Measured poses in the robot's base frame.

    Attributes:
        actuators: (n, 4) readings theta_1..3, Z [rad, rad, rad, m].
        poses: (n, 4) x, y, theta, z, or (n, 6) with tilt_x, tilt_y [m, m, rad, m, rad, rad]; the
            platform is turned by R_z(theta) exp(tilt), tilt in its own axes.

    Raises:
        InvalidInput: If the shapes are others, or a number is not finite.
    """

    actuators: Array
    poses: Array

    def __post_init__(self) -> None:
        actuators = own_vectors(self.actuators, "actuators")
        poses = as_numbers(self.poses, "poses").copy()
        if poses.ndim != 2 or poses.shape[1] not in (4, 6) or actuators.shape != (len(poses), 4):
            problem = f"(n, 4) readings and (n, 4) or (n, 6) poses are needed, not {poses.shape}"
            raise InvalidInput("poses", problem)
        for name, values in (("actuators", actuators), ("poses", poses)):
            if not np.isfinite(values).all():
                raise InvalidInput(name, "finite numbers are needed")
        object.__setattr__(self, "actuators", actuators)
        object.__setattr__(self, "poses", poses)

    def __len__(self) -> int:
        return len(self.poses)

    def take(self, chosen: NDArray[np.intp] | NDArray[np.bool_]) -> Measurements:
        """Return some of them."""
        return Measurements(self.actuators[chosen], self.poses[chosen])


@dataclass(frozen=True, eq=False)
class PredictionErrors:
    """Errors of predicted poses, in the order of the measured coordinates [m, m, rad, m, rad, rad].

    Attributes:
        rms, largest: (c,) over the poses; NaN for none.
        poses: How many.
    """

    rms: Array
    largest: Array
    poses: int


def length_scales(design: Design) -> Array:
    """Return the lengths that turn deviations (3, 14) into meters: 1, R_b or R_pl."""
    scale = np.ones((3, len(LENGTHS)))
    scale[:, [INDEX["axis_angle"], INDEX["actuator_zero"]]] = design.geometry.base_radius
    scale[:, INDEX["joint_angle"]] = design.geometry.platform_radius
    return scale


@of_design
def coordinate_scales(design: Design) -> Array:
    """Return the factors that turn the six coordinates into meters, (6,): 1 or R_pl [m/rad]."""
    radius = design.geometry.platform_radius
    return np.array([1.0, 1.0, radius, 1.0, radius, radius])


@of_design
def predict(design: Design, deviations: ArrayLike, measured: Measurements) -> UnequalPose:
    """Return the poses that legs with deviations (3, 14) have at the measured readings.

    Args:
        design: The robot; its own deviations do not count.
        deviations: (3, 14) in the order of `LENGTHS` [m, rad], from the nominal lengths.
        measured: Readings, and the poses that the solution starts from.

    Raises:
        InvalidInput: If the deviations have another shape, or are not real.
    """
    lengths = nominal_lengths(design.geometry) + as_lengths(deviations, "deviations")
    return solve_pose(design.geometry, lengths, measured.actuators, measured.poses[:, :4])


@of_design
def prediction_errors(
    design: Design, deviations: ArrayLike, measured: Measurements
) -> PredictionErrors:
    """Return by how much legs with deviations (3, 14) miss measured poses.

    Arguments and what is raised as in `predict`.
    """
    return errors_of(differences(predict(design, deviations, measured), measured))


def errors_of(residuals: Array) -> PredictionErrors:
    """Return the errors of residuals (n, c), see `differences`."""
    if not len(residuals):
        none = np.full(residuals.shape[1], np.nan)
        return PredictionErrors(none, none, 0)
    rms = np.sqrt((residuals**2).mean(axis=0))
    return PredictionErrors(rms, np.abs(residuals).max(axis=0), len(residuals))


def differences(found: UnequalPose, measured: Measurements) -> Array:
    """Return predicted minus measured coordinates, (n, c) [m, m, rad, m, rad, rad]."""
    return found.coordinates[:, : measured.poses.shape[1]] - measured.poses


def rotation_coordinates(rotation: ArrayLike) -> Array:
    """Return theta and the tilt of rotation matrices, for poses that are measured as matrices.

    R = R_z(theta) exp(tilt) with a tilt about a horizontal axis of the platform is the only such
    product, unless the platform is upside down.

    Args:
        rotation: (..., 3, 3) from the platform's axes to the base's.

    Returns:
        (..., 3) = (theta, tilt_x, tilt_y) [rad].

    Raises:
        InvalidInput: If these are no rotations.
    """
    matrix = as_numbers(rotation, "rotation")
    if matrix.shape[-2:] != (3, 3) or not (
        np.allclose(matrix @ np.swapaxes(matrix, -1, -2), np.eye(3), atol=1e-6)
        and (np.linalg.det(matrix) > 0).all()
    ):
        raise InvalidInput("rotation", "rotation matrices (..., 3, 3) are needed")
    # the last row is that of exp(tilt) alone: (-sin t t_y/t, sin t t_x/t, cos t)
    x, y, z = np.moveaxis(matrix[..., 2, :], -1, 0)
    sine = np.hypot(x, y)
    size = np.arctan2(sine, z)
    factor = size / np.where(sine > 0, sine, 1.0)
    # exp(tilt) is symmetric in x and y, so that these two hold theta alone
    theta = np.arctan2(matrix[..., 1, 0] - matrix[..., 0, 1], matrix[..., 0, 0] + matrix[..., 1, 1])
    return np.stack([theta, factor * y, -factor * x], axis=-1)


@of_design
def simulated_measurements(
    design: Design,
    asked: Measurements,
    *,
    size: float = 5e-4,
    noise: float = 1e-5,
    seed: int = 0,
) -> Measurements:
    """Measure a robot whose legs are off at random, in the poses of given readings.

    Args:
        design: The robot as it was drawn; its own deviations count as well.
        asked: Readings, with a pose near each.
        size: Largest deviation of a length [m] and of an angle [rad]; they are uniform.
        noise: Standard deviation of a measured coordinate, angles counted with R_pl [m].
        seed: Of the random numbers.

    Returns:
        Readings and measured poses, with as many coordinates as asked. Poses that legs so far off
        do not reach, such as near a singular one, are left out.

    Raises:
        InvalidInput: If size, noise or seed is not possible.
        InvalidMeasurement: If that is all of them.
    """
    require_at_least(size, "size")
    require_at_least(noise, "noise")
    require_seed(seed)
    random = np.random.default_rng(seed)
    true = deviation_array(design) + random.uniform(-size, size, (3, len(LENGTHS)))
    found = predict(design, true, asked)
    if not found.ok.any():
        raise InvalidMeasurement(0, f"legs off by up to {size:g} m: {found.reason(0)}")
    error = random.normal(scale=noise, size=(len(asked), 6)) / coordinate_scales(design)
    measured = (found.coordinates + error)[found.ok, : asked.poses.shape[1]]
    return Measurements(asked.actuators[found.ok], measured)
