"""Inverse and forward dynamics against first principles, the energies, and each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    COEFFICIENTS,
    Design,
    Friction,
    Limit,
    Misprint,
    actuator_power,
    actuator_velocity,
    backend,
    forward_dynamics,
    inverse_dynamics,
    inverse_jacobian,
    joint_rates,
    kinetic_energy,
    lumped_coefficients,
    lumped_matrix,
    mass_vector,
    platform_wrench,
    potential_energy,
    static_torques,
    torque_breakdown,
    torque_regressor,
    unit_torques,
)
from paminsa_viz.model import regressor as module
from paminsa_viz.model.lumped import MASS_PATHS, EnergyTerms, term_factors
from paminsa_viz.model.regressor import leg_unit_terms, regressor_torques
from paminsa_viz.trajectory import point_to_point, simulate
from tests.model import paper
from tests.support import samples
from tests.support.cases import BY_HAND, PROTOTYPES, Case, assert_close, assert_within, cases

RUBBING = Friction(
    viscous_rotary=0.4,
    coulomb_rotary=0.3,
    viscous_linear=15.0,
    coulomb_linear=4.0,
    transition_speed=0.02,
)


def rubbing(design: Design) -> Design:
    return replace(design, friction=RUBBING)


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
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
def test_actuators_make_the_wrench_on_the_platform(case: Case) -> None:
    pose, v, a = case.states()
    torque = inverse_dynamics(case.design, pose, v, a).torque
    turned = np.einsum("nji,nj->ni", inverse_jacobian(case.geometry, pose), torque)
    assert_close(platform_wrench(case.design, pose, v, a), turned, 1e-10)


@given(case=cases())
def test_forward_dynamics_undoes_inverse_dynamics(case: Case) -> None:
    pose, v, a = case.states()
    for design in (case.design, rubbing(case.design)):
        torque = inverse_dynamics(design, pose, v, a).torque
        assert_close(forward_dynamics(design, pose, v, torque), a, 1e-10)


def test_a_robot_without_inertia_is_refused() -> None:
    """Legs of no mass and a point for a platform: nothing resists a turn."""
    bare = APPENDIX_4.vary(dict.fromkeys(MASS_PATHS, 0.0) | {"platform.mass": 1.0})
    with pytest.raises(InvalidInput, match=r"platform\.inertia above 0"):
        forward_dynamics(bare, BY_HAND, np.zeros(4), np.zeros(4))
    with pytest.raises(InvalidInput, match=r"platform\.inertia above 0"):
        simulate(bare, point_to_point(BY_HAND[0], BY_HAND[1]).sample(100))


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


def solve_eq_15(
    design: Design, states: Any, misprints: Misprint = Misprint.NONE
) -> tuple[Any, Any]:
    """Multipliers from the first four Lagrange equations, torques from the last four."""
    pose, v, a = (np.asarray(s, float) for s in states)
    motion = joint_rates(design.geometry, pose, v, a)
    q = np.concatenate([pose, motion.configuration.actuators], -1)
    v8 = np.concatenate([v, motion.actuators_velocity], -1)
    a8 = np.concatenate([a, motion.actuators_acceleration], -1)
    left = paper.lagrange(design, q, v8, a8, misprints)
    coefficients = paper.slopes(
        lambda p: paper.closure(design.geometry, p), list(np.moveaxis(q, -1, 0))
    )
    by_pose = np.swapaxes(coefficients[..., :4], -1, -2)
    multipliers = np.linalg.solve(by_pose, left[..., :4, None])[..., 0]
    reaction = np.einsum("...ij,...i->...j", coefficients[..., 4:], multipliers)
    return multipliers, left[..., 4:] - reaction


@pytest.mark.slow
@given(case=cases())
def test_multipliers_and_torques_are_those_of_the_papers_equations(case: Case) -> None:
    states = case.states()
    multipliers, torque = solve_eq_15(case.design, states)
    result = inverse_dynamics(case.design, *states)
    assert_close(result.torque, torque, 1e-10)
    assert_close(result.multipliers, multipliers, 1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("misprints", [*Misprint, Misprint.ALL], ids=str)
@settings(max_examples=2)  # robots for each of seven
@given(case=cases())
def test_the_formulas_as_printed_are_those_of_the_text(misprints: Misprint, case: Case) -> None:
    states = case.states()
    multipliers, torque = solve_eq_15(case.design, states, misprints)
    result = inverse_dynamics(case.design, *states, misprints)
    assert_close(result.torque, torque, 1e-10)
    assert_close(result.multipliers, multipliers, 1e-10)


@given(case=cases(), flags=st.integers(0, Misprint.ALL.value).map(Misprint))
def test_both_routes_agree_with_any_of_the_misprints(case: Case, flags: Misprint) -> None:
    """Jourdain's principle against Lagrange's multipliers."""
    states, gravity = case.states(), case.design.gravity
    y = torque_regressor(case.geometry, *states, gravity=gravity, misprints=flags)
    assert y.shape == (8, 4, 18)
    torque = y @ lumped_coefficients(case.design, flags)
    expected = inverse_dynamics(case.design, *states, flags).torque
    assert_close(torque, expected, 1e-11)


@given(case=cases(), other=st.integers(0, 10000))
def test_one_regressor_serves_all_masses(case: Case, other: int) -> None:
    """Another robot's masses on the same trajectory: one product, and no new Y."""
    states = case.states()
    y = torque_regressor(case.geometry, *states, gravity=case.design.gravity)
    masses = samples.random_design(np.random.default_rng(other))
    design = replace(masses, geometry=case.geometry, gravity=case.design.gravity)
    c = lumped_matrix(case.geometry, design.gravity) @ mass_vector(design)
    torque = regressor_torques(y, c)
    assert_close(torque, y @ c, 1e-13)
    expected = inverse_dynamics(design, *states).torque
    assert_close(torque, expected, 1e-11)


