"""MuJoCo and Pinocchio agree with first principles and with the model."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines import EngineMissing, why_missing
from paminsa_viz.engines.closed_loop import ClosedLoopRobot, _solve
from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.engines.missing import is_installed
from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.engines.pinocchio_model import PinocchioRobot
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.statics import static_torques
from tests import oracle
from tests.support import samples
from tests.support.cases import BOTH
from tests.support.samples import with_knee

Engine = type[ClosedLoopRobot]
RANDOM = samples.random_design(np.random.default_rng(1))
EACH = samples.each_robot(range(2))
SHARP = 1e-11
"""Relative to the largest value of each actuator; a millionth is asked for."""


@pytest.fixture(params=["mujoco", "pinocchio"])
def engine(request: pytest.FixtureRequest) -> Engine:
    pytest.importorskip(request.param, reason=f"{request.param} comes with the extra 'verify'")
    return MujocoRobot if request.param == "mujoco" else PinocchioRobot


def worst(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference relative to the largest value of the same actuator."""
    return float((np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)).max())


@pytest.mark.slow
@EACH
def test_static_torques(engine: Engine, design: Design) -> None:
    poses = samples.random_poses(np.random.default_rng(1), design, 40, natural=False)
    found = engine(design).static_torques(poses)
    assert worst(found, oracle.static_torques(design, poses)) < SHARP
    assert worst(static_torques(design, poses), found) < SHARP


@pytest.mark.slow
@EACH
def test_dynamic_torques(engine: Engine, design: Design) -> None:
    states = samples.random_states(np.random.default_rng(2), design, 40)
    found = engine(design).inverse_dynamics(*states)
    assert worst(found, oracle.inverse_dynamics(design, *states)) < SHARP
    assert worst(inverse_dynamics(design, *states).torque, found) < SHARP


@pytest.mark.parametrize("frame", list(LoadFrame))
def test_loads_and_wrenches_on_top_of_them(engine: Engine, frame: LoadFrame) -> None:
    """With drives, whose rotors turn with the legs; every component of a wrench off the center."""
    load = LoadCase(
        30.0, -20.0, -80.0, 2.0, -3.0, 4.0, point_x=0.05, point_y=-0.03, point_z=0.02, frame=frame
    )
    servo = Drive("servo", rotor_inertia=1e-4, gear_ratio=50.0)
    axis = Drive("axis", rotor_inertia=2e-5, transmission="screw", lead=0.01)
    design = replace(RANDOM, load=load, drives=(servo, None, servo, axis))
    states = samples.random_states(np.random.default_rng(2), design, 20)
    robot = engine(design)
    assert worst(robot.inverse_dynamics(*states), inverse_dynamics(design, *states).torque) < SHARP
    extra = np.random.default_rng(3).normal(size=(20, 6)) * 20
    found = robot.inverse_dynamics(*states, load=extra)
    names = ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z")
    for row, wrench in enumerate(extra):
        more = {
            f"load.{n}": design.value(f"load.{n}") + w for n, w in zip(names, wrench, strict=True)
        }
        exact = inverse_dynamics(design.vary(more), *(part[row] for part in states)).torque
        np.testing.assert_allclose(found[row], exact, rtol=1e-9, atol=1e-8)
    # one wrench serves every state; without the design's own load it is the only one
    bare = replace(design, load=LoadCase(point_x=0.05, point_y=-0.03, point_z=0.02, frame=frame))
    plain = engine(bare)
    assert worst(plain.static_torques(states[0]), static_torques(bare, states[0])) < SHARP
    found = plain.inverse_dynamics(*states, load=load.wrench)
    assert worst(found, inverse_dynamics(design, *states).torque) < SHARP


def test_forces_that_a_program_has_left_on_the_joints_count_for_nothing(mujoco: Any) -> None:
    """With servos that hold an exported model, and its load."""
    load = LoadCase(30.0, -20.0, -80.0, 2.0, -3.0, 4.0, point_x=0.05)
    design = replace(RANDOM, load=load)
    robot = MujocoRobot(design, xml=exported_mjcf(design))
    states = samples.random_states(np.random.default_rng(4), design, 5)
    left = np.random.default_rng(5).normal(size=(2, robot.model.nv))
    robot.data.qfrc_applied[:], robot.data.qfrc_actuator[:] = left
    found = robot.inverse_dynamics(*states)
    assert worst(found, inverse_dynamics(design, *states).torque) < SHARP


def test_a_stack_with_a_singular_system_has_nan_there_alone() -> None:
    matrix = np.stack([2.0 * np.eye(3), np.zeros((3, 3)), np.diag([1.0, 2.0, 4.0])])
    found = _solve(matrix, np.ones((3, 3, 2)))
    assert found.shape == (3, 3, 2)
    np.testing.assert_array_equal(found[0], 0.5)
    assert np.isnan(found[1]).all()
    np.testing.assert_allclose(found[2, :, 1], [1.0, 0.5, 0.25])


def test_a_state_has_the_robots_pose_and_one_out_of_reach_none(engine: Engine) -> None:
    robot = engine(APPENDIX_4)
    pose, rate = np.array([0.05, -0.02, 0.3, -0.55]), np.array([0.1, 0.2, -0.3, 0.4])
    q, v = robot.state(pose, rate)
    np.testing.assert_allclose(robot.pose(q), pose, atol=1e-12)
    ahead, _ = robot.state(pose + 1e-6 * rate, rate)
    behind, _ = robot.state(pose - 1e-6 * rate, rate)
    np.testing.assert_allclose((ahead - behind) / 2e-6, v, atol=1e-6)
    with pytest.raises(PaminsaError, match="the bars cannot close at x 5000 mm"):
        robot.state([5.0, 0.0, 0.0, -0.5], rate)


