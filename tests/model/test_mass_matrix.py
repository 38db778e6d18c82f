"""The mass matrix: shape, signs, and the same kinetic energy from three sources."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Limit,
    Misprint,
    check_reach,
    forward_dynamics,
    inverse_dynamics,
    inverse_jacobian,
    inverse_kinematics,
    kinetic_energy,
    mass_matrix,
    measure_singularity,
    torque_breakdown,
)
from tests import oracle
from tests.model import paper
from tests.support.cases import BY_HAND, PROTOTYPES, Case, assert_close, cases


@pytest.mark.slow
@given(case=cases())
def test_it_is_symmetric_and_positive_definite(case: Case) -> None:
    matrix = mass_matrix(case.design, case.poses(64))
    np.testing.assert_array_equal(matrix, np.swapaxes(matrix, -1, -2))
    assert (np.linalg.eigvalsh(matrix) > 0).all()


@PROTOTYPES
def test_it_is_so_at_every_pose_that_can_be_taken(design: Design) -> None:
    """Type-2 singularities included: the platform has inertia wherever it is.

    With joint 5 on its leg axis (type 1) the smallest motion would turn the leg without bound.
    """
    axes = (np.linspace(-0.4, 0.4, 17), np.linspace(-0.4, 0.4, 17))
    turn, height = np.linspace(-np.pi, np.pi, 13), np.linspace(-0.9, 0.8, 9)
    pose = np.stack(np.meshgrid(*axes, turn, height, indexing="ij"), -1).reshape(-1, 4)
    pose = np.concatenate([pose, [[0.25, 0.0, 0.0, -0.5], [0.0, 0.0, np.arccos(2 / 7), -0.5]]])
    ok = check_reach(APPENDIX_4.geometry, pose).ok
    ok &= measure_singularity(APPENDIX_4.geometry, pose).serial_distance > 1e-6  # type 1
    assert ok[-2:].all()
    assert 1000 < ok.sum() < len(pose) / 2
    matrix = mass_matrix(design, pose)[ok]
    assert (np.linalg.eigvalsh(matrix) > 0).all()


@pytest.mark.slow
@given(case=cases())
def test_it_has_the_kinetic_energy_of_the_bodies(case: Case) -> None:
    """T = v.M v/2 = Eqs. 12-14 with Appendix 3 = the sum over rigid bodies."""
    pose, v, _ = case.states()
    matrix = mass_matrix(case.design, pose)
    from_matrix = np.einsum("ni,nij,nj->n", v, matrix, v) / 2
    term_by_term = kinetic_energy(case.design, pose, v)
    np.testing.assert_allclose(from_matrix, term_by_term, rtol=1e-12)
    exact = oracle.kinetic(case.design, pose, v)
    np.testing.assert_allclose(from_matrix, exact, rtol=1e-12)


@given(case=cases())
def test_the_inertial_torque_is_the_matrix_times_the_acceleration(case: Case) -> None:
    """G^T Q_inertial = M a."""
    pose, v, a = case.states()
    parts = torque_breakdown(case.design, pose, v, a)
    forces = np.einsum("nji,nj->ni", inverse_jacobian(case.geometry, pose), parts.inertial)
    matrix = mass_matrix(case.design, pose)
    assert_close(forces, np.einsum("nij,nj->ni", matrix, a), 1e-11)


@given(case=cases())
def test_forward_dynamics_is_its_inverse_times_the_forces(case: Case) -> None:
    pose, v, _ = case.states()
    rng = np.random.default_rng(case.seed)
    push = rng.normal(size=pose.shape)
    bias = inverse_dynamics(case.design, pose, v, np.zeros(4)).torque
    a = forward_dynamics(case.design, pose, v, bias + push)
    forces = np.einsum("nji,nj->ni", inverse_jacobian(case.geometry, pose), push)
    matrix = mass_matrix(case.design, pose)
    assert_close(a, np.linalg.solve(matrix, forces[..., None])[..., 0], 1e-9)


@pytest.mark.parametrize("misprints", [*Misprint, Misprint.ALL], ids=str)
@PROTOTYPES
def test_with_misprints_it_is_the_second_degree_of_the_printed_energy(
    misprints: Misprint, design: Design
) -> None:
    """Eq. 13's Z' is linear and has no place in a mass matrix; everything else has."""
    v = np.array([0.3, -0.2, 0.8, 0.1])
    rates = inverse_jacobian(APPENDIX_4.geometry, BY_HAND) @ v
    actuators = inverse_kinematics(design.geometry, BY_HAND).actuators
    q = list(np.concatenate([BY_HAND, actuators], -1).T)
    qdot = np.concatenate([np.broadcast_to(v, (3, 4)), rates], -1)
    typed = paper.kinetic(design, q, list(qdot.T), misprints)
    term_by_term = kinetic_energy(design, BY_HAND, v, misprints)
    np.testing.assert_allclose(term_by_term, typed, rtol=1e-12)
    linear = 0.0
    if Misprint.EQ13_LIFT_SPEED in misprints:
        linear = 3 * APPENDIX_4.links.b1 / 8 * rates[:, 3]
    matrix = mass_matrix(design, BY_HAND, misprints)
    np.testing.assert_allclose(v @ matrix @ v / 2 + linear, typed, rtol=1e-12)


@PROTOTYPES
def test_out_of_reach_there_is_no_acceleration(design: Design) -> None:
    pose = np.array([[0.0, 0.0, 0.0, -1.2], BY_HAND[1], [0.0, np.nan, 0.0, -0.5]])
    assert np.isnan(mass_matrix(design, pose)[[0, 2]]).all()
    a = forward_dynamics(design, pose, np.zeros(4), np.zeros(4))
    assert np.isnan(a[[0, 2]]).all()
    assert np.isfinite(a[1]).all()
    status = inverse_dynamics(design, pose, np.zeros(4), np.zeros(4)).status
    assert status.tolist() == [Limit.STRETCHED, Limit.OK, Limit.NOT_FINITE]
