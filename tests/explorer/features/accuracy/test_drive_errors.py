"""The layer of drive errors: the solid of the corners, rings of the RMS, the stated scale."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from paminsa_viz.explorer.features.accuracy.layers import FARTHEST, outline, prism, rms_rings
from paminsa_viz.explorer.scene.forces import BAR
from paminsa_viz.model import APPENDIX_4, DriveAccuracy, jacobian, singular_rotation
from paminsa_viz.precision.drive_errors import drive_errors
from tests.support.scene import POSE, Scene

GEOMETRY = APPENDIX_4.geometry


def test_outline_is_the_convex_hull() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(40, 2))
    found = outline(points)
    edges = np.roll(found, -1, axis=0) - found
    for corner, edge in zip(found, edges, strict=True):
        away = points - corner
        assert (edge[0] * away[:, 1] - edge[1] * away[:, 0] >= -1e-12).all()
    assert len(outline(np.zeros((5, 2)))) == 1
    assert len(outline(np.outer(np.arange(5.0), [1.0, 2.0]))) == 2


def test_solid_holds_all_corners_and_is_closed() -> None:
    found = drive_errors(GEOMETRY, DriveAccuracy(), POSE)
    vertices, faces, edges = prism(found)
    mesh = trimesh.Trimesh(vertices * 1e6, faces)
    assert mesh.is_watertight
    assert mesh.volume > 0
    inside = np.column_stack([0.999 * found.corners[:, :2], np.full(8, 0.999 * found.worst[3])])
    normals, origins = mesh.face_normals, mesh.triangles_center
    for point in (*(1e6 * inside), *(-1e6 * inside)):
        assert (((point - origins) * normals).sum(axis=1) <= 1e-6).all()
    assert np.abs(edges[..., 2]).max() == pytest.approx(float(found.worst[3]))
    assert np.hypot(*np.moveaxis(edges[..., :2], -1, 0)).max() == pytest.approx(
        float(found.horizontal)
    )


def test_rings_are_one_standard_deviation() -> None:
    found = drive_errors(GEOMETRY, DriveAccuracy(), POSE)
    rings = rms_rings(found, GEOMETRY)
    root = jacobian(GEOMETRY, POSE)[[0, 1, 3]] * found.accuracy.deviations
    inverse = np.linalg.inv(root @ root.T)
    size = np.einsum("npi,ij,npj->np", rings, inverse, rings)
    np.testing.assert_allclose(size, 1.0, rtol=1e-9)


@pytest.mark.slow
def test_drawn_errors_have_the_scale_that_the_label_states(scene: Scene) -> None:
    scene.draw(layers=["drive_errors"])
    text = scene.nodes["/drive_errors/label"].text
    found = drive_errors(GEOMETRY, DriveAccuracy(), POSE)
    stated = float(text.rpartition("= ")[2].split()[0]) * 1e-6
    lines = np.asarray(scene.nodes["/drive_errors/edges"].points) - np.array(POSE)[[0, 1, 3]]
    drawn = np.hypot(lines[..., 0], lines[..., 1]).max() * stated / BAR
    assert drawn == pytest.approx(float(found.horizontal), rel=1e-3)
    assert np.linalg.norm(lines, axis=-1).max() <= FARTHEST * (1 + 1e-6)


@pytest.mark.slow
def test_the_layer_says_why_there_is_no_bound_and_hides(scene: Scene) -> None:
    angle = singular_rotation(GEOMETRY) - 0.01
    scene.draw((0.0, 0.0, angle, -0.3), layers=["drive_errors"])
    assert "cannot be assembled" in scene.nodes["/drive_errors/label"].text
    assert "/drive_errors/solid" not in scene.nodes
    lift_alone = replace(APPENDIX_4, accuracy=DriveAccuracy(resolution_rotary=0.0))
    scene.draw(design=lift_alone, layers=["drive_errors"])
    assert "/drive_errors/edges" in scene.nodes
    assert "/drive_errors/solid" not in scene.nodes
    perfect = replace(APPENDIX_4, accuracy=DriveAccuracy(0.0, 0.0))
    scene.draw(design=perfect, layers=["drive_errors"])
    assert "no error" in scene.nodes["/drive_errors/label"].text
    scene.draw(layers=[])
    assert not any(name.startswith("/drive_errors/") for name in scene.nodes)
