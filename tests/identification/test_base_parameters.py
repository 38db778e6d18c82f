"""The base parameters: complete, minimal, and true to torques that no regressor made."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.identification import (
    BASE_PARAMETERS,
    LEG_PARAMETERS,
    base_matrix,
    base_parameters,
    base_regressor,
    identity_row,
    leg_base_regressor,
)
from paminsa_viz.identification.base_parameters import SELECTION, mass_columns
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    actuator_acceleration,
    actuator_velocity,
    inverse_dynamics,
    lumped_coefficients,
)
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.lumped import mass_vector
from paminsa_viz.model.regressor import torque_regressor
from tests.support.cases import Case, assert_close, cases
from tests.support.identification_logs import moved_unseen

STATES = 60
"""Random states of a robot: enough rows for 27 columns."""


def rank(columns: Any) -> int:
    """Rank of columns over all rows, each column scaled to length 1."""
    flat = columns.reshape(-1, columns.shape[-1])
    values = np.linalg.svd(flat / np.linalg.norm(flat, axis=0), compute_uv=False)
    kept = int((values > 1e-9 * values[0]).sum())
    assert kept == len(values) or values[kept] < 1e-12 * values[0]  # no doubt about the rank
    return kept


@pytest.mark.slow
@given(cases())
def test_eleven_base_parameters_carry_the_whole_regressor(case: Case) -> None:
    design, states = case.design, case.states(STATES)
    y = torque_regressor(case.geometry, *states, gravity=design.gravity)
    x = base_regressor(case.geometry, *states)
    assert rank(y) == rank(x) == len(BASE_PARAMETERS) == 11
    b = base_matrix(case.geometry, design.gravity)
    np.testing.assert_allclose(y, x @ b, rtol=0, atol=1e-12 * np.abs(y).max())
    assert_close(x @ base_parameters(design), case.driving_torques(STATES), 1e-8)
    assert not SELECTION.flags.writeable  # all share it


@pytest.mark.slow
@given(cases())
def test_legs_with_masses_of_their_own_have_27_base_parameters(case: Case) -> None:
    states = case.states(STATES)
    x, legs = base_regressor(case.geometry, *states), leg_base_regressor(case.geometry, *states)
    size = np.abs(x).max()
    np.testing.assert_allclose(legs.sum(axis=2), x[..., list(LEG_PARAMETERS)], atol=1e-12 * size)
    common = np.delete(x, LEG_PARAMETERS, axis=-1)
    assert rank(np.concatenate([legs.reshape(STATES, 4, 24), common], axis=-1)) == 27


@pytest.mark.slow
@given(cases(), st.integers(0, 2**32 - 1))
def test_masses_moved_along_the_null_space_change_no_torque(case: Case, seed: int) -> None:
    design = case.design
    columns, fixed = mass_columns(design)
    masses = mass_vector(design)
    values = np.linalg.svd(columns, compute_uv=False)
    assert int((values > 1e-12 * values[0]).sum()) == 10
    other = moved_unseen(design, seed)
    assert np.abs(mass_vector(other) - masses).max() > 1e-3
    np.testing.assert_allclose(columns @ masses + fixed, base_parameters(design), rtol=1e-12)
    states = case.states(STATES)
    y = torque_regressor(case.geometry, *states, gravity=design.gravity)
    before, after = (y @ lumped_coefficients(item) for item in (design, other))
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-10 * np.abs(before).max())
    np.testing.assert_allclose(base_parameters(other), base_parameters(design), rtol=1e-9)


@given(cases(), st.floats(-0.3, 0.3), st.sampled_from(["b3", "b4", "b7", "b8"]))
def test_identity_holds_for_any_masses_and_counterweights(
    case: Case, beyond: float, bar: str
) -> None:
    joint = {"b3": 4, "b4": 9, "b7": 8, "b8": 9}[bar]
    design = replace(case.design, counterweights=(Counterweight(bar, joint, beyond, 1.3),))
    row, b = identity_row(case.geometry, design.gravity), base_parameters(design)
    assert abs(row @ b) <= 1e-12 * np.abs(row * b).sum()
    assert abs(row @ (b - 0.3 * b[1] * np.eye(11)[1])) > 0.1 * abs(b[1])  # a spring breaks it


def test_drives_add_their_inertia_to_two_base_parameters() -> None:
    drive = Drive(rotor_inertia=2e-4, gear_ratio=20.0)
    lift = Drive(rotor_inertia=1e-4, gear_ratio=1.0, transmission="belt", lead=0.1)
    driven = replace(APPENDIX_4, drives=(drive, drive, drive, lift))
    states = Case(0, APPENDIX_4.geometry.knee).states(STATES)
    speeds = actuator_acceleration(APPENDIX_4.geometry, *states)
    x = base_regressor(APPENDIX_4.geometry, *states)
    extra = x @ (base_parameters(driven) - base_parameters(APPENDIX_4))
    np.testing.assert_allclose(extra, speeds * np.array(driven.drive_inertia), rtol=1e-9, atol=1e-9)
    assert rank(np.concatenate([x, speeds[..., None] * np.eye(4)], axis=-1)) == 13


def test_torques_of_unequal_drives_are_those_of_their_mean_and_each_difference() -> None:
    drive = Drive(rotor_inertia=1e-4, gear_inertia=2e-5, gear_ratio=30.0)
    driven = replace(APPENDIX_4, drives=(drive, None, None, None))
    states = Case(0, APPENDIX_4.geometry.knee).states(STATES)
    inertia = np.array(driven.drive_inertia)
    assert inertia[0] > inertia[1] == inertia[2] == 0.0
    apart = np.append(inertia[:3] - inertia[:3].mean(), 0.0)
    rest = apart * actuator_acceleration(APPENDIX_4.geometry, *states)
    found = base_regressor(APPENDIX_4.geometry, *states) @ base_parameters(driven)
    torque = inverse_dynamics(driven, *states).torque
    np.testing.assert_allclose(found + rest, torque, rtol=1e-9, atol=1e-9 * np.abs(torque).max())
    assert np.abs(found - torque).max() > 1e-3  # so that X b alone is not the torques


@pytest.mark.slow
@given(cases())
def test_ranks_with_friction_offsets_and_rotors(case: Case) -> None:
    pose, velocity, acceleration = case.states(STATES)
    speed = actuator_velocity(case.design, pose, velocity)
    x = base_regressor(case.geometry, pose, velocity, acceleration)
    signals = {
        "viscous": speed,
        "coulomb": np.sign(speed),
        "offset": np.ones_like(speed),
        "rotor": actuator_acceleration(case.geometry, pose, velocity, acceleration),
    }
    each = {name: signal[..., None] * np.eye(4) for name, signal in signals.items()}
    ranks = {name: rank(np.concatenate([x, part], axis=-1)) for name, part in each.items()}
    # F_4's offset repeats the weight; the rotors' mean the spin, and M4's the mass along z.
    assert ranks == {"viscous": 15, "coulomb": 15, "offset": 14, "rotor": 13}
    assert rank(np.concatenate([x, *each.values()], axis=-1)) == 24
