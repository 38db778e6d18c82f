"""Legs with lengths of their own: position, tilt, their derivatives, what has no solution."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.files.design_file import read_design, write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import (
    APPENDIX_4,
    KneeBranch,
    check_reach,
    inverse_kinematics,
    jacobian,
)
from paminsa_viz.model.accuracy import LENGTH_NAMES, LegDeviations
from paminsa_viz.precision.closure_equations import closure_equations
from paminsa_viz.precision.leg_lengths import (
    INDEX,
    LENGTHS,
    design_lengths,
    deviation_array,
    nominal_lengths,
    with_deviations,
)
from paminsa_viz.precision.unequal_legs import (
    Closure,
    UnequalPose,
    nominal_pose,
    sensitivities,
    solve_actuators,
    solve_pose,
)
from tests.precision.mujoco_legs import assemble
from tests.support.cases import BOTH, BY_HAND, PROTOTYPES, Case, cases
from tests.support.samples import random_poses

TILTING = {
    "bar_94", "bar_45", "bar_43", "bar_37", "bar_87", "bar_89", "shaft", "joint_height",
    "guide_height",
}  # fmt: skip
"""Lengths that change the height of joint 5 above its place; the others shift it sideways."""


def random_deviations(seed: int, size: float, *batch: int) -> Any:
    return np.random.default_rng(seed).uniform(-size, size, (*batch, 3, len(LENGTHS)))


def nominal(case: Case, n: int = 8) -> tuple[Any, Any, Any]:
    poses = case.poses(n)
    actuators = inverse_kinematics(case.geometry, poses).actuators
    return nominal_lengths(case.geometry), poses, actuators


def nominal_slopes(geometry: Any, poses: Any) -> Any:
    return sensitivities(geometry, nominal_lengths(geometry), nominal_pose(geometry, poses))


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
    assert 0.04 < lost < 0.058  # 5.6 %; 6.0 % if the whole step has to do
    state = np.concatenate([found.coordinates, found.slides, found.actuators], axis=-1)[found.ok]
    closed = closure_equations(lengths[found.ok], state, g.knee.sign)
    assert np.abs(closed.gap).max() < 1e-12


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


def reasons(found: UnequalPose) -> list[Closure]:
    return [Closure(int(value)) for value in np.ravel(found.closure)]


def test_what_has_no_solution_says_why() -> None:
    g = APPENDIX_4.geometry
    pose = BY_HAND[0]
    actuators = inverse_kinematics(g, pose).actuators
    lengths = np.stack([nominal_lengths(g)] * 4)
    lengths[1, 0, INDEX["bar_89"]] = np.nan
    lengths[2, 0, INDEX["bar_89"]] = 2.0
    lengths[3, 2, INDEX["bar_37"]] = 1e-3
    found = solve_pose(g, lengths, actuators, pose)
    assert reasons(found) == [Closure.OK, Closure.NOT_FINITE, Closure.OPEN, Closure.OPEN]
    assert np.isnan(found.coordinates[1:]).all()
    assert np.isnan(found.actuators[1:]).all()
    assert all(reason.reason for reason in Closure)


def test_no_number_at_a_singular_pose() -> None:
    """On the singular circle of theta = 0, |(x, y)| = R_b - R_pl, the platform is loose."""
    g = APPENDIX_4.geometry
    radius = g.base_radius - g.platform_radius
    pose = np.array([0.6 * radius, 0.8 * radius, 0.0, -0.5])
    found = solve_pose(g, nominal_lengths(g), inverse_kinematics(g, pose).actuators, pose)
    loose = nominal_slopes(g, pose)
    assert np.isnan(loose.lengths).all()
    assert np.isnan(loose.actuators).all()
    assert reasons(found) == [Closure.SINGULAR]
    # Beside it deviations decide whether there is an assembly, often far away: all are exact, on
    # the nominal robot's side of the locus, or none.
    near = pose * [1 - 1e-9, 1 - 1e-9, 1, 1]
    lengths = nominal_lengths(g) + random_deviations(0, 1e-3, 50)
    actuators = inverse_kinematics(g, near).actuators
    bad = solve_pose(g, lengths, actuators, near)
    assert 10 < bad.ok.sum() < 40
    assert np.isnan(bad.pose[~bad.ok]).all()
    state = np.concatenate([bad.coordinates, bad.slides, bad.actuators], axis=-1)[bad.ok]
    closed = closure_equations(lengths[bad.ok], state, g.knee.sign)
    assert np.abs(closed.gap).max() < 1e-12
    sides = np.linalg.slogdet(closed.by_state[:, :, :9])[0]
    assert (sides == -1).all()  # as inside the circle for all |theta| < 73 degrees


def test_an_unreachable_pose_has_no_sensitivities() -> None:
    g = APPENDIX_4.geometry
    assert np.isnan(nominal_slopes(g, [0, 0, 0, -3.0]).lengths).all()
    found = solve_actuators(g, nominal_lengths(g), [0, 0, 0, -3.0])
    assert reasons(found) == [Closure.OPEN]


def test_deviations_and_arrays_are_the_same_numbers() -> None:
    values = random_deviations(0, 1e-3)
    design = with_deviations(APPENDIX_4, values)
    assert np.array_equal(deviation_array(design), values)
    assert design.leg3.guide_height == values[2, INDEX["guide_height"]]
    assert design.value("leg2.bar_94") == values[1, 0]
    assert not deviation_array(APPENDIX_4).any()
    assert np.array_equal(design_lengths(design), nominal_lengths(APPENDIX_4.geometry) + values)
    assert [item.name for item in LENGTHS] == list(LENGTH_NAMES)
    assert APPENDIX_4.leg1.zero
    assert not design.leg1.zero
    assert with_deviations(design, np.zeros((3, 14))) == APPENDIX_4


def test_design_files_hold_deviations_and_tolerances() -> None:
    design = with_deviations(APPENDIX_4, random_deviations(1, 1e-3))
    design = design.vary({"tolerances.bar": 1e-5, "leg2.shaft": 0.0})
    text = write_design(design)
    assert read_design(text, "robot.toml") == design
    assert "[leg1]" in text
    assert "bar_m = 1e-05" in text
    assert "shaft_clearance" not in text
    plain = write_design(APPENDIX_4)
    assert not any(f"[{table}]" in plain for table in ("leg1", "leg2", "leg3", "tolerances"))
    with pytest.raises(
        DesignFileError, match=r"line 3, \[leg2\] bar_94_m = 1000000000.0: .* at most 100"
    ):
        read_design("schema_version = 1\n[leg2]\nbar_94_m = 1e9\n", "robot.toml")


@pytest.mark.parametrize("shape", [(14,), (2, 14), (3, 13), (5, 3, 13)], ids=str)
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(InvalidInput, match="3 legs and 14 lengths"):
        solve_pose(APPENDIX_4.geometry, np.zeros(shape), np.zeros(4), np.zeros(4))


def test_bad_deviations_are_refused() -> None:
    with pytest.raises(InvalidDesign, match="bar_94 = nan"):
        LegDeviations(bar_94=float("nan"))
    with pytest.raises(InvalidDesign, match="at most 100 in size"):
        with_deviations(APPENDIX_4, np.full((3, 14), 200.0))
    with pytest.raises(InvalidInput, match="batch shapes"):
        solve_pose(APPENDIX_4.geometry, np.zeros((5, 3, 14)), np.zeros((4, 4)), np.zeros(4))
