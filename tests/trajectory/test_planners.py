"""Planners: where they go, how they get there, and exact derivatives."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, InvalidInput, KneeBranch
from paminsa_viz.model.resizing import TURN_LENGTH
from paminsa_viz.trajectory import (
    PRESET,
    MotionLimits,
    Plan,
    TimeLaw,
    arch,
    chain,
    check_path,
    circle,
    from_samples,
    line,
    paper_like,
    point_to_point,
    preset_center,
    round_trip,
    shortest_stretch,
    via_points,
)
from paminsa_viz.trajectory.paths import spline_path, straight_path
from paminsa_viz.trajectory.plan import Blend, Displacement
from paminsa_viz.trajectory.planners import shared_time
from paminsa_viz.trajectory.sampled import Locus, Passage
from tests.support.samples import enlarged, with_knee
from tests.trajectory.plans import ALL_PRESETS, LAWS, PLANS, A, B, C, inside, place, preset_plan

lengths = st.floats(-0.3, 0.3)
poses = st.tuples(lengths, lengths, st.floats(-2, 2), lengths).map(np.array)


@PLANS
def test_rates_are_those_of_the_pose_in_time(plan: Plan) -> None:
    t, h = plan.duration * inside(plan), 1e-6
    state, before, after = plan.at(t), plan.at(t - h), plan.at(t + h)
    jerk = plan.jerk(t)
    pairs = (
        (before.pose, after.pose, state.velocity),
        (before.velocity, after.velocity, state.acceleration),
        (before.acceleration, after.acceleration, jerk),
    )
    for low, high, rate in pairs:
        assert np.abs((high - low) / (2 * h) - rate).max() <= 1e-6 * max(np.abs(jerk).max(), 1.0)


@PLANS
def test_it_starts_and_ends_at_rest(plan: Plan) -> None:
    state = plan.at([0.0, plan.duration])
    np.testing.assert_allclose(state.velocity, 0.0, atol=1e-12)
    if plan.curve.bounded_jerk:
        np.testing.assert_allclose(state.acceleration, 0.0, atol=1e-10)
    rates = plan.curve(np.array([0.0, 1.0]), 2) / plan.duration**2
    np.testing.assert_array_equal(state.acceleration, rates)
    outside = plan.at([-0.01, plan.duration + 0.01])
    np.testing.assert_array_equal(outside.pose, state.pose)
    assert not np.any(outside.velocity)
    assert not np.any(outside.acceleration)


@PLANS
def test_derivatives_at_the_ends_are_those_from_inside(plan: Plan) -> None:
    gap = 1e-9
    for order in range(1, 4):
        size = np.abs(plan.curve(inside(plan), order)).max()
        for end, near in ((0.0, gap), (1.0, 1.0 - gap)):
            jump = plan.curve(np.array([near]), order) - plan.curve(np.array([end]), order)
            assert np.abs(jump).max() <= 1e-6 * size + 1e-9


@PLANS
def test_a_jerk_is_bounded_where_the_acceleration_never_jumps(plan: Plan) -> None:
    """Also against the rest before and after; poses and velocities jump nowhere."""
    at, gap = plan.duration * plan.curve.breaks, 1e-9 * plan.duration
    before, after = plan.at(at - gap), plan.at(at + gap)
    size = max(np.abs(plan.curve(inside(plan), 3)).max(), 1.0)
    for low, high in zip(before[:2], after[:2], strict=True):
        assert np.abs(high - low).max() <= 1e-7 * size
    step = np.abs(after.acceleration - before.acceleration).max()
    assert plan.curve.bounded_jerk == (step <= 1e-7 * size)


@given(poses, poses, st.sampled_from(LAWS), st.floats(0.1, 10))
def test_a_move_is_straight(start, goal, law, duration) -> None:
    plan = point_to_point(start, goal, duration, law)
    pose = plan.at(np.linspace(0, duration, 20)).pose
    np.testing.assert_allclose(pose[[0, -1]], [start, goal], atol=1e-12)
    share = law(np.linspace(0, 1, 20))[:, None]
    np.testing.assert_allclose(pose, start + share * (goal - start), atol=1e-12)


def test_a_line_holds_theta() -> None:
    pose = line(A, [0.1, 0.2, -0.4]).at(np.linspace(0, 1, 9)).pose
    np.testing.assert_array_equal(pose[:, 2], A[2])
    np.testing.assert_allclose(pose[-1], [0.1, 0.2, A[2], -0.4], atol=1e-15)
    across = np.cross(pose[:, [0, 1, 3]] - A[[0, 1, 3]], [0.1 - A[0], 0.2 - A[1], -0.4 - A[3]])
    np.testing.assert_allclose(across, 0.0, atol=1e-15)


@pytest.mark.parametrize(("plane", "columns"), [("xy", [0, 1]), ("xz", [0, 3]), ("yz", [1, 3])])
def test_a_circle_is_round(plane: str, columns: list[int]) -> None:
    plan = circle(C, 0.05, 2.0, plane=plane, begin=0.4, angle=np.pi)
    pose = plan.at(np.linspace(0, 2, 30)).pose
    out = pose - C
    np.testing.assert_allclose(np.linalg.norm(out[:, columns], axis=1), 0.05, rtol=1e-12)
    rest = [i for i in range(4) if i not in columns]
    np.testing.assert_array_equal(out[:, rest], 0.0)
    np.testing.assert_allclose(out[0, columns], [0.05 * np.cos(0.4), 0.05 * np.sin(0.4)])
    np.testing.assert_allclose(out[-1], -out[0], atol=1e-15)
    whole = circle(C, 0.05).at([0.0, 1.0]).pose
    np.testing.assert_allclose(whole[0], whole[1], atol=1e-15)


@given(poses, poses, st.floats(0, 0.2), st.floats(0.1, 0.5), st.floats(0, 1))
def test_an_arch_goes_up_over_and_down(start, goal, height, lift, overlap) -> None:
    if 1 - 2 * lift * (1 - overlap) < 1e-3:
        return
    plan = arch(start, goal, height, lift_share=lift, overlap=overlap)
    u = np.linspace(0, 1, 101)
    pose = plan.at(u).pose
    np.testing.assert_allclose(pose[[0, -1]], [start, goal], atol=1e-12)
    top = max(start[3], goal[3]) + height
    assert pose[:, 3].max() <= top + 1e-12
    middle = (u >= lift) & (u <= 1 - lift)
    np.testing.assert_allclose(pose[middle, 3], top, atol=1e-12)
    still = u <= lift * (1 - overlap)
    np.testing.assert_allclose(pose[still][:, :3], np.tile(start[:3], (still.sum(), 1)), atol=1e-12)


def test_waypoints_are_passed_when_they_should_be() -> None:
    plan = via_points([A, C, B, A], times=[2.0, 2.5, 4.0, 4.5])
    assert plan.duration == pytest.approx(2.5)
    np.testing.assert_allclose(plan.at([0.0, 0.5, 2.0, 2.5]).pose, [A, C, B, A], atol=1e-12)
    shared = via_points([A, C, B, A], 2.0)
    np.testing.assert_allclose(shared.curve(shared.curve.breaks), [A, C, B, A], atol=1e-12)
    t = np.linspace(0.01, 1.99, 400)
    third = np.diff(shared.jerk(t), axis=0) / np.diff(t)[:, None]
    assert np.abs(third).max() < 100 * np.abs(shared.jerk(t)).max()  # the jerk does not jump


def test_two_waypoints_make_the_quintic_move() -> None:
    t = np.linspace(0, 1, 11)
    for way, direct in zip(via_points([A, B]).at(t), point_to_point(A, B).at(t), strict=True):
        np.testing.assert_allclose(way, direct, atol=1e-11)


@pytest.mark.parametrize("still", range(4))
def test_a_coordinate_that_stays_has_rates_of_exactly_zero(still: int) -> None:
    """Else rounding gives an actuator that stands still a direction, and with it Coulomb friction
    and losses."""
    poses = np.array([A, B, C, 0.5 * (A + C), A, B, C])
    poses[:, still] = poses[0, still]
    u = np.linspace(0.0, 1.0, 101)
    imported = (from_samples(np.arange(7.0), poses, rest=rest) for rest in (False, True))
    rates = [
        *(curve(u, order) for curve in (via_points(poses).curve, spline_path(poses))
          for order in (1, 2)),
        *(rate for motion in imported for rate in (motion.velocity, motion.acceleration)),
    ]  # fmt: skip
    for rate in rates:
        moves = np.abs(rate).max(axis=0) > 0.0
        assert np.array_equal(moves, np.arange(4) != still)


def test_an_actuator_that_stands_still_has_no_friction() -> None:
    """M4 holds 240 N at a constant height; its 20 N of friction would be beyond the limit."""
    robot = APPENDIX_4.vary({"friction.coulomb_linear": 20.0})
    plan = via_points(np.array([A, B, C]) * [1.0, 1.0, 1.0, 0.0] + [0.0, 0.0, 0.0, -0.6])
    limits = MotionLimits(torque=14.0, force=250.0)
    expected = shortest_stretch(plan, limits, APPENDIX_4).plan.duration
    assert shortest_stretch(plan, limits, robot).plan.duration == expected


def test_chain_and_back() -> None:
    first, second = point_to_point(A, B, 0.5), point_to_point(B, C, 1.5)
    whole = chain(first, second)
    assert whole.duration == 2.0
    np.testing.assert_allclose(whole.at([0.25]).velocity, first.at([0.25]).velocity)
    np.testing.assert_allclose(whole.at([1.0]).acceleration, second.at([0.5]).acceleration)
    both = round_trip(first)
    assert both.duration == 1.0
    t = np.array([0.1, 0.2])
    np.testing.assert_allclose(both.at(1.0 - t).pose, both.at(t).pose)
    np.testing.assert_allclose(both.at(1.0 - t).velocity, -both.at(t).velocity)
    np.testing.assert_allclose(both.at(1.0 - t).acceleration, both.at(t).acceleration)


def test_samples_are_those_of_the_plan() -> None:
    plan = point_to_point(A, B, 1.23456)
    made = plan.sample(100)
    assert made.size == 124
    assert plan.sample(1e-3).t.tolist() == [0.0, plan.duration]
    assert made.t[-1] == plan.duration
    assert place(made.pose[-1:] - B)[0] < 1e-15
    np.testing.assert_array_equal(made.acceleration, plan.at(made.t).acceleration)


NAN = [np.nan, 0, 0, 0]


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("start", lambda: point_to_point(NAN, B)),
        ("goal", lambda: point_to_point(A, [1, 2, 3])),
        ("duration", lambda: point_to_point(A, B, 0.0)),
        ("duration", lambda: point_to_point(A, B, np.inf)),
        ("point", lambda: line(A, [0, 0, np.inf])),
        ("radius", lambda: circle(A, 0.0)),
        ("angle", lambda: circle(A, 0.1, angle=np.nan)),
        ("plane", lambda: circle(A, 0.1, plane="zx")),
        ("height", lambda: arch(A, B, -0.1)),
        ("height", lambda: arch(A, B, "x")),  # type: ignore[arg-type]
        ("lift_share", lambda: arch(A, B, 0.1, lift_share=0.6)),
        ("overlap", lambda: arch(A, B, 0.1, overlap=1.5)),
        ("overlap", lambda: arch(A, B, 0.1, lift_share=0.5, overlap=0.0)),
        ("poses", lambda: via_points([A])),
        ("poses", lambda: via_points([A, B, B, C])),
        ("poses", lambda: via_points([A, NAN])),
        ("times", lambda: via_points([A, B, C], times=[0, 2, 1])),
        ("times", lambda: via_points([A, B, C], times=[0, 1])),
        ("plans", lambda: chain()),
        ("plans", lambda: chain(point_to_point(A, B), point_to_point(C, A))),
        ("rate", lambda: point_to_point(A, B).sample(0.0)),
        ("rate", lambda: point_to_point(A, B).sample(1e9)),
    ],
    ids=count(),
)
def test_errors_name_the_argument(argument: str, make) -> None:
    with pytest.raises(InvalidInput) as caught:
        make()
    assert caught.value.argument == argument


LENGTHS = (
    "base_radius", "platform_radius", "arm_length", "shaft_length", "crank_length",
    "coupler_length", "platform_joint_height", "guide_link_length",
)  # fmt: skip


@ALL_PRESETS
@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("scale", [1.0, 2.5])
def test_presets_run_on_robots_of_other_sizes(preset, knee, scale) -> None:
    geometry = APPENDIX_4.vary(
        {f"geometry.{name}": scale * APPENDIX_4.value(f"geometry.{name}") for name in LENGTHS}
    ).geometry
    plan = preset.build(with_knee(geometry, knee))
    check = check_path(geometry, plan.sample())
    assert check.possible
    assert check.closest.margin > 0.05 * scale * APPENDIX_4.geometry.base_radius
    u = np.linspace(0.0, 1.0, 8)
    unscaled = preset.build(with_knee(APPENDIX_4.geometry, knee)).curve(u)
    np.testing.assert_allclose(plan.curve(u), unscaled * [scale, scale, 1, scale], atol=1e-12)


@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("key", ["line", "arch"])
def test_preset_line_and_arch_go_through_the_axis_from_one_side_to_the_other(key, knee) -> None:
    geometry = with_knee(APPENDIX_4.geometry, knee)
    plan, center = PRESET[key].build(geometry), preset_center(geometry)
    start, middle, goal = plan.curve(np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(start[:2] + goal[:2], 2 * center[:2], atol=1e-12)
    assert start[3] == goal[3]
    assert np.linalg.norm((goal - start)[:2]) > 0.5 * geometry.base_radius
    np.testing.assert_allclose(middle[:2], center[:2], atol=1e-9)
    if key == "line":
        assert start[2] == goal[2]
        assert start[3] == pytest.approx(center[3])
    else:  # the arch turns from one side to the other, and is up in the middle
        assert start[2] + goal[2] == pytest.approx(2 * center[2], abs=1e-12)
        assert start[2] < center[2]
        height = plan.curve(np.linspace(0, 1, 201))[:, 3]
        assert height.max() - start[3] == pytest.approx(middle[3] - start[3], abs=1e-9)
        assert middle[3] + start[3] == pytest.approx(2 * center[3])  # as far above as below


def documented() -> dict[str, tuple[list[list[float]], str]]:
    """Poses of the presets from the center [mm, deg] and the duration, by docs/motions.md."""
    page = (Path(__file__).parents[2] / "docs" / "motions.md").read_text("utf-8")
    rows = re.findall(r"^\| (`[^|]+) \| ([^|]+) \| ([^|]+) \|$", page, re.MULTILINE)
    found = {}
    for names, motion, lasts in rows:
        groups = re.findall(r"\(([^)]*)\)", motion.replace("−", "-"))
        poses = [[float(number) for number in group.split(",")] for group in groups]
        found |= {name: (poses, lasts.split(",")[0]) for name in re.findall("`([^`]+)`", names)}
    same = found["paper-like"][0]
    return found | {key: (same, found[key][1]) for key in ("quintic", "trapezoid", "s-curve")}


@pytest.mark.parametrize("key", ["paper-like", "quintic", "trapezoid", "s-curve", "line", "arch"])
def test_presets_are_those_of_the_documentation(key: str) -> None:
    plan, center = PRESET[key].build(APPENDIX_4.geometry), preset_center(APPENDIX_4.geometry)
    poses, lasts = documented()[key]
    found = (plan.curve(np.array([0.0, 1.0])) - center) * [1e3, 1e3, 180 / np.pi, 1e3]
    assert np.abs(found[:, : len(poses[0])] - poses).max() < 0.5
    if key == "line":
        np.testing.assert_allclose(found[:, 2:], [[11.0, 0.0]] * 2, atol=0.5)
    if key == "arch":
        assert plan.curve(np.array([0.5]))[0, 3] - center[3] == pytest.approx(0.06)  # 120 mm up
    assert f"{plan.duration:.3g} s" == lasts


def test_preset_waypoints_and_circle_are_those_of_the_documentation() -> None:
    circle, ways = (PRESET[key].build(APPENDIX_4.geometry) for key in ("circle", "waypoints"))
    center = preset_center(APPENDIX_4.geometry)
    poses, lasts = documented()["waypoints"]
    found = (ways.curve(ways.curve.breaks) - center) * [1e3, 1e3, 180 / np.pi, 1e3]
    assert np.abs(found - [[0.0] * 4, *poses, [0.0] * 4]).max() < 0.5
    around = circle.curve(np.linspace(0.0, 1.0, 400)) - center
    np.testing.assert_allclose(np.hypot(*around[:, :2].T), 0.1)
    np.testing.assert_allclose(around[:, 2:], 0.0, atol=1e-12)
    assert f"{ways.duration:g} s" == lasts
    assert f"{circle.duration:g} s" == documented()["circle"][1]


def test_preset_waypoints_are_a_round_trip_over_all_coordinates() -> None:
    plan = PRESET["waypoints"].build(APPENDIX_4.geometry)
    center = preset_center(APPENDIX_4.geometry)
    u = np.linspace(0.0, 1.0, 801)
    pose = plan.curve(u) - center
    np.testing.assert_allclose(pose[[0, -1]], 0.0, atol=1e-12)
    size = APPENDIX_4.geometry.base_radius
    for column, least in ((0, 0.4 * size), (1, 0.4 * size), (2, 0.5), (3, 0.2 * size)):
        assert np.ptp(pose[:, column]) > least
        assert pose[:, column].min() < 0 < pose[:, column].max()
    # around the axis once, counterclockwise
    away = np.hypot(*pose[:, :2].T) > 0.02
    turn = np.unwrap(np.arctan2(pose[away, 1], pose[away, 0]))
    assert 1.0 * np.pi < turn[-1] - turn[0] < 2.0 * np.pi


def test_home() -> None:
    np.testing.assert_allclose(preset_center(APPENDIX_4.geometry), [0, 0, 0, -0.5], atol=1e-15)
    height = APPENDIX_4.geometry.platform_joint_height
    mirror = preset_center(with_knee(APPENDIX_4.geometry, KneeBranch.UPPER))
    assert mirror[3] + height == pytest.approx(0.5 - height)


@pytest.mark.parametrize("knee", KneeBranch)
def test_paper_like_accelerates_at_1_meter_per_second_squared(knee: KneeBranch) -> None:
    plan = paper_like(with_knee(APPENDIX_4.geometry, knee))
    peaks = plan.duration * np.array([0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6])
    np.testing.assert_allclose(place(plan.at(peaks).acceleration), 1.0, rtol=1e-14)
    t = np.linspace(0, plan.duration, 20001)
    assert place(plan.at(t).acceleration).max() <= 1 + 1e-14
    moved = np.abs(plan.at(plan.duration).pose - plan.at(0.0).pose)
    assert (moved > 0.05).all()  # all four coordinates


def test_no_preset_claims_to_be_the_papers() -> None:
    for preset in PRESET.values():
        plan = preset_plan(preset)
        assert "paper" not in f"{plan.name} {plan.kind} {preset.label}".lower()
    (note,) = preset_plan(PRESET["paper-like"]).notes
    assert "not the motion of the paper" in note


@given(radius=st.floats(0.2, 0.6))
def test_preset_circle_has_a_radius_of_two_sevenths_of_the_bases(radius: float) -> None:
    plan = PRESET["circle"].build(replace(APPENDIX_4.geometry, base_radius=radius))
    far = plan.at(np.linspace(0, plan.duration, 2000)).pose[:, :2]
    middle = (far.max(axis=0) + far.min(axis=0)) / 2
    np.testing.assert_allclose(np.linalg.norm(far - middle, axis=1), 2 / 7 * radius, rtol=1e-3)


def test_waypoints_share_the_time_by_the_roots_of_their_distances_and_ends_take_longer() -> None:
    """1.3 times as long at both ends; a turn counts as the way of a point on it."""
    ways = np.array([[0.3, 0.0, 0.0, 0.4], [0.0, 0.04, 0.0, 0.03], [0.0, 0.0, 0.25, 0.0]])
    lengths = np.array([0.5, 0.05, 0.25 * TURN_LENGTH])
    for order in ([0, 1, 2], [2, 1, 0], [1, 0, 2], [0, 1], [1]):
        share = np.sqrt(lengths[order])
        if len(order) > 1:
            share = share * ([1.3, 1.0, 1.3] if len(order) == 3 else 1.3)
        found = shared_time(np.concatenate([np.zeros((1, 4)), np.cumsum(ways[order], axis=0)]))
        np.testing.assert_allclose(np.diff(found), share / share.sum(), rtol=1e-12)
        assert (found[0], found[-1]) == (0.0, 1.0)


def test_a_turn_counts_as_a_length_of_the_robots_own_size() -> None:
    poses = np.array([A, B, np.add(A, [0.05, 0.0, 0.4, 0.01])])
    for size in (0.01, 10.0):
        robot, scale = enlarged(APPENDIX_4, size), np.array([size, size, 1.0, size])
        for own, other in (
            (via_points(poses * scale, geometry=robot).curve, via_points(poses).curve),
            (spline_path(poses * scale, robot), spline_path(poses)),
        ):
            u = np.linspace(0.0, 1.0, 9)
            np.testing.assert_allclose(own(u), other(u) * scale, atol=1e-12 * size)


def test_a_round_trip_passes_loci_at_instants_that_mirror_each_other() -> None:
    plan = replace(
        point_to_point(A, B, 2.0),
        passages=(Passage(0.2, Locus.CIRCLE), Passage(0.9, Locus.ROTATION)),
    )
    assert [(item.t, item.locus) for item in round_trip(plan).passages] == [
        (pytest.approx(0.1), Locus.CIRCLE), (pytest.approx(0.45), Locus.ROTATION),
        (pytest.approx(0.55), Locus.ROTATION), (pytest.approx(0.9), Locus.CIRCLE),
    ]  # fmt: skip


def test_a_chain_passes_loci_when_its_plans_do() -> None:
    first = replace(point_to_point(A, B, 2.0), passages=(Passage(0.25, Locus.CIRCLE),))
    second = replace(point_to_point(B, A, 6.0), passages=(Passage(0.5, Locus.ROTATION),))
    assert chain(first, second, first).passages == (
        Passage(0.05, Locus.CIRCLE), Passage(0.5, Locus.ROTATION), Passage(0.85, Locus.CIRCLE),
    )  # fmt: skip


def test_a_spline_through_two_poses_is_straight_and_one_pose_is_none() -> None:
    s = np.linspace(0.0, 1.0, 7)
    for order in (0, 1, 2):
        np.testing.assert_allclose(
            spline_path([A, B])(s, order), straight_path(A, B)(s, order), atol=1e-15
        )
    for poses_ in ([A], [A, [np.nan, 0, 0, 0]], A):
        with pytest.raises(InvalidInput, match="at least two finite poses"):
            spline_path(poses_)


@pytest.mark.parametrize("law", LAWS)
def test_a_displacement_with_a_pause_before_and_after_has_their_breaks_and_rests_there(
    law: TimeLaw,
) -> None:
    shift = B - A
    curve = Blend(A, (Displacement(shift, law, 0.25, 0.75),))
    np.testing.assert_allclose(
        curve.breaks, np.unique([0.0, *(0.25 + 0.5 * law.breaks), 1.0]), atol=1e-15
    )
    for order in (1, 2, 3):  # at a jump it is what comes after
        rest = curve(np.array([0.0, 0.2, 0.75, 0.8, 1.0]), order)
        np.testing.assert_array_equal(rest, 0.0)
        np.testing.assert_allclose(
            curve(np.array([0.25]), order)[0], law(np.array([0.0]), order)[0] * 2.0**order * shift
        )
    np.testing.assert_allclose(curve(np.array([0.1, 0.5, 0.9])), [A, 0.5 * (A + B), B], atol=1e-15)


def test_plans_meet_to_a_nanometer_and_messages_say_which_does_not() -> None:
    first, off = point_to_point(A, B), np.array([0.0, 0.0, 0.0, 1e-9])
    chain(first, point_to_point(B + 0.95 * off, C))
    with pytest.raises(InvalidInput, match="plan 2 does not start where the one before ends"):
        chain(first, point_to_point(B + 1.05 * off, C))
    with pytest.raises(InvalidInput, match="plan 3 does not start"):
        chain(first, point_to_point(B, C), first)
    with pytest.raises(InvalidInput, match="waypoints 2 and 3 are the same"):
        via_points([A, B, B, C])
    with pytest.raises(InvalidInput, match="waypoints 3 and 4 are the same"):
        spline_path([A, C, B, B, C])


def test_chains_and_round_trips_are_called_by_what_they_are_made_of() -> None:
    first = replace(point_to_point(A, B, name="out"), notes=("one", "two"))
    second = replace(via_points([B, A], name="home"), notes=("two", "three"))
    whole = chain(first, second, first)
    assert (whole.name, whole.kind) == (
        "out + home", "move, quintic, then waypoints, quintic spline",
    )  # fmt: skip
    assert whole.notes == ("one", "two", "three")
    assert chain(first, second, name="shuttle").name == "shuttle"
    back = round_trip(first)
    assert (back.name, back.kind, back.notes) == ("out, there and back", first.kind, first.notes)


def test_one_part_whose_acceleration_jumps_is_enough() -> None:
    smooth, sharp = (Displacement(B - A, law, 0.2, 0.8) for law in LAWS[:2])
    for terms in ((smooth, sharp), (sharp, smooth)):
        assert not Blend(A, terms).bounded_jerk
    for laws in (LAWS[:2], LAWS[1::-1]):
        there, back = point_to_point(A, B, law=laws[0]), point_to_point(B, A, law=laws[1])
        assert not chain(there, back).curve.bounded_jerk
