"""What a calibration will tell, before anything is measured: poses, and how well lengths show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import require_positive
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.precision.calibration import within
from paminsa_viz.precision.calibration_problem import (
    GAP,
    CalibrationProblem,
    measuring_poses,
    require_enough,
)
from paminsa_viz.precision.measurements import Measurements, length_scales
from paminsa_viz.progress import Progress, go_on


@dataclass(frozen=True, eq=False)
class CalibrationPlan:
    """Poses to measure, and what a calibration with them will tell of equal legs.

    Attributes:
        measurements: The poses and the actuators' readings for them; with 6 coordinates the tilt
            is 0. What is measured takes the place of the poses.
        noise: Standard deviation of a measured coordinate, angles counted with R_pl [m].
        half_widths: (m,) half intervals of 95 % of the combinations of lengths that show, narrowest
            first [m].
        determined: (3, 14) which lengths show by themselves, not in combinations alone.
        standard_deviations: (3, 14) of those lengths [m, rad]; NaN of the others.
    """

    measurements: Measurements
    noise: float
    half_widths: Array
    determined: NDArray[np.bool_]
    standard_deviations: Array


@of_design
def plan_calibration(
    design: Design,
    poses: int,
    *,
    coordinates: int = 6,
    noise: float = 2e-5,
    seed: int = 0,
    progress: Progress = go_on,
) -> CalibrationPlan:
    """Choose poses to measure, and say what they will tell.

    To first order, with equal legs: legs that differ show more, see `calibrate`.

    Args:
        design: The robot.
        poses, coordinates, seed, progress: As of `measuring_poses`.
        noise: Standard deviation of a measured coordinate, angles counted with R_pl [m].

    Raises:
        InvalidInput: If the poses are too few, or a number is not possible.
        Canceled: If ``progress`` ends it.
    """
    require_positive(noise, "noise")
    chosen = measuring_poses(design, poses, coordinates=coordinates, seed=seed, progress=progress)
    require_enough(len(chosen), coordinates)
    actuators = inverse_kinematics(design.geometry, chosen).actuators
    asked = np.zeros((len(chosen), coordinates))
    asked[:, :4] = chosen
    problem = CalibrationProblem(design, Measurements(actuators, asked))
    _, singular, directions = np.linalg.svd(problem.equal_legs(), full_matrices=False)
    shown = singular > GAP * singular[0]
    basis, sizes = directions[shown], noise / singular[shown]
    determined = within(basis)
    spread = np.linalg.norm(basis * sizes[:, None], axis=0).reshape(3, -1) / length_scales(design)
    return CalibrationPlan(
        measurements=problem.measured,
        noise=noise,
        half_widths=problem.margin(len(basis)) * sizes,
        determined=determined,
        standard_deviations=np.where(determined, spread, np.nan),
    )
