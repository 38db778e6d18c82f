"""Accuracy: errors of the drives, unequal legs, tolerances and clearances, calibration.

Lengths of the legs are (3 legs, 14) arrays in the order of `LENGTHS`; errors of a pose are in the
order x, y, theta, z, and tilt about x and y where the legs are unequal.
"""

from __future__ import annotations

from paminsa_viz.precision.calibration import Calibration, Combination, calibrate
from paminsa_viz.precision.calibration_plan import CalibrationPlan, plan_calibration
from paminsa_viz.precision.calibration_problem import measuring_poses
from paminsa_viz.precision.drive_errors import Bound, DriveErrors, drive_errors, field_drive_errors
from paminsa_viz.precision.leg_lengths import (
    LENGTHS,
    LegLength,
    design_lengths,
    nominal_lengths,
    with_deviations,
)
from paminsa_viz.precision.manufacture import (
    MonteCarlo,
    ToleranceErrors,
    design_sensitivities,
    manufactured_pose,
    monte_carlo,
    tolerance_errors,
)
from paminsa_viz.precision.measurements import (
    Measurements,
    PredictionErrors,
    coordinate_scales,
    predict,
    prediction_errors,
    simulated_measurements,
)
from paminsa_viz.precision.unequal_legs import (
    Closure,
    Sensitivities,
    UnequalPose,
    sensitivities,
    solve_actuators,
    solve_pose,
)

__all__ = [
    "LENGTHS",
    "Bound",
    "Calibration",
    "CalibrationPlan",
    "Closure",
    "Combination",
    "DriveErrors",
    "LegLength",
    "Measurements",
    "MonteCarlo",
    "PredictionErrors",
    "Sensitivities",
    "ToleranceErrors",
    "UnequalPose",
    "calibrate",
    "coordinate_scales",
    "design_lengths",
    "design_sensitivities",
    "drive_errors",
    "field_drive_errors",
    "manufactured_pose",
    "measuring_poses",
    "monte_carlo",
    "nominal_lengths",
    "plan_calibration",
    "predict",
    "prediction_errors",
    "sensitivities",
    "simulated_measurements",
    "solve_actuators",
    "solve_pose",
    "tolerance_errors",
    "with_deviations",
]
