"""The bodies in a scene: nodes are made once, at the model's poses, and only what moves is sent."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from trimesh.transformations import quaternion_matrix

from paminsa_viz.dimensions.placement import place_parts
from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.meshes.bodies import body_glb
from paminsa_viz.model.design import APPENDIX_4, Design
from tests.support.samples import random_poses
from tests.support.scene import UPPER, Scene


@pytest.mark.slow
@pytest.mark.parametrize("design", [APPENDIX_4, UPPER], ids=["lower", "upper"])
def test_bodies_are_at_the_models_poses(scene: Scene, design: Design) -> None:
    for pose in random_poses(np.random.default_rng(4), design, 5):
        configuration = scene.draw(pose, design).configuration
        for body, place in place_parts(configuration).items():
            got = scene.world(node_name(body))
            expected = quaternion_matrix(place.wxyz)
            # viser leaves out changes below 1e-5 of a value.
            assert got[:3, 3] == pytest.approx(place.position, abs=3e-5), body
            assert got[:3, :3] == pytest.approx(expected[:3, :3], abs=6e-5), body


def test_first_pose_is_exact(scene: Scene) -> None:
    configuration = scene.draw().configuration
    g = APPENDIX_4.geometry
    for leg in range(3):
        for bar, joint, along in (
            ("b4", 9, 0.0), ("b4", 5, g.coupler_length), ("b8", 9, g.crank_length),
            ("b7", 7, g.short_coupler_length), ("b3", 7, g.crank_length / g.magnification),
        ):  # fmt: skip
            point = scene.world(node_name(f"leg{leg + 1}/{bar}")) @ [along, 0.0, 0.0, 1.0]
            assert point[:3] == pytest.approx(configuration.points[joint][leg], abs=1e-12)


@pytest.mark.slow
def test_pose_makes_no_node_and_sends_poses_only(scene: Scene) -> None:
    scene.draw(layers=["mesh"])
    before = scene.nodes
    with scene.sent() as messages:
        for pose in random_poses(np.random.default_rng(1), n=20):
            scene.draw(pose, layers=["mesh"])
    after = scene.nodes
    assert list(after) == list(before)
    assert all(after[name] is before[name] for name in before)
    kinds = Counter(type(message).__name__ for message in messages)
    assert set(kinds) == {"SetOrientationMessage", "SetPositionMessage"}
    assert sum(kinds.values()) / 20 <= 30


def test_only_bodies_that_move_are_sent(scene: Scene) -> None:
    scene.draw((0.0, 0.0, 0.0, -0.5))
    with scene.sent() as messages:
        scene.draw((0.0, 0.0, 0.0, -0.55))
    # Lifting turns no leg about its axis.
    assert not {m.name for m in messages} & {f"/robot/leg{k}" for k in (1, 2, 3)}
    assert {"/robot/carriage", "/robot/platform"} <= {m.name for m in messages}
    with scene.sent() as messages:
        scene.draw((0.0, 0.0, 0.0, -0.55))
    assert messages == []


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0, -1.5), (np.nan, 0.0, 0.0, -0.5)], ids=str)
def test_pose_without_a_configuration_sends_nothing(scene: Scene, pose: tuple[float, ...]) -> None:
    layers = ["mesh", "labels"]
    scene.draw(layers=layers)
    with scene.sent() as messages:
        scene.draw(pose, layers=layers)
    assert messages == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"geometry.platform_radius": 0.12}, {"platform", "ground", "base"}),
        ({"geometry.platform_joint_height": 0.03}, {"platform", "ground", "base"}),
        ({"geometry.arm_length": 0.3}, {"carriage"}),
        ({"geometry.guide_stroke": 0.3}, {"ground"}),
        ({"geometry.axis_clearance": 0.05}, set()),
        ({"links.b3": 0.9, "payload.mass": 2.0, "gravity": 1.62}, set()),
        ({"geometry.crank_length": 0.425}, {f"leg{i}/{b}" for i in (1, 2, 3) for b in ("b3", "b8")}
         | {"ground", "base", "mast", "m4", "platform", "carriage"}),
    ],
)  # fmt: skip
def test_change_of_the_design_remakes_its_bodies_only(
    scene: Scene, change: dict[str, float], expected: set[str]
) -> None:
    scene.draw()
    before = scene.nodes
    with scene.sent() as messages:
        scene.draw(design=APPENDIX_4.vary(change))
    names = {"/stage/ground" if body == "ground" else node_name(body) for body in expected}
    remade = {
        m.name for m in messages
        if type(m).__name__ == "SceneNodeUpdateMessage" and "glb_data" in m.updates
    }  # fmt: skip
    assert remade <= names
    fixed = {"/stage/ground", *map(node_name, ("base", "mast", "m4", "platform", "carriage"))}
    assert remade >= names - fixed
    # The payload's node is made when there first is one; the rest are the same nodes.
    assert set(scene.nodes) - set(before) <= {"/robot/platform/payload"}
    assert all(scene.nodes[name] is before[name] for name in before)


@pytest.mark.slow
def test_other_knee_remakes_the_frame_upside_down(scene: Scene) -> None:
    layers = ["mesh"]
    scene.draw(layers=layers)
    before = {name: getattr(node, "glb_data", None) for name, node in scene.nodes.items()}
    scene.draw((0.0, 0.0, 0.0, 0.4), UPPER, layers)
    assert set(scene.nodes) == set(before)
    for name in (*map(node_name, ("base", "m1", "m2", "m3", "m4", "carriage")), "/stage/ground"):
        assert scene.nodes[name].glb_data != before[name]
    assert scene.world("/robot/platform")[2, 3] == pytest.approx(0.4)


@pytest.mark.slow
def test_fine_bodies_are_a_layer(scene: Scene) -> None:
    scene.draw()
    bar = scene.nodes["/robot/leg1/slider/b8/b4"]
    plain = bar.glb_data
    scene.draw(layers=["mesh", "fine"])
    assert bar.glb_data == body_glb(APPENDIX_4.geometry, "leg1/b4")
    assert len(bar.glb_data) > 2 * len(plain)
    scene.draw(layers=["mesh"])
    assert bar.glb_data == plain
