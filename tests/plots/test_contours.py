"""Contours, boundary and circle against geometry that is known."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.path import Path

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots import contours
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale
from tests.plots.samples import made_up, real

SLOPES = np.array([(10.0, 5.0), (-4.0, 8.0), (6.0, -7.0)])


def planes() -> MapData:
    """Return three maps that are planes of different slope."""
    x, y = np.linspace(-0.42, 0.42, 31), np.linspace(-0.36, 0.36, 27)
    values = SLOPES[:, :1, None] * x[None, None, :] + SLOPES[:, 1:, None] * y[None, :, None]
    return made_up(values=values, status=np.zeros((27, 31), np.uint8))


@pytest.mark.parametrize("panel", range(3))
def test_contours_follow_the_values_of_their_own_panel(panel: int) -> None:
    found = contours.contour_lines(planes(), panel, Scale(-4.0, 4.0))
    assert set(found) >= {-3.0, 0.0, 3.0}
    for level, line in found.items():
        assert np.allclose(line @ SLOPES[panel], level, atol=1e-9, equal_nan=True)


def test_no_contour_runs_along_a_pole() -> None:
    data = made_up(nx=121, ny=121)
    found = contours.contour_lines(data, 0, Scale(-20.0, 20.0))
    assert found
    for level, line in found.items():
        for part in contours.pieces(line):
            stuck = np.abs(np.hypot(*part.T) - 0.25) < 0.004
            along = np.hypot(*np.diff(part, axis=0).T).sum()
            assert stuck.mean() < 0.5 or along < 0.03, level


@pytest.mark.parametrize(("end", "near"), [(2000.0, True), (2.0, False)])
def test_no_contour_runs_along_an_unknown_pole(end: float, near: bool) -> None:
    data = made_up(nx=121, ny=121, singular_radius=None)
    points = np.concatenate(list(contours.contour_lines(data, 0, Scale(-end, end)).values()))
    away = points[np.abs(points[:, 1]) < 0.1]  # further up and down the torque vanishes
    assert (np.abs(np.hypot(*away.T) - 0.25) < 0.002).any() == near


def test_contours_of_smooth_values_cross_the_circle() -> None:
    values = np.broadcast_to(np.linspace(-0.42, 0.42, 31), (3, 27, 31))
    data = made_up(values=values, status=np.zeros((27, 31), np.uint8))
    zero = contours.contour_lines(data, 0, Scale(-0.5, 0.5))[0.0]
    assert len(contours.pieces(zero)) == 1
    assert np.ptp(zero[:, 1]) == pytest.approx(0.72)


def test_coarse_contours_agree_with_fine_ones() -> None:
    data = real(121)
    scale = Scale(-20.0, 20.0)
    fine, coarse = (contours.contour_lines(data, 0, scale, most)[0.0] for most in (None, 50))
    inner = [part[np.hypot(*part.T) < 0.2] for part in (fine, coarse)]
    gap = np.hypot(*(inner[1][:, None, :] - inner[0][None, :, :]).transpose(2, 0, 1)).min(axis=1)
    assert gap.max() < 0.007  # about a cell


@pytest.mark.parametrize(("margin", "distance"), [(True, 1e-3), (False, 0.007)])
def test_the_boundary_is_where_the_margin_vanishes_or_follows_the_cells(
    margin: bool, distance: float
) -> None:
    data = made_up(nx=121, ny=121)
    points = contours.boundary(data if margin else replace(data, margin=None))
    assert np.allclose(np.hypot(points[:, 0] / 1.3, points[:, 1]), 0.3, atol=distance)


def test_singular_cells_are_no_boundary() -> None:
    status = np.zeros((27, 31), dtype=np.uint8)
    status[10:12] = Limit.SINGULAR
    data = made_up(status=status, margin=None)
    assert contours.boundary(data).size == 0


def test_reached_area_is_the_area_within_the_boundary() -> None:
    found = contours.reached_area(made_up(nx=121, ny=121))
    assert found is not None
    polygons = Path(*found).to_polygons()
    area = sum(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) for x, y in (p.T for p in polygons))
    assert area == pytest.approx(np.pi * 0.3 * 0.39, rel=1e-3)
    assert contours.reached_area(made_up(margin=np.full((27, 31), -0.1))) is None


def test_singular_circle_is_clipped_to_the_map() -> None:
    whole = contours.singular_circle(made_up())
    assert np.allclose(np.hypot(*whole.T), 0.25)
    left, right, bottom, top = made_up().extent
    arcs = contours.pieces(contours.singular_circle(made_up(singular_radius=0.45)))
    assert len(arcs) >= 4
    for arc in arcs:
        assert np.allclose(np.hypot(*arc.T), 0.45)
        assert ((arc[:, 0] >= left) & (arc[:, 0] <= right)).all()
        assert ((arc[:, 1] >= bottom) & (arc[:, 1] <= top)).all()
    for radius in (None, 0.0, 3.0):
        assert contours.singular_circle(made_up(singular_radius=radius)).size == 0


def test_contour_labels_are_on_their_lines_and_clear_of_others() -> None:
    data, scale = real(121, theta=0.7), Scale(-8.0, 8.0)
    found = contours.contour_lines(data, 0, scale)
    room, margin = dict.fromkeys(found, 0.02), 0.005
    places = contours.label_places(data, found, room, margin)
    assert 2 <= len(places) <= contours.LABELS * len(found)
    near = [contours.boundary(data), contours.singular_circle(data), data.pose[None, :2]]
    for place in places:
        gaps = {v: np.nanmin(np.hypot(*(line - place).T)) for v, line in found.items()}
        own = min(gaps, key=lambda level: gaps[level])
        assert gaps.pop(own) < 1e-12
        assert min(gaps.values()) > 0.02
        assert min(np.nanmin(np.hypot(*(line - place).T)) for line in near) > 0.02
    apart = [np.hypot(*np.subtract(a, b)) for a, b in combinations(places, 2)]
    assert min(apart) > 0.025
    assert contours.label_places(data, found, dict.fromkeys(found, 1.0), margin) == []
