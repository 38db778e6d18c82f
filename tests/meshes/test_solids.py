"""Solids are closed, of the right size, and keep their edges."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from paminsa_viz.meshes import solids


def closed(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Join the corners that shading split, and require a closed surface facing outward."""
    whole = mesh.copy()
    whole.merge_vertices(merge_norm=True, merge_tex=True)
    assert whole.is_watertight
    assert whole.volume > 0
    return whole


BEAM = (0.04 * 0.06 + 4 * 0.03 * 0.045 + 0.02 * 0.03) / 6 * 0.4


@pytest.mark.parametrize(
    ("solid", "volume", "tolerance", "bounds"),
    [
        (solids.rod(0.02, -0.1, 0.3, 1e-4, 200), np.pi * 0.02**2 * 0.4, 1e-3, (-0.1, 0.3)),
        (solids.tube(0.01, 0.02, 0.0, 0.1, 1e-4, 200), np.pi * 3e-4 * 0.1, 1e-3, (0.0, 0.1)),
        (solids.box((0.1, 0.2, 0.3), (1.0, 2.0, 3.0), 0.0), 0.006, 1e-9, (2.85, 3.15)),
        (solids.box((0.1, 0.2, 0.3), (1.0, 2.0, 3.0), 0.002), 0.006, 1e-2, (2.85, 3.15)),
        (
            solids.beam(0.1, 0.5, (0.04, 0.06), (0.02, 0.03), 1e-6, 1e-5), BEAM, 1e-2,
            (-0.03, 0.03),
        ),
        (
            solids.revolve([(0.0, 0.0), (0.1, 0.0), (0.0, 0.3)], 180), np.pi * 1e-3, 1e-3,
            (0.0, 0.3),
        ),
    ],
    ids=["rod", "tube", "sharp box", "box", "beam", "cone"],
)  # fmt: skip
def test_a_solid_is_closed_and_has_its_volume_and_height(solid, volume, tolerance, bounds) -> None:
    whole = closed(solid)
    assert whole.volume == pytest.approx(volume, rel=tolerance)
    assert whole.bounds[:, 2] == pytest.approx(bounds)


def test_a_piece_of_a_ring_spans_its_angle() -> None:
    piece = closed(solids.arc_beam(0.3, 0.02, 0.0, 0.01, 0.2, 1.2, chamfer=1e-6))
    assert piece.volume == pytest.approx(0.3 * 1.0 * 0.02 * 0.01, rel=5e-3)
    angle = np.arctan2(piece.vertices[:, 1], piece.vertices[:, 0])
    assert (angle.min(), angle.max()) == pytest.approx((0.2, 1.2))


def test_the_outline_around_circles_runs_at_their_radius() -> None:
    corners = np.array([[0.1, 0.0], [-0.05, 0.08], [-0.05, -0.08]])
    rounded = solids.rounded_polygon(corners, 0.02, 0.0, 10)
    outline = rounded[:, :2]
    nearest = np.linalg.norm(outline[:, None] - corners, axis=2).min(axis=1)
    assert nearest == pytest.approx(np.full(len(outline), 0.02))
    plate = closed(solids.prism(rounded, 0.0, 0.01, 0.001, steps=3))
    assert plate.extents[2] == pytest.approx(0.01)


def test_sharp_edges_stay_sharp_and_round_sides_smooth() -> None:
    rod = solids.rod(0.02, 0.0, 0.1, chamfer=0.0005, segments=32)
    normals = np.asarray(rod.vertex_normals)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)), abs=1e-5)
    side = np.isclose(np.hypot(*rod.vertices[:, :2].T), 0.02, atol=1e-9)
    level = side & (np.abs(normals[:, 2]) < 1e-3)
    # On the side the normals are radial: the 32 facets do not show.
    radial = rod.vertices[level, :2] / 0.02
    assert level.sum() >= 64
    assert np.abs(normals[level, :2] - radial).max() < 0.01
    # The caps are flat: somewhere a corner carries the cap's own normal.
    assert np.isclose(np.abs(normals[:, 2]), 1.0, atol=1e-6).sum() >= 64


def test_large_flat_sides_are_shaded_flat_next_to_round_corners() -> None:
    plate = solids.prism(solids.rounded_rectangle(0.2, 0.1, 0.02, steps=4), 0.0, 0.1, 0.001)
    large = plate.area_faces > 0.05 * plate.area
    assert large.sum() >= 4
    corners = plate.vertex_normals[plate.faces[large]]
    assert corners == pytest.approx(np.repeat(plate.face_normals[large][:, None], 3, axis=1))


def test_rings_lie_around_their_radii_and_face_up() -> None:
    radii, width = np.array([0.2, 0.4]), 0.01
    rings = solids.flat_rings(radii, width, 0.3, 600)
    assert rings.area == pytest.approx(2 * np.pi * radii.sum() * width, rel=1e-4)
    assert rings.face_normals == pytest.approx(np.tile([0.0, 0.0, 1.0], (len(rings.faces), 1)))
    assert set(rings.vertices[:, 2]) == {0.3}
    found = np.unique(np.hypot(*rings.vertices[:, :2].T).round(9))
    assert found == pytest.approx([0.195, 0.205, 0.395, 0.405])


def test_turning_keeps_normals_with_the_faces() -> None:
    rotation = solids.turn("x", 0.7) @ solids.turn("z", 0.3)
    box = solids.box((0.1, 0.2, 0.3))
    turned = solids.moved(box, (0.5, 0.0, 0.0), rotation)
    assert turned.vertices == pytest.approx(box.vertices @ rotation.T + [0.5, 0.0, 0.0])
    assert turned.vertex_normals == pytest.approx(box.vertex_normals @ rotation.T)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


def test_a_plain_solid_is_made_once_from_the_same_numbers_and_alike_every_time() -> None:
    def made(height: float) -> list[trimesh.Trimesh]:
        loops = [solids.rounded_rectangle(0.1, 0.2, 0.01, z) for z in (0.0, height)]
        return [
            solids.rod(0.01, 0.0, height), solids.loft(loops), solids.box((0.1, 0.2, height))
        ]  # fmt: skip

    with solids.plain_shapes():
        first, again, other = made(0.3), made(0.3), made(0.4)
    with solids.plain_shapes():
        alone = made(0.4)
    assert first[:2] == again[:2]  # the same objects; a box is a moved copy
    for one, same, changed in zip(other, alone, first, strict=True):
        np.testing.assert_array_equal(one.vertices, same.vertices)
        np.testing.assert_array_equal(one.faces, same.faces)
        np.testing.assert_array_equal(one.vertex_normals, same.vertex_normals)
        assert one.bounds[1, 2] != changed.bounds[1, 2]
    assert made(0.3)[0] is not first[0]  # nothing is kept outside
