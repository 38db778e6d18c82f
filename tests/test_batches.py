"""Public functions of poses: an empty batch and poses that are no poses give no error."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz import clearance, elastostatics, identification, precision
from paminsa_viz.actuation import capability
from paminsa_viz.model import (
    APPENDIX_4,
    Drive,
    InvalidInput,
    center_wrench,
    drive_regressor,
    inverse_dynamics,
    inverse_kinematics,
    measure_singularity,
    static_torques,
    torque_breakdown,
)

G = APPENDIX_4.geometry

FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "static_torques": lambda p: static_torques(APPENDIX_4, p),
    "inverse_dynamics": lambda p: inverse_dynamics(APPENDIX_4, p, np.zeros(4), np.zeros(4)).torque,
    "inverse_kinematics": lambda p: inverse_kinematics(G, p).points[9],
    "measure_singularity": lambda p: measure_singularity(G, p).condition,
    "capability": lambda p: capability(APPENDIX_4, p).payload,
    "joint_forces": lambda p: elastostatics.joint_forces(APPENDIX_4, p).of("5"),
    "bar_loads": lambda p: elastostatics.bar_loads(
        elastostatics.joint_forces(APPENDIX_4, p), "b4"
    ).extremes(),
    "utilization": lambda p: elastostatics.utilization(elastostatics.joint_forces(APPENDIX_4, p)),
    "platform_stiffness": lambda p: elastostatics.platform_stiffness(APPENDIX_4, p).compliance,
    "drive_stiffness": lambda p: elastostatics.drive_stiffness(APPENDIX_4, p),
    "first_frequencies": lambda p: elastostatics.first_frequencies(APPENDIX_4, p),
    "clearance": lambda p: clearance.clearance(APPENDIX_4, p).least,
    "drive_errors": lambda p: precision.drive_errors(G, APPENDIX_4.accuracy, p).worst,
    "tolerance_errors": lambda p: precision.tolerance_errors(APPENDIX_4, p).worst,
    "manufactured_pose": lambda p: precision.manufactured_pose(APPENDIX_4, p).pose,
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_empty_batches_and_poses_out_of_reach_are_no_error(name: str) -> None:
    function = FUNCTIONS[name]
    poses = np.full((5, 4), [0.0, 0.0, 0.0, -0.5])
    poses[1, 2], poses[2, 3], poses[3, 0], poses[4, 2] = np.nan, -np.inf, 9.0, np.inf
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = np.asarray(function(poses))
        empty = [np.asarray(function(np.zeros(shape))) for shape in ((0, 4), (2, 0, 4))]
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1:]).all()
    assert [item.shape for item in empty] == [(0, *found.shape[1:]), (2, 0, *found.shape[1:])]


ONE_DRIVE = replace(APPENDIX_4, drives=(Drive(rotor_inertia=1e-4, gear_ratio=50.0), *[None] * 3))
"""A robot with a drive's inertia at M1 and none at the others."""

OF_MOTION: dict[str, Callable[..., Any]] = {
    "inverse_dynamics": lambda *motion: inverse_dynamics(ONE_DRIVE, *motion).torque,
    "torque_breakdown": lambda *motion: torque_breakdown(ONE_DRIVE, *motion).total,
    "drive_regressor": lambda *motion: drive_regressor(G, *motion),
    "leg_base_regressor": lambda *motion: identification.leg_base_regressor(G, *motion),
}


@pytest.mark.parametrize("name", OF_MOTION)
@pytest.mark.parametrize("order", [1, 2], ids=["velocity", "acceleration"])
def test_a_motion_without_bound_is_not_finite_in_its_own_row_alone(name: str, order: int) -> None:
    motion = [np.full((5, 4), [0.0, 0.05, 0.1, -0.5]), np.full((5, 4), 0.1), np.full((5, 4), 0.2)]
    wanted = np.asarray(OF_MOTION[name](*motion))
    for row, value in enumerate((np.inf, -np.inf, np.nan, 1e200), start=1):
        motion[order][row, 2] = value
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = np.asarray(OF_MOTION[name](*motion))
    np.testing.assert_allclose(found[0], wanted[0], rtol=1e-12)
    assert not np.isfinite(found[1:4].reshape(3, -1)).all(axis=1).any()


def test_a_start_without_bound_has_no_pose_of_unequal_legs() -> None:
    at = inverse_kinematics(G, [0.0, 0.05, 0.1, -0.5]).actuators
    near = np.full((4, 4), [0.0, 0.05, 0.1, -0.5])
    near[1, 2], near[2, 2], near[3, 0] = np.inf, np.nan, 1e200
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = precision.solve_pose(G, precision.nominal_lengths(G), at, near)
    np.testing.assert_allclose(found.pose[0], near[0], atol=1e-12)
    assert np.isnan(found.pose[1:]).all()
    assert found.ok.tolist() == [True, False, False, False]


def test_functions_of_one_pose_and_of_an_angle_say_what_they_need() -> None:
    with pytest.raises(InvalidInput, match=r"pose: one pose \(4,\) is needed; got \(2, 4\)"):
        elastostatics.robot_modes(APPENDIX_4, np.zeros((2, 4)))
    with pytest.raises(InvalidInput, match="theta: real numbers are needed"):
        center_wrench(APPENDIX_4.load, "x")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        modes = elastostatics.robot_modes(APPENDIX_4, [0.0, 0.0, np.inf, -0.5])
    assert np.isnan(modes.frequencies).all()
    assert precision.monte_carlo(APPENDIX_4, np.zeros((0, 4)), robots=3).errors.shape == (3, 0, 6)
