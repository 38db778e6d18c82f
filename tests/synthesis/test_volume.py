"""The volume against poses one by one, against finer grids, and against closed forms."""

from __future__ import annotations

import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage

from paminsa_viz.kept import size_of
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.model.reach import check_reach, home_pose
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.progress import Canceled, go_on
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume import measure, solve
from paminsa_viz.synthesis.volume.causes import FIRST_REQUIREMENT, OTHER_SIDE, CauseKind
from paminsa_viz.synthesis.volume.grid import COARSE, FINE, Resolution, axes_of
from paminsa_viz.synthesis.volume.measure import VolumeNodes
from paminsa_viz.synthesis.volume.solve import Volume, _margins, solve_volume
from tests.support.cases import Case, cases
from tests.synthesis.robots import TURN, met, needs
from tests.synthesis.volumes import counted_volume

BOUNDS = ("condition <= 10", "max_torque <= 15 N m", "f_4 <= 250 N")
MEDIUM = Resolution(60_000, 9, 5.0)


@pytest.fixture(scope="module")
def solved() -> Volume:
    return solve_volume(APPENDIX_4, needs(*BOUNDS), resolution=MEDIUM)


def depth_at(volume: Volume, points: np.ndarray) -> np.ndarray:
    """Interpolate the depth at points (n, 3)."""
    index = (points - [volume.x[0], volume.y[0], volume.z[0]]) / volume.cell
    return ndimage.map_coordinates(volume.depth, index.T, order=1, mode="nearest")


@pytest.mark.slow
def test_random_poses_inside_meet_all_and_outside_some_do_not(solved: Volume) -> None:
    # poses whose distance to the surface is larger than what a cell and a heading can hide
    rng = np.random.default_rng(1)
    low = [solved.x[0], solved.y[0], solved.z[0]]
    high = [solved.x[-1], solved.y[-1], min(solved.z[-1], 0.0)]
    points = rng.uniform(low, high, (100_000, 3))
    theta = rng.uniform(-TURN, TURN, len(points))
    poses = np.column_stack([points[:, :2], theta, points[:, 2]])
    holds = met(APPENDIX_4, poses, 10.0, 15.0, 250.0)
    depth = depth_at(solved, points)
    assert (depth > solved.cell).sum() > 10_000
    assert holds[depth > 0.25 * solved.cell].all()
    # outside, some heading breaks something
    outside = points[(depth < -solved.cell) & (points[:, 2] < 0.0)][:4000]
    assert len(outside) == 4000
    turned = np.linspace(-TURN, TURN, 33)
    poses = np.concatenate(
        [
            np.broadcast_to(outside[:, None, :2], (4000, 33, 2)),
            np.broadcast_to(turned[:, None], (4000, 33, 1)),
            np.broadcast_to(outside[:, None, 2:], (4000, 33, 1)),
        ],
        axis=-1,
    )
    holds = met(APPENDIX_4, poses.reshape(-1, 4), 10.0, 15.0, 250.0).reshape(4000, 33)
    assert not holds.all(axis=1).any()


@pytest.mark.slow
def test_every_requirement_and_reach_cut_somewhere(solved: Volume) -> None:
    kinds = {cause.kind for cause in solved.shares()}
    assert kinds >= {CauseKind.INSIDE, CauseKind.REQUIREMENT}
    cut = {cause.requirement for cause in solved.shares()}
    assert cut >= {0, 1, 2}
    assert (solved.removed_alone > solved.removed_last).all()
    assert (solved.removed_last > 0.0).all()
    assert 0.0 < solved.reachable_share < 1.0


def test_reach_and_fold_cut_a_robot_of_unequal_bars() -> None:
    g = replace(APPENDIX_4.geometry, crank_length=0.25, coupler_length=0.75)
    design = replace(APPENDIX_4, geometry=g)
    volume = solve_volume(design, needs("condition <= 100"), resolution=MEDIUM)
    words = {volume.causes[code].word.partition(":")[0] for code in np.unique(volume.cause)}
    assert {"stretched", "folded"} <= words
    assert volume.volume > 0.0


