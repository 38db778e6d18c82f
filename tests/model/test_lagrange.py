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
    APPENDIX_4,
    Design,
    KneeBranch,
    Misprint,
    actuator_velocity,
    closure_matrix,
    inverse_dynamics,
    joint_rates,
)
from paminsa_viz.model.lumped import MASS_PATHS
from tests.model import paper
from tests.support.cases import BOTH, BY_HAND, Case, assert_close, assert_within, cases
from tests.support.samples import with_knee


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


@given(case=cases())
def test_the_papers_equations_agree_with_first_principles(case: Case) -> None:
    """Two derivations that share no formula, neither of them the package's."""
    _, torque = solve_eq_15(case.design, case.states())
    assert_close(torque, case.driving_torques(), 1e-10)


@pytest.mark.parametrize("misprints", [*Misprint, Misprint.ALL], ids=str)
@given(case=cases())
def test_the_formulas_as_printed_are_those_of_the_text(misprints: Misprint, case: Case) -> None:
    states = case.states()
    multipliers, torque = solve_eq_15(case.design, states, misprints)
    result = inverse_dynamics(case.design, *states, misprints)
    assert_close(result.torque, torque, 1e-10)
    assert_close(result.multipliers, multipliers, 1e-10)


@given(case=cases())
def test_the_closure_forces_do_no_work(case: Case) -> None:
    """sum lambda_i A_ij q_j' = 0: what they take from the platform they give to the actuators."""
    pose, v, a = case.states()
    result = inverse_dynamics(case.design, pose, v, a)
    motion = joint_rates(case.geometry, pose, v, a)
    matrix = closure_matrix(case.geometry, pose, motion.configuration.actuators)
    forces = np.einsum("nij,ni->nj", matrix, result.multipliers)
    given_away = np.sum(forces[:, :4] * v, axis=-1)
    rates = actuator_velocity(case.design, pose, v)
    received = np.sum(forces[:, 4:] * rates, axis=-1)
    assert_within(given_away + received, np.zeros(8), 1e-11 * np.abs(forces).max())


@BOTH
def test_with_a_heavy_platform_alone_the_multipliers_carry_it(knee: KneeBranch) -> None:
    """Newton's law of the platform: sum lambda_i A_ij (j = x, y, theta, z) = (m a, m (g + a_z))."""
    design = APPENDIX_4.vary(dict.fromkeys(MASS_PATHS, 0.0) | {"platform.mass": 7.0})
    design = design.vary({"platform.inertia": 0.3})
    v, a = np.array([0.3, -0.2, 0.8, 0.1]), np.array([1.0, 2.0, -3.0, 0.5])
    result = inverse_dynamics(with_knee(design, knee), BY_HAND, v, a)
    motion = joint_rates(with_knee(design.geometry, knee), BY_HAND, v, a)
    matrix = closure_matrix(design.geometry, BY_HAND, motion.configuration.actuators)[..., :4]
    forces = np.einsum("nij,ni->nj", matrix, result.multipliers)
    wanted = [7.0 * a[0], 7.0 * a[1], 0.3 * a[2], 7.0 * (a[3] + design.gravity)]
    # Eq. 15 has the multipliers on the side of the torques: they push the platform.
    assert_close(forces, np.broadcast_to(wanted, (3, 4)), 1e-12)