@given(case=cases())
def test_terms_of_the_legs_add_up_to_the_regressor(case: Case) -> None:
    """And a turn by a third of a circle makes each leg the next one."""
    states = case.states()
    terms = leg_unit_terms(case.geometry, *states)
    assert terms.shape == (*states[0].shape[:-1], 4, 3, len(EnergyTerms._fields) - 2)
    c = np.array(term_factors(case.design))
    legs = terms.sum(axis=-2) @ c[:-2]
    y = torque_regressor(case.geometry, *states, gravity=case.design.gravity)
    without = lumped_coefficients(case.design)
    without[-2:] = 0.0
    assert_close(legs, y @ without, 1e-11)
    turned = [values.copy() for values in states]
    turn = 2 * np.pi / 3
    cosine, sine = np.cos(turn), np.sin(turn)
    for values in turned:
        values[..., 0], values[..., 1] = (
            cosine * values[..., 0] - sine * values[..., 1],
            sine * values[..., 0] + cosine * values[..., 1],
        )
    after = leg_unit_terms(case.geometry, *turned)
    following = np.array([1, 2, 0])
    assert_close(after[..., following, :, :][..., following, :], terms[..., :3, :, :], 1e-9)
    assert_close(after[..., 3, following, :], terms[..., 3, :, :], 1e-9)


@PROTOTYPES
def test_at_rest_its_columns_are_the_static_maps(design: Design) -> None:
    still = np.zeros(4)
    y = torque_regressor(design.geometry, BY_HAND, still, still)
    named = dict(zip(COEFFICIENTS, np.moveaxis(y, -1, 0), strict=True))
    lift = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (3, 4))
    assert_within(named["Mp1"], 9 * lift, 1e-14)  # 3 legs times k
    assert_within(named["Mp3"], 3 * lift, 1e-14)
    assert_within(named["Mp2"], unit_torques(design.geometry, BY_HAND), 1e-13)
    assert_within(named["m_pl"], 9.81 * 3 * lift, 1e-13)
    for name in (*(f"Mc{i}" for i in range(1, 14)), "I_pl"):
        np.testing.assert_array_equal(named[name], 0.0)


@PROTOTYPES
def test_gravity_enters_through_the_platforms_mass_alone(design: Design) -> None:
    v, a = np.array([0.3, -0.2, 0.8, 0.1]), np.array([1.0, 2.0, -3.0, 0.5])
    heavy, light = (
        torque_regressor(design.geometry, BY_HAND, v, a, gravity=g) for g in (9.81, 1.62)
    )
    change = heavy - light
    assert_within(change[:, 3, 16], np.full(3, 3 * (9.81 - 1.62)), 1e-13)
    change[:, 3, 16] = 0.0
    np.testing.assert_array_equal(change, 0.0)


def test_a_misprint_of_a_coefficient_is_none_of_the_regressor() -> None:
    v, a = np.array([0.3, -0.2, 0.8, 0.1]), np.array([1.0, 2.0, -3.0, 0.5])
    right = torque_regressor(APPENDIX_4.geometry, BY_HAND, v, a)
    for flag in Misprint:
        printed = torque_regressor(APPENDIX_4.geometry, BY_HAND, v, a, misprints=flag)
        assert (printed != right).any() == (flag is not Misprint.APP3_MC4)


def test_long_trajectories_are_worked_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(3)
    states = samples.random_states(rng, APPENDIX_4, n=25)
    whole = torque_regressor(APPENDIX_4.geometry, *states)
    for block in (1, 7, 24):
        monkeypatch.setattr(module, "BLOCK", block)
        with backend.use_numpy():
            assert_close(torque_regressor(APPENDIX_4.geometry, *states), whole, 1e-12)