@pytest.mark.slow
def test_finer_grid_changes_the_volume_by_less_than_its_error(solved: Volume) -> None:
    fine = solve_volume(APPENDIX_4, solved.requirements, resolution=Resolution(200_000, 17, 9.0))
    assert abs(solved.volume - fine.volume) <= solved.error
    for nodes in (8_000, 30_000):
        rough = solve_volume(APPENDIX_4, solved.requirements, resolution=Resolution(nodes, 9, 9.0))
        assert abs(rough.volume - fine.volume) <= rough.error, nodes
    assert fine.error < solved.error < 0.1 * solved.volume


def test_volume_of_the_condition_number_has_the_known_radius() -> None:
    # At theta = 0 kappa is 10 at r = 0.736761 (R_b - R_pl), first toward the legs; so at +y.
    requirements = Requirements(needs("condition <= 10").bounds, (0.0, 0.0))
    volume = solve_volume(APPENDIX_4, requirements, resolution=Resolution(200_000, 3, 5.0))
    radius = 0.736761 * 0.25
    level = int(np.abs(volume.z + 0.4).argmin())
    distance = np.hypot(volume.x[:, None], volume.y[None, :])
    inside = volume.inside[..., level]
    assert inside[distance < radius - 1e-9].all()
    middle = len(volume.x) // 2
    np.testing.assert_array_equal(inside[middle, middle:], distance[middle, middle:] < radius)
    depth = volume.depth[middle, :, level]
    edge = np.flatnonzero(inside[middle])[-1]
    crossing = volume.y[edge] + volume.cell * depth[edge] / (depth[edge] - depth[edge + 1])
    assert crossing == pytest.approx(radius, abs=0.1 * volume.cell)


def test_condition_at_the_center_sets_the_range_of_headings() -> None:
    # kappa at the center is X_1 / (sqrt(2) |R_b cos theta - R_pl|)
    rb, rp, theta = 0.35, 0.1, 1.0
    x1 = math.sqrt(rb**2 + rp**2 - 2 * rb * rp * math.cos(theta))
    kappa = x1 / (math.sqrt(2) * abs(rb * math.cos(theta) - rp))
    for factor, center in ((1.001, True), (0.999, False)):
        volume = solve_volume(
            APPENDIX_4, needs(f"condition <= {factor * kappa!r}", theta=(-theta, theta)),
            resolution=COARSE,
        )  # fmt: skip
        middle = len(volume.x) // 2
        assert bool(volume.met[0, middle, middle].any()) is center


def test_heights_beyond_the_guides_count_only_if_asked_for() -> None:
    below = solve_volume(APPENDIX_4, needs(), resolution=COARSE)
    both = solve_volume(APPENDIX_4, needs(), resolution=COARSE, both_sides=True)
    assert (below.z[below.inside.any(axis=(0, 1))] <= 0.0).all()
    assert both.z[both.inside.any(axis=(0, 1))].max() > 0.3
    assert both.volume > 1.5 * below.volume
    assert (below.cause[..., below.z > 0.0] == OTHER_SIDE).all()


def test_mirrored_knee_has_the_mirrored_reach() -> None:
    flat = replace(APPENDIX_4, geometry=replace(APPENDIX_4.geometry, platform_joint_height=0.0))
    lower = solve_volume(flat, needs("condition <= 10"), resolution=COARSE)
    upper = solve_volume(
        flat.with_knee(KneeBranch.UPPER), needs("condition <= 10"), resolution=COARSE
    )
    assert upper.volume == pytest.approx(lower.volume, abs=upper.error + lower.error)
    assert upper.error + lower.error < 0.1 * lower.volume
    np.testing.assert_allclose(upper.z, -lower.z[::-1], atol=1e-12)
    np.testing.assert_array_equal(upper.inside, lower.inside[..., ::-1])


