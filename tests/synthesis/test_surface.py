"""Surfaces of volumes, causes on maps, and files of both."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Payload
from paminsa_viz.model.reach import Limit, check_reach
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.synthesis.volume.causes import (
    FIRST_REQUIREMENT,
    CauseKind,
    cause_slice,
    zero_surface,
)
from paminsa_viz.synthesis.volume.grid import COARSE, Resolution
from paminsa_viz.synthesis.volume.margins import Columns, solve_columns
from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
from paminsa_viz.synthesis.volume.surface import (
    VOLUME_FORMATS,
    VolumeSurface,
    cause_color,
    volume_bytes,
    volume_surface,
    volume_table,
)
from tests.synthesis.robots import TURN, needs


@pytest.fixture(scope="module")
def volume() -> Volume:
    requirements = needs("condition <= 10", "max_torque <= 15 N m", "f_4 <= 250 N")
    return solve_volume(APPENDIX_4, requirements, resolution=Resolution(60_000, 9, 5.0))


@pytest.fixture(scope="module")
def surface(volume: Volume) -> VolumeSurface:
    return volume_surface(volume, faces=4_000)


@pytest.mark.slow
def test_surface_is_closed_and_encloses_the_volume(volume: Volume, surface: VolumeSurface) -> None:
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert len(surface.faces) <= 4_000
    assert mesh.is_watertight
    # positive: normals point outward
    assert mesh.volume == pytest.approx(volume.volume, rel=0.01)
    whole = volume_surface(volume, faces=10**9)
    enclosed = trimesh.Trimesh(whole.vertices, whole.faces).volume
    assert enclosed == pytest.approx(volume.volume, rel=0.008)
    assert mesh.volume == pytest.approx(enclosed, rel=3e-4)


@pytest.mark.slow
def test_surface_with_fewer_faces_has_none_back_to_back() -> None:
    """Two faces meet at each edge; merging this volume's edges folds pairs onto each other."""
    resolution = Resolution(30_000, 5, 5.0)
    found = solve_volume(APPENDIX_4, needs("condition <= 25"), resolution=resolution)
    surface = volume_surface(found, faces=1_750)
    pairs = np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, meet = np.unique(pairs, axis=0, return_counts=True)
    assert (meet == 2).all(), np.unique(meet)
    assert len(surface.faces) > 1_740
    np.testing.assert_array_equal(np.unique(surface.faces), np.arange(len(surface.vertices)))


@pytest.mark.slow
def test_surface_of_a_body_that_the_grid_ends_is_closed_there(volume: Volume) -> None:
    middle = volume.inside.shape[0] // 2
    half = {name: getattr(volume, name)[:middle] for name in ("x", "cause", "depth", "nearest")}
    cut = volume_surface(replace(volume, **half), faces=10**9)
    assert trimesh.Trimesh(cut.vertices, cut.faces, process=False).is_watertight
    assert cut.vertices[:, 0].max() <= half["x"][-1] + volume.cell
    whole = volume_surface(volume, faces=10**9)
    kept = whole.vertices[:, 0] < half["x"][-1] - volume.cell
    places, ends = whole.vertices[kept].round(9), cut.vertices.round(9)
    there = {tuple(v): c for v, c in zip(places, whole.cause[kept], strict=True)}
    same = [there[tuple(v)] == c for v, c in zip(ends, cut.cause, strict=True)
            if tuple(v) in there]  # fmt: skip
    assert len(same) > 100
    assert all(same)


