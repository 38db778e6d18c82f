"""Contours, boundary and circle against geometry that is known."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots import lines
from paminsa_viz.plots.scale import Scale
from tests.plots.samples import made_up, real


def test_contours_follow_the_values() -> None:
    x, y = np.linspace(-0.42, 0.42, 31), np.linspace(-0.36, 0.36, 27)
    plane = 10 * x[None, :] + 5 * y[:, None]
    data = made_up(
        values=np.broadcast_to(plane, (3, 27, 31)).copy(), status=np.zeros((27, 31), np.uint8)
    )
    found = lines.contour_lines(data, 0, Scale(-4.0, 4.0))
    assert set(found) >= {-3.0, 0.0, 3.0}
    for level, parts in found.items():
        for part in parts:
            assert np.allclose(10 * part[:, 0] + 5 * part[:, 1], level, atol=1e-9)


def test_no_contour_runs_along_a_pole() -> None:
    data = made_up(nx=121, ny=121)
    found = lines.contour_lines(data, 0, Scale(-20.0, 20.0))
    assert found
    naive = lines.contour_lines(replace(data, singular_radius=None), 0, Scale(-2000.0, 2000.0))
    near = np.concatenate([p for parts in naive.values() for p in parts])
    assert (np.abs(np.hypot(*near.T) - 0.25) < 0.003).mean() > 0.5  # what would happen
    for level, parts in found.items():
        for part in parts:
            distance = np.abs(np.hypot(*part.T) - 0.25)
            along = np.hypot(*np.diff(part, axis=0).T).sum()
            stuck = distance < 0.004
            assert stuck.mean() < 0.5 or along < 0.03, level


def test_no_contour_runs_along_a_pole_that_nobody_named() -> None:
    data = made_up(nx=121, ny=121, singular_radius=None)
    for scale, near in ((Scale(-2000.0, 2000.0), True), (Scale(-2.0, 2.0), False)):
        found = lines.contour_lines(data, 0, scale)
        points = np.concatenate([part for parts in found.values() for part in parts])
        away = points[np.abs(points[:, 1]) < 0.1]  # further up and down the torque vanishes
        assert (np.abs(np.hypot(*away.T) - 0.25) < 0.002).any() == near


def test_contours_of_smooth_values_cross_the_circle() -> None:
    x = np.linspace(-0.42, 0.42, 31)
    values = np.broadcast_to(x[None, None, :], (3, 27, 31)).copy()
    data = made_up(values=values, status=np.zeros((27, 31), np.uint8))
    zero = lines.contour_lines(data, 0, Scale(-0.5, 0.5))[0.0]
    assert len(zero) == 1
    assert np.ptp(zero[0][:, 1]) == pytest.approx(0.72)


def test_coarse_contours_agree_with_fine_ones() -> None:
    data = real(121)
    scale = Scale(-20.0, 20.0)
    fine, coarse = (lines.contour_lines(data, 0, scale, most)[0.0] for most in (None, 50))
    inner = [np.concatenate(part) for part in (fine, coarse)]
    inner = [part[np.hypot(*part.T) < 0.2] for part in inner]
    gap = np.hypot(*(inner[1][:, None, :] - inner[0][None, :, :]).transpose(2, 0, 1)).min(axis=1)
    assert gap.max() < 0.007  # about a cell


def test_the_boundary_is_where_the_margin_vanishes() -> None:
    data = made_up(nx=121, ny=121)
    points = np.concatenate(lines.boundary(data))
    assert np.allclose(np.hypot(points[:, 0] / 1.3, points[:, 1]), 0.3, atol=1e-3)


def test_without_a_margin_the_boundary_follows_the_cells() -> None:
    data = replace(made_up(nx=121, ny=121), margin=None)
    points = np.concatenate(lines.boundary(data))
    assert np.allclose(np.hypot(points[:, 0] / 1.3, points[:, 1]), 0.3, atol=0.007)


def test_singular_cells_are_no_boundary() -> None:
    status = np.zeros((27, 31), dtype=np.uint8)
    status[10:12] = Limit.SINGULAR
    data = made_up(status=status, margin=None)
    assert lines.boundary(data) == []


def test_the_area_within_the_boundary() -> None:
    data = made_up(nx=121, ny=121)
    area = 0.0
    for points, offsets in lines.reached_area(data):
        for start, end in pairwise(offsets):
            x, y = points[start:end].T
            area += 0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    assert area == pytest.approx(np.pi * 0.3 * 0.39, rel=1e-3)


def test_the_circle_is_cut_at_the_edges_of_the_map() -> None:
    whole = lines.singular_circle(made_up())
    assert len(whole) == 1
    assert np.allclose(np.hypot(*whole[0].T), 0.25)
    left, right, bottom, top = made_up().extent
    arcs = lines.singular_circle(made_up(singular_radius=0.45))
    assert len(arcs) >= 4
    for arc in arcs:
        assert np.allclose(np.hypot(*arc.T), 0.45)
        assert ((arc[:, 0] >= left) & (arc[:, 0] <= right)).all()
        assert ((arc[:, 1] >= bottom) & (arc[:, 1] <= top)).all()
    assert lines.singular_circle(made_up(singular_radius=None)) == []
    assert lines.singular_circle(made_up(singular_radius=0.0)) == []
    assert lines.singular_circle(made_up(singular_radius=3.0)) == []