def test_volume_is_one_part_that_holds_home(solved: Volume) -> None:
    assert ndimage.label(solved.inside)[1] == 1
    assert solved.home_inside
    z = home_pose(APPENDIX_4.geometry)[3]
    middle = len(solved.x) // 2
    assert solved.inside[middle, middle, int(np.abs(solved.z - z).argmin())]
    assert (solved.depth[solved.inside] >= 0.0).all()
    assert (solved.depth[~solved.inside] <= 0.0).all()


def test_range_of_z_frees_other_heights() -> None:
    everywhere = solve_volume(APPENDIX_4, needs("condition <= 3"), resolution=COARSE)
    free = solve_volume(APPENDIX_4, needs("condition <= 3 for z -600..-400 mm"), resolution=COARSE)
    held = (free.z >= -0.6) & (free.z <= -0.4)
    np.testing.assert_array_equal(free.met[0][..., held], everywhere.met[0][..., held])
    reachable = free.reachable & ~held
    assert free.met[0][reachable].all()
    assert not everywhere.met[0][reachable].all()


def test_margins_are_worked_out_and_kept_where_poses_can_be_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    requirements, found, most = needs("condition <= 3", "|tau_1| <= 5 N m"), [], []
    for size in (10**6, 16):
        monkeypatch.setattr(solve, "BLOCK", size)
        told: list[float] = []
        found.append(
            solve_volume(APPENDIX_4, requirements, resolution=COARSE, progress=told.append)
        )
        assert np.all(np.diff(told) >= 0)
        assert told[-1] == 1.0
        volume = found[-1]
        x, z = volume.x, volume.z
        tracemalloc.start()
        _margins(APPENDIX_4, requirements, x, z, volume.reachable, volume.headings, go_on)
        most.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    at_once, in_blocks = found
    np.testing.assert_allclose(in_blocks.margins, at_once.margins, rtol=1e-12)
    assert most[1] < most[0] / 3
    nodes = volume.reachable
    assert np.isnan(volume.margins[:, ~nodes]).all()
    assert not np.isnan(volume.margins[:, nodes]).any()
    assert volume.reached_margins.shape == (2, nodes.sum())
    assert size_of(volume) < volume.depth.nbytes + volume.margins.nbytes
    np.testing.assert_allclose(volume.removed_alone, (~volume.met)[:, nodes].mean(axis=1))
    last = ~volume.met & ((~volume.met).sum(axis=0) == 1)
    np.testing.assert_allclose(volume.removed_last, last[:, nodes].mean(axis=1))
    assert volume.removed_last.all()


def test_own_range_of_headings_counts() -> None:
    few = solve_volume(APPENDIX_4, needs("condition <= 3 for theta 0..0"), resolution=COARSE)
    wide = solve_volume(APPENDIX_4, needs("condition <= 3"), resolution=COARSE)
    assert few.volume > wide.volume


@pytest.mark.slow
def test_reach_of_a_volume_is_exact_between_sampled_headings() -> None:
    volume = solve_volume(APPENDIX_4, needs(theta=(-1.0, 0.7)), resolution=COARSE)
    nodes = np.argwhere(volume.reachable)
    theta = np.linspace(-1.0, 0.7, 101)
    poses = np.empty((len(nodes), len(theta), 4))
    poses[..., 0] = volume.x[nodes[:, 0], None]
    poses[..., 1] = volume.y[nodes[:, 1], None]
    poses[..., 2] = theta
    poses[..., 3] = volume.z[nodes[:, 2], None]
    assert check_reach(APPENDIX_4.geometry, poses).ok.all()


def test_canceled_between_blocks() -> None:
    with pytest.raises(Canceled):
        solve_volume(APPENDIX_4, needs("f_4 <= 400"), resolution=COARSE, progress=lambda _: True)


def test_headings_beyond_the_singularity_leave_nothing() -> None:
    volume = solve_volume(
        APPENDIX_4, needs("condition <= 10", theta=(-1.5, 1.5)), resolution=COARSE
    )
    assert volume.empty
    assert volume.volume == volume.error == volume.reachable_volume == 0.0
    assert math.isnan(volume.reachable_share)
    words = {volume.causes[code].word for code in np.unique(volume.cause)}
    assert "singular" in words


