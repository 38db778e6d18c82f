"""Speed of unequal legs: forward kinematics, errors by tolerances, random robots, calibration.

Run: ``python -m benchmarks.calibration_speed``.
"""

from __future__ import annotations

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.model import APPENDIX_4, forward_kinematics, inverse_kinematics
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.calibration_problem import measuring_poses
from paminsa_viz.precision.leg_lengths import nominal_lengths
from paminsa_viz.precision.manufacture import monte_carlo, tolerance_errors
from paminsa_viz.precision.measurements import Measurements, coordinate_scales, predict
from paminsa_viz.precision.unequal_legs import nominal_pose, sensitivities, solve_pose

CELLS = 72


def main() -> None:
    """Run everything."""
    geometry, random = APPENDIX_4.geometry, np.random.default_rng(0)
    poses = np.zeros((CELLS**2, 4))
    poses[:, :2] = random.uniform(-0.15, 0.15, (CELLS**2, 2))
    poses[:, 2:] = 0.4, -0.5
    actuators = inverse_kinematics(geometry, poses).actuators
    drawn = random.uniform(-5e-4, 5e-4, (3, 14))
    equal = nominal_lengths(geometry)
    asked = measuring_poses(APPENDIX_4, 60)
    readings = Measurements(inverse_kinematics(geometry, asked).actuators, asked)
    measured = predict(APPENDIX_4, drawn, readings).coordinates
    measured = measured + random.normal(scale=1e-5, size=measured.shape) / coordinate_scales(
        APPENDIX_4
    )
    log = Measurements(readings.actuators, measured)
    robots = 2000
    runs = {
        "forward kinematics of equal legs, closed form": (
            lambda: forward_kinematics(geometry, actuators), CELLS**2
        ),
        "forward kinematics of unequal legs": (
            lambda: solve_pose(geometry, equal + drawn, actuators, poses), CELLS**2
        ),
        "derivatives by 42 lengths": (
            lambda: sensitivities(geometry, equal, nominal_pose(geometry, poses)), CELLS**2
        ),
        "errors by tolerances": (lambda: tolerance_errors(APPENDIX_4, poses), CELLS**2),
        "random robots at one pose": (
            lambda: monte_carlo(APPENDIX_4, poses[0], robots=robots), robots
        ),
        "calibration, 60 poses of six coordinates": (lambda: calibrate(APPENDIX_4, log), 1),
        "choice of 60 poses": (lambda: measuring_poses(APPENDIX_4, 60), 1),
    }  # fmt: skip
    times = {name: (best(run), count) for name, (run, count) in runs.items()}
    first = next(iter(times.values()))
    unit = first[0] / first[1]
    heading(f"Unequal legs, {CELLS}x{CELLS} poses")
    rows = [
        [name, number(1e3 * wall), number(1e6 * wall / count), number(wall / count / unit)]
        for name, (wall, count) in times.items()
    ]
    table(["what", "ms", "µs each", "times the closed form"], rows)


if __name__ == "__main__":
    main()
