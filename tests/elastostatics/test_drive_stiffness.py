"""Stiffness of the drives alone under load, against differences of wrenches and energies."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.elastostatics.drive_stiffness import (
    drive_stiffness,
    geometric_stiffness,
    gravity_stiffness,
    load_tilt_stiffness,
)
from paminsa_viz.elastostatics.leg_matrices import leg_matrices
from paminsa_viz.elastostatics.vibration import reduced_robot
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.energy import potential_energy
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.parameters import Payload
from paminsa_viz.model.statics import static_torques
from tests.elastostatics.robots import POSE, elastic_design, poses_of
from tests.elastostatics.test_stiffness import relative


@pytest.mark.parametrize("frame", LoadFrame)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_loaded_drives_follow_from_the_wrench_that_keeps_a_displaced_pose(seed, frame) -> None:
    """Motors locked at the torques that hold the pose: differences of the wrench, without K."""
    design = elastic_design(seed).vary(
        {"load.force_x": 20.0, "load.force_z": -50.0, "load.moment_z": 2.0, "load.point_x": 0.05,
         "load.point_y": -0.1, "payload.mass": 5.0}
    )  # fmt: skip
    design = replace(design, load=replace(design.load, frame=frame))
    pose = poses_of(design, 1, seed)[0]
    k = np.array([design.elastic.drive_rotary] * 3 + [design.elastic.drive_linear])
    at = inverse_kinematics(design.geometry, pose).actuators
    motors = at + static_torques(design, pose) / k

    def missing(p: np.ndarray) -> np.ndarray:
        """What has to be added at the platform to hold pose p with these motors."""
        q = inverse_kinematics(design.geometry, p).actuators
        short = static_torques(design, p) - k * (motors - q)
        return inverse_jacobian(design.geometry, p).T @ short

    assert np.abs(missing(pose)).max() < 1e-6
    steps = 1e-6 * np.eye(4)
    difference = np.stack([(missing(pose + s) - missing(pose - s)) / 2e-6 for s in steps], axis=-1)
    found = drive_stiffness(design, pose)
    assert relative(found, difference) < 1e-6
    plain = drive_stiffness(design, pose, loaded=False)
    assert np.abs(found - plain).max() > 1.0
    symmetric = np.allclose(found, found.T, rtol=1e-9, atol=1e-6)
    assert symmetric == (frame is LoadFrame.WORLD)


@pytest.mark.parametrize("frame", LoadFrame)
def test_what_loads_add_is_symmetric_and_the_same_alone_and_among_others(frame) -> None:
    load = LoadCase(20.0, -5.0, -50.0, moment_z=2.0, point_x=0.05, point_y=-0.1, frame=frame)
    design = replace(APPENDIX_4, load=load)
    poses = poses_of(design, 4)
    for found, each in (
        (geometric_stiffness(design, poses), [geometric_stiffness(design, p) for p in poses]),
        (load_tilt_stiffness(load, poses[:, 2]), [load_tilt_stiffness(load, p[2]) for p in poses]),
    ):
        np.testing.assert_array_equal(found, np.swapaxes(found, 1, 2))
        np.testing.assert_allclose(found, each, rtol=1e-12, atol=1e-9)
        assert np.abs(found).max() > 1.0


def test_gravity_stiffness_is_the_second_derivative_of_the_energy() -> None:
    pose = np.array(POSE)
    steps = 1e-3 * np.eye(4)
    hessian = np.array(
        [[sum(a * b * float(potential_energy(APPENDIX_4, pose + a * s + b * t))
              for a in (-1, 1) for b in (-1, 1)) / 4e-6 for t in steps] for s in steps]
    )  # fmt: skip
    np.testing.assert_allclose(gravity_stiffness(APPENDIX_4, pose), hessian, atol=2e-3)


def test_a_force_off_the_center_stiffens_the_tilt_as_a_weight_there_does() -> None:
    weight = 3.0 * APPENDIX_4.gravity
    hung = replace(APPENDIX_4, payload=Payload(mass=3.0, height=0.11))
    pushed = replace(APPENDIX_4, load=LoadCase(force_z=-weight, point_z=0.11))
    first, second = (
        reduced_robot(leg_matrices(d), np.array([POSE])).stiffness for d in (hung, pushed)
    )
    np.testing.assert_allclose(first, second, atol=1e-9 * np.abs(first).max())
    turning = LoadCase(4.0, -7.0, -90.0, 2.0, 3.0, -5.0, 0.1, 0.2, -0.3, LoadFrame.PLATFORM)
    for load in (turning, replace(turning, frame=LoadFrame.WORLD)):
        loaded, plain = (
            reduced_robot(leg_matrices(d), np.array([POSE])).stiffness[0]
            for d in (replace(APPENDIX_4, load=load), APPENDIX_4)
        )
        tilts = np.ix_([3, 4], range(6))
        expected = load_tilt_stiffness(load, POSE[2])[tilts]
        np.testing.assert_allclose((loaded - plain)[tilts], expected, atol=1e-6)
        assert np.abs(expected - load_tilt_stiffness(load, POSE[3])[tilts]).max() > 1.0


@pytest.mark.parametrize("frame", LoadFrame)
def test_tilt_stiffness_of_a_load_is_the_slope_of_its_wrench(frame: LoadFrame) -> None:
    load, step = LoadCase(4.0, -7.0, 11.0, 2.0, 3.0, -5.0, 0.1, 0.2, -0.3, frame), 1e-6
    turn = Rotation.from_rotvec([0.0, 0.0, 0.7])
    slope = np.zeros((6, 6))
    for tilt, sign in product(step * np.eye(3), (1, -1)):
        now = Rotation.from_rotvec(sign * tilt) * turn
        own = now if frame is LoadFrame.PLATFORM else Rotation.identity()
        force = own.apply(load.wrench[:3])
        moment = own.apply(load.wrench[3:]) + np.cross(now.apply(load.point), force)
        slope[:, 3:] -= sign * np.outer(np.r_[force, moment], tilt) / (2 * step**2)
    found = load_tilt_stiffness(load, 0.7)
    tilts = np.ix_([3, 4], range(6))
    np.testing.assert_allclose(found[tilts], 0.5 * (slope + slope.T)[tilts], atol=1e-8)
    assert not found[np.ix_([0, 1, 2, 5], [0, 1, 2, 5])].any()
