"""The robot and its controller at one state, against the model's own functions."""

from __future__ import annotations

import ast
import inspect
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.clearance import search
from paminsa_viz.model import (
    APPENDIX_4,
    actuator_velocity,
    backend,
    forward_dynamics,
    friction_torque,
    inverse_dynamics,
    inverse_kinematics,
)
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import generalized_force
from paminsa_viz.trajectory import Controller, ControlMode, equations, plant, point_to_point
from paminsa_viz.trajectory.equations import robot_numbers
from tests.trajectory.plans import FRICTION, A, B

ROBOT = APPENDIX_4.vary(
    {**FRICTION, "payload.mass": 1.0, "load.force_x": 30.0, "load.moment_z": 2.0,
     "load.point_y": 0.05, "load.force_z": -50.0}
)  # fmt: skip
SERVO = Drive("servo", rotor_inertia=2e-4, gear_ratio=50.0, viscous=1e-3, coulomb=0.02)
AXIS = Drive("axis", rotor_inertia=1e-4, transmission="screw", lead=0.01)
ROBOT = replace(ROBOT, drives=(SERVO, replace(SERVO, gear_ratio=30.0), SERVO, AXIS))
MODEL = ROBOT.vary({"payload.mass": 0.2, "friction.viscous_rotary": 0.1})
PLAIN = point_to_point(A, B, 0.6).sample(30)
SWINGING = replace(
    PLAIN, load=np.sin(PLAIN.t[:, None] * 9.0 + np.arange(6)) * [30.0, 30.0, 50.0, 5.0, 5.0, 4.0]
)
RNG = np.random.default_rng(3)
STATES = [(0.6 * share, RNG.normal(size=(2, 4)) * 0.02) for share in (0.0, 0.31, 0.77, 1.0)]


def table(trajectory: Any) -> Any:
    load = np.zeros((trajectory.size, 6)) if trajectory.load is None else trajectory.load
    return np.hstack([trajectory.pose, trajectory.velocity, trajectory.acceleration, load])


@pytest.mark.parametrize("t", [-0.3, 0.0, 0.05, PLAIN.t[7], 0.31, 0.6, 0.9])
def test_what_is_wanted_is_the_trajectory_at_a_time(t: float) -> None:
    found = plant.wanted_at(t, SWINGING.t, table(SWINGING))
    for one, other in zip(found[:3], SWINGING.at(t), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
    np.testing.assert_allclose(found[3], SWINGING.load_at(np.array([t]))[0], atol=1e-12)


@pytest.mark.parametrize("control", ControlMode)
@pytest.mark.parametrize(("t", "off"), STATES, ids=["start", "early", "late", "end"])
def test_a_controller_commands_what_its_model_says(
    control: ControlMode, t: float, off: Any
) -> None:
    gains = Controller(control, bandwidth=3.0, damping=0.7).gains(MODEL, A)
    goal, rate, growth = SWINGING.at(t)
    pose, velocity = goal + off[0], rate + off[1]
    load = SWINGING.load_at(np.array([t]))[0]
    found = plant.command(robot_numbers(MODEL), gains, (goal, rate, growth, load), pose, velocity)
    wide = 6.0 * np.pi
    if control is ControlMode.COMPUTED_TORQUE:
        growth = growth - wide**2 * off[0] - 2.0 * 0.7 * wide * off[1]
        expected = inverse_dynamics(MODEL, pose, velocity, growth, load=load).torque
    else:
        expected = inverse_dynamics(MODEL, goal, rate, growth, load=load).torque
    if control is ControlMode.PD:
        there, here = (inverse_kinematics(MODEL.geometry, one).actuators for one in (goal, pose))
        slip = actuator_velocity(MODEL, goal, rate) - actuator_velocity(MODEL, pose, velocity)
        turn = there - here
        turn[:3] = np.angle(np.exp(1j * turn[:3]))
        expected = expected + gains.proportional * turn + gains.derivative * slip
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("trajectory", [PLAIN, SWINGING], ids=["plain", "swinging"])
@pytest.mark.parametrize(("t", "off"), STATES, ids=["start", "early", "late", "end"])
def test_a_state_changes_as_forward_dynamics_and_powers_say(
    trajectory: Any, t: float, off: Any
) -> None:
    gains = Controller(bandwidth=3.0).gains(MODEL, A)
    goal, rate, _ = trajectory.at(t)
    pose, velocity = goal + off[0], rate + off[1]
    load = None if trajectory.load is None else trajectory.load_at(np.array([t]))[0]
    with backend.use_numpy():
        derivative, torques = equations.equations(ROBOT, MODEL, gains, trajectory)
    state = np.concatenate([pose, velocity, [1.0, 2.0, 3.0]])
    found = derivative(t, state)
    torque = torques(np.array([t]), state[None])[0]
    speed = actuator_velocity(ROBOT, pose, velocity)
    push = generalized_force(ROBOT.load, np.array(pose[2]), load)
    np.testing.assert_array_equal(found[:4], velocity)
    back = inverse_dynamics(ROBOT, pose, velocity, found[4:8], load=load).torque
    np.testing.assert_allclose(back, torque, rtol=1e-8, atol=1e-8)
    assert found[8:] == pytest.approx(
        [torque @ speed, friction_torque(ROBOT.actuator_friction, speed) @ speed, push @ velocity]
    )
    np.testing.assert_array_equal(derivative(t, state[:10]), found[:10])
    exact = forward_dynamics(ROBOT, pose, velocity, torque, load=load)
    np.testing.assert_allclose(found[4:8], exact, rtol=1e-8)


def test_a_state_that_bars_cannot_close_has_no_derivative() -> None:
    gains = Controller().gains(APPENDIX_4, A)
    with backend.use_numpy():
        derivative, torques = equations.equations(APPENDIX_4, APPENDIX_4, gains, PLAIN)
    lost = np.concatenate([[0.0, 0.0, 0.0, -5.0], np.zeros(6)])
    assert np.isnan(derivative(0.1, lost)[4:8]).all()
    assert torques(np.zeros(0), np.zeros((0, 10))).shape == (0, 4)


@pytest.mark.parametrize("module", [plant, search], ids=["plant", "clearance"])
def test_compiled_formulas_work_entry_by_entry(module: Any) -> None:
    """Products of matrices, solvers and assignments of slices take Numba seconds each."""
    for node in ast.walk(ast.parse(inspect.getsource(module))):
        assert not isinstance(node, ast.MatMult)
        assert not (isinstance(node, ast.Attribute) and node.attr == "linalg")
        if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
            assert not any(isinstance(part, ast.Slice) for part in ast.walk(node.slice)), (
                node.lineno
            )
