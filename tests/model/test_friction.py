"""Friction at the actuators: none by default, dissipative, smooth, and of the stated size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Friction,
    InvalidInput,
    actuator_velocity,
    friction_torque,
    inverse_dynamics,
    torque_breakdown,
)
from tests.support.cases import BY_HAND, Case, assert_close, assert_within, cases

SIZES = st.floats(0.0, 100.0)
FRICTIONS = st.builds(
    Friction,
    viscous_rotary=SIZES,
    coulomb_rotary=SIZES,
    viscous_linear=SIZES,
    coulomb_linear=SIZES,
    transition_speed=st.floats(1e-4, 1.0),
)
SPEEDS = st.lists(st.floats(-50.0, 50.0), min_size=4, max_size=4).map(np.array)


def test_the_paper_has_none() -> None:
    assert Friction().by_actuator.zero
    assert APPENDIX_4.actuator_friction.zero
    np.testing.assert_array_equal(friction_torque(Friction(), [1.0, -2.0, 3.0, 4.0]), 0.0)


@pytest.mark.parametrize(
    "field", ["viscous_rotary", "coulomb_rotary", "viscous_linear", "coulomb_linear"]
)
def test_one_coefficient_is_enough(field: str) -> None:
    friction = Friction(**{field: 0.5})
    assert not friction.by_actuator.zero
    torque = friction_torque(friction, [2.0, 2.0, 2.0, 2.0])
    size = 1.0 if field.startswith("viscous") else 0.5
    expected = [0.0, 0.0, 0.0, size] if field.endswith("linear") else [size, size, size, 0.0]
    assert_within(torque, expected, 1e-12)


@given(friction=FRICTIONS, speed=SPEEDS)
def test_it_resists_every_motion_and_is_odd(friction: Friction, speed: np.ndarray) -> None:
    torque = friction_torque(friction, speed)
    assert (torque * speed >= 0).all()
    np.testing.assert_array_equal(friction_torque(friction, -speed), -torque)
    np.testing.assert_array_equal(friction_torque(friction, np.zeros(4)), 0.0)


@given(friction=FRICTIONS, speed=SPEEDS)
def test_it_has_the_size_of_its_coefficients(friction: Friction, speed: np.ndarray) -> None:
    viscous = np.array([friction.viscous_rotary] * 3 + [friction.viscous_linear])
    coulomb = np.array([friction.coulomb_rotary] * 3 + [friction.coulomb_linear])
    torque = friction_torque(friction, speed)
    most = viscous * np.abs(speed) + coulomb
    assert (np.abs(torque) <= most * (1 + 1e-12)).all()
    sliding = np.abs(speed) > 20 * friction.transition_speed
    assert_within(np.abs(torque)[sliding], most[sliding], 1e-10 * (1 + most.max()))
    # 76 % of the Coulomb part at the transition speed
    step = friction_torque(friction, np.full(4, friction.transition_speed))
    assert_within(
        step, viscous * friction.transition_speed + np.tanh(1.0) * coulomb, 1e-10 * (1 + most.max())
    )


@given(friction=FRICTIONS, speed=SPEEDS)
def test_it_grows_with_speed_without_a_jump(friction: Friction, speed: np.ndarray) -> None:
    step = 1e-3 * friction.transition_speed
    rise = friction_torque(friction, speed + step) - friction_torque(friction, speed)
    viscous = np.array([friction.viscous_rotary] * 3 + [friction.viscous_linear])
    coulomb = np.array([friction.coulomb_rotary] * 3 + [friction.coulomb_linear])
    slope = viscous + coulomb / friction.transition_speed
    assert (rise >= -1e-9).all()
    assert (rise <= slope * step * (1 + 1e-6) + 1e-9).all()


@pytest.mark.slow
@given(case=cases(), friction=FRICTIONS)
def test_friction_is_added_to_the_torque(case: Case, friction: Friction) -> None:
    pose, v, a = case.states()
    design = replace(case.design, friction=friction)
    plain = inverse_dynamics(case.design, pose, v, a)
    full = inverse_dynamics(design, pose, v, a)
    added = friction_torque(friction, actuator_velocity(design, pose, v))
    assert_close(full.torque, plain.torque + added, 1e-13)
    np.testing.assert_array_equal(full.multipliers, plain.multipliers)
    parts = torque_breakdown(design, pose, v, a)
    np.testing.assert_array_equal(parts.friction, added)


def test_no_transition_speed_is_too_small() -> None:
    friction = Friction(coulomb_rotary=1.0, coulomb_linear=1.0, transition_speed=1e-6)
    torque = friction_torque(friction, [1.0, -1.0, 0.0, 1e300])
    np.testing.assert_array_equal(torque, [1.0, -1.0, 0.0, 1.0])


def test_any_batch_of_speeds() -> None:
    friction = Friction(viscous_rotary=1.0)
    assert friction_torque(friction, np.zeros((2, 0, 4))).shape == (2, 0, 4)
    assert friction_torque(friction, BY_HAND).shape == (3, 4)
    with pytest.raises(InvalidInput, match="speed"):
        friction_torque(friction, [1.0, 2.0])
