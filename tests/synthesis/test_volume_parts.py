"""Parts of volumes, each against brute force or a closed form."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    KneeBranch,
    check_reach,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.reach import MARGINS, Limit, home_pose
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume import margins, measure
from paminsa_viz.synthesis.volume.causes import (
    FIRST_REACH,
    SINGULAR,
    margin_distance,
    margin_slope,
    reach_distances,
)
from paminsa_viz.synthesis.volume.grid import Resolution, home_side, joined_to_home
from paminsa_viz.synthesis.volume.margins import Columns, heading_margins, headings
from paminsa_viz.synthesis.volume.reach import (
    can_be_taken,
    leg_distances,
    reach_bounds,
    takes_own_headings,
)
from paminsa_viz.synthesis.volume.solve import _distances
from paminsa_viz.synthesis.volume.workspace import (
    best_center,
    center_at,
    least_within,
    sample_workspace,
)
from tests.synthesis.robots import needs

GEOMETRY = APPENDIX_4.geometry
BOX, CYLINDER = WorkspaceShape.BOX, WorkspaceShape.CYLINDER


# ---------------------------------------------------------------- where a workspace may lie


@pytest.mark.parametrize(
    "reach", [(2, 2, 2), (2, 1, 3), (3, 2, 2), (2, 2, 3), (4, 4, 4), (2, 3, 1)]
)
@pytest.mark.parametrize("center", [(None, None, None), (0.0, None, 0.0), (0.1, -0.1, None)])
def test_a_workspace_as_large_as_the_nodes_has_one_place(reach: Any, center: Any) -> None:
    """And a larger one none; on five by five by six nodes."""
    axes = [0.1 * np.arange(-2.0, 3.0), 0.1 * np.arange(-2.0, 3.0), 0.1 * np.arange(-3.0, 3.0)]
    volume: Any = SimpleNamespace(x=axes[0], y=axes[1], z=axes[2], cell=0.1)
    values = np.random.default_rng(1).normal(size=(5, 5, 6))
    size = cast(Any, tuple(0.2 * np.array(reach)))
    space = Workspace(BOX, size, center)
    found = least_within(values, space, volume)
    places = [
        np.arange(n) if given is None else [int(np.abs(axis - given).argmin())]
        for n, axis, given in zip(values.shape, axes, center, strict=True)
    ]
    assert found.shape == tuple(len(part) for part in places)
    for index, least in np.ndenumerate(found):
        at = [part[i] for part, i in zip(places, index, strict=True)]
        fits = all(
            i - r >= 0 and i + r < n for i, r, n in zip(at, reach, values.shape, strict=True)
        )
        block = tuple(slice(i - r, i + r + 1) for i, r in zip(at, reach, strict=True))
        assert least == (values[block].min() if fits else -np.inf)
        flat = int(np.ravel_multi_index(index, found.shape))
        expected = [
            axis[i] if given is None else given
            for axis, i, given in zip(axes, at, center, strict=True)
        ]
        assert center_at(space, volume, flat) == pytest.approx(expected)
    volume.depth = values
    best = center_at(space, volume, int(found.argmax()))
    assert best_center(space, volume) == best


@pytest.mark.parametrize("density", [1, 2, 4])
def test_samples_are_rings_with_as_many_directions_as_their_radius(density: int) -> None:
    disc = sample_workspace(Workspace(CYLINDER, (0.2, 0.2, 0.3)), (0.1, -0.2, -0.5), density)
    away = disc.positions - [0.1, -0.2]
    radius, angle = np.hypot(*away.T), np.degrees(np.arctan2(away[:, 1], away[:, 0]))
    for ring in range(1, density + 1):
        own = np.isclose(radius, 0.1 * ring / density)
        assert own.sum() == 12 * max(1, round(ring / 2))
        assert np.isclose(angle[own], 30.0).any()
        steps = np.diff(np.sort(angle[own]))
        assert steps == pytest.approx(np.full(len(steps), 360.0 / own.sum()))
    assert np.isclose(radius, 0.0).sum() == 1
    box = sample_workspace(Workspace(BOX, (0.2, 0.4, 0.3)), (0.1, -0.2, -0.5), density)
    assert len(box.positions) == (2 * density + 1) ** 2
    for one, half, middle in ((0, 0.1, 0.1), (1, 0.2, -0.2)):
        wanted = middle + half * np.linspace(-1, 1, 2 * density + 1)
        assert np.unique(np.round(box.positions[:, one], 9)) == pytest.approx(wanted)
    for found in (disc, box):
        assert found.z == pytest.approx(-0.5 + 0.15 * np.linspace(-1, 1, 2 * density + 1))


# ---------------------------------------------------------------- reach and headings


def test_what_can_be_taken_may_be_at_the_end_of_a_guide_only() -> None:
    guide = MARGINS.index(Limit.GUIDE)
    for which in range(12):
        code = np.array([which] * 3, np.uint8)
        taken = can_be_taken(np.array([-1e-12, 0.0, 1e-12]), code)
        assert taken.tolist() == [False, which % 4 == guide, True]


def test_own_headings_have_to_be_taken_at_their_own_heights() -> None:
    """Below, within and above a range of z, at a place where a turn of 1.4 rad is singular."""
    z = np.array([-0.7, -0.6, -0.5, -0.4, -0.3])
    good = Requirement("condition", high=9.0, theta=(0.0, 0.2))
    bad = replace(good, theta=(0.0, 1.4))
    far = np.array([0.0, 3.0])[:, None]
    level = np.broadcast_to(z, (2, 5))
    for bound, here in ((good, True), (bad, False)):
        for limits, inside in ((None, [1, 1, 1, 1, 1]), ((-0.6, -0.4), [0, 1, 1, 1, 0])):
            found = takes_own_headings(GEOMETRY, far, 0.0, level, replace(bound, z=limits))
            expected = [here or not one for one in inside]
            assert found[0].tolist() == expected
            assert found[1].tolist() == [not one for one in inside]


@pytest.mark.parametrize("knee", KneeBranch)
def test_heights_on_homes_side_of_the_guides(knee: KneeBranch) -> None:
    g = replace(GEOMETRY, knee=knee)
    z = np.array([-0.5, 0.0, 0.25])
    below = knee is KneeBranch.LOWER
    # with the upper knee until the joints 5, 27.5 mm above P, have passed the guides
    expected = [0.5, 0.0, -0.25] if below else [-0.4725, 0.0275, 0.2775]
    assert home_side(g, z, False) == pytest.approx(expected, abs=1e-15)
    assert np.isinf(home_side(g, z, True)).all()


def test_nodes_joined_to_home_or_the_largest_part() -> None:
    x, z = 0.1 * np.arange(-2.0, 3.0), home_pose(GEOMETRY)[3] + np.array([-0.2, -0.1, 0.04, 0.1])
    nodes = np.zeros((5, 5, 4), bool)
    nodes[2, 2, 2] = True
    nodes[0, 0, :3] = True
    nodes[4, 4, 0] = True
    found, home = joined_to_home(nodes, x, z, GEOMETRY)
    assert (home, np.argwhere(found).tolist()) == (True, [[2, 2, 2]])
    nodes[2, 2, 2] = False
    found, home = joined_to_home(nodes, x, z, GEOMETRY)
    assert (home, found.sum()) == (False, 3)
    assert found[0, 0, :3].all()
    found, home = joined_to_home(np.zeros_like(nodes), x, z, GEOMETRY)
    assert (home, found.any()) == (False, False)


def test_resolutions_have_limits_on_either_number() -> None:
    assert Resolution(64, 3, 1.0).nodes == 64
    for nodes, count in ((63, 3), (64, 1), (64, 2), (64, 4)):
        with pytest.raises(ValueError, match="64 nodes or more"):
            Resolution(nodes, count, 1.0)


def test_distances_to_the_end_of_reach_are_those_of_its_margins() -> None:
    """Guide, axis and circle by themselves; bars by their margin over its slope."""
    lengths = {"crank_length": 0.45, "coupler_length": 0.55, "guide_stroke": 0.22}
    g = replace(GEOMETRY, **lengths, axis_clearance=0.01)
    x, y = np.meshgrid(np.linspace(-0.3, 0.3, 41), np.linspace(-0.3, 0.3, 41), indexing="ij")
    bounds = reach_bounds(g, x[..., None], y[..., None], (-0.1, 0.2))
    z = np.array([-0.8, -0.45, -0.05])
    least, code = reach_distances(bounds, z)
    ratio, height = g.span_ratio, z + g.platform_joint_height

    def slope(radius: Any) -> Any:
        step = 1e-6
        length = lambda r, h: np.hypot(ratio * r, h)  # noqa: E731
        by_r = (length(radius + step, height) - length(radius - step, height)) / (2 * step)
        by_z = (length(radius, height + step) - length(radius, height - step)) / (2 * step)
        return np.hypot(by_r, by_z)

    far, near = bounds.far, bounds.near
    expected = np.stack(np.broadcast_arrays(
        bounds.position,
        (g.crank_length + g.coupler_length - np.hypot(ratio * far, height)) / slope(far),
        (np.hypot(ratio * near, height) - 0.1) / slope(near),
        g.stroke * (g.magnification - 1) - far, near - 0.01,
    ))  # fmt: skip
    assert least == pytest.approx(expected.min(axis=0), abs=1e-6)
    which = expected.argmin(axis=0)
    assert set(np.unique(which)) >= {0, 1, 3}
    kinds = np.where(code == SINGULAR, 0, 1 + (code - FIRST_REACH) % 4)
    clear = np.diff(np.sort(expected, axis=0)[:2], axis=0)[0] > 1e-6
    assert (kinds == which)[clear].all()
    legs = np.where(np.isin(which, (1, 3)), bounds.far_leg, bounds.near_leg)
    assert ((code - FIRST_REACH) // 4 == legs)[clear & (which > 0)].all()
    # where the headings reach the singular rotation nothing is left, and the center is the best
    turned = reach_bounds(g, x[..., None], y[..., None], (0.0, 1.6))
    least, code = reach_distances(turned, z)
    assert turned.turn < 0.0
    assert (least < 0.0).all()


# ---------------------------------------------------------------- margins over headings


def test_slopes_are_the_larger_of_two_differences_along_each_axis() -> None:
    rng = np.random.default_rng(6)
    margin = rng.normal(size=(4, 5, 3))
    margin[rng.uniform(size=margin.shape) < 0.1] = np.nan
    margin[0, 0, 0], margin[3, 4, 2] = np.inf, -np.inf
    found = margin_slope(margin)
    for place in np.ndindex(margin.shape):
        total = 0.0
        for axis in range(3):
            most = 0.0
            for side in (-1, 1):
                other = list(place)
                other[axis] += side
                if 0 <= other[axis] < margin.shape[axis]:
                    change = abs(margin[place] - margin[tuple(other)])
                    most = max(most, change) if np.isfinite(change) else most
            total += most**2
        assert found[place] == pytest.approx(np.sqrt(total))


def test_distances_of_margins_are_at_most_as_far_as_the_grid() -> None:
    margin = np.array([1.0, -1.0, 0.5, 0.0, 0.0, np.inf, -np.inf, 1e9, -1e9, np.nan])[:, None, None]
    slope = np.array([2.0, 2.0, 0.0, 0.0, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0])[:, None, None]
    found = margin_distance(margin, slope, 0.1).ravel()
    expected = [0.05, -0.05, 1.0, 0.0, 0.0, 0.1, -0.1, 1.0, -1.0, np.nan]
    np.testing.assert_allclose(found, expected)


def test_the_nearest_requirement_that_breaks_counts_at_its_own_heights() -> None:
    """Beyond them it is as far away as its heights."""
    z = np.array([-0.6, -0.5, -0.4, -0.3])
    bounds = (
        Requirement("condition", high=9.0, z=(-0.55, -0.35)), Requirement("f_4", high=400.0),
    )  # fmt: skip
    one = np.broadcast_to(np.array([1.0, 2.0, 3.0])[:, None, None], (3, 2, 4)).copy()
    other = np.broadcast_to(np.array([4.0, 3.8, 3.6])[:, None, None], (3, 2, 4)).copy()
    least, worst = _distances(Requirements(bounds), np.stack([one, other]), z, 0.01)
    first = np.maximum(one * 0.01, np.maximum(-0.55 - z, z + 0.35))
    second = np.clip(other * 0.01 / 0.2, -0.04, 0.04)
    np.testing.assert_allclose(least, np.minimum(first, second), atol=1e-12)
    np.testing.assert_array_equal(worst, np.where(second < first, 1, 0))
    assert {0, 1} == set(np.unique(worst))


@pytest.mark.parametrize("lifted", [False, True])
def test_least_margins_are_those_of_each_pose(lifted: bool) -> None:
    """Of all and of every second heading; where a requirement does not hold, infinite."""
    needed = Requirements(
        (
            Requirement("condition", high=9.0, theta=(0.1, 0.3)), Requirement("f_4", high=400.0),
            Requirement("f_4", low=100.0, z=(-0.62, -0.52)), Requirement("condition", low=1.5),
        ),
        (-0.2, 0.2),
    )  # fmt: skip
    rng = np.random.default_rng(9)
    positions, z = rng.uniform(-0.1, 0.1, (6, 2)), np.array([-0.65, -0.6, -0.5])
    lift = rng.uniform(-0.05, 0.05, 6) if lifted else None
    told: list[float] = []
    found = heading_margins(
        APPENDIX_4, needed, positions, z, 5, lambda done: bool(told.append(done)), lift
    )
    assert told[-1] == pytest.approx(1.0)
    for number, bound in enumerate(needed.bounds):
        theta = np.linspace(*needed.headings(bound), 5)
        pose = Columns.at(positions, theta, z, lift).poses()
        value = static_torques(APPENDIX_4, pose)[..., 3]
        if bound.quantity == "condition":
            value = measure_singularity(GEOMETRY, pose).condition
        margin = bound.margin(value)
        for part, least in zip(found, (margin, margin[:, ::2]), strict=True):
            expected = least.min(axis=1)
            if bound.z is not None:
                level = pose[:, 0, :, 3]
                outside = (level < bound.z[0]) | (level > bound.z[1])
                assert outside.any()
                expected = np.where(outside, np.inf, expected)
            np.testing.assert_allclose(part[number], expected, rtol=1e-7)


def test_headings_have_the_ends_of_their_range() -> None:
    assert headings((-0.2, 0.4), 4) == pytest.approx([-0.2, 0.0, 0.2, 0.4])
    assert headings((0.3, 0.3), 9).tolist() == [0.3]


def test_robots_with_a_large_base_have_no_bars_that_reach_all() -> None:
    ratio = GEOMETRY.span_ratio
    for share, none in ((0.99, False), (1.01, True)):
        radius = share * 10.0 / ratio - GEOMETRY.platform_radius
        lengths = {"base_radius": radius, "crank_length": 10.0, "coupler_length": 10.0}
        large = APPENDIX_4.vary({f"geometry.{name}": value for name, value in lengths.items()})
        assert (margins._without_reach(large) is None) is none


# ---------------------------------------------------------------- sizes


def test_costly_quantities_get_as_many_points_as_half_their_time_pays(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[float] = []

    class Surface:
        @classmethod
        def of(cls, nodes: Any, inside: Any, apart: Any, depth: Any, count: float) -> Any:
            asked.append(count)
            return SimpleNamespace(points=np.zeros((4, 3)), size=sizes)

    def sizes(holds: Any) -> tuple[float, float]:
        return 100.0 + 10.0 * float(holds.sum()), 2.0

    monkeypatch.setattr(measure, "_Surface", Surface)
    monkeypatch.setattr(measure, "_taken", lambda *_: np.array([True, True, True, False]))
    monkeypatch.setattr(
        measure, "_met", lambda *_: (np.array([True, False, False]), np.array([True, True, False]))
    )
    monkeypatch.setattr(measure, "_uncertain", lambda nodes: 5.0)
    grid = np.zeros((3, 3, 3), bool)
    nodes = measure.VolumeNodes(np.arange(3) * 0.5, np.arange(3.0), grid, grid, grid, grid, grid)
    needed = needs("condition <= 9")
    for each, count in ((0.0, np.inf), (0.01, 500.0), (1.0, 200.0)):
        monkeypatch.setattr(measure, "time_per_position", lambda *_, e=each: e)
        asked.clear()
        found = measure.measure(APPENDIX_4, needed, nodes, 9, False, 10.0)
        assert asked == [np.inf, count]
    # 110 cubes, less a third of the ten that every second heading adds
    cube = 0.125
    assert found.volume == pytest.approx(cube * (110 - 10 / 3))
    assert found.error == pytest.approx(cube * (3 * 2 + 10 + 5))
    assert found.reachable == pytest.approx(cube * 130)
    asked.clear()
    alone = measure.measure(APPENDIX_4, Requirements(()), nodes, 9, False, 10.0)
    assert (alone.volume, alone.reachable) == (cube * 130, cube * 130)
    assert alone.error == pytest.approx(cube * 6)
    assert asked == [np.inf]


def test_parts_that_a_hidden_neck_may_join_count_as_error() -> None:
    inside, apart = np.zeros((12, 3, 3), bool), np.zeros((12, 3, 3), bool)
    inside[0, 1, 1] = True
    apart[3, 1, 1] = apart[4, 2, 2] = True  # one part, three nodes away
    apart[9:11, 1, 1] = True
    nodes: Any = SimpleNamespace(inside=inside, apart=apart)
    assert measure._uncertain(nodes) == 2.0
    apart[3] = False  # then four nodes away
    assert measure._uncertain(nodes) == 0.0
    apart[:] = False
    assert measure._uncertain(nodes) == 0.0


@pytest.mark.parametrize("both_sides", [True, False])
def test_points_of_the_reachable_body_are_those_that_can_be_taken(both_sides: bool) -> None:
    rng = np.random.default_rng(8)
    points = rng.uniform([-0.4, -0.4, -1.0], [0.4, 0.4, 1.0], (1000, 3))
    needed = Requirements((), (-0.3, 0.3))
    found = measure._taken(APPENDIX_4, needed, points, both_sides)
    theta = np.linspace(-0.3, 0.3, 31)
    pose = np.empty((len(points), 31, 4))
    pose[..., :2], pose[..., 2], pose[..., 3] = points[:, None, :2], theta, points[:, None, 2]
    circle = measure_singularity(GEOMETRY, pose).position_distance > 0.0
    expected = (check_reach(GEOMETRY, pose).ok & circle).all(axis=1)
    expected &= both_sides | (points[:, 2] <= 0.0)
    assert 0.02 < expected.mean() < 0.9
    assert (found == expected).mean() > 0.995
    assert not (found & ~expected).any()


def test_the_surface_of_a_single_node_is_in_the_cubes_around_it() -> None:
    """But for those of parts that are not joined to it; points are drawn in some, each once."""
    x, inside = np.arange(5.0), np.zeros((5, 5, 5), bool)
    inside[2, 2, 2] = True
    depth = np.where(inside, 0.2, -0.3)
    apart = np.zeros_like(inside)
    for joined, cubes in ((True, 27), (False, 26)):
        apart[1, 1, 1] = not joined
        nodes = measure.VolumeNodes(x, x, inside, apart, depth, inside, depth)
        drawn = measure._Surface.of(nodes, inside, apart, depth, 20)
        assert drawn.cubes == cubes
        assert len(np.unique(np.rint(drawn.points), axis=0)) == len(drawn.points) == 20
        assert np.abs(drawn.points - 2.0).max() <= 1.5


@pytest.mark.parametrize("leg", range(3))
@pytest.mark.parametrize("turn", [0.5, 2.6, 3.7, 5.8])
@pytest.mark.parametrize("flat", [0, 1])
def test_an_arc_that_crosses_two_sides_of_a_box_is_at_no_distance(
    leg: int, turn: float, flat: int
) -> None:
    """Far from its corners, whichever two sides are long."""
    g, axis = GEOMETRY, LEG_AXES[leg]
    point = g.base_radius * axis + g.platform_radius * np.array([np.cos(turn), np.sin(turn)])
    half = np.array([[0.03, 0.03]])
    half[0, flat] = 0.001
    low, high = leg_distances(
        np.array([g.base_radius]), np.array([g.platform_radius]), point, half, (0.0, 2 * np.pi),
        BOX,
    )  # fmt: skip
    assert low[0, leg] == 0.0
    assert high[0, leg] > 2 * g.platform_radius