def test_impossible_requirement_is_the_cause_everywhere() -> None:
    volume = solve_volume(APPENDIX_4, needs("condition <= 1"), resolution=COARSE)
    assert volume.empty
    assert volume.reachable.any()
    assert (volume.cause[volume.reachable] == FIRST_REQUIREMENT).all()
    assert volume.removed_alone[0] == 1.0


def test_a_range_of_one_heading_is_sampled_once() -> None:
    """As many headings as asked for are said only where a range has as many."""
    volume = solve_volume(APPENDIX_4, needs("condition <= 1"), resolution=COARSE)
    for bounds, theta, count in (
        (("condition <= 1",), (0.1, 0.1), 1),
        (("condition <= 1",), (-0.1, 0.1), COARSE.headings),
        (("condition <= 1 for theta 5..5",), (-0.1, 0.1), 1),
        (("condition <= 1", "payload >= 1 kg for theta -5..5"), (0.0, 0.0), COARSE.headings),
        ((), (-0.1, 0.1), COARSE.headings),
    ):
        asked = replace(volume, requirements=needs(*bounds, theta=theta))
        assert asked.sampled_headings == count


@pytest.mark.slow
def test_costly_quantities_get_larger_cells() -> None:
    volume = solve_volume(APPENDIX_4, needs("frequency_1 >= 1 Hz"), resolution=COARSE)
    assert volume.reachable.size < 3_000
    assert volume.volume > 0.0
    assert volume.headings == 5


def test_without_home_the_largest_part_that_can_be_reached_counts() -> None:
    home = home_pose(APPENDIX_4.geometry)[3]
    split = needs(f"condition <= 1 for z {1e3 * home - 60:.0f}..{1e3 * home + 60:.0f} mm")
    volume = solve_volume(APPENDIX_4, split, resolution=MEDIUM)
    assert not volume.home_inside
    assert ndimage.label(volume.inside)[1] == 1
    other = volume.reachable & volume.met.all(axis=0) & ~volume.inside
    assert 0 < other.sum() <= volume.inside.sum()
    kinds = np.array([cause.kind for cause in volume.causes])[volume.cause]
    assert (kinds[other] == CauseKind.DISCONNECTED).all()


def test_part_that_is_not_joined_to_home_does_not_count() -> None:
    split = needs("condition <= 1 for z -700..-640 mm")
    volume = solve_volume(APPENDIX_4, split, resolution=MEDIUM)
    assert volume.home_inside
    assert volume.z[volume.inside.any(axis=(0, 1))].min() > -0.65
    below = volume.reachable & (volume.z < -0.71)
    words = {volume.causes[code].word for code in np.unique(volume.cause[below])}
    assert words == {"not-connected"}


def test_own_headings_have_to_be_reachable() -> None:
    few = solve_volume(APPENDIX_4, needs("condition <= 1e6", theta=(0.0, 0.0)), resolution=COARSE)
    more = needs("condition <= 1e6 for theta -40..40", theta=(0.0, 0.0))
    volume = solve_volume(APPENDIX_4, more, resolution=COARSE)
    wide = solve_volume(
        APPENDIX_4, needs(theta=(-math.radians(40), math.radians(40))), resolution=COARSE
    )
    assert volume.volume < few.volume
    assert volume.volume == pytest.approx(wide.volume, rel=0.05)
    nodes = np.argwhere(volume.reachable)[::5]
    at = [axis[nodes[:, i], None] for i, axis in enumerate((volume.x, volume.y, volume.z))]
    turns = np.linspace(-math.radians(40), math.radians(40), 17)
    poses = np.stack(np.broadcast_arrays(at[0], at[1], turns, at[2]), axis=-1)
    own = check_reach(APPENDIX_4.geometry, poses).margins.min(axis=(1, 2, 3))
    margin = volume.margins[0][volume.reachable][::5]
    assert (own < -1e-4).sum() > 20
    assert (margin[own < -1e-4] == -np.inf).all()
    assert (margin[own > 1e-4] > 0.0).any()
    assert (volume.cause[volume.reachable][::5][own < -1e-4] == FIRST_REQUIREMENT).all()