@pytest.mark.slow
def test_margin_of_what_cuts_is_zero_at_the_surface(volume: Volume, surface: VolumeSurface) -> None:
    for index in range(3):
        code = next(c.code for c in volume.causes if c.requirement == index)
        points = surface.vertices[surface.cause == code]
        points = points[:: len(points) // 100 + 1]
        assert len(points) > 30
        theta = np.linspace(-TURN, TURN, volume.headings)
        bound = volume.requirements.bounds[index]
        moved = []
        for shift in (-volume.cell, volume.cell):
            direction = points * [1.0, 1.0, 0.0] / np.linalg.norm(points[:, :2], axis=1)[:, None]
            if index == 2:
                direction = np.broadcast_to([0.0, 0.0, 1.0], points.shape)
            shifted = points + shift * direction
            margin = []
            for point in shifted:
                field = solve_columns(
                    APPENDIX_4.geometry, Columns.at(point[None, :2], theta, point[None, 2])
                )
                margin.append(float(bound.margin(bound.entry.over(field, APPENDIX_4)).min()))
            moved.append(np.array(margin))
        with np.errstate(invalid="ignore"):
            # what cuts holds on one side of the surface, and breaks on the other
            crossed = moved[0] * moved[1] < 0.0
        assert crossed[np.isfinite(moved[0] * moved[1])].mean() > 0.9


def test_parts_by_cause_are_the_whole(surface: VolumeSurface) -> None:
    parts = surface.parts()
    assert sum(len(faces) for _, faces in parts.values()) == len(surface.faces)
    assert {cause.kind for cause in parts} >= {CauseKind.REQUIREMENT, CauseKind.REACH}
    assert CauseKind.INSIDE not in {cause.kind for cause in parts}
    assert [cause.code for cause in parts] == sorted(cause.code for cause in parts)
    colors = {cause_color(cause) for cause in parts if cause.requirement is not None}
    assert len(colors) == 3


@pytest.mark.parametrize("kind", ["stl", "glb"])
def test_files_hold_the_same_surface(volume: Volume, kind: str) -> None:
    loaded = trimesh.load(io.BytesIO(volume_bytes(volume, kind)), file_type=kind)
    if kind == "stl":
        mesh = loaded
        assert mesh.volume == pytest.approx(1e9 * volume.volume, rel=0.01)
        assert mesh.bounds[0][2] < -500.0
    else:
        mesh = loaded.to_geometry()
        assert mesh.volume == pytest.approx(volume.volume, rel=0.01)
        assert mesh.bounds[0][1] < -0.5  # y is up
        assert any("condition" in name for name in loaded.geometry)


def test_table_has_a_row_a_node_that_can_be_reached(volume: Volume) -> None:
    table = volume_table(volume)
    rows = len(table.columns["x_m"])
    assert volume.reachable.sum() < rows < volume.cause.size
    assert np.isfinite(table.columns["margin1_condition"]).sum() == volume.reachable.sum()
    assert table.arrays is not None
    assert table.arrays["cause"].shape == volume.cause.shape
    assert list(table.columns)[:5] == ["x_m", "y_m", "z_m", "cause", "depth_m"]
    assert "margin2_max_torque_Nm" in table.columns
    assert (table.columns["cause"] == "inside").sum() == volume.inside.sum()
    assert table.provenance["requirement 1"] == "condition <= 10"
    assert float(table.provenance["volume [m^3]"]) == volume.volume
    # lengths to a nanometer, distances to a tenth of a micrometer
    for axis in ("x", "y", "z"):
        nodes = np.round(getattr(volume, axis), 9)
        assert set(table.columns[f"{axis}_m"]) <= set(nodes)
    depth = np.round(volume.depth[volume.inside], 7)
    own = table.columns["depth_m"][table.columns["cause"] == "inside"]
    np.testing.assert_array_equal(own, depth)
    stated = {name: value for name, value in table.provenance.items() if name.startswith("design ")}
    assert float(stated["design geometry.base_radius [m]"]) == 0.35
    assert float(stated["design geometry.magnification"]) == 3.0


@pytest.mark.parametrize("kind", VOLUME_FORMATS)
def test_equal_volumes_give_equal_files(kind: str) -> None:
    small = solve_volume(APPENDIX_4, needs("condition <= 5"), resolution=COARSE)
    again = solve_volume(APPENDIX_4, needs("condition <= 5"), resolution=COARSE)
    if kind != "npz":  # its archive names the time
        assert volume_bytes(small, kind) == volume_bytes(again, kind)
    assert volume_bytes(small, kind)


def test_empty_volume_has_no_surface_to_write() -> None:
    empty = solve_volume(APPENDIX_4, needs("condition <= 1"), resolution=COARSE)
    none = volume_surface(empty)
    assert (none.vertices.shape, none.faces.shape, none.cause.shape) == ((0, 3), (0, 3), (0,))
    with pytest.raises(InvalidInput, match="empty"):
        volume_bytes(empty, "stl")
    assert volume_bytes(empty, "csv")
    with pytest.raises(InvalidInput, match="stl, glb"):
        volume_bytes(empty, "obj")


X = np.linspace(-0.35, 0.35, 36)
Y = np.linspace(-0.35, 0.35, 31)


@pytest.mark.parametrize(("theta", "z"), [(0.0, -0.5), (0.4, -0.85), (-0.3, -0.2)])
def test_causes_are_those_of_each_pose(theta: float, z: float) -> None:
    found = cause_slice(APPENDIX_4, needs("condition <= 6", "max_torque <= 8 N m"), X, Y, theta, z)
    poses = np.empty((len(Y), len(X), 4))
    poses[..., 0], poses[..., 1] = X, Y[:, None]
    poses[..., 2], poses[..., 3] = theta, z
    reach = check_reach(APPENDIX_4.geometry, poses)
    singular = measure_singularity(APPENDIX_4.geometry, poses)
    torque = np.abs(static_torques(APPENDIX_4, poses)[..., :3]).max(axis=-1)
    kinds = np.array([cause.kind for cause in found.causes])[found.cause]
    np.testing.assert_array_equal(kinds == CauseKind.REACH, ~reach.ok)
    legs = np.array([-1 if c.leg is None else c.leg for c in found.causes])[found.cause]
    np.testing.assert_array_equal(legs, reach.leg)
    for code in np.unique(found.cause[kinds == CauseKind.REACH]):
        limit = {int(s) for s in reach.status[found.cause == code]}
        word = found.causes[code].word.partition(":")[0]
        assert {Limit(s).word for s in limit} == {word}
    beyond = reach.ok & (singular.position_distance <= 0.0)
    np.testing.assert_array_equal(kinds == CauseKind.SINGULAR, beyond)
    rest = reach.ok & ~beyond
    with np.errstate(invalid="ignore"):
        np.testing.assert_array_equal(found.broken[0][rest], singular.condition[rest] > 6.0)
        np.testing.assert_array_equal(found.broken[1][rest], torque[rest] > 8.0)
    np.testing.assert_array_equal(kinds[rest] == CauseKind.INSIDE, ~found.broken.any(axis=0)[rest])


@pytest.mark.slow
def test_a_requirement_without_a_value_is_broken_and_the_worst() -> None:
    bare = replace(APPENDIX_4, payload=Payload())
    found = cause_slice(
        bare, needs("condition <= 1.5", "clearance_payload >= 1 mm"), X, Y, 0.0, -0.5
    )
    poses = np.stack(np.broadcast_arrays(X, Y[:, None], 0.0, -0.5), axis=-1)
    reach = check_reach(bare.geometry, poses).ok
    np.testing.assert_array_equal(found.broken[1], reach)
    assert found.broken[0].any()
    named = found.cause[reach & (found.cause >= FIRST_REQUIREMENT)]
    assert len(named) > 100
    assert (named == FIRST_REQUIREMENT + 1).all()


def test_a_surface_is_where_the_depth_is_zero_and_closed_at_the_edge() -> None:
    """A ball inside the nodes, and one that they cut off."""
    x, y, z = np.meshgrid(*[np.arange(13.0)] * 3, indexing="ij")
    for middle in ((6.0, 5.0, 6.5), (1.0, 5.0, 6.5)):
        away = np.linalg.norm(np.stack([x, y, z], axis=-1) - middle, axis=-1)
        vertices, faces = zero_surface(4.0 - away)
        radius = np.linalg.norm(vertices - middle, axis=1)
        inner = (vertices > 0.01).all(axis=1)
        assert radius[inner] == pytest.approx(4.0, abs=0.05)
        assert inner.all() == (middle[0] > 4.0)
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        assert mesh.is_watertight
        assert mesh.volume > 0.0


def test_a_surface_is_closed_whatever_the_depths_and_through_nodes_too() -> None:
    rng = np.random.default_rng(1)
    for digits in (1, 16):
        depth = np.round(rng.normal(size=(20, 20, 20)), digits)
        vertices, faces = zero_surface(depth)
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        assert mesh.is_watertight, digits
        assert mesh.is_winding_consistent, digits
        on_an_edge = (vertices == np.round(vertices)).sum(axis=1) >= 2
        assert on_an_edge.all(), digits


def test_worst_of_two_requirements_is_named() -> None:
    found = cause_slice(APPENDIX_4, needs("condition <= 100", "condition <= 2"), X, Y, 0.0, -0.5)
    only = found.broken[1] & ~found.broken[0]
    assert (found.cause[only & (found.cause >= FIRST_REQUIREMENT)] == FIRST_REQUIREMENT + 1).all()


def test_requirement_of_other_headings_or_heights_does_not_count() -> None:
    at = (X, Y, 0.4, -0.5)
    assert not cause_slice(APPENDIX_4, needs("condition <= 1 for theta 0..20"), *at).broken.any()
    assert not cause_slice(APPENDIX_4, needs("condition <= 1 for z -900..-600"), *at).broken.any()
    assert cause_slice(APPENDIX_4, needs("condition <= 1 for z -900..-500"), *at).broken.any()


def test_areas_of_the_causes_are_those_of_their_faces(surface: VolumeSurface) -> None:
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    areas = surface.areas()
    assert sum(areas.values()) == pytest.approx(mesh.area, rel=1e-9)
    assert list(areas.values()) == sorted(areas.values(), reverse=True)
    assert len(areas) > 2
    for code in np.unique(surface.face_cause):
        own = mesh.area_faces[surface.face_cause == code].sum()
        assert areas[surface.causes[code]] == pytest.approx(own, rel=1e-9)
    cause = surface.cause[surface.faces]
    for face, own in zip(cause[::50], surface.face_cause[::50], strict=True):
        values, counts = np.unique(face, return_counts=True)
        assert own == (values[counts.argmax()] if counts.max() > 1 else face[0])
