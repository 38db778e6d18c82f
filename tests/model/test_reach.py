"""Which poses are refused, for which reason, and by how many meters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Geometry,
    Limit,
    PaminsaError,
    UnreachablePose,
    check_reach,
    inverse_kinematics,
    require_reachable,
    robot,
)
from paminsa_viz.model.kinematics import AXIS_ANGLES, LEG_AXES
from paminsa_viz.model.leg import Mechanism, mechanism, mechanism_of_lengths
from paminsa_viz.model.lumped import term_factors
from paminsa_viz.model.reach import (
    MARGINS,
    decode,
    home_pose,
    reach_status,
    status_words,
    workspace_height,
    workspace_radius,
)
from tests.support.cases import BY_HAND, Case, assert_within, cases
from tests.support.samples import resized

LEGS = st.integers(0, 2)
AMOUNT = st.floats(1e-6, 0.1)


def roomy(geometry: Geometry, difference: float = 0.0) -> Geometry:
    """The same robot with long bars, B4 longer than B8 by ``difference``, and a long guide."""
    crank = 3 * geometry.home_span
    return replace(
        geometry,
        crank_length=crank,
        coupler_length=crank + difference,
        guide_link_length=2 * geometry.base_radius / (geometry.magnification - 1),
    )


def place(geometry: Geometry, leg: int, rho: float, zeta: float, theta: float = 0.0) -> Any:
    """The pose in which joint 5 of a leg is ``rho`` from its axis, inward, at z_5 = ``zeta``."""
    angle = AXIS_ANGLES[leg] + theta
    p5 = geometry.platform_radius * np.array([np.cos(angle), np.sin(angle)])
    x, y = (geometry.base_radius - rho) * LEG_AXES[leg] - p5
    return np.array([x, y, theta, zeta - geometry.platform_joint_height])


def expect(geometry: Geometry, pose: Any, limit: Limit, leg: int, excess: float) -> None:
    found = check_reach(geometry, pose)
    assert (Limit(int(found.status)), int(found.leg)) == (limit, leg)
    assert found.excess == pytest.approx(excess, abs=1e-12)
    assert not found.ok
    assert str(found.words()) == f"{limit.word}:leg{leg + 1}"


@given(case=cases(), leg=LEGS, amount=AMOUNT)
def test_stretched(case: Case, leg: int, amount: float) -> None:
    """Bars longer by the excess would just reach."""
    g = case.geometry
    rho = 1.1 * abs(g.base_radius - g.platform_radius)
    reach = g.crank_length + g.coupler_length
    zeta = -np.sqrt((reach + amount) ** 2 - (g.span_ratio * rho) ** 2)
    pose = place(g, leg, rho, zeta)
    expect(g, pose, Limit.STRETCHED, leg, amount)
    assert np.isnan(inverse_kinematics(g, pose).points[9][leg]).all()
    longer = replace(g, coupler_length=g.coupler_length + amount * (1 + 1e-4))
    assert check_reach(longer, pose).ok
    assert np.isfinite(inverse_kinematics(longer, pose).points[9]).all()


@given(case=cases(), leg=LEGS, amount=st.floats(1e-6, 0.1))
def test_folded(case: Case, leg: int, amount: float) -> None:
    """Bars whose lengths differed less by the excess would just close."""
    difference = 0.5 * case.geometry.home_span
    amount = amount * difference
    g = roomy(case.geometry, difference)
    near = difference - amount
    pose = place(g, leg, 0.8 * near / g.span_ratio, 0.6 * near, theta=0.1)
    expect(g, pose, Limit.FOLDED, leg, amount)
    assert np.isnan(inverse_kinematics(g, pose).points[9][leg]).all()
    closer = replace(g, crank_length=g.crank_length + amount * (1 + 1e-4))
    assert check_reach(closer, pose).ok
    expect(replace(g, crank_length=g.coupler_length + difference), pose, Limit.FOLDED, leg, amount)


@given(case=cases(), leg=LEGS, amount=AMOUNT)
def test_guide(case: Case, leg: int, amount: float) -> None:
    """A guide longer by the excess would just do; its default length is that of its link."""
    g = roomy(case.geometry)
    rho = 1.1 * abs(g.base_radius - g.platform_radius)
    travel = rho / (g.magnification - 1)
    amount = amount * travel
    pose = place(g, leg, rho, -0.5)
    assert check_reach(g, pose).ok
    x8 = inverse_kinematics(g, pose).points[8][leg, :2] - g.base_radius * LEG_AXES[leg]
    assert np.hypot(*x8) == pytest.approx(travel, rel=1e-12)
    for short in (
        replace(g, guide_stroke=travel - amount),
        replace(g, guide_link_length=travel - amount),
        replace(g, guide_link_length=2 * travel, guide_stroke=travel - amount),
    ):
        expect(short, pose, Limit.GUIDE, leg, amount)
        assert check_reach(replace(short, guide_stroke=travel * (1 + 1e-9)), pose).ok


@given(case=cases(), leg=LEGS, clearance=st.floats(0.01, 0.2), share=st.floats(0.1, 0.99))
def test_axis(case: Case, leg: int, clearance: float, share: float) -> None:
    g = roomy(case.geometry)
    clearance = clearance * g.base_radius
    pose = place(g, leg, share * clearance, -0.3)
    expect(replace(g, axis_clearance=clearance), pose, Limit.AXIS, leg, (1 - share) * clearance)
    assert check_reach(replace(g, axis_clearance=share * clearance * (1 - 1e-6)), pose).ok
    assert check_reach(g, pose).ok


def wide_poses(case: Case, n: int = 400) -> Any:
    """Poses far and near, most of them out of reach."""
    rng = np.random.default_rng(case.seed)
    g = case.geometry
    size = np.array([2 * g.base_radius, 2 * g.base_radius, np.pi, 2 * g.coupler_length])
    return rng.normal(size=(n, 4)) * size * rng.choice([0.1, 0.4, 1.0], (n, 1))


@given(case=cases())
def test_margins_are_distances_between_joints(case: Case) -> None:
    g, pose = case.geometry, wide_poses(case)
    found = check_reach(g, pose)
    assert found.margins.shape == (400, 3, 4)
    p = inverse_kinematics(g, pose).points
    span = np.linalg.norm(p[5] - p[8], axis=-1)
    axis = g.base_radius * LEG_AXES
    near = np.hypot(*np.moveaxis(p[5][..., :2] - axis, -1, 0))
    travel = np.hypot(*np.moveaxis(p[8][..., :2] - axis, -1, 0))
    expected = [
        g.crank_length + g.coupler_length - span,
        span - abs(g.coupler_length - g.crank_length),
        g.stroke - travel,
        near - g.axis_clearance,
    ]
    assert_within(found.margins, np.stack(expected, -1), 1e-12)
    assert MARGINS == (Limit.STRETCHED, Limit.FOLDED, Limit.GUIDE, Limit.AXIS)
    # status, leg and excess are the worst margin's
    worst = found.margins.reshape(-1, 12).argmin(axis=-1)
    least = found.margins.reshape(-1, 12).min(axis=-1)
    bad = least < 0
    np.testing.assert_array_equal(found.status, np.where(bad, np.array(MARGINS)[worst % 4], 0))
    np.testing.assert_array_equal(found.leg, np.where(bad, worst // 4, -1))
    np.testing.assert_array_equal(found.excess, np.where(bad, -least, 0.0))
    assert bad.any()
    assert not bad.all()
    assert (found.status.dtype, found.leg.dtype) == (np.uint8, np.int8)


@given(case=cases())
def test_bars_close_exactly_where_margins_are_positive(case: Case) -> None:
    """By the triangle inequality, and by whether the configuration has a knee."""
    g, pose = case.geometry, wide_poses(case)
    margins = check_reach(g, pose).margins
    knee = inverse_kinematics(g, pose).points[9]
    clear = np.abs(margins[..., :2]).min(axis=-1) > 1e-9
    closes = (margins[..., :2] > 0).all(axis=-1)
    np.testing.assert_array_equal(np.isfinite(knee).all(axis=-1)[clear], closes[clear])


@given(case=cases())
def test_reach_status_agrees_with_check_reach(case: Case) -> None:
    pose = wide_poses(case)
    pose[::7, case.seed % 4] = np.nan
    pose[1::7, case.seed % 4] = np.inf
    full = check_reach(case.geometry, pose)
    status, leg = reach_status(case.geometry, pose)
    clear = ~(np.abs(full.margins.reshape(-1, 12)).min(axis=-1) < 1e-12)
    np.testing.assert_array_equal(status[clear], full.status[clear])
    np.testing.assert_array_equal(leg[clear], full.leg[clear])
    assert (status[::7] == Limit.NOT_FINITE).all()
    assert (status[1::7] == Limit.NOT_FINITE).all()


@given(
    values=st.lists(
        st.sampled_from([np.nan, np.inf, -np.inf, 0.01]), min_size=4, max_size=4
    ).filter(lambda values: not np.isfinite(values).all())
)
def test_what_is_not_finite_is_no_pose(values: list[float]) -> None:
    found = check_reach(APPENDIX_4.geometry, [values, BY_HAND[0]])
    assert found.status.tolist() == [Limit.NOT_FINITE, Limit.OK]
    assert found.leg.tolist() == [-1, -1]
    assert found.excess.tolist() == [0.0, 0.0]
    assert found.words().tolist() == ["not-finite", "ok"]
    with pytest.raises(UnreachablePose, match="not finite") as caught:
        require_reachable(APPENDIX_4.geometry, values)
    assert (caught.value.leg, caught.value.limit) == (0, "not-finite")


@given(case=cases())
def test_the_workspace_lies_within_its_radius_and_height(case: Case) -> None:
    g, pose = case.geometry, wide_poses(case)
    ok = check_reach(g, pose).ok
    radius, height = workspace_radius(g), workspace_height(g)
    assert np.hypot(pose[ok, 0], pose[ok, 1]).max() <= radius
    center = pose * [0.0, 0.0, 1.0, 1.0]
    ok = check_reach(g, center).ok
    assert np.abs(center[ok, 3] + g.platform_joint_height).max() <= height


@given(case=cases())
def test_home_is_reached_on_the_side_of_the_knee_and_not_too_deep(case: Case) -> None:
    g = case.geometry
    x, y, theta, z = home_pose(g)
    z5 = z + g.platform_joint_height
    assert (x, y, theta) == (0.0, 0.0, 0.0)
    assert -z5 * g.knee.sign > 0
    depth = min(0.75 * workspace_height(g), 0.5 * (g.crank_length + g.coupler_length))
    assert abs(z5) == pytest.approx(depth, abs=5.01e-4)
    assert depth < 0.01 or z == round(z, 3)  # to a millimeter


@pytest.mark.parametrize("times", [1e-1, 1e-2, 1e-3, 1e-4, 2e-5])
def test_home_of_a_small_robot_is_in_the_same_place_of_its_workspace(times: float) -> None:
    """A millimeter is more than all of the workspace of the smallest ones."""
    g = resized(APPENDIX_4, times).geometry
    z5 = home_pose(g)[3] + g.platform_joint_height
    assert z5 == pytest.approx(-0.5 * (g.crank_length + g.coupler_length), rel=0.05)
    assert check_reach(g, home_pose(g)).ok


def test_the_radius_and_height_of_appendix_4_are_reached() -> None:
    g = APPENDIX_4.geometry
    for scale, wanted in ((1 - 1e-9, True), (1 + 1e-9, False)):
        top = [0.0, 0.0, 0.0, -scale * workspace_height(g) - g.platform_joint_height]
        corner = [0.0, scale * workspace_radius(g), 0.0, -g.platform_joint_height]
        assert check_reach(g, [top, corner]).ok.tolist() == [wanted, wanted]


def test_a_robot_that_is_wide_has_its_home_less_deep() -> None:
    wide = replace(APPENDIX_4.geometry, base_radius=0.75)
    assert home_pose(wide)[3] + wide.platform_joint_height == pytest.approx(
        -0.75 * workspace_height(wide), abs=5.01e-4
    )
    assert 0.75 * workspace_height(wide) < 0.5 * (wide.crank_length + wide.coupler_length)


def test_status_and_leg_follow_from_the_least_margin_and_its_number() -> None:
    """Zero is no margin but of a guide, each pose alone and all at once."""
    rows = [
        (margin, tag, Limit.OK if free else MARGINS[tag % 4], -1 if free else tag // 4)
        for tag in range(12)
        for margin, free in ((1.0, True), (0.0, tag % 4 == 2), (-1.0, False))
    ]
    rows += [(bad, 5, Limit.NOT_FINITE, -1) for bad in (np.nan, -np.inf)]
    for some in (rows, *([row] for row in rows)):
        margins, tags, limits, legs = zip(*some, strict=True)
        status, leg = decode(np.array(margins), np.array(tags, float))
        assert status.tolist() == list(limits)
        assert leg.tolist() == list(legs)
        assert (status.dtype, leg.dtype) == (np.uint8, np.int8)


def test_long_numbers_of_a_pose_are_shortened() -> None:
    for x, text in ((9.9999, "9999.9 mm"), (9999.0, "9.999e+06 mm"), (1.05e4, "1.05e+07 mm"),
                    (-1.05e4, "-1.05e+07 mm"), (np.nan, "–")):  # fmt: skip
        with pytest.raises(UnreachablePose) as caught:
            require_reachable(APPENDIX_4.geometry, [x, 0.0, 0.0, 0.0])
        assert f"pose x {text}, y 0 mm, theta 0°, z 0 mm cannot be taken" in str(caught.value)


def test_words() -> None:
    words = [limit.word for limit in Limit]
    assert words == ["ok", "not-finite", "stretched", "folded", "guide", "axis", "singular"]
    assert len({limit.explanation for limit in Limit}) == len(Limit)
    codes = np.array([[Limit.OK, Limit.GUIDE], [Limit.SINGULAR, Limit.AXIS]])
    legs = np.array([[-1, 1], [-1, 2]])
    assert status_words(codes, legs).tolist() == [["ok", "guide:leg2"], ["singular", "axis:leg3"]]
    assert status_words(Limit.FOLDED).tolist() == "folded"


def test_error_names_leg_and_excess() -> None:
    g = APPENDIX_4.geometry
    require_reachable(g, BY_HAND)
    pose = [0.1, 0.05, 0.2, -1.1]
    with pytest.raises(UnreachablePose) as caught:
        require_reachable(g, [BY_HAND[0], pose, [9.0, 0.0, 0.0, 0.0]])
    error, found = caught.value, check_reach(g, pose)
    assert error.pose == tuple(pose)
    assert error.limit == Limit(int(found.status)).word == "stretched"
    assert error.leg == int(found.leg) + 1
    assert error.excess == float(found.excess)
    assert "pose x 100 mm, y 50 mm, theta 11.459°, z -1100 mm cannot be taken" in str(error)
    assert f"(leg {error.leg}, by {1e3 * error.excess:.2f} mm)" in str(error)
    assert isinstance(error, PaminsaError)


@given(
    seed=st.integers(0, 10_000), power=st.integers(-8, 8), clearance=st.sampled_from([0.0, 0.02])
)
def test_bounds_of_reach_and_their_rounding_scale_with_the_robot(
    seed: int, power: int, clearance: float
) -> None:
    rng = np.random.default_rng(seed)
    k, scale = rng.uniform(1.2, 4.0), 2.0**power
    lengths = np.append(rng.uniform(0.1, 1.0, 7), clearance)  # R_b, R_pl, l_B5, l_B2, ..., stroke
    one, other = (
        Mechanism(*mechanism_of_lengths(k, *(factor * lengths), 1.0)) for factor in (1.0, scale)
    )
    for name in ("rho2_min", "rho2_max", "reach2_min", "reach2_max"):
        assert getattr(other, name) == pytest.approx(scale**2 * getattr(one, name), rel=1e-14)
    assert one.rho2_min > 0


def test_an_explanation_names_the_leg_and_by_how_much_or_neither() -> None:
    angle = AXIS_ANGLES[:, None]
    away = np.concatenate([-0.5 * np.cos(angle), -0.5 * np.sin(angle)], axis=1)
    pose = np.array([*([x, y, 0.0, -0.5] for x, y in away), [0.0, 0.0, 0.0, -0.5], [np.nan] * 4])
    found = check_reach(APPENDIX_4.geometry, pose)
    for leg in range(3):
        text = found.explanation((leg,))
        assert text.startswith(Limit(int(found.status[leg])).explanation)
        assert text.endswith(f" (leg {leg + 1}, by {1e3 * found.excess[leg]:.2f} mm)")
    assert found.explanation((3,)) == Limit.OK.explanation
    assert found.explanation((4,)) == Limit.NOT_FINITE.explanation
    on_axis = replace(APPENDIX_4.geometry, platform_radius=APPENDIX_4.geometry.base_radius)
    assert check_reach(on_axis, pose[3]).explanation().endswith(" (leg 1, by 0.00 mm)")


def test_torques_have_no_number_where_any_one_leg_is_out_of_reach() -> None:
    """Of the formulas themselves, whose status somebody else may not look at."""
    g = replace(APPENDIX_4.geometry, guide_stroke=0.25)  # bars alone would reach farther
    m, e = mechanism(g), term_factors(APPENDIX_4)
    for angle in AXIS_ANGLES:
        place = (-0.3 * np.cos(angle), -0.3 * np.sin(angle), 1.0, 0.0, -0.5)
        margins = check_reach(g, [*place[:2], 0.0, -0.5]).margins
        assert (margins < 0).any(axis=1).sum() == 1
        with np.errstate(all="ignore"):
            assert np.isnan(robot.unit_torques(m, *place)).all()
            assert np.isnan(robot.inverse_dynamics_kernel(m, e, 9.81, *place, *[0.1] * 8)).all()
