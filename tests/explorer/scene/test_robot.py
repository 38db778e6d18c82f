"""The robot in a scene: nodes are made once, stand where the model says, and only they move."""

from __future__ import annotations

from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
import viser
from trimesh.transformations import quaternion_matrix

from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.explorer.scene.robot import RobotScene
from paminsa_viz.meshes.placement import BODIES, place_parts
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from tests.explorer.scene.seen import nodes, recorded, solved, world
from tests.samples import random_poses, with_knee


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_bodies_stand_where_the_model_says(server: viser.ViserServer, knee: KneeBranch) -> None:
    robot = RobotScene(server.scene, with_knee(APPENDIX_4, knee))
    for pose in random_poses(np.random.default_rng(4), with_knee(APPENDIX_4, knee), 5):
        configuration = solved(pose, knee=knee)
        assert robot.pose(configuration)
        for body, place in place_parts(configuration).items():
            got = world(server, node_name(body))
            expected = quaternion_matrix(place.wxyz)
            # viser leaves out changes below 1e-5 of a value.
            assert got[:3, 3] == pytest.approx(place.position, abs=3e-5), body
            assert got[:3, :3] == pytest.approx(expected[:3, :3], abs=6e-5), body


def test_a_first_pose_is_exact(server: viser.ViserServer, robot: RobotScene) -> None:
    configuration = solved()
    robot.pose(configuration)
    g = APPENDIX_4.geometry
    for leg in range(3):
        for bar, joint, along in (
            ("b4", 9, 0.0), ("b4", 5, g.coupler_length), ("b8", 9, g.crank_length),
            ("b7", 7, g.short_coupler_length), ("b3", 7, g.crank_length / g.magnification),
        ):  # fmt: skip
            point = world(server, node_name(f"leg{leg + 1}/{bar}")) @ [along, 0.0, 0.0, 1.0]
            assert point[:3] == pytest.approx(configuration.points[joint][leg], abs=1e-12)


def test_posing_makes_no_node_and_sends_poses_only(
    server: viser.ViserServer, robot: RobotScene
) -> None:
    robot.pose(solved())
    before = nodes(server)
    with recorded(server) as messages:
        for pose in random_poses(np.random.default_rng(1), n=20):
            robot.pose(solved(pose))
    after = nodes(server)
    assert list(after) == list(before)
    assert all(after[name] is before[name] for name in before)
    kinds = Counter(type(message).__name__ for message in messages)
    assert set(kinds) == {"SetOrientationMessage", "SetPositionMessage"}
    assert sum(kinds.values()) / 20 <= 30


def test_only_what_the_pose_moves_is_moved(server: viser.ViserServer, robot: RobotScene) -> None:
    robot.pose(solved((0.0, 0.0, 0.0, -0.5)))
    with recorded(server) as messages:
        robot.pose(solved((0.0, 0.0, 0.0, -0.55)))
    # Lifting turns no leg about its axis.
    assert not {m.name for m in messages} & {f"/robot/leg{k}" for k in (1, 2, 3)}
    assert {"/robot/carriage", "/robot/platform"} <= {m.name for m in messages}
    with recorded(server) as messages:
        robot.pose(solved((0.0, 0.0, 0.0, -0.55)))
    assert messages == []


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0, -1.5), (np.nan, 0.0, 0.0, -0.5)])
def test_an_unreachable_pose_leaves_the_robot_standing(
    server: viser.ViserServer, robot: RobotScene, pose: tuple[float, ...]
) -> None:
    good = solved()
    robot.pose(good)
    with recorded(server) as messages:
        assert not robot.pose(solved(pose))
    assert messages == []
    assert robot.configuration is good


def test_a_posture_of_another_robot_is_refused(robot: RobotScene) -> None:
    with pytest.raises(ValueError, match="another robot"):
        robot.pose(solved(knee=KneeBranch.UPPER, pose=(0.0, 0.0, 0.0, 0.4)))
    with pytest.raises(ValueError, match="another robot"):
        robot.pose(solved(design=APPENDIX_4.vary({"geometry.base_radius": 0.36})))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"geometry.platform_radius": 0.12}, {"platform", "ground", "base"}),
        ({"geometry.platform_joint_height": 0.03}, {"platform", "ground", "base"}),
        ({"geometry.arm_length": 0.3}, {"carriage"}),
        ({"geometry.guide_stroke": 0.3}, set()),
        ({"geometry.axis_clearance": 0.05}, set()),
        ({"links.b3": 0.9, "payload.mass": 2.0, "gravity": 1.62}, set()),
    ],
)
def test_a_change_remakes_only_what_it_touches(
    server: viser.ViserServer, robot: RobotScene, change: dict[str, float], expected: set[str]
) -> None:
    robot.pose(solved())
    before = nodes(server)
    design = APPENDIX_4.vary(change)
    with recorded(server) as messages:
        remade = robot.change(design)
    assert set(remade) <= expected
    if expected - {"ground", "base"}:
        assert set(remade) >= expected - {"ground", "base"}
    shapes = {
        m.name for m in messages
        if type(m).__name__ == "SceneNodeUpdateMessage" and "glb_data" in m.updates
    }  # fmt: skip
    named = {"/stage/ground" if b == "ground" else node_name(b) for b in remade}
    assert shapes == named
    # The payload's node is made when there first is one; the rest are the same nodes.
    assert set(nodes(server)) - set(before) <= {"/robot/platform/payload"}
    assert all(nodes(server)[name] is before[name] for name in before)
    assert robot.pose(solved(design=design))


def test_a_longer_bar_changes_its_own_kind_on_every_leg(robot: RobotScene) -> None:
    remade = robot.change(APPENDIX_4.vary({"geometry.crank_length": 0.425}))
    moving = {body for body in remade if body in BODIES}
    assert moving == {f"leg{leg}/{bar}" for leg in (1, 2, 3) for bar in ("b3", "b8")}


def test_the_other_knee_turns_the_machine_over(
    server: viser.ViserServer, robot: RobotScene
) -> None:
    robot.pose(solved())
    count = len(nodes(server))
    remade = robot.change(with_knee(APPENDIX_4, KneeBranch.UPPER))
    assert {"base", "ground", "m1", "m2", "m3", "m4", "carriage"} <= set(remade)
    configuration = solved((0.0, 0.0, 0.0, 0.4), knee=KneeBranch.UPPER)
    assert robot.pose(configuration)
    assert len(nodes(server)) == count
    assert world(server, "/robot/platform")[2, 3] == pytest.approx(0.4)


def test_a_scene_of_a_tab_will_do() -> None:
    """`RobotScene` asks a scene for nothing but to add nodes and set the light."""
    made: list[str] = []

    class Recorder(SimpleNamespace):
        def __getattr__(self, name: str):
            made.append(name)
            return lambda *a, **k: SimpleNamespace(visible=True, cast_shadow=False)

    RobotScene(Recorder(), APPENDIX_4)  # type: ignore[arg-type]
    assert all(name.startswith(("add_", "configure_", "set_")) for name in made)