@given(cases(), st.floats(-0.6, 0.2), st.floats(0.0, 0.6))
def test_every_node_inside_can_be_taken_by_any_robot(case: Case, low: float, width: float) -> None:
    requirements = needs("condition <= 20", theta=(low, low + width))
    volume = solve_volume(case.design, requirements, resolution=Resolution(1500, 5, 5.0))
    nodes = np.argwhere(volume.inside)[::7]
    assert volume.volume <= volume.reachable_volume * (1.0 + 1e-9)
    assert ndimage.label(volume.inside)[1] == (0 if volume.empty else 1)
    poses = np.empty((len(nodes), volume.headings, 4))
    poses[..., 0] = volume.x[nodes[:, 0], None]
    poses[..., 1] = volume.y[nodes[:, 1], None]
    poses[..., 2] = np.linspace(low, low + width, volume.headings)
    poses[..., 3] = volume.z[nodes[:, 2], None]
    assert check_reach(case.geometry, poses).ok.all()
    found = measure_singularity(case.geometry, poses)
    assert (found.rotation_distance > 0.0).all()
    assert (found.condition <= 20.0).all()


def test_costly_quantities_get_fewer_headings_before_too_few_nodes() -> None:
    x, _, headings = axes_of(APPENDIX_4, needs("frequency_1 >= 1 Hz"), FINE, False)
    assert headings == 5
    assert len(x) > 12
    assert axes_of(APPENDIX_4, needs("max_torque <= 15 N m"), FINE, False)[2] == FINE.headings


def test_cells_of_what_does_not_depend_on_the_height_grow_by_its_time() -> None:
    """It is evaluated once a position: a node takes as much less as there are heights."""
    required, headings = needs("condition <= 10", theta=(-0.1, 0.1)), 5
    x, z, _ = axes_of(APPENDIX_4, required, Resolution(100_000, headings, 1e9), False)
    each = QUANTITIES["condition"].cost * headings / (len(z) - 3.5)  # beyond what is reached
    for share in (0.3, 0.6):
        budget = share * 100_000 * each
        less = axes_of(APPENDIX_4, required, Resolution(100_000, headings, budget), False)
        assert less[2] == headings
        assert (less[0][1] - less[0][0]) / (x[1] - x[0]) == pytest.approx(
            share ** (-1 / 3), rel=0.01
        )


def test_home_is_on_its_side_however_far_joints_are_above_the_platform() -> None:
    """With the upper knee it is what the joints 5 reach above the guides, wherever P is."""
    upper = replace(APPENDIX_4.geometry, knee=KneeBranch.UPPER)
    volumes = [
        solve_volume(
            replace(APPENDIX_4, geometry=replace(upper, platform_joint_height=height)),
            needs("condition <= 10"), resolution=COARSE,
        )
        for height in (0.0, 0.6, 3.0)
    ]  # fmt: skip
    for height, volume in zip((0.0, 0.6, 3.0), volumes, strict=True):
        assert volume.home_inside
        np.testing.assert_allclose(volume.z + height, volumes[0].z, atol=1e-12)
        np.testing.assert_array_equal(volume.inside, volumes[0].inside)
    hung = replace(APPENDIX_4.geometry, platform_joint_height=3.0)
    assert solve_volume(replace(APPENDIX_4, geometry=hung), needs(), resolution=COARSE).home_inside


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 4])
def test_stated_error_holds_against_points_one_by_one(seed: int) -> None:
    """Robots, headings and bounds at random; `benchmarks.volume_error` looks at hundreds."""
    volume, counted = counted_volume(seed, 20_000, 2**14)
    assert abs(volume.volume - counted.volume) <= volume.error + counted.deviation
    assert volume.error < 0.03 * counted.volume


