"""The posed robot as a file: named bodies, in place, y up."""

from __future__ import annotations

import io
import json
import struct

import numpy as np
import pytest
import trimesh

from paminsa_viz import palette
from paminsa_viz.dimensions.attached import LOAD_DENSITY, PAYLOAD_HEIGHT
from paminsa_viz.dimensions.layout import layout
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.errors import InvalidInput
from paminsa_viz.meshes import assemble_glb
from paminsa_viz.meshes.bodies import STANDING
from paminsa_viz.meshes.part import srgb_to_linear
from paminsa_viz.model.design import APPENDIX_4, Geometry, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics

LOADED = APPENDIX_4.vary({"payload.mass": 8.0})
POSE = (0.05, -0.03, 0.4, -0.6)


def tree(data: bytes) -> dict:
    """The JSON part of a GLB."""
    magic, size, length = struct.unpack("<4s4xII", data[:16])
    assert (magic, size) == (b"glTF", len(data))
    return json.loads(data[20 : 20 + length])


@pytest.fixture(scope="module")
def posed() -> bytes:
    return assemble_glb(LOADED, inverse_kinematics(LOADED.geometry, POSE))


def load(data: bytes) -> trimesh.Scene:
    return trimesh.load_scene(io.BytesIO(data), file_type="glb", process=False)


@pytest.mark.slow
def test_every_body_is_a_named_node(posed: bytes) -> None:
    bare = assemble_glb(APPENDIX_4, inverse_kinematics(APPENDIX_4.geometry, POSE), ground=False)
    names, fewer = ({node["name"] for node in tree(file)["nodes"]} for file in (posed, bare))
    assert {name.replace("/", "_") for name in (*STANDING, *BODIES)} <= names
    assert {"paminsa", "payload"} <= names
    assert not {"ground", "payload"} & fewer


@pytest.mark.slow
def test_bodies_stand_where_the_mechanism_is_with_y_up(posed: bytes) -> None:
    scene = load(posed)
    configuration = inverse_kinematics(LOADED.geometry, POSE)
    for leg in range(3):
        matrix, _ = scene.graph.get(f"leg{leg + 1}_b4")
        x, y, z = configuration.points[9][leg]
        assert matrix[:3, 3] == pytest.approx([x, z, -y], abs=1e-6)
        far = matrix @ [LOADED.geometry.coupler_length, 0.0, 0.0, 1.0]
        x, y, z = configuration.points[5][leg]
        assert far[:3] == pytest.approx([x, z, -y], abs=1e-6)
    assert scene.bounds[0, 1] == pytest.approx(layout(LOADED.geometry).ground - 0.02, abs=1e-6)


@pytest.mark.slow
def test_the_file_carries_pose_and_design(posed: bytes) -> None:
    extras = tree(posed)["scenes"][0]["extras"]
    assert extras["design"] == LOADED.name
    assert extras["knee"] == "lower"
    assert extras["pose"] == dict(zip(("x", "y", "theta", "z"), POSE, strict=True))


def test_legs_have_their_colors(posed: bytes) -> None:
    file = tree(posed)
    for leg, color in enumerate(palette.LEG_COLORS):
        node = next(n for n in file["nodes"] if n["name"] == f"leg{leg + 1}_b8.accent")
        primitive = file["meshes"][node["mesh"]]["primitives"][0]
        factor = file["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
        assert factor[:3] == pytest.approx(srgb_to_linear(color), abs=0.01)


def test_the_payloads_volume_shows_its_mass(posed: bytes) -> None:
    scene = load(posed)
    matrix, geometry = scene.graph.get("payload.load")
    mesh = scene.geometry[geometry].copy()
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    volume = mesh.volume * np.linalg.det(matrix[:3, :3])
    assert volume == pytest.approx(8.0 / LOAD_DENSITY, rel=0.05)
    bounds = mesh.copy().apply_transform(matrix).bounds
    assert bounds[1, 1] - bounds[0, 1] == pytest.approx(2 * PAYLOAD_HEIGHT, rel=1e-3)
    assert bounds[1, 1] < POSE[3]


@pytest.mark.slow
def test_the_upper_knee_carries_its_payload_on_top() -> None:
    design = LOADED.with_knee(KneeBranch.UPPER)
    configuration = inverse_kinematics(design.geometry, (0.0, 0.0, 0.0, 0.4))
    scene = load(assemble_glb(design, configuration))
    matrix, geometry = scene.graph.get("payload.load")
    mesh = scene.geometry[geometry].copy().apply_transform(matrix)
    assert mesh.bounds[0, 1] > 0.4
    assert scene.metadata["knee"] == "upper"


@pytest.mark.parametrize(
    ("geometry", "pose"),
    [
        (APPENDIX_4.geometry, (0.0, 0.0, 0.0, -1.5)),
        (APPENDIX_4.geometry, (np.nan, 0.0, 0.0, -0.5)),
        (APPENDIX_4.geometry, [(0.0, 0.0, 0.0, -0.5)]),
        (Geometry(base_radius=0.36), POSE),
    ],
    ids=["unreachable", "NaN", "batch", "another geometry"],
)
def test_a_configuration_that_cannot_be_drawn_is_refused(geometry, pose) -> None:
    with pytest.raises(InvalidInput) as caught:
        assemble_glb(APPENDIX_4, inverse_kinematics(geometry, pose))
    assert caught.value.argument == "configuration"