def test_a_model_of_another_robot_is_refused(engine: Engine) -> None:
    robot = engine(APPENDIX_4)
    names = robot._names
    robot._set_order(reversed(names))
    with pytest.raises(InvalidInput, match=r"model: its joints are not those of this robot \(door"):
        robot._set_order([*names, "door"])
    with pytest.raises(InvalidInput, match="model: its joints are not"):
        robot._set_order(names[1:])


@BOTH
def test_kinetic_energy_from_the_mass_matrix(engine: Engine, knee: KneeBranch) -> None:
    design = RANDOM
    poses, rates, _ = samples.random_states(np.random.default_rng(3), with_knee(design, knee), 20)
    inertia = engine(with_knee(design, knee)).actuator_inertia(poses)
    speed = oracle.actuator_rates(design, poses, rates)
    energy = 0.5 * np.einsum("ni,nij,nj->n", speed, inertia, speed)
    np.testing.assert_allclose(
        energy, oracle.kinetic(with_knee(design, knee), poses, rates), rtol=1e-11
    )


@BOTH
def test_massless_parts_and_no_gravity(engine: Engine, knee: KneeBranch) -> None:
    """Zeros that a design may have, though an engine may not."""
    design = APPENDIX_4.vary(
        {
            "joints.j7": 0.0, "links.b7": 0.0, "joints.j8": 0.0, "links.b1": 0.0,
            "inertias.b7_axial": 0.0, "inertias.b7_transverse": 0.0,
            "inertias.b10_vertical": 0.0, "platform.inertia": 0.0, "links.b10": 0.0,
        }
    )  # fmt: skip
    states = samples.random_states(np.random.default_rng(5), with_knee(design, knee), 20)
    found = engine(with_knee(design, knee)).inverse_dynamics(*states)
    assert worst(found, oracle.inverse_dynamics(with_knee(design, knee), *states)) < SHARP
    afloat = design.vary({"gravity": 0.0})
    assert np.abs(engine(with_knee(afloat, knee)).static_torques(states[0])).max() < 1e-12


def test_batches_and_poses_out_of_reach(engine: Engine) -> None:
    robot = engine(APPENDIX_4)
    poses = samples.random_poses(np.random.default_rng(6), n=6)
    flat = robot.static_torques(poses)
    np.testing.assert_allclose(robot.static_torques(poses.reshape(2, 3, 4)), flat.reshape(2, 3, 4))
    np.testing.assert_allclose(robot.static_torques(poses[3]), flat[3])
    pushed = engine(replace(APPENDIX_4, load=LoadCase(force_x=5.0, force_z=-20.0)))
    apart = [pushed.static_torques(pose) for pose in poses]
    for shape in ((6,), (2, 3), (3, 1, 2)):
        found = pushed.static_torques(poses.reshape(*shape, 4))
        np.testing.assert_allclose(found, np.reshape(apart, (*shape, 4)))
    mixed = np.array([poses[0], [0.0, 0.0, 0.0, -3.0], [np.nan, 0.0, 0.0, -0.5], poses[1]])
    found = robot.static_torques(mixed)
    np.testing.assert_allclose(found[[0, 3]], flat[:2])
    assert np.isnan(found[1:3]).all()
    assert robot.static_torques(np.empty((0, 4))).shape == (0, 4)
    inertia = robot.actuator_inertia(mixed.reshape(2, 2, 4))
    np.testing.assert_allclose(inertia[0, 0], robot.actuator_inertia(poses[0]))
    np.testing.assert_allclose(inertia[1, 1], robot.actuator_inertia(poses[1]))
    assert np.isnan(inertia[[0, 1], [1, 0]]).all()
    with pytest.raises(InvalidInput, match="poses"):
        robot.static_torques(poses[:, :3])


@pytest.mark.parametrize(
    ("module", "robot", "install"),
    [
        ("mujoco", MujocoRobot, "part of the installation: pip install mujoco"),
        ("pinocchio", PinocchioRobot, 'pip install "paminsa-viz[verify]"'),
    ],
)
def test_a_missing_engine_is_named_with_what_brings_it(
    monkeypatch: pytest.MonkeyPatch, module: str, robot: Engine, install: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    is_installed.cache_clear()
    with pytest.raises(EngineMissing) as caught:
        robot(APPENDIX_4)
    assert caught.value.engine in str(caught.value)
    assert install in str(caught.value)
    assert why_missing(caught.value.engine) == str(caught.value)
    is_installed.cache_clear()
    assert isinstance(caught.value, PaminsaError)
    assert isinstance(caught.value, ImportError)


def test_an_engine_that_is_installed_is_not_missing(engine: Engine) -> None:
    is_installed.cache_clear()
    assert why_missing("MuJoCo" if engine is MujocoRobot else "Pinocchio") == ""


def test_cause_of_a_failed_import_is_reported() -> None:
    error = EngineMissing("MuJoCo", ImportError("libGL.so: cannot open shared object file"))
    assert "does not load (libGL.so" in str(error)
    assert "is not installed" in str(EngineMissing("MuJoCo", ModuleNotFoundError("mujoco")))
