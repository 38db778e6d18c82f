"""Numbers on contour lines: on their line, upright, clear of everything else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.plots.labels import place_labels, walk

WIDTH, HEIGHT = 4.0, 1.6


def rings(count: int, gap: float) -> dict[float, list[np.ndarray]]:
    """Return circles about (30, 30)."""
    angle = np.linspace(0, 2 * np.pi, 200)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return {float(i): [30 + (8 + i * gap) * ring] for i in range(count)}


def test_walking_keeps_the_ends_and_the_step() -> None:
    line = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])
    points = walk(line, 0.5)
    assert points[0].tolist() == [0, 0]
    assert points[-1].tolist() == [3, 4]
    assert np.allclose(np.hypot(*np.diff(points, axis=0).T), 0.5)


@given(st.integers(1, 6), st.floats(2.6, 5.0))
def test_numbers_lie_on_their_lines_and_keep_apart(count: int, gap: float) -> None:
    found = rings(count, gap)
    labels, cut = place_labels(found, lambda _: WIDTH, HEIGHT, [])
    assert {label.level for label in labels} == set(found)
    for label in labels:
        radius = np.hypot(label.x - 30, label.y - 30)
        assert radius == pytest.approx(8 + label.level * gap, abs=0.1)
        assert -90 <= label.angle <= 90
        tangent = np.degrees(np.arctan2(label.y - 30, label.x - 30)) + 90
        assert abs((label.angle - tangent + 90) % 180 - 90) < 4
    for i, a in enumerate(labels):
        for b in labels[i + 1 :]:
            assert np.hypot(a.x - b.x, a.y - b.y) > HEIGHT
    for label in labels:
        turn = np.radians(label.angle)
        along = np.array([np.cos(turn), np.sin(turn)])
        for parts in cut.values():
            for part in parts:
                away = walk(part, 0.1) - [label.x, label.y]
                inside = (np.abs(away @ along) < WIDTH / 2) & (
                    np.abs(away @ [-along[1], along[0]]) < HEIGHT / 2
                )
                assert not inside.any()


def test_crowded_lines_get_no_numbers_and_stay_whole() -> None:
    found = rings(5, 0.8)
    labels, cut = place_labels(found, lambda _: WIDTH, HEIGHT, [])
    inner = [label for label in labels if 0 < label.level < 4]
    assert inner == []
    for level in (1.0, 2.0, 3.0):
        length = sum(np.hypot(*np.diff(part, axis=0).T).sum() for part in cut[level])
        assert length == pytest.approx(2 * np.pi * (8 + 0.8 * level), rel=1e-3)


def test_numbers_keep_clear_of_other_things() -> None:
    line = {1.0: [np.array([[0.0, 0.0], [40.0, 0.0]])]}
    wall = [np.array([[-1.0, 0.5], [25.0, 0.5]])]
    labels, _ = place_labels(line, lambda _: WIDTH, HEIGHT, wall)
    assert labels
    assert all(label.x - WIDTH / 2 > 25 for label in labels)


def test_short_lines_get_no_numbers() -> None:
    line = {1.0: [np.array([[0.0, 0.0], [4.5, 0.0]]), np.zeros((1, 2))]}
    labels, cut = place_labels(line, lambda _: WIDTH, HEIGHT, [])
    assert labels == []
    assert np.allclose(cut[1.0][0][[0, -1]], [[0, 0], [4.5, 0]])
