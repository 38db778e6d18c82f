"""Stiffness of the drives alone under load, against differences of wrenches and energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.elastostatics.drive_stiffness import (
    POSE_AXES,
    drive_stiffness,
    geometric_stiffness,
    gravity_stiffness,
    load_tilt_stiffness,
)
from paminsa_viz.elastostatics.leg_matrices import leg_matrices
from paminsa_viz.elastostatics.vibration import reduced_robot
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.energy import potential_energy
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.leg import knee_height, mechanism, pantograph
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.parameters import Payload
from paminsa_viz.model.statics import static_imbalance, static_torques
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
        known = replace(APPENDIX_4, load=load)
        expected = geometric_stiffness(known, POSE) - geometric_stiffness(APPENDIX_4, POSE)
        np.testing.assert_allclose((loaded - plain)[:6, :6], expected, atol=1e-6)


def test_what_loads_add_is_that_of_the_drives_alone_and_in_tilt_that_of_the_energy() -> None:
    """Every leg a rigid pantograph that motors pull with constant torques, the shafts with forces.

    At rest these make the energy stationary; its second differences are the stiffness.
    """
    load = LoadCase(4.0, -7.0, -90.0, 2.0, 3.0, -5.0, 0.1, 0.2, -0.3)
    raised = APPENDIX_4.vary({"geometry.platform_joint_height": 0.08})
    for design in (
        replace(raised, payload=Payload(mass=3.0, height=0.11), load=load),
        replace(raised, load=replace(load, frame=LoadFrame.PLATFORM)),
        replace(APPENDIX_4, payload=Payload(mass=5.0)),
    ):
        found = geometric_stiffness(design, POSE)
        rigid = drive_stiffness(design, POSE) - drive_stiffness(design, POSE, loaded=False)
        block = np.ix_(POSE_AXES, POSE_AXES)
        np.testing.assert_allclose(found[block], 0.5 * (rigid + rigid.T), atol=1e-8)
        if design.load.frame is LoadFrame.WORLD:
            gradient, hessian = _differences(_held_energy(design, np.array(POSE)), 5e-4)
            np.testing.assert_allclose(gradient, 0.0, atol=1e-3)
            np.testing.assert_allclose(found, hessian, atol=5e-3)
    # the platform's weight and the payload's hang from joints l_B5 above P
    lower = design.vary({"geometry.platform_joint_height": 0.0})
    moved = [*POSE[:3], POSE[3] + design.geometry.platform_joint_height]
    hung = (geometric_stiffness(design, POSE) - geometric_stiffness(lower, moved))[3:5, 3:5]
    weight = (design.platform.mass + 5.0) * design.gravity
    assert np.diag(hung) == pytest.approx([weight * 0.0275] * 2, rel=0.2)


def _held_energy(design: Design, pose: Array) -> Callable[[Array], float]:
    """Return the energy of a twist: weight and load, less the work of motors and shafts."""
    g, radius = design.geometry, design.geometry.platform_radius
    angles = np.radians([210.0, -30.0, 90.0])
    axes = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    body = radius * axes + [0.0, 0.0, g.platform_joint_height]
    torque, m = static_torques(design, pose), mechanism(g)
    turn = Rotation.from_rotvec([0.0, 0.0, pose[2]])
    center, load = pose[[0, 1, 3]], design.load

    def parts(twist: Array) -> Array:
        """Return the energy without the shafts' work, and the heights of the joints 5."""
        now = Rotation.from_rotvec(twist[3:]) * turn
        p = center + twist[:3]
        out = p + now.apply(body) - g.base_radius * axes
        start = center + turn.apply(body) - g.base_radius * axes
        knees = knee_height(m, pantograph(m, out[:, 0] ** 2 + out[:, 1] ** 2, out[:, 2]), out[:, 2])
        turned = np.arctan2(
            start[:, 0] * out[:, 1] - start[:, 1] * out[:, 0], (start * out)[:, :2].sum(axis=1)
        )
        total = static_imbalance(design) * knees[0].sum() - torque[:3] @ turned
        total += design.gravity * design.platform.mass * p[2]
        hung = p + now.apply([0.0, 0.0, design.payload.height])
        total += design.gravity * design.payload.mass * hung[2]
        total -= load.wrench[:3] @ (p + now.apply(load.point)) + load.wrench[3:] @ twist[3:]
        return np.r_[total, out[:, 2]]

    slopes = np.array([(parts(s) - parts(-s)) / 2e-6 for s in 1e-6 * np.eye(6)[[2, 3, 4]]])
    shafts = np.linalg.solve(slopes[:, 1:], slopes[:, 0])
    return lambda twist: float(parts(twist) @ np.r_[1.0, -shafts])


def _differences(energy: Callable[[Array], float], step: float) -> tuple[Array, Array]:
    """Return first and second central differences."""
    steps, signs = step * np.eye(6), ((1, 1), (1, -1), (-1, 1), (-1, -1))
    gradient = [(energy(s) - energy(-s)) / (2 * step) for s in steps]
    hessian = [
        [sum(a * b * energy(a * s + b * t) for a, b in signs) / (4 * step**2) for t in steps]
        for s in steps
    ]
    return np.array(gradient), np.array(hessian)


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
