"""Velocities and accelerations of every joint, against differences and exact derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    actuator_velocity,
    closure_matrix,
    inverse_jacobian,
    inverse_jacobian_rate,
    inverse_kinematics,
    jacobian,
    joint_rates,
)
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.leg import leg_motion, leg_position, mechanism
from tests import oracle
from tests.model import paper
from tests.support.cases import Case, assert_within, cases

JOINTS = (2, 3, 4, 5, 7, 8, 9)


def largest(*arrays: Any) -> float:
    return max(float(np.abs(a).max()) for a in arrays)


def joint_jets(design: Design, pose: Any, v: Any, a: Any) -> list[Any]:
    return [oracle.leg(design, oracle.jets(pose, v, a), index).points for index in range(3)]


@given(case=cases())
def test_joints_move_as_first_principles_say(case: Case) -> None:
    """Exact derivatives of the oracle's joint points along the motion."""
    pose, v, a = case.states()
    motion = joint_rates(case.geometry, pose, v, a)
    legs = joint_jets(case.design, pose, v, a)
    for number in JOINTS:
        for index, points in enumerate(legs):
            for ours, of in ((motion.velocity, oracle.rate), (motion.acceleration, oracle.second)):
                exact = np.stack(np.broadcast_arrays(*of(points[number]), pose[:, 0])[:3], -1)
                got = ours[number][:, index]
                assert_within(got, exact, 1e-11 * largest(v, a, exact))


@given(case=cases())
def test_bars_turn_as_first_principles_say(case: Case) -> None:
    """psi' and phi' from the directions of B4 and B8; the leg plane from its heading."""
    pose, v, a = case.states()
    motion = joint_rates(case.geometry, pose, v, a)
    q = oracle.jets(pose, v, a)
    for index in range(3):
        leg = oracle.leg(case.design, q, index)
        h = leg.heading
        spin = oracle.cross(oracle.value(h), oracle.rate(h))[2]
        growth = oracle.cross(oracle.value(h), oracle.second(h))[2]
        assert_within(motion.actuators_velocity[:, index], spin, 1e-11 * largest(spin))
        assert_within(motion.actuators_acceleration[:, index], growth, 1e-11 * largest(growth))
        for start, end, rate, second in (
            (9, 5, motion.psi_rate, motion.psi_acceleration),
            (8, 9, motion.phi_rate, motion.phi_acceleration),
        ):
            bar = oracle.unit(oracle.add(leg.points[end], leg.points[start], -1.0))
            along, up = oracle.dot(bar, h), bar[2]
            exact = along.a * up.rate - up.a * along.rate
            assert_within(rate[:, index], exact, 1e-11 * largest(exact))
            # cos and sin of an angle: c s'' - s c'' = angle''
            exact = along.a * up.second - up.a * along.second
            assert_within(second[:, index], exact, 1e-10 * largest(exact, spin * spin))
    top = oracle.leg(case.design, q, 0).points[2][2]
    assert_within(motion.actuators_velocity[:, 3], top.rate, 1e-13)
    assert_within(motion.actuators_acceleration[:, 3], top.second, 1e-12)


@given(case=cases())
def test_the_formulas_carry_complex_steps(case: Case) -> None:
    """`leg_position` on complex numbers differentiates itself, to rounding."""
    pose, v, a = case.states()
    m, step = mechanism(case.geometry), 1e-30

    def leg(p: Any) -> Any:
        x, y, theta, z = np.moveaxis(p, -1, 0)[..., None]
        return leg_position(
            m, LEG_AXES[:, 0], LEG_AXES[:, 1], x, y, np.cos(theta), np.sin(theta), z
        )

    position, along = leg(pose), leg(pose + 1j * step * v)
    columns = [np.moveaxis(array, -1, 0)[..., None] for array in (v, a)]
    motion = leg_motion(m, position, *columns[0], *columns[1])
    for name in ("rho", "zeta", "r9", "z9"):
        exact = getattr(along, name).imag / step
        got = np.broadcast_to(getattr(motion, f"{name}_rate"), exact.shape)
        assert_within(got, exact, 1e-11 * largest(v, exact))
    for angle in ("psi", "phi"):
        c, s = getattr(position, f"cos_{angle}"), getattr(position, f"sin_{angle}")
        c_rate = getattr(along, f"cos_{angle}").imag / step
        s_rate = getattr(along, f"sin_{angle}").imag / step
        assert_within(c * c + s * s, np.ones_like(c), 1e-12)
        exact = c * s_rate - s * c_rate
        assert_within(getattr(motion, f"{angle}_rate"), exact, 1e-11 * largest(exact))
    for name in ("r9", "z9", "psi", "phi"):
        partial = getattr(position, f"{name}_rho") * motion.rho_rate
        partial = partial + getattr(position, f"{name}_zeta") * motion.zeta_rate
        assert_within(partial, getattr(motion, f"{name}_rate"), 1e-11 * largest(v, partial))


