"""Stiffness of the drives alone under load, against differences of wrenches and energies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.elastostatics.drive_stiffness import drive_stiffness, gravity_stiffness
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.energy import potential_energy
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.load import LoadFrame
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


def test_gravity_stiffness_is_the_second_derivative_of_the_energy() -> None:
    pose = np.array(POSE)
    steps = 1e-3 * np.eye(4)
    hessian = np.array(
        [[sum(a * b * float(potential_energy(APPENDIX_4, pose + a * s + b * t))
              for a in (-1, 1) for b in (-1, 1)) / 4e-6 for t in steps] for s in steps]
    )  # fmt: skip
    np.testing.assert_allclose(gravity_stiffness(APPENDIX_4, pose), hessian, atol=2e-3)
