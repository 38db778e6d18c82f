"""The paper's eight coordinates, differentiated to rounding from its energies alone.

`tests.model.paper` types Eqs. 11-17 and Appendices 1 to 3 again and forms Lagrange's left side
without any formula of the package; the multipliers and torques then follow from Eq. 15.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given

from paminsa_viz.model import (
    Design,
    Misprint,
    inverse_dynamics,
    joint_rates,
)
from tests.model import paper
from tests.support.cases import Case, assert_close, cases


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


@given(case=cases())
def test_multipliers_and_torques_are_those_of_the_papers_equations(case: Case) -> None:
    states = case.states()
    multipliers, torque = solve_eq_15(case.design, states)
    result = inverse_dynamics(case.design, *states)
    assert_close(result.torque, torque, 1e-10)
    assert_close(result.multipliers, multipliers, 1e-10)


@pytest.mark.parametrize("misprints", [*Misprint, Misprint.ALL], ids=str)
@given(case=cases())
def test_the_formulas_as_printed_are_those_of_the_text(misprints: Misprint, case: Case) -> None:
    states = case.states()
    multipliers, torque = solve_eq_15(case.design, states, misprints)
    result = inverse_dynamics(case.design, *states, misprints)
    assert_close(result.torque, torque, 1e-10)
    assert_close(result.multipliers, multipliers, 1e-10)
