"""Measured poses of the robot, and how well legs with given deviations predict them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.precision.leg_lengths import INDEX, LENGTHS, nominal_lengths
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
        actuators = as_vectors(self.actuators, "actuators")
        poses = as_numbers(self.poses, "poses")
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


def coordinate_scales(design: Design) -> Array:
    """Return the lengths that turn the six coordinates into meters: 1 or R_pl."""
    radius = design.geometry.platform_radius
    return np.array([1.0, 1.0, radius, 1.0, radius, radius])


def predict(design: Design, deviations: ArrayLike, measured: Measurements) -> UnequalPose:
    """Return the poses that legs with deviations (3, 14) have at the measured readings."""
    lengths = nominal_lengths(design.geometry) + np.asarray(deviations, np.float64)
    return solve_pose(design.geometry, lengths, measured.actuators, measured.poses[:, :4])


def prediction_errors(
    design: Design, deviations: ArrayLike, measured: Measurements
) -> PredictionErrors:
    """Return by how much legs with deviations (3, 14) miss measured poses."""
    width = measured.poses.shape[1]
    if not len(measured):
        return PredictionErrors(np.full(width, np.nan), np.full(width, np.nan), 0)
    error = differences(predict(design, deviations, measured), measured)
    rms = np.sqrt((error**2).mean(axis=0))
    return PredictionErrors(rms, np.abs(error).max(axis=0), len(measured))


def differences(found: UnequalPose, measured: Measurements) -> Array:
    """Return predicted minus measured coordinates, (n, c) [m, m, rad, m, rad, rad]."""
    return found.coordinates[:, : measured.poses.shape[1]] - measured.poses
