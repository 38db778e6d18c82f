"""What volumes and workspaces do exactly at a bound, an edge or a tie."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.grids import Field
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.progress import go_on
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.quantity import Missing
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume import measure, solve
from paminsa_viz.synthesis.volume.causes import (
    FIRST_REQUIREMENT,
    INSIDE,
    OTHER_SIDE,
    SINGULAR,
    cause_slice,
    reach_distances,
)
from paminsa_viz.synthesis.volume.conflict import smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE, Resolution
from paminsa_viz.synthesis.volume.margins import heading_margins
from paminsa_viz.synthesis.volume.measure import VolumeNodes
from paminsa_viz.synthesis.volume.reach import ReachBounds, reach_bounds
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.synthesis.volume.workspace import Samples, least_within, reach_items, worst_over
from tests.synthesis.robots import needs

GEOMETRY = APPENDIX_4.geometry
BOX, CYLINDER = WorkspaceShape.BOX, WorkspaceShape.CYLINDER
TURN = (-0.1, 0.1)


def at_most(*limits: float) -> Requirements:
    """Bounds on the condition number."""
    return Requirements(tuple(Requirement("condition", high=most) for most in limits), TURN)


# ---------------------------------------------------------------- bounds


def test_a_bound_that_is_just_met_is_met_at_nodes_and_at_points() -> None:
    rough = Resolution(1_000, 3, 5.0)
    zero = solve_volume(APPENDIX_4, at_most(0.0), resolution=rough)
    value = -zero.margins[0]  # of which a bound is exactly at a node
    level = int(zero.reachable.sum(axis=(0, 1)).argmax())
    place = np.where(zero.reachable & (value < 4.0), value, 0.0)[..., level].argmax()
    i, j = np.unravel_index(place, value.shape[:2])
    most = float(value[i, j, level])
    assert 2.0 < most < 4.0
    volume = solve_volume(APPENDIX_4, at_most(most), resolution=rough)
    assert volume.margins[0, i, j, level] == 0.0
    assert volume.met[0, i, j, level]
    assert volume.cause[i, j, level] == INSIDE
    assert volume.depth[i, j, level] == 0.0
    less = solve_volume(APPENDIX_4, at_most(np.nextafter(most, 0.0)), resolution=rough)
    assert less.cause[i, j, level] == FIRST_REQUIREMENT
    point = np.array([[volume.x[i], volume.y[j], volume.z[level]]])
    margins, _ = heading_margins(
        APPENDIX_4, at_most(0.0), point[:, :2], np.zeros(1), 3, lift=point[:, 2]
    )
    exact = -float(margins[0, 0, 0])
    for bound, holds in ((exact, True), (np.nextafter(exact, 0.0), False)):
        every, second = measure._met(APPENDIX_4, at_most(bound), point, 3, go_on)
        assert (every.tolist(), second.tolist()) == ([holds], [holds])


def test_a_bound_that_one_node_just_meets_contradicts_nothing() -> None:
    rough = Resolution(1_000, 3, 5.0)
    zero = solve_volume(APPENDIX_4, at_most(0.0), resolution=rough)
    least = -float(np.nanmax(zero.margins))
    volume = solve_volume(APPENDIX_4, at_most(least), resolution=rough)
    assert volume.inside.any()
    assert smallest_conflict(volume) is None
    empty = solve_volume(APPENDIX_4, at_most(np.nextafter(least, 0.0)), resolution=rough)
    found = smallest_conflict(empty)
    assert found is not None
    assert found.requirements == (0,)
    assert found.relaxations[0].relaxed == at_most(least).bounds[0]


def test_of_equal_requirements_the_first_is_named() -> None:
    volume = solve_volume(APPENDIX_4, at_most(3.0, 3.0, 9.0), resolution=Resolution(1_000, 3, 5.0))
    broken = volume.reachable & ~volume.inside
    assert broken.sum() > 50
    assert (volume.cause[broken] == FIRST_REQUIREMENT).all()
    assert FIRST_REQUIREMENT in volume.nearest[volume.inside]
    assert not np.isin(volume.nearest, FIRST_REQUIREMENT + np.array([1, 2])).any()


@pytest.mark.parametrize("which", range(3))
def test_of_equal_limits_of_reach_the_first_is_named(which: int) -> None:
    """Each as near as one after it, and the others farther, at lengths that are exact."""
    for other in range(which + 1, 4):
        margin = np.full(4, 0.25)
        margin[[which, other]] = 0.125
        bars, apart = 0.625 + margin[0], 0.625 - margin[1]
        g = replace(
            GEOMETRY, magnification=5.0, crank_length=0.5 * (bars - apart),
            coupler_length=0.5 * (bars + apart), guide_stroke=0.125 + margin[2],
            axis_clearance=0.5 - margin[3],
        )  # fmt: skip
        near_leg, far_leg = np.ones(1, np.int8), np.full(1, 2, np.int8)
        half = np.full(1, 0.5)
        bounds = ReachBounds(g, half, half, near_leg, far_leg, half, 1.0)
        least, code = bounds.margin(np.array([-g.platform_joint_height]))
        assert least.tolist() == [0.125]
        assert code.tolist() == [4 * (1 if which % 2 else 2) + which]


@pytest.mark.parametrize(
    ("missing", "reason"),
    [(None, "no value"), (0, "no value"), (1, "nothing to measure"), (2, "too short")],
)
def test_a_value_that_is_missing_has_its_reason(
    monkeypatch: pytest.MonkeyPatch, missing: int | None, reason: str
) -> None:
    """That of the quantity where the pose can be taken, else that of the pose."""

    def value(field: Field, design: Any) -> Any:
        return np.where(field.grid.poses()[..., 0] > 0.05, np.nan, 1.0)

    def why(field: Field, design: Any) -> Missing:
        code = np.full(field.status.shape, missing, np.uint8)
        return Missing(code, ("", "nothing to measure", "too short"), ("", "a", "b"))

    made = replace(QUANTITIES["condition"], value=value, missing=None if missing is None else why)
    monkeypatch.setattr(Requirement, "entry", made)
    bound = Requirement("condition", high=1.0)
    z, theta = np.array([-0.6]), np.array([0.0])
    for x, expected in ((0.1, reason), (3.0, "out of reach: leg")):
        samples = Samples(np.array([[0.0, 0.0], [x, 0.0]]), z)
        found = worst_over(APPENDIX_4, bound, 0, samples, theta)
        assert (found.margin, found.holds) == (-np.inf, False)
        assert found.pose == (x, 0.0, 0.0, -0.6)
        assert found.reason.startswith(expected)
        assert len(found.reason) == len(reason) or x == 3.0
    # and a bound that is just met holds
    found = worst_over(APPENDIX_4, bound, 0, Samples(np.zeros((1, 2)), z), theta)
    assert (found.margin, found.holds, found.reason) == (0.0, True, "")


def test_what_takes_long_has_no_value_where_a_pose_cannot_be_taken() -> None:
    """Also beside what is quick, and of a formula that would have one."""
    bounds = (Requirement("f_4", high=1e9), Requirement("linear_error_x", high=1.0))
    positions, z = np.array([[0.0, 0.0], [0.5, 0.0]]), np.array([-0.6, -1.5])
    for asked in (bounds, bounds[1:]):
        for found in heading_margins(APPENDIX_4, Requirements(asked, TURN), positions, z, 3):
            assert np.isfinite(found[-1]).tolist() == [[True, False], [False, False]]
            assert np.isneginf(found[-1]).sum() == 3


def test_a_requirement_holds_at_the_ends_of_its_heights() -> None:
    bound = Requirement("f_4", high=400.0, z=(-0.625, -0.5))
    z = np.array([np.nextafter(-0.625, -1.0), -0.625, -0.5, np.nextafter(-0.5, 0.0)])
    asked, middle = Requirements((bound,), TURN), np.zeros((4, 2))
    free = [True, False, False, True]
    assert np.isinf(heading_margins(APPENDIX_4, asked, middle[:1], z, 3)[0][0, 0]).tolist() == free
    lifted = heading_margins(APPENDIX_4, asked, middle, np.zeros(1), 3, lift=z)[0][0, :, 0]
    assert np.isinf(lifted).tolist() == free


def test_of_bounds_of_any_size_the_one_broken_most_is_named() -> None:
    """By the part of itself; a bound that is just met is not broken."""
    x, y = np.linspace(-0.2, 0.2, 9), np.linspace(-0.15, 0.15, 7)
    poses = np.stack(np.broadcast_arrays(x, y[:, None], 0.1, -0.6), axis=-1)
    lift = static_torques(APPENDIX_4, poses)[..., 3]
    kappa = measure_singularity(GEOMETRY, poses).condition
    exact = float(np.median(kappa))
    bounds = (
        Requirement("condition", high=exact), Requirement("f_4", high=float(np.median(lift))),
    )  # fmt: skip
    found = cause_slice(APPENDIX_4, Requirements(bounds, TURN), x, y, 0.1, -0.6)
    shares = np.stack([kappa / exact - 1.0, lift / bounds[1].high - 1.0])  # type: ignore[operator]
    np.testing.assert_array_equal(found.broken, shares > 0.0)
    assert not found.broken[0][kappa == exact].any()
    named = np.where((shares > 0.0).any(axis=0), FIRST_REQUIREMENT + shares.argmax(axis=0), INSIDE)
    np.testing.assert_array_equal(found.cause, named)
    assert {INSIDE, FIRST_REQUIREMENT, FIRST_REQUIREMENT + 1} == set(np.unique(found.cause))


@pytest.mark.parametrize("turn", [0.0, -0.1])
def test_no_position_is_within_reach_where_headings_are_singular(turn: float) -> None:
    """Neither at the center nor beyond the circle; the center is the farthest off."""
    x = np.array([0.0, 0.1, 0.3, 0.5])
    for part in (x, x[2:]):
        bounds = reach_bounds(GEOMETRY, part, 0.0, (-0.2, 0.2))
        least, _ = reach_distances(replace(bounds, turn=turn), np.full(len(part), -0.6))
        assert (least < 0.0).all()
    far, code = reach_distances(replace(bounds, turn=0.1), np.full(len(part), -0.6))
    assert (far < 0.0).all()
    assert (code == SINGULAR).any()


# ---------------------------------------------------------------- heights


def test_heights_on_the_guides_belong_to_homes_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """With nodes exactly there: inside, at no distance from the other side."""
    x, z = 0.05 * np.arange(-6.0, 7.0), 0.05 * np.arange(-19.0, 2.0)
    monkeypatch.setattr(solve, "axes_of", lambda *_: (x, z, 3))
    volume = solve_volume(APPENDIX_4, Requirements((), TURN), resolution=COARSE)
    top = z.tolist().index(0.0)
    assert volume.inside[..., top].any()
    assert (volume.cause[..., : top + 1] != OTHER_SIDE).all()
    assert (volume.cause[..., top + 1 :] == OTHER_SIDE).all()
    bounds = reach_bounds(GEOMETRY, x[:, None, None], x[None, :, None], TURN)
    distance, code = reach_distances(bounds, z)
    expected = np.minimum(distance, -z)
    assert volume.depth[volume.inside] == pytest.approx(expected[volume.inside], abs=1e-12)
    named = np.where(-z < distance, OTHER_SIDE, code)
    np.testing.assert_array_equal(volume.nearest[volume.inside], named[volume.inside])
    assert OTHER_SIDE in volume.nearest[volume.inside]
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1e-9], [0.0, 0.0, 1e-9]])
    for both, expected in ((False, [True, True, False]), (True, [True] * 3)):
        found = measure._taken(APPENDIX_4, volume.requirements, points, both)
        assert found.tolist() == expected


def test_distances_to_the_end_of_reach_are_negative_beyond_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And what ends the volume next to it is the requirement that is broken first."""
    seen: list[VolumeNodes] = []
    whole = measure.measure

    def noted(design: Any, requirements: Any, nodes: VolumeNodes, *more: Any) -> Any:
        seen.append(nodes)
        return whole(design, requirements, nodes, *more)

    monkeypatch.setattr(solve, "measure", noted)
    rough = Resolution(1_000, 3, 5.0)
    volume = solve_volume(APPENDIX_4, at_most(50.0, 3.0, 4.0), resolution=rough)
    (nodes,) = seen
    for inside, depth in ((nodes.reachable, nodes.body), (nodes.inside, nodes.depth)):
        assert (depth[inside] >= 0.0).all()
        assert (depth[~inside] <= 0.0).all()
        assert depth[inside].max() > volume.cell
        assert depth[~inside].min() < -volume.cell
    broken = volume.reachable & ~volume.inside
    assert (volume.cause[broken] == FIRST_REQUIREMENT + 1).all()
    assert FIRST_REQUIREMENT + 1 in volume.nearest[volume.inside]
    ends = np.unique(volume.nearest[volume.inside])
    assert set(ends[ends >= FIRST_REQUIREMENT]) == {FIRST_REQUIREMENT + 1}


