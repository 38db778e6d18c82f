"""Modes, deflection and compliance in the scene, and the animation that the browser plays."""

from __future__ import annotations

import io
import json
import struct
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.explorer.features.stiffness.layers import (
    LARGEST,
    LONGEST_AXIS,
    LONGEST_SWING,
    MODE_NODE,
    ellipsoid_text,
)
from paminsa_viz.explorer.features.stiffness.solving import analyze_elasticity
from paminsa_viz.explorer.scene.forces import BAR, round_scale
from paminsa_viz.explorer.scene.nodes import ball
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.stiffness import ElasticJob, ElasticOutcome
from paminsa_viz.meshes.vibrating import KEYS, SIDES, vibrating_glb
from paminsa_viz.model import APPENDIX_4
from tests.support.scene import POSE, Scene, frame_at

LAYERS = ("mode_shape", "deflection", "compliance")


@pytest.fixture(scope="module")
def outcome() -> ElasticOutcome:
    return solve(analyze_elasticity, ElasticJob(APPENDIX_4, POSE, "x"))


@pytest.mark.slow
def test_layers_show_the_result_and_leave_with_the_pose(
    scene: Scene, outcome: ElasticOutcome
) -> None:
    shown = frame_at(POSE, layers=LAYERS).state.updated("stiffness", outcome=outcome)
    scene.show(shown)
    assert MODE_NODE in scene.nodes
    assert "mode 1" in scene.nodes["/elastic/mode_label"].text
    assert f"{outcome.result.frequencies[0]:.3g} Hz" in scene.nodes["/elastic/mode_label"].text
    for name in ("deflected", "ellipsoid"):
        assert scene.nodes[f"/elastic/{name}"].visible
    moved = frame_at((0.0, 0.0, 0.0, -0.5), layers=LAYERS).state
    scene.show(moved.updated("stiffness", outcome=outcome), dragging=True)
    assert MODE_NODE not in scene.nodes
    for name in ("deflected", "ellipsoid"):
        assert f"/elastic/{name}" not in scene.shown
    scene.show(replace(shown, layers=frozenset()))
    assert MODE_NODE not in scene.nodes


@pytest.mark.slow
def test_a_new_animation_waits_until_nothing_is_dragged(
    scene: Scene, outcome: ElasticOutcome
) -> None:
    state = frame_at(POSE, layers=LAYERS).state.updated("stiffness", outcome=outcome)
    scene.show(state)
    before = scene.nodes[MODE_NODE].glb_data
    scene.show(state, dragging=True)
    assert scene.nodes[MODE_NODE].glb_data == before
    other = state.updated("stiffness.settings", mode=1)
    scene.show(other, dragging=True)
    assert MODE_NODE not in scene.nodes
    scene.show(other)
    assert scene.nodes[MODE_NODE].glb_data != before
    assert "mode 2" in scene.nodes["/elastic/mode_label"].text


@pytest.mark.slow
def test_ellipsoid_is_where_a_force_of_one_size_moves_the_platform(
    scene: Scene, outcome: ElasticOutcome
) -> None:
    scene.show(frame_at(POSE, layers=LAYERS).state.updated("stiffness", outcome=outcome))
    vertices = np.asarray(scene.nodes["/elastic/ellipsoid"].vertices, float)
    scale = BAR / round_scale(
        float(platform_stiffness(APPENDIX_4, POSE).ellipsoid()[0][-1]), LONGEST_AXIS
    )
    sphere = ball(1.0).vertices
    expected = scale * platform_stiffness(APPENDIX_4, POSE).deflection(
        np.concatenate([sphere, np.zeros_like(sphere)], axis=1)
    )
    assert vertices == pytest.approx(expected[:, :3], abs=1e-6)
    text = scene.nodes["/elastic/ellipsoid_label"].text
    assert text == f"compliance: 100 mm = {1e4 / scale:.3g} mm by 100 N"
    small = ellipsoid_text(scale, 0.01)  # whose lengths are some millimeters
    assert small == f"compliance: 1 mm = {1e2 / scale:.3g} mm by 100 N"
    assert np.linalg.norm(vertices, axis=1).max() <= LONGEST_AXIS


def test_deflection_is_drawn_to_its_scale(scene: Scene, outcome: ElasticOutcome) -> None:
    scene.show(frame_at(POSE, layers=LAYERS).state.updated("stiffness", outcome=outcome))
    lines = outcome.result.deflected
    assert lines is not None
    scale = BAR / round_scale(float(lines.largest[0]), LARGEST)
    assert f"× {scale:g}" in scene.nodes["/elastic/deflected_label"].text
    center = lines.names.index("platform")
    rest = np.array(POSE)[[0, 1, 3]]
    move = platform_stiffness(APPENDIX_4, POSE).deflection([100.0, 0, 0, 0, 0, 0])[:3]
    assert lines.points[center, 0] == pytest.approx(rest, abs=1e-12)
    assert lines.moves[center, 0, :, 0] == pytest.approx(move, rel=1e-9)


def parts(data: bytes) -> tuple[dict, list[np.ndarray]]:
    """The JSON of a GLB and its accessors as arrays."""
    length = struct.unpack_from("<I", data, 12)[0]
    tree = json.loads(data[20 : 20 + length])
    blob = data[28 + length :]
    arrays = []
    for accessor in tree["accessors"]:
        view = tree["bufferViews"][accessor["bufferView"]]
        kind = "<u4" if accessor["componentType"] == 5125 else "<f4"
        piece = blob[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        arrays.append(np.frombuffer(piece, kind))
        assert len(arrays[-1]) == accessor["count"] * (3 if accessor["type"] == "VEC3" else 1)
    return tree, arrays


def test_glb_swings_by_the_displacements(outcome: ElasticOutcome) -> None:
    lines = outcome.result.shapes
    assert lines is not None
    moves = lines.moves[..., 0] * LONGEST_SWING / lines.largest[0]
    data = vibrating_glb(lines.points, moves, radius=0.005, color="#CC79A7", period=1.5)
    tree, (rest, delta, faces, times, weights) = parts(data)
    assert struct.unpack_from("<I", data, 8)[0] == len(data)
    shape = (*lines.points.shape[:2], SIDES, 3)
    assert rest.reshape(shape).mean(axis=2) == pytest.approx(lines.points, abs=1e-6)
    radii = np.linalg.norm(rest.reshape(shape) - lines.points[:, :, None], axis=-1)
    assert radii == pytest.approx(np.full_like(radii, 0.005), abs=1e-6)
    assert delta.reshape(shape)[:, :, 3] == pytest.approx(moves, abs=1e-6)
    assert np.linalg.norm(delta.reshape(-1, 3), axis=1).max() == pytest.approx(LONGEST_SWING)
    assert faces.max() == len(rest) // 3 - 1
    assert (times[0], times[-1], len(times)) == (0.0, 1.5, KEYS)
    assert weights == pytest.approx(np.sin(2 * np.pi * times / 1.5), abs=1e-6)
    assert tree["meshes"][0]["primitives"][0]["targets"] == [{"POSITION": 1}]
    mesh = trimesh.load_scene(io.BytesIO(data), file_type="glb").to_geometry()
    assert len(mesh.faces) == 2 * SIDES * (shape[1] - 1) * shape[0]
