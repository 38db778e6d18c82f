"""The compiled regressor does what its array form does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from paminsa_viz.model import Misprint, backend, torque_regressor
from tests.model.cases import Case, cases

OUT_OF_REACH = np.array([[9.0, 0.0, 0.0, 0.0], [np.nan, 0.0, 0.0, -0.5], [0.0, 0.0, np.inf, -0.5]])


@pytest.mark.parametrize("misprints", [Misprint.NONE, Misprint.ALL])
@given(cases())
def test_compiled_and_array_form_agree(misprints: Misprint, case: Case) -> None:
    pose, velocity, acceleration = case.states(6)
    pose = np.concatenate([pose, OUT_OF_REACH])
    velocity, acceleration = (np.concatenate([u, u[:3]]) for u in (velocity, acceleration))
    arguments = (case.geometry, pose, velocity, acceleration)
    backend.compile_now()
    compiled = torque_regressor(*arguments, gravity=3.7, misprints=misprints)
    with backend.use_numpy():
        arrays = torque_regressor(*arguments, gravity=3.7, misprints=misprints)
    assert np.isnan(arrays[6:]).all()
    size = np.abs(arrays[:6]).max(axis=(0, 1))
    np.testing.assert_array_equal(np.isnan(compiled), np.isnan(arrays))
    assert (np.abs(compiled - arrays)[:6] <= 1e-11 * size + 1e-300).all()