# ---------------------------------------------------------------- places of a workspace


@pytest.mark.parametrize("shape", WorkspaceShape)
def test_a_workspace_at_every_node_up_to_the_edge_and_beyond(shape: WorkspaceShape) -> None:
    """Of a given center: the least of its nodes, and nothing where it sticks out by one."""
    x, y, z = 0.1 * np.arange(5.0), 0.1 * np.arange(6.0), 0.1 * np.arange(4.0)
    volume: Any = SimpleNamespace(x=x, y=y, z=z, cell=0.1)
    values = np.random.default_rng(2).normal(size=(5, 6, 4))
    for i, j in np.ndindex(5, 6):
        space = Workspace(shape, (0.2, 0.2, 0.001), (float(x[i]), float(y[j]), None))
        found = least_within(values, space, volume)
        assert found.shape == (1, 1, 4)
        fits = 1 <= i <= 3 and 1 <= j <= 4
        block = values[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2]
        least = block.min(axis=(0, 1))
        if shape is CYLINDER and fits:
            cross = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], bool)
            least = block[cross].min(axis=0)
        assert found[0, 0].tolist() == (least.tolist() if fits else [-np.inf] * 4)


def test_an_extent_is_as_many_nodes_as_are_nearest_to_it() -> None:
    axis = 0.1 * np.arange(-9.0, 10.0)
    volume: Any = SimpleNamespace(x=axis, y=axis, z=axis, cell=0.1)
    values = np.zeros((19, 19, 19))
    values[9, 9, 2] = -1.0  # 0.7 from the middle
    for half, held in ((0.64, False), (0.66, True)):
        found = least_within(values, Workspace(BOX, (0.1, 0.1, 2 * half), (0.0, 0.0, 0.0)), volume)
        assert found[0, 0, 0] == (-1.0 if held else 0.0)


