"""Curves in a scene."""

from __future__ import annotations

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.scene.curves import Curve, dashes, segments


def circle(radius: float, count: int = 128) -> np.ndarray:
    """A closed circle of as many segments."""
    angle = np.linspace(0, 2 * np.pi, count + 1)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_a_curve_is_one_node(server: viser.ViserServer) -> None:
    curve = Curve(server.scene, "/circle")
    curve.draw([])
    assert "/circle" not in server.scene._handle_from_node_name
    curve.draw([circle(0.3), circle(0.1)], height=-0.5)
    node = server.scene._handle_from_node_name["/circle"]
    assert node.points.shape == (256, 2, 3)
    assert np.unique(node.points[..., 2]) == pytest.approx([-0.5])
    curve.draw([circle(0.3, 16)])
    assert server.scene._handle_from_node_name["/circle"] is node
    assert node.points.shape == (16, 2, 3)
    curve.draw([])
    assert not node.visible


def test_a_gap_breaks_a_curve() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [np.nan, 0.0], [2.0, 0.0], [3.0, 0.0]])
    assert segments(line, 0.5) == pytest.approx(
        np.array([[[0, 0, 0.5], [1, 0, 0.5]], [[2, 0, 0.5], [3, 0, 0.5]]])
    )


def test_dashes_cover_half_of_a_curve() -> None:
    lines = segments(circle(0.3, 400))
    cut = dashes(lines, 0.02)
    drawn = np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1).sum()
    assert drawn == pytest.approx(np.pi * 0.3, rel=0.01)
    assert np.hypot(cut[..., 0], cut[..., 1]) == pytest.approx(0.3, abs=1e-4)
