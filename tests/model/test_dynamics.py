"""Inverse and forward dynamics against first principles, the energies, and each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Friction,
    Limit,
    actuator_power,
    actuator_velocity,
    forward_dynamics,
    inverse_dynamics,
    kinetic_energy,
    potential_energy,
    static_torques,
    torque_breakdown,
)
from tests.support.cases import BY_HAND, Case, assert_close, assert_within, cases

RUBBING = Friction(
    viscous_rotary=0.4,
    coulomb_rotary=0.3,
    viscous_linear=15.0,
    coulomb_linear=4.0,
    transition_speed=0.02,
)


def rubbing(design: Design) -> Design:
    return replace(design, friction=RUBBING)


@given(case=cases())
def test_torques_are_those_of_first_principles(case: Case) -> None:
    result = inverse_dynamics(case.design, *case.states())
    assert_close(result.torque, case.driving_torques(), 1e-11)
    assert (result.status == Limit.OK).all()
    assert (result.leg == -1).all()
    assert (result.status.dtype, result.leg.dtype) == (np.uint8, np.int8)


@given(case=cases(), speed=st.floats(0.0, 30.0), push=st.floats(0.0, 30.0))
def test_fast_and_slow_motions(case: Case, speed: float, push: float) -> None:
    """The parts are quadratic in the speeds and linear in the accelerations: Q(sv, pa) is known."""
    pose, v, a = case.states()
    parts = torque_breakdown(case.design, pose, v, a)
    expected = parts.gravity + push * parts.inertial + speed**2 * parts.velocity
    got = inverse_dynamics(case.design, pose, speed * v, push * a).torque
    assert_close(got, expected, 1e-10)


@given(case=cases())
def test_the_parts_of_the_torque_add_up(case: Case) -> None:
    states = case.states()
    for design in (case.design, rubbing(case.design)):
        parts = torque_breakdown(design, *states)
        total = inverse_dynamics(design, *states).torque
        assert_close(parts.total, total, 1e-12)
        added = parts.gravity + parts.inertial + parts.velocity + parts.friction
        np.testing.assert_array_equal(parts.total, added)
        static = static_torques(case.design, states[0])
        assert_close(parts.gravity, static, 1e-11)
        assert parts.friction.any() == (design is not case.design)
        still = torque_breakdown(design, states[0], np.zeros(4), states[2])
        np.testing.assert_array_equal(still.velocity, 0.0)
        np.testing.assert_array_equal(still.friction, 0.0)
        coasting = torque_breakdown(design, states[0], states[1], np.zeros(4))
        np.testing.assert_array_equal(coasting.inertial, 0.0)
        np.testing.assert_array_equal(coasting.velocity, parts.velocity)


@given(case=cases())
def test_power_of_the_actuators_is_the_growth_of_energy(case: Case) -> None:
    """sum Q_j q_j' = d(T + V)/dt, the energies taken a little before and after."""
    pose, v, a = case.states()
    torque = inverse_dynamics(case.design, pose, v, a).torque
    power = actuator_power(case.design, pose, v, torque)
    np.testing.assert_array_equal(power, torque * actuator_velocity(case.design, pose, v))

    def energy(t: float) -> Any:
        q, rate = pose + v * t + a * t * t / 2, v + a * t
        kinetic = kinetic_energy(case.design, q, rate)
        return kinetic + potential_energy(case.design, q)

    h = 2e-4
    growth = (
        45 * (energy(h) - energy(-h))
        - 9 * (energy(2 * h) - energy(-2 * h))
        + (energy(3 * h) - energy(-3 * h))
    ) / (60 * h)
    assert_within(power.sum(axis=-1), growth, 1e-7 * np.abs(power).max())


@given(case=cases())
def test_forward_dynamics_undoes_inverse_dynamics(case: Case) -> None:
    pose, v, a = case.states()
    for design in (case.design, rubbing(case.design)):
        torque = inverse_dynamics(design, pose, v, a).torque
        assert_close(forward_dynamics(design, pose, v, torque), a, 1e-10)


@pytest.mark.parametrize("which", ["velocity", "acceleration"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_motions_that_are_not_finite_are_named_so(which: str, bad: float) -> None:
    motion = {"velocity": np.zeros((3, 4)), "acceleration": np.zeros((3, 4))}
    motion[which][1, 2] = bad
    for design in (APPENDIX_4, rubbing(APPENDIX_4)):
        result = inverse_dynamics(design, BY_HAND, **motion)
        assert result.status.tolist() == [Limit.OK, Limit.NOT_FINITE, Limit.OK]
        assert np.isnan(result.torque[1]).all()
        assert np.isnan(result.multipliers[1]).all()
        assert np.isfinite(result.torque[[0, 2]]).all()