def test_nodes_on_the_rim_of_a_disc_count_to_a_billionth_of_a_step() -> None:
    axis = 0.1 * np.arange(-4.0, 5.0)
    volume: Any = SimpleNamespace(x=axis, y=axis, z=axis, cell=0.1)
    values = np.zeros((9, 9, 9))
    values[7, 4] = -1.0  # 0.3 from the middle
    for inward, held in ((0.0, True), (0.95e-10, True), (1.05e-10, False), (5e-9, False)):
        radius = 0.3 - inward
        size = cast(Any, (2 * radius, 2 * radius, 0.1))
        found = least_within(values, Workspace(CYLINDER, size, (0.0, 0.0, 0.0)), volume)
        assert found[0, 0, 0] == (-1.0 if held else 0.0)


# ---------------------------------------------------------------- headings


def test_of_several_positions_the_one_nearest_to_the_circle_is_named() -> None:
    """At the first height, or at one that counts there; beyond the circle it says so."""
    samples = Samples(np.array([[0.05, 0.0], [0.2, 0.1], [0.1, 0.0]]), np.array([-0.7, -0.6, -0.5]))
    needed = Requirements((), (-0.3, 0.3))
    item = reach_items(APPENDIX_4, needed, samples)[1]
    assert item.pose == pytest.approx((0.2, 0.1, 0.0, -0.7), abs=1e-12)
    assert (item.value, item.reason) == (pytest.approx(0.25 - np.hypot(0.2, 0.1)), "")
    counted = np.array([[1, 1, 1], [0, 1, 0], [0, 0, 1]], bool)
    item = reach_items(APPENDIX_4, needed, samples, counted)[1]
    assert item.pose == pytest.approx((0.2, 0.1, 0.0, -0.6), abs=1e-12)
    beyond = samples._replace(positions=samples.positions + np.array([0.05, 0.0]))
    item = reach_items(APPENDIX_4, needed, beyond)[1]
    assert (item.holds, item.reason) == (False, "beyond the circle of singular positions")
    turned = reach_items(APPENDIX_4, Requirements((), (0.0, 2.0)), beyond)[1]
    assert turned.reason == "the headings reach the singular rotation"
    # of equal radii the singular heading is that of home
    same = replace(APPENDIX_4, geometry=replace(GEOMETRY, platform_radius=GEOMETRY.base_radius))
    item = reach_items(same, Requirements((), (-0.25, 0.5)), samples)[1]
    assert item.pose is not None
    assert (item.holds, item.pose[2]) == (False, pytest.approx(0.0, abs=1e-12))
    assert item.reason == turned.reason