def test_rates_of_joints_without_the_knee_are_finite_out_of_reach() -> None:
    motion = joint_rates(APPENDIX_4.geometry, [0.0, 0.0, 0.0, -1.2], np.ones(4), np.ones(4))
    for number in (2, 3, 5, 8):
        assert np.isfinite(motion.velocity[number]).all()
        assert np.isfinite(motion.acceleration[number]).all()
    for number in (4, 7, 9):
        assert np.isnan(motion.velocity[number]).all()
        assert np.isnan(motion.acceleration[number]).all()


def eight(pose: Any, actuators: Any) -> list[Any]:
    """The paper's eight coordinates as a list of arrays."""
    return list(np.moveaxis(np.concatenate([pose, actuators], -1), -1, 0))


@given(case=cases())
def test_a_ij_are_the_derivatives_of_the_printed_closure(case: Case) -> None:
    """Complex steps through Eqs. 16 and 17, also at actuators that do not fit the pose."""
    pose = case.poses()
    fitting = inverse_kinematics(case.geometry, pose).actuators
    rng = np.random.default_rng(case.seed)
    for actuators in (fitting, fitting + rng.normal(size=fitting.shape)):
        exact = paper.slopes(
            lambda q: paper.closure(case.geometry, q), eight(pose, actuators)
        )  # (n, 4, 8)
        assert_within(closure_matrix(case.geometry, pose, actuators), exact, 1e-14)


@given(case=cases())
def test_the_inverse_jacobian_is_that_of_first_principles(case: Case) -> None:
    pose = case.poses()
    exact = oracle.actuator_jacobian(case.design, pose)
    got = inverse_jacobian(case.geometry, pose)
    assert_within(got, exact, 1e-12 * np.abs(exact).max())
    # decoupled as the paper says: z moves the lift alone, and the lift follows z alone
    np.testing.assert_array_equal(got[:, :3, 3], 0.0)
    np.testing.assert_array_equal(got[:, 3, :3], 0.0)
    assert_within(got[:, 3, 3] * case.geometry.magnification, np.ones(len(pose)), 1e-15)


@given(case=cases())
def test_jacobian_and_inverse_jacobian_undo_each_other(case: Case) -> None:
    pose = case.poses(32)
    j, g = jacobian(case.geometry, pose), inverse_jacobian(case.geometry, pose)
    one = np.broadcast_to(np.eye(4), g.shape)
    assert_within(j @ g, one, 1e-12)
    assert_within(g @ j, one, 1e-11)
    assert_within(j, np.linalg.inv(g), 1e-11 * np.abs(j).max())


@given(case=cases())
def test_the_rate_is_the_change_of_the_inverse_jacobian(case: Case) -> None:
    pose, v, a = case.states()
    rate = inverse_jacobian_rate(case.geometry, pose, v)
    h = 1e-5
    ahead, behind = (inverse_jacobian(case.geometry, pose + s * h * v) for s in (1.0, -1.0))
    assert_within(rate, (ahead - behind) / (2 * h), 1e-6 * np.abs(rate).max())
    # and to rounding: the actuators' accelerations are G a + G' v
    exact = joint_rates(case.geometry, pose, v, a).actuators_acceleration
    got = np.einsum("nij,nj->ni", inverse_jacobian(case.geometry, pose), a)
    got += np.einsum("nij,nj->ni", rate, v)
    assert_within(got, exact, 1e-12 * np.abs(exact).max())


@given(case=cases())
def test_actuator_velocity_is_that_of_the_motion(case: Case) -> None:
    pose, v, a = case.states()
    exact = joint_rates(case.geometry, pose, v, a).actuators_velocity
    assert_within(actuator_velocity(case.design, pose, v), exact, 1e-12 * np.abs(exact).max())


def test_joint_5_on_its_axis_has_no_inverse_jacobian() -> None:
    geometry = APPENDIX_4.geometry
    on_axis = np.array([0.0, geometry.base_radius - geometry.platform_radius, 0.0, -0.3])
    g = inverse_jacobian(geometry, on_axis)
    assert not np.isfinite(g[2, :3]).any()
    assert np.isfinite(g[[0, 1, 3]]).all()
