"""Every shape of a workspace, by what its edge says: no test here asks which shape it is."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.workspace_shapes import CrossSection, WorkspaceShape, _on_arc

ALL_SHAPES = pytest.mark.parametrize("shape", WorkspaceShape)


def half_extents(section: CrossSection) -> Array:
    """Half extents that the shape can have; of two different ones if it has them."""
    return np.array(section.fitted((0.3, 0.2, 0.4))[:2])


def outline(section: CrossSection, half: Array, count: int = 4000) -> Array:
    """Positions close to each other on the edge."""
    corners, _ = section.edge()
    share = np.linspace(0.0, 1.0, count // (len(corners) - 1))[:, None]
    pieces = [a + share * (b - a) for a, b in pairwise(corners)]
    return section.clipped(2.0 * np.concatenate(pieces), (1.0, 1.0)) * half


def inside(section: CrossSection, position: Array, half: Array, slack: float = 1e-9) -> Array:
    return section.gauge_squared(position[..., 0], position[..., 1], half) <= 1.0 + slack


@ALL_SHAPES
def test_sizes_that_a_shape_is_given_by_are_those_of_its_extents(shape: WorkspaceShape) -> None:
    section = shape.section
    sizes = tuple(0.1 + 0.2 * n for n in range(len(section.sizes)))
    size = section.size(*sizes)
    assert section.given(size) == sizes
    assert section.fitted(size) == size
    assert size[2] == sizes[-1]
    assert section.text(*(f"{extent:g}" for extent in size)).startswith(shape.value)
    assert section.fitted((3.0, 3.0, 4.0)) == (3.0, 3.0, 4.0)


@ALL_SHAPES
def test_a_gauge_is_one_on_the_edge_and_what_is_outside_is_moved_there(
    shape: WorkspaceShape,
) -> None:
    section = shape.section
    half, rng = half_extents(section), np.random.default_rng(1)
    edge = outline(section, half)
    for scale in (0.5, 1.0, 2.0):
        gauge = np.sqrt(section.gauge_squared(*(scale * edge).T, half))
        np.testing.assert_allclose(gauge, scale, rtol=1e-9)
    anywhere = rng.uniform(-1.0, 1.0, (500, 2))
    found = section.clipped(anywhere, half)
    held = inside(section, anywhere, half, 0.0)
    assert 20 < held.sum() < 480
    np.testing.assert_array_equal(found[held], anywhere[held])
    np.testing.assert_allclose(section.gauge_squared(*found[~held].T, half), 1.0, rtol=1e-12)
    with np.errstate(all="ignore"):
        nothing = section.gauge_squared(np.array([0.1]), np.array([0.0]), (0.0, 0.0))
        assert np.isposinf(nothing).all()
        assert np.isnan(section.gauge_squared(np.zeros(1), np.zeros(1), (0.0, 0.0))).all()


@ALL_SHAPES
def test_its_area_and_positions_spread_over_it(shape: WorkspaceShape) -> None:
    section = shape.section
    unit = (np.stack(np.meshgrid(*[np.arange(400)] * 2), axis=-1).reshape(-1, 2) + 0.5) / 400 - 0.5
    half = half_extents(section)
    assert inside(section, 2.0 * unit * half, half).mean() == pytest.approx(section.fill, abs=1e-3)
    spread = section.spread(unit)
    assert inside(section, spread, (0.5, 0.5)).all()
    # as many in the inner part as it has of the area, and as many on each side
    inner = inside(section, spread, (0.25, 0.25)).mean()
    assert inner == pytest.approx(0.25, abs=1e-2)
    np.testing.assert_allclose((spread > 0.0).mean(axis=0), 0.5, atol=1e-2)
    np.testing.assert_allclose(spread.mean(axis=0), 0.0, atol=1e-3)


@ALL_SHAPES
def test_how_far_it_extends_by_its_edge(shape: WorkspaceShape) -> None:
    section = shape.section
    half, rng = half_extents(section), np.random.default_rng(2)
    edge = outline(section, half)
    for center in (np.array([0.05, -0.1]), np.array([0.7, 0.4]), np.array([-0.2, 0.35])):
        at = center + edge
        far = np.hypot(*at.T).max()
        assert section.farthest(center, half) == pytest.approx(far, rel=1e-4)
        for angle in (0.0, np.pi / 2, np.pi, *rng.uniform(0.0, 6.0, 5)):
            along = np.array([np.cos(angle), np.sin(angle)])
            assert section.extent(half, along) == pytest.approx((edge @ along).max(), rel=1e-4)
            run = section.ray(center, half, along)
            if not inside(section, -center, half):
                assert run == 0.0
                continue
            assert section.gauge_squared(*(run * along - center), half) == pytest.approx(1.0)


@ALL_SHAPES
def test_samples_are_within_and_its_edge_is_among_them(shape: WorkspaceShape) -> None:
    section = shape.section
    half = half_extents(section)
    for count in (1, 2, 4, 12):
        ring = section.ring(count, third=False)
        np.testing.assert_allclose(section.gauge_squared(*ring.T, (1.0, 1.0)), 1.0, rtol=1e-12)
        assert len(np.unique(ring.round(9), axis=0)) == len(ring)
        if section.threefold:
            third = section.ring(count, third=True)
            turned = [third @ [[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]
                      for a in 2.0 * np.pi / 3.0 * np.arange(3)]  # fmt: skip
            np.testing.assert_allclose(np.concatenate(turned), ring, atol=1e-12)
    for density in (1, 3, 8):
        filled = section.filled(density, half)
        gauge = np.sqrt(section.gauge_squared(*filled.T, half))
        assert (gauge < 1.0 + 1e-12).all()
        assert (np.abs(gauge - 1.0) < 1e-12).sum() >= 8
        np.testing.assert_allclose(np.unique(gauge.round(9)), np.arange(density + 1) / density)
        np.testing.assert_allclose(filled.mean(axis=0), 0.0, atol=1e-12)
    edge, uprights = section.edge()
    np.testing.assert_array_equal(edge[0].round(12), edge[-1].round(12))
    assert len(edge[uprights]) >= 4
    assert np.unique(np.hypot(*edge[uprights].T).round(9)).size == 1


@ALL_SHAPES
def test_nodes_of_a_grid_that_are_within_it(shape: WorkspaceShape) -> None:
    section = shape.section
    half = half_extents(section)
    x, y = (extent * np.linspace(-1.0, 1.0, 21) for extent in half)
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    slack = 1e-9 * half
    np.testing.assert_array_equal(
        section.on_nodes(x, y, half + slack), inside(section, nodes, half)
    )


@ALL_SHAPES
@pytest.mark.parametrize("theta", [(-0.4, 0.9), (0.3, 0.3), (-3.0, 4.0)])
def test_distances_of_arcs_are_those_of_points_on_both(
    shape: WorkspaceShape, theta: tuple[float, float]
) -> None:
    section, rng = shape.section, np.random.default_rng(4)
    half = np.array([half_extents(section), 0.4 * half_extents(section)])
    center = rng.uniform(-0.6, 0.6, (2, 3, 2))
    radius, alpha = np.array([[[0.3]], [[0.12]]]), np.array([[-0.5], [1.6], [3.7]])
    near, far = section.arc_distances(center, radius, alpha, theta, half)
    turn = np.linspace(*theta, 400)
    for robot, leg in np.ndindex(2, 3):
        edge = outline(section, half[robot], 256)
        angle = alpha[leg, 0] + turn
        arc = -radius[robot, 0, 0] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        arc = arc - center[robot, leg]
        apart = np.hypot(*(arc[:, None] - edge).T)
        assert far[robot, leg] == pytest.approx(apart.max(), abs=1e-3)
        least = 0.0 if inside(section, arc, half[robot]).any() else apart.min()
        assert max(near[robot, leg], 0.0) == pytest.approx(least, abs=5e-3)


def test_headings_on_an_arc_are_those_to_a_billionth_of_a_radian_beyond_its_ends() -> None:
    theta = (0.3, 1.1)
    for end, way in zip(theta, (-1.0, 1.0), strict=True):
        beyond = end + way * np.array([-0.1, -2.5e-9, 0.0, 0.95e-9, 1.05e-9, 2.5e-9, 0.1])
        for turns in (-2.0, 0.0, 1.0):
            found = _on_arc(beyond + 2.0 * np.pi * turns, theta)
            assert found.tolist() == [True] * 4 + [False] * 3
