"""Measurements of a robot that is not there: its legs are off at random, and so is the device."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
from paminsa_viz.precision.measurements import (
    InvalidMeasurement,
    Measurements,
    coordinate_scales,
    predict,
)


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
        InvalidMeasurement: If that is all of them.
    """
    random = np.random.default_rng(seed)
    true = deviation_array(design) + random.uniform(-size, size, (3, len(LENGTHS)))
    found = predict(design, true, asked)
    if not found.ok.any():
        raise InvalidMeasurement(0, f"legs off by up to {size:g} m: {found.reason(0)}")
    error = random.normal(scale=noise, size=(len(asked), 6)) / coordinate_scales(design)
    measured = (found.coordinates + error)[found.ok, : asked.poses.shape[1]]
    return Measurements(asked.actuators[found.ok], measured)