@pytest.mark.parametrize("swap", [False, True])
def test_singular_headings_are_shown_at_their_worst(swap: bool) -> None:
    """Where no turn is singular, the heading of the smallest circle: without a turn, exactly."""
    radii = (0.1, 0.35) if swap else (0.35, 0.1)
    g = replace(GEOMETRY, base_radius=radii[0], platform_radius=radii[1])
    design = replace(APPENDIX_4, geometry=g)
    middle = Samples(np.zeros((1, 2)), np.array([-0.6]))
    for theta, turned in (((-0.4, 0.5), True), ((-2.0, 1.9), swap)):
        item = reach_items(design, Requirements((), theta), middle)[1]
        found = reach_bounds(g, 0.0, 0.0, theta)
        cosines = np.cos(np.linspace(*theta, 4001))
        least = float((np.sign(radii[0] - radii[1]) * (radii[0] * cosines - radii[1])).min())
        assert found.turn == pytest.approx(least, abs=1e-6)
        assert item.holds is turned
        assert item.pose is not None
        expected = 0.0 if turned else theta[0]
        assert item.pose[2] == pytest.approx(expected, abs=0.013)
        assert item.value == pytest.approx(0.25 if turned else least)
    even = reach_items(design, Requirements((), (-0.4, 0.4)), middle)[1]
    assert even.pose is not None
    assert even.pose[2] == pytest.approx(0.0, abs=1e-15)


