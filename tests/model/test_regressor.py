"""Q = Y c: the second route to the torques, and what it makes cheap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    COEFFICIENTS,
    Design,
    Misprint,
    backend,
    inverse_dynamics,
    lumped_coefficients,
    lumped_matrix,
    mass_vector,
    torque_regressor,
    unit_torques,
)
from paminsa_viz.model import regressor as module
from paminsa_viz.model.regressor import regressor_torques
from tests.support import samples
from tests.support.cases import BY_HAND, PROTOTYPES, Case, assert_close, assert_within, cases


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