@pytest.mark.slow
def test_volume_of_reach_alone_is_that_of_its_closed_form() -> None:
    """At one heading and with long bars a robot reaches a cylinder; the guides are its ends."""
    g = APPENDIX_4.geometry
    design = replace(APPENDIX_4, geometry=replace(g, crank_length=0.6, coupler_length=0.6))
    volume = solve_volume(design, needs(theta=(0.0, 0.0)), resolution=Resolution(30_000, 3, 5.0))
    # joint 5 is |P - (R_b - R_pl) axis| from its leg axis, and |85| at most 1.2 m
    radius, ratio = g.base_radius - g.platform_radius, g.span_ratio
    angle = np.radians([210.0, -30.0, 90.0])
    axes = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    side = np.linspace(-radius, radius, 1201)
    x, y = np.meshgrid(0.5 * (side[1:] + side[:-1]), 0.5 * (side[1:] + side[:-1]))
    away = np.hypot(x[..., None] - axes[:, 0], y[..., None] - axes[:, 1])
    lowest = -np.sqrt(np.maximum(1.44 - (ratio * away.max(axis=-1)) ** 2, 0.0))
    deep = np.maximum(g.platform_joint_height - lowest, 0.0)
    held = (np.hypot(x, y) < radius) & (away.min(axis=-1) > g.axis_clearance)
    held &= away.max(axis=-1) <= g.stroke * (g.magnification - 1)
    exact = float((deep * held).sum()) * (side[1] - side[0]) ** 2
    assert volume.volume == volume.reachable_volume
    assert abs(volume.volume - exact) <= volume.error + 2e-4 * exact
    assert volume.error < 0.02 * exact


@pytest.mark.parametrize("step", [1.0, 0.25])
def test_a_cube_just_beyond_the_band_is_whole_and_no_point_is_drawn_in_it(step: float) -> None:
    x, ones = step * np.arange(3.0), np.ones((3, 3, 3), bool)
    alone = np.zeros((3, 3, 3), bool)
    alone[1, 1, 1] = True
    for depth, cubes in ((1.25 * step, 0), (1.2499 * step, 27)):
        deep = np.full((3, 3, 3), depth)
        nodes = VolumeNodes(x, x, ones, ~ones, deep, ones, deep)
        drawn = measure._Surface.of(nodes, ones, ~ones, deep, 100)
        assert (drawn.cubes, drawn.whole) == (cubes, 27 - cubes)
        # nor in one as far outside
        around = np.where(alone, 0.2 * step, -deep)
        drawn = measure._Surface.of(nodes, alone, ~ones, around, 100)
        assert (drawn.cubes, drawn.whole) == (cubes or 1, 0)
        few = measure._Surface.of(nodes, alone, ~ones, around, 1)
        assert len(few.points) == 1


@pytest.mark.parametrize("count", [10_000, 60])
def test_points_are_drawn_in_their_cubes_one_in_each_layer(count: int) -> None:
    x = 0.1 * np.arange(-6.0, 7.0)
    depth = 0.45 - np.linalg.norm(np.stack(np.meshgrid(x, x, x, indexing="ij")), axis=0)
    inside, none = depth > 0, np.zeros(depth.shape, bool)
    nodes = VolumeNodes(x, x, inside, none, depth, inside, depth)
    drawn = measure._Surface.of(nodes, inside, none, depth, count)
    place = (drawn.points - x[0]) / 0.1
    index = np.rint(place).astype(int)
    assert (inside | (np.abs(depth) < 0.2))[tuple(index.T)].all()
    np.testing.assert_allclose(
        drawn.share, np.clip(0.5 + depth / 0.1, 0, 1)[tuple(index.T)], atol=1e-12
    )
    cubes, times = np.unique(index, axis=0, return_counts=True)
    if count == 60:
        assert len(cubes) == 60
        return
    assert (times == 2).all()
    assert len(cubes) == drawn.cubes
    # the same ones in every version, so that volumes that were written down come out again
    offset = np.random.default_rng(5).uniform(-0.5, 0.5, (len(place), 3))
    np.testing.assert_allclose((place - index)[:, :2], offset[:, :2], atol=1e-9)
    upper = place[:, 2] > index[:, 2]
    assert upper.sum() == len(cubes)
    assert len(np.unique(index[upper], axis=0)) == len(cubes)
