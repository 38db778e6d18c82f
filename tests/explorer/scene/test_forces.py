"""The load and the forces that are held, drawn to a stated scale."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.actuation.polytope import wrench_polytope
from paminsa_viz.actuation.wrench_capability import capability
from paminsa_viz.explorer.scene.actuators import arc_arrow
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.forces import (
    BAR,
    FARTHEST,
    load_arrow,
    load_arrows,
    played_load,
    round_scale,
    scale_text,
)
from paminsa_viz.explorer.scene.nodes import LayerView
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.model import APPENDIX_4, LoadCase, LoadFrame
from paminsa_viz.trajectory import PRESET, analyze
from tests.support.scene import POSE, Scene, frame_at

LOADED = replace(APPENDIX_4, load=LoadCase(30.0, 0.0, -40.0, moment_z=5.0, point_x=0.05))


def test_scale_is_stated_of_a_length_beside_the_robots() -> None:
    """Of a robot of 14 mm it was 100 mm = 0.2 N at an arrow of 10 mm."""
    texts = [scale_text(0.2, 0.04), scale_text(50.0, 1.0), scale_text(500.0, 20.0)]
    assert texts == ["10 mm = 0.02 N", "100 mm = 50 N", "1000 mm = 5000 N"]
    assert scale_text(20.0, 0.5, "µm") == "100 mm = 20 µm"


@given(largest=st.floats(1e-6, 1e6), longest=st.floats(0.05, 2.0))
def test_scale_is_a_round_number_that_fits(largest: float, longest: float) -> None:
    scale = round_scale(largest, longest)
    assert largest * BAR / scale <= longest * (1 + 1e-9)
    assert largest * BAR / scale > longest / 2.6
    assert f"{scale:.0e}"[0] in "125"


def test_arrow_has_the_length_that_its_label_states(scene: Scene) -> None:
    arrow, scale = load_arrow(LOADED, np.array(POSE))
    assert np.linalg.norm(arrow[0, 1] - arrow[0, 0]) == pytest.approx(50.0 * BAR / scale)
    np.testing.assert_allclose((arrow[0, 1] - arrow[0, 0]) * scale / BAR, [30, 0, -40], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(arrow[0, 0] - np.array(POSE)[[0, 1, 3]]), 0.05)
    scene.draw(design=LOADED, layers=["load"])
    text = scene.nodes["/load/label"].text
    assert scale_text(scale, 1.0) in text
    assert "moment 5 N·m about z" in text
    turned = replace(LOADED, load=replace(LOADED.load, frame=LoadFrame.PLATFORM))
    force = np.diff(load_arrow(turned, np.array(POSE))[0][0], axis=0)[0]
    assert np.degrees(np.arctan2(force[1], force[0])) == pytest.approx(np.degrees(POSE[2]))


@pytest.mark.parametrize(
    ("moment", "full"), [(0.03, "0.05"), (4.0, "5"), (20.0, "20"), (730, "1000")]
)
def test_full_arc_suits_the_moment_and_is_stated(scene: Scene, moment: float, full: str) -> None:
    scene.draw(design=replace(APPENDIX_4, load=LoadCase(moment_z=moment)), layers=["load"])
    assert f"(full arc {full} N·m)" in scene.nodes["/load/label"].text
    arc = arc_arrow(moment / float(full))
    np.testing.assert_allclose(scene.nodes["/load/moment"].vertices, arc, atol=1e-6)


def test_no_load_draws_nothing(scene: Scene) -> None:
    scene.draw(layers=["load"])
    assert "/load/force" not in scene.nodes
    scene.draw(design=LOADED, layers=["load"])
    assert scene.shown >= {"/load/force", "/load/moment"}
    scene.draw(layers=["load"])
    assert not [name for name in scene.shown if name.startswith("/load/")]


def test_polygon_and_solid_are_the_polytopes(scene: Scene) -> None:
    pose = (0.02, -0.01, 0.2, -0.55)
    scene.draw(pose, LOADED, ["force_polygon", "wrench_solid"])
    found = wrench_polytope(LOADED, pose)
    lines = np.asarray(scene.nodes["/forces/polygon"].points)
    middle = np.array(pose)[[0, 1, 3]]
    size = np.linalg.norm((lines - middle)[..., :2], axis=-1).max()
    polygon = found.section()
    scale = np.linalg.norm(polygon, axis=1).max() / size
    np.testing.assert_allclose((lines[:, 0] - middle)[:, :2] * scale, polygon, rtol=1e-3, atol=0.1)
    radius = float(capability(LOADED, pose).horizontal_force)
    assert f"{radius:.3g} N" in scene.nodes["/forces/polygon label"].text
    solid = np.asarray(scene.nodes["/forces/solid"].vertices) - middle
    assert np.linalg.norm(solid, axis=1).max() <= FARTHEST * 1.001
    ratio = solid / (found.vertices / [1, 1, found.length])
    np.testing.assert_allclose(ratio, ratio[0, 0], rtol=1e-3)
    text = scene.nodes["/forces/solid label"].text
    assert found.faces[found.limiting_face] in text
    assert "_" not in text  # a label has no subscripts
    scene.draw(pose, LOADED, [])
    assert not [name for name in scene.nodes if name.startswith("/forces/")]


def test_arrow_of_a_played_motion_is_its_load_at_the_time() -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(50)
    swing = np.zeros((motion.size, 6))
    swing[:, 1] = np.linspace(0.0, 120.0, motion.size)
    motion = replace(motion, load=swing)
    load, (largest, moment) = played_load(LOADED.load, motion, motion.duration / 2)
    assert load.wrench == pytest.approx((30.0, 60.0, -40.0, 0.0, 0.0, 5.0))
    assert largest == pytest.approx(130.0)
    assert moment == pytest.approx(5.0)
    assert load_arrow(replace(LOADED, load=load), np.array(POSE), largest)[1] == 50.0
    assert played_load(LOADED.load, replace(motion, load=None), 0.1) == (LOADED.load, (0.0, 0.0))


def test_a_played_motion_moves_the_arrow(server: viser.ViserServer) -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(50)
    pushed = np.tile([0.0, 80.0, 0.0, 0.0, 0.0, 0.0], (motion.size, 1))
    analysis = analyze(APPENDIX_4, replace(motion, load=pushed))
    motions: Any = SimpleNamespace(analysis=lambda state: analysis)
    view = LayerView(LAYERS["load"], load_arrows, SceneContext(server.scene))
    frame = frame_at(layers=["load"])
    view.draw(frame, False)
    nodes = server.scene._handle_from_node_name
    assert "/load/force" not in nodes
    playing = frame.state.updated("playback", following=True, time=0.1)
    view.draw(replace(frame, state=playing, motions=motions), False)
    assert nodes["/load/force"].visible
    assert nodes["/load/label"].text.startswith("80 N")