def test_no_position_and_no_turn_may_be_singular_itself() -> None:
    leg = np.zeros(3, np.int8)
    one = np.ones(3)
    for turn, expected in ((0.1, [False, False, True]), (0.0, [False] * 3)):
        found = ReachBounds(GEOMETRY, one, one, leg, leg, np.array([-0.1, 0.0, 0.1]), turn)
        assert found.regular.tolist() == expected


def test_progress_is_a_growing_share_that_ends_with_all() -> None:
    told: list[float] = []
    solve_volume(
        APPENDIX_4, needs("max_torque <= 9 N m", "condition <= 5"),
        resolution=Resolution(1_000, 3, 5.0), progress=lambda done: bool(told.append(done)),
    )  # fmt: skip
    assert told == sorted(told)
    assert 0.0 < told[0] < told[-1] == 1.0


# ---------------------------------------------------------------- points


@pytest.mark.parametrize(("times", "points"), [(1.0, 1), (1.6, 1), (2.0, 2), (9.0, 2)])
def test_each_cube_has_as_many_points_as_can_be_paid_for(times: float, points: int) -> None:
    """One or two; of two one in each half, of one anywhere in its height."""
    x = np.arange(-5.0, 6.0)
    depth = 3.3 - np.linalg.norm(np.stack(np.meshgrid(x, x, x, indexing="ij")), axis=0)
    none = np.zeros(depth.shape, bool)
    nodes = VolumeNodes(x, x, depth > 0, none, depth, depth > 0, depth)
    cubes = measure._Surface.of(nodes, depth > 0, none, depth, np.inf).cubes
    drawn = measure._Surface.of(nodes, depth > 0, none, depth, times * cubes)
    place = np.rint(drawn.points)
    found, count = np.unique(place, axis=0, return_counts=True)
    assert len(found) == cubes == drawn.cubes
    assert (count == points).all()
    np.testing.assert_array_equal(place, np.tile(found, (points, 1)))  # in the order of nodes
    height = drawn.points[:, 2] - place[:, 2]
    assert np.abs(height).max() <= 0.5
    assert (height > 0.0).mean() == pytest.approx(0.5, abs=0.1)
    few = measure._Surface.of(nodes, depth > 0, none, depth, 40)
    above = few.points[:, 2] > np.rint(few.points[:, 2])
    assert 8 < above.sum() < 32


def test_the_time_of_points_is_that_of_one_height_each(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def time(*given: Any) -> float:
        asked.append(given)
        return 0.0

    monkeypatch.setattr(measure, "time_per_position", time)
    needed = at_most(3.0)
    solve_volume(APPENDIX_4, needed, resolution=Resolution(64, 3, 5.0))
    assert asked == [(APPENDIX_4, needed, 3, 1)]
