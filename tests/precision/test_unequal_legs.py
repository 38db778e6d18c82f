"""Legs with lengths of their own: position, tilt, their derivatives, what has no solution."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    KneeBranch,
    check_reach,
    inverse_kinematics,
    jacobian,
)
from paminsa_viz.precision.closure_equations import closure_equations
from paminsa_viz.precision.leg_lengths import (
    INDEX,
    LENGTHS,
    nominal_lengths,
)
from paminsa_viz.precision.unequal_legs import (
    Closure,
    nominal_pose,
    sensitivities,
    solve_actuators,
    solve_pose,
)
from tests.precision.deviations import nominal_slopes, random_deviations, reasons
from tests.precision.mujoco_legs import assemble
from tests.support.cases import BOTH, BY_HAND, PROTOTYPES, Case, cases
from tests.support.samples import random_poses

TILTING = {
    "bar_94", "bar_45", "bar_43", "bar_37", "bar_87", "bar_89", "shaft", "joint_height",
    "guide_height",
}  # fmt: skip
"""Lengths that change the height of joint 5 above its place; the others shift it sideways."""


def nominal(case: Case, n: int = 8) -> tuple[Any, Any, Any]:
    poses = case.poses(n)
    actuators = inverse_kinematics(case.geometry, poses).actuators
    return nominal_lengths(case.geometry), poses, actuators


@given(case=cases())
def test_equal_legs_are_the_model_s_robot(case: Case) -> None:
    lengths, poses, actuators = nominal(case)
    near = poses + np.array([2e-3, -1e-3, 5e-3, 3e-3])
    found = solve_pose(case.geometry, lengths, actuators, near)
    assert found.ok.all()
    assert np.allclose(found.pose, poses, rtol=0, atol=2e-13)
    assert np.abs(found.tilt).max() < 2e-12
    wanted = solve_actuators(case.geometry, lengths, poses)
    assert np.allclose(wanted.actuators, actuators, rtol=0, atol=2e-13)
    # the sliders are at the paper's X_4
    axis = case.geometry.base_radius
    points = inverse_kinematics(case.geometry, poses).points
    assert np.allclose(
        np.abs(wanted.slides),
        np.linalg.norm(points[8][..., :2] - points[3][..., :2], axis=-1),
        rtol=0, atol=1e-12 * axis,
    )  # fmt: skip


@given(case=cases())
def test_the_first_order_of_the_actuators_is_the_robot_s_jacobian(case: Case) -> None:
    _, poses, _ = nominal(case)
    found = nominal_slopes(case.geometry, poses).actuators
    wanted = jacobian(case.geometry, poses)
    scale = np.abs(wanted).max(axis=(-1, -2), keepdims=True)
    assert (np.abs(found[:, :4] - wanted) <= 1e-12 * scale).all()
    assert (np.abs(found[:, 4:]) <= 1e-10 * scale).all()


@pytest.mark.slow
@given(case=cases(), seed=st.integers(0, 99))
def test_sensitivities_are_the_solver_s_differences(case: Case, seed: int) -> None:
    lengths, poses, actuators = nominal(case)
    lengths = lengths + random_deviations(seed, 1e-3)
    at = solve_pose(case.geometry, lengths, actuators, poses)
    ok = at.ok
    slopes = sensitivities(case.geometry, lengths, at)
    change = random_deviations(seed + 1, 1.0)
    step = np.random.default_rng(seed).uniform(-1, 1, 4)
    h = 1e-6
    high = solve_pose(case.geometry, lengths + h * change, actuators + h * step, at.pose)
    low = solve_pose(case.geometry, lengths - h * change, actuators - h * step, at.pose)
    ok = ok & high.ok & low.ok
    assert ok.sum() >= 6
    measured = (high.coordinates - low.coordinates)[ok] / (2 * h)
    linear = np.einsum("nikl,kl->ni", slopes.lengths, change) + slopes.actuators @ step
    scale = np.abs(measured).max(axis=-1, keepdims=True)
    assert (np.abs(measured - linear[ok]) < 1e-6 * (1 + scale)).all()


@PROTOTYPES
def test_position_and_tilt_are_mujoco_s(design: Any) -> None:
    g = design.geometry
    poses = BY_HAND * [1, 1, 1, g.knee.sign]
    for seed, pose in enumerate(poses):
        lengths = nominal_lengths(g) + random_deviations(seed, 1.5e-3)
        actuators = inverse_kinematics(g, pose).actuators
        found = solve_pose(g, lengths, actuators, pose)
        assert found.ok
        assert np.abs(found.coordinates - [*pose, 0, 0]).max() > 1e-3
        assert np.abs(found.tilt).max() > 1e-3
        reference = assemble(g, lengths, actuators, pose)
        assert np.allclose(found.coordinates, reference, rtol=0, atol=1e-10)


@pytest.mark.slow
@given(case=cases(), seed=st.integers(0, 99))
def test_inverse_and_forward_agree(case: Case, seed: int) -> None:
    lengths, poses, _ = nominal(case)
    lengths = lengths + random_deviations(seed, 5e-4, 8)
    wanted = solve_actuators(case.geometry, lengths, poses)
    assert wanted.ok.sum() >= 6
    back = solve_pose(case.geometry, lengths, wanted.actuators, poses)
    ok = wanted.ok & back.ok
    assert ok.sum() >= 6
    assert np.allclose(back.pose[ok], poses[ok], rtol=0, atol=1e-11)
    assert np.allclose(back.tilt[ok], wanted.tilt[ok], rtol=0, atol=1e-10)
    assert np.array_equal(wanted.pose[ok], poses[ok])


@given(case=cases())
def test_only_heights_and_bars_tilt(case: Case) -> None:
    """Lengths in the ground plan move the sliders, and the pantograph keeps z_5 = k z_3."""
    _, poses, _ = nominal(case)
    slopes = nominal_slopes(case.geometry, poses).lengths
    for name, index in INDEX.items():
        tilt = np.abs(slopes[:, 4:, :, index])
        if name in TILTING:
            assert tilt.max() > 0.1
        else:
            assert tilt.max() < 1e-9 * np.abs(slopes).max()


@BOTH
def test_height_differences_tilt_the_plane_of_the_joints_5(knee: KneeBranch) -> None:
    """Three heights h_k: the platform is in the plane through them, P below their middle."""
    g = replace(APPENDIX_4.geometry, knee=knee)
    pose = np.array([0.0, 0.0, 0.0, -0.5 * knee.sign])
    slopes = nominal_slopes(g, pose)
    rise = slopes.lengths[..., INDEX["joint_height"]]
    # e = R_pl n(a_k): sum of (2/3R) (h_k sin a_k, -h_k cos a_k) about the middle
    angles = np.radians([210, -30, 90])
    lean = 2 / (3 * g.platform_radius) * np.stack([np.sin(angles), -np.cos(angles)])
    assert np.allclose(rise[3], -1 / 3)
    assert np.allclose(rise[4:], -lean)
    # turned about the joints 5, l_B5 above P
    aside = g.platform_joint_height * np.stack([-rise[5], rise[4]])
    assert np.allclose(slopes.lengths[3, :, INDEX["shaft"]], -g.magnification / 3)
    assert np.abs(aside).max() > 0.1


@pytest.mark.slow
@given(case=cases(), seed=st.integers(0, 99))
def test_a_third_of_a_turn_permutes_the_legs(case: Case, seed: int) -> None:
    lengths, poses, actuators = nominal(case)
    change = random_deviations(seed, 5e-4)
    first = solve_pose(case.geometry, lengths + change, actuators, poses)
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    turned = poses.copy()
    turned[:, :2] = poses[:, :2] @ np.array([[c, s], [-s, c]])
    # leg 1 at 210 degrees comes to -30, that of leg 2
    order = [2, 0, 1]
    second = solve_pose(case.geometry, lengths + change[order], actuators[:, [*order, 3]], turned)
    ok = first.ok & second.ok
    assert ok.sum() >= 6
    moved = first.pose[ok].copy()
    moved[:, :2] = moved[:, :2] @ np.array([[c, s], [-s, c]])
    assert np.allclose(second.pose[ok], moved, rtol=0, atol=1e-11)
    # the tilt is in the platform's axes, which the legs have turned in as well
    tilt = first.tilt[ok] @ np.array([[c, s], [-s, c]])
    assert np.allclose(second.tilt[ok], tilt, rtol=0, atol=1e-10)


def test_all_lengths_scaled_scale_the_pose() -> None:
    g = APPENDIX_4.geometry
    meters = np.array([item.unit == "m" for item in LENGTHS])
    lengths = nominal_lengths(g) + random_deviations(3, 1e-3)
    pose = BY_HAND[1]
    actuators = inverse_kinematics(g, pose).actuators
    first = solve_pose(g, lengths, actuators, pose)
    twice = np.where(meters, 1.01 * lengths, lengths)
    second = solve_pose(g, twice, actuators * [1, 1, 1, 1.01], pose)
    factors = [1.01, 1.01, 1, 1.01, 1, 1]
    assert np.allclose(second.coordinates, first.coordinates * factors, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_poses_near_limits_are_found_on_the_robot_s_side_or_not_at_all() -> None:
    """Where Newton's step leaves the robot's side of a singularity, a shorter one is tried."""
    g = APPENDIX_4.geometry
    random = np.random.default_rng(0)
    drawn = random.uniform([-0.3, -0.3, -1.2, -0.96], [0.3, 0.3, 1.2, -0.1], (4000, 4))
    poses = drawn[check_reach(g, drawn).ok]
    lengths = nominal_lengths(g) + random_deviations(0, 1e-3, len(poses))
    actuators = inverse_kinematics(g, poses).actuators
    found = solve_pose(g, lengths, actuators, poses)
    assert (found.slides[found.ok] < 0).all()
    assert set(reasons(found)) >= {Closure.OK, Closure.OPEN, Closure.SINGULAR}
    lost = (~found.ok).mean()
    assert 0.04 < lost < 0.055  # 5.4 %; 5.8 % if the whole step has to do
    # all but a few of those for which no solution is found have met a singularity on the way
    assert 0 < (found.status == Closure.DIVERGED).sum() < 20
    state = np.concatenate([found.coordinates, found.slides, found.actuators], axis=-1)[found.ok]
    closed = closure_equations(lengths[found.ok], state, g.knee.sign)
    assert np.abs(closed.gap).max() < 1e-12


@pytest.mark.slow
def test_bars_that_do_not_meet_at_the_nominal_sliders_are_followed_from_the_nominal_robot() -> None:
    """2 mm before the nominal pantographs are stretched, in 150 small steps by Newton's method."""
    g, n, steps = APPENDIX_4.geometry, 40, 150
    pose = np.array([0.0, 0.0, 0.0, -1.00611])
    start, nominal_legs = nominal_pose(g, pose), nominal_lengths(g)
    deviations = random_deviations(0, 5e-4, n)
    found = solve_pose(g, nominal_legs + deviations, start.actuators, pose)
    inverse = solve_actuators(g, nominal_legs + deviations, pose)

    def followed(unknown: slice) -> Any:
        """States (n, 13), NaN from where bars do not meet or the determinant changes its sign."""
        now = np.tile(np.concatenate([start.coordinates, start.slides, start.actuators]), (n, 1))
        before, side = now.copy(), None
        for share in np.linspace(0.0, 1.0, steps + 1):
            trial, matrix = 2.0 * now - before, np.eye(9)
            for _ in range(2 if share < 1.0 else 5):  # the end alone has to be exact
                closure = closure_equations(nominal_legs + share * deviations, trial, g.knee.sign)
                matrix = closure.by_state[:, :, unknown]
                lost = ~np.isfinite(matrix).all(axis=(1, 2))
                trial[lost], matrix[lost], closure.gap[lost] = np.nan, np.eye(9), np.nan
                trial[:, unknown] -= np.linalg.solve(matrix, closure.gap[..., None])[..., 0]
            sign = np.sign(np.linalg.det(matrix))
            side = sign if side is None else side
            trial[(sign != side) | (np.abs(trial - now).max(axis=1) > 0.01)] = np.nan
            before, now = now, trial
        return now

    for solution, unknown in ((found, slice(0, 9)), (inverse, slice(4, 13))):
        expected = followed(unknown)
        closes = np.isfinite(expected).all(axis=1)
        assert closes.sum() >= 3
        assert np.array_equal(solution.ok, closes)
        assert np.allclose(solution.coordinates[closes], expected[closes, :6], rtol=0.0, atol=1e-10)


def test_starts_some_way_off_lead_to_the_same_pose() -> None:
    g = APPENDIX_4.geometry
    poses = random_poses(np.random.default_rng(0), APPENDIX_4, 500)
    lengths = nominal_lengths(g) + random_deviations(0, 2e-3, 500)
    wanted = solve_actuators(g, lengths, poses)
    assert wanted.ok.all()
    way = np.random.default_rng(1).uniform(-1, 1, poses.shape) * [0.02, 0.02, 0.06, 0.02]
    found = solve_pose(g, lengths, wanted.actuators, poses + way)
    assert found.ok.mean() > 0.99
    assert np.allclose(found.pose[found.ok], poses[found.ok], rtol=0, atol=1e-12)
