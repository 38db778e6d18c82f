"""The robot in a scene: nodes are made once, stand where the model says, and only they move."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import viser
from trimesh.transformations import quaternion_matrix

from paminsa_viz.explorer.page import has_graphics_card
from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.explorer.scene.cameras import VIEWS, preset
from paminsa_viz.explorer.scene.curves import Curve, circle, dashes, segments
from paminsa_viz.explorer.scene.efforts import FACES, arc_arrow, force_arrow
from paminsa_viz.explorer.scene.masses import gravity_arrows, mass_centres
from paminsa_viz.explorer.scene.robot import SHOWN_AT_START, Layer, RobotScene
from paminsa_viz.explorer.scene.skeleton import sticks
from paminsa_viz.model.counterweight import Counterweight
from paminsa_viz.model.design import APPENDIX_4, Assembly
from paminsa_viz.model.kinematics import solve_posture
from paminsa_viz.model.leg_points import counterweight_point
from paminsa_viz.model.lumped import lumped_coefficients
from paminsa_viz.shapes.bodies import body_glb
from paminsa_viz.shapes.placement import BODIES, place_parts
from tests.samples import random_poses

POSE = (0.05, -0.03, 0.4, -0.6)


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    running = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield running
    running.stop()


@pytest.fixture
def robot(server: viser.ViserServer) -> RobotScene:
    return RobotScene(server.scene, APPENDIX_4)


def solved(pose=POSE, design=APPENDIX_4, assembly=Assembly.PRINTED):
    return solve_posture(design.geometry, pose, assembly)


def nodes(server: viser.ViserServer) -> dict[str, object]:
    return dict(server.scene._handle_from_node_name)


@contextmanager
def recorded(server: viser.ViserServer) -> Iterator[list]:
    """Collect the messages that are queued for the browser."""
    seen: list = []
    queue = server.scene._queue_scene_message

    def record(message, *rest, **more):
        seen.append(message)
        return queue(message, *rest, **more)

    server.scene._queue_scene_message = record  # type: ignore[method-assign]
    try:
        yield seen
    finally:
        del server.scene._queue_scene_message


def world(server: viser.ViserServer, name: str) -> np.ndarray:
    """The node's transform in the world, composed from its parents' as the browser does."""
    out = np.eye(4)
    parts = name.strip("/").split("/")
    for depth in range(1, len(parts) + 1):
        node = server.scene._handle_from_node_name["/" + "/".join(parts[:depth])]
        local = quaternion_matrix(node.wxyz)
        local[:3, 3] = node.position
        out = out @ local
    return out


@pytest.mark.parametrize("assembly", list(Assembly))
def test_bodies_stand_where_the_model_says(server: viser.ViserServer, assembly: Assembly) -> None:
    robot = RobotScene(server.scene, APPENDIX_4, assembly)
    for pose in random_poses(np.random.default_rng(4), APPENDIX_4, assembly, 5):
        posture = solved(pose, assembly=assembly)
        assert robot.pose(posture)
        for body, place in place_parts(posture).items():
            got = world(server, node_name(body))
            expected = quaternion_matrix(place.wxyz)
            # viser leaves out changes below 1e-5 of a value.
            assert got[:3, 3] == pytest.approx(place.position, abs=3e-5), body
            assert got[:3, :3] == pytest.approx(expected[:3, :3], abs=6e-5), body


def test_a_first_pose_is_exact(server: viser.ViserServer, robot: RobotScene) -> None:
    posture = solved()
    robot.pose(posture)
    g = APPENDIX_4.geometry
    for leg in range(3):
        for bar, joint, along in (
            ("b4", 9, 0.0), ("b4", 5, g.coupler_length), ("b8", 9, g.crank_length),
            ("b7", 7, g.short_coupler_length), ("b3", 7, g.crank_length / g.magnification),
        ):  # fmt: skip
            point = world(server, node_name(f"leg{leg + 1}/{bar}")) @ [along, 0.0, 0.0, 1.0]
            assert point[:3] == pytest.approx(posture.points[joint][leg], abs=1e-12)


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
    assert robot.posture is good


def test_a_posture_of_another_robot_is_refused(robot: RobotScene) -> None:
    with pytest.raises(ValueError, match="another robot"):
        robot.pose(solved(assembly=Assembly.MIRROR, pose=(0.0, 0.0, 0.0, 0.4)))
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


def test_the_other_assembly_turns_the_machine_over(
    server: viser.ViserServer, robot: RobotScene
) -> None:
    robot.pose(solved())
    count = len(nodes(server))
    remade = robot.change(APPENDIX_4, Assembly.MIRROR)
    assert {"base", "ground", "m1", "m2", "m3", "m4", "carriage"} <= set(remade)
    posture = solved((0.0, 0.0, 0.0, 0.4), assembly=Assembly.MIRROR)
    assert robot.pose(posture)
    assert len(nodes(server)) == count
    assert world(server, "/robot/platform")[2, 3] == pytest.approx(0.4)


def test_the_payload_shows_its_mass(server: viser.ViserServer, robot: RobotScene) -> None:
    assert "/robot/platform/payload" not in nodes(server)
    robot.change(APPENDIX_4.vary({"payload.mass": 1.0}))
    one = nodes(server)["/robot/platform/payload"].scale
    robot.change(APPENDIX_4.vary({"payload.mass": 8.0}))
    load = nodes(server)["/robot/platform/payload"]
    assert load.scale == pytest.approx(2 * one)
    assert load.visible
    robot.change(APPENDIX_4)
    assert not load.visible


def test_layers_switch_on_and_off(server: viser.ViserServer, robot: RobotScene) -> None:
    assert {layer for layer in Layer if robot.shown(layer)} == SHOWN_AT_START
    robot.pose(solved())
    robot.efforts([1.0, -0.5, 0.2, 120.0], 2.0, 200.0)
    for layer in Layer:
        robot.show(layer)
        assert robot.shown(layer)
    first = set(nodes(server))
    for layer in Layer:
        robot.show(layer, False)
        assert not robot.shown(layer)
    robot.pose(solved((0.0, 0.0, 0.0, -0.5)))
    for layer in Layer:
        robot.show(layer)
    assert set(nodes(server)) == first


def test_bodies_begin_plain_and_can_be_fine(server: viser.ViserServer, robot: RobotScene) -> None:
    bar = nodes(server)["/robot/leg1/slider/b8/b4"]
    plain = bar.glb_data
    robot.show(Layer.FINE)
    assert bar.glb_data == body_glb("leg1/b4", APPENDIX_4.geometry)
    assert len(bar.glb_data) > 2 * len(plain)
    robot.show(Layer.FINE, False)
    assert bar.glb_data == plain


@pytest.mark.parametrize(
    ("renderer", "card"),
    [
        ("ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 Direct3D11 vs_5_0 ps_5_0, D3D11)", True),
        ("Apple M2", True),
        ("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)", False),
        ("llvmpipe (LLVM 15.0.7, 256 bits)", False),
        ("", False),
        (None, False),
    ],
)
def test_a_program_is_no_graphics_card(renderer: object, card: bool) -> None:
    assert has_graphics_card(renderer) is card


def test_hidden_layers_cost_nothing(server: viser.ViserServer, robot: RobotScene) -> None:
    robot.pose(solved())
    hidden = [Layer.SKELETON, Layer.NUMBERS, Layer.MASSES, Layer.GRAVITY, Layer.EFFORTS]
    for layer in hidden:
        robot.show(layer)
        robot.show(layer, False)
    with recorded(server) as messages:
        robot.pose(solved((0.0, 0.0, 0.1, -0.5)))
        robot.efforts([1.0, 0.5, 0.2, 100.0], 2.0, 200.0)
    assert all(m.name.startswith(("/robot/", "/stage/")) for m in messages)


def test_a_layer_shown_late_is_up_to_date(server: viser.ViserServer, robot: RobotScene) -> None:
    robot.pose(solved())
    robot.show(Layer.SKELETON)
    robot.show(Layer.SKELETON, False)
    posture = solved((0.1, 0.0, 0.0, -0.45))
    robot.pose(posture)
    robot.show(Layer.SKELETON)
    points = nodes(server)["/skeleton/lines"].points
    assert points == pytest.approx(sticks(posture).reshape(-1, 2, 3), abs=1e-6)


def test_sticks_join_the_papers_joints() -> None:
    posture = solved()
    lines = sticks(posture)
    assert lines.shape == (3, 9, 2, 3)
    lengths = np.linalg.norm(lines[:, :, 1] - lines[:, :, 0], axis=-1)
    g = APPENDIX_4.geometry
    bars = [
        g.coupler_length, g.crank_length, g.short_coupler_length, g.crank_length, g.shaft_length,
        g.arm_length, g.guide_link_length, g.platform_joint_height,
        np.sqrt(3) * g.platform_radius,
    ]  # fmt: skip
    assert lengths == pytest.approx(np.tile(bars, (3, 1)))


def test_mass_centres_weigh_what_the_design_does() -> None:
    design = APPENDIX_4.vary({"payload.mass": 3.0})
    posture = solved(design=design)
    points = mass_centres(design, posture)
    joints = sum(getattr(design.joints, f"j{i}") for i in (2, 3, 4, 5, 7, 8, 9))
    links = sum(getattr(design.links, f"b{i}") for i in (1, 2, 3, 4, 7, 8, 10))
    total = 3 * (joints + links) + design.platform.mass + 3.0
    assert points.mass.sum() == pytest.approx(total)
    # Together they have the potential energy of Eq. 11.
    c = lumped_coefficients(design)
    other = solved((0.0, 0.0, 0.2, -0.5), design)
    change = points.mass @ (mass_centres(design, other).centre - points.centre)[:, 2]
    legs = sum(
        c[i] * (b - a).sum()
        for i, a, b in (
            (0, posture.points[5][:, 2], other.points[5][:, 2]),
            (1, posture.points[9][:, 2], other.points[9][:, 2]),
            (2, posture.points[2][:, 2], other.points[2][:, 2]),
        )
    )
    platform = (design.platform.mass + 3.0) * 0.1
    assert change == pytest.approx(legs / design.gravity + platform, abs=1e-9)


def test_gravity_arrows_point_down_by_the_weight() -> None:
    points = mass_centres(APPENDIX_4, solved())
    arrows = gravity_arrows(points, 9.81)
    drop = arrows[:, 0] - arrows[:, 1]
    assert drop[:, :2] == pytest.approx(np.zeros((len(drop), 2)))
    heavy = points.mass > 0.25
    ratio = drop[heavy, 2] / points.mass[heavy]
    assert ratio == pytest.approx(np.full(heavy.sum(), ratio[0]))
    assert drop[points.mass == 0, 2] == pytest.approx(0.0)
    assert gravity_arrows(points, 0.0)[:, 0] == pytest.approx(gravity_arrows(points, 0.0)[:, 1])


@pytest.mark.parametrize("fraction", [-1.0, -0.3, 0.0, 0.4, 1.0])
def test_arcs_turn_the_way_of_the_torque(fraction: float) -> None:
    corners = arc_arrow(fraction)
    assert corners.shape == arc_arrow(0.9).shape
    assert FACES.max() == len(corners) - 1
    angle = np.unwrap(np.arctan2(corners[:, 1], corners[:, 0]).reshape(-1, 12)[:, 0])
    turned = angle[-1] - angle[0]
    assert np.sign(turned) == (1 if fraction >= 0 else -1)
    assert abs(turned) < 2 * np.pi


def test_longer_arcs_and_arrows_for_greater_efforts() -> None:
    lengths = [np.ptp(force_arrow(f)[:, 2]) for f in (0.1, 0.4, 0.9, 1.0, 5.0)]
    assert lengths == sorted(lengths)
    assert lengths[-1] == lengths[-2]
    assert force_arrow(-0.5)[:, 2].min() < -0.1


def test_efforts_that_are_not_finite_are_not_drawn(
    server: viser.ViserServer, robot: RobotScene
) -> None:
    robot.pose(solved())
    robot.show(Layer.EFFORTS)
    robot.efforts([np.nan, np.inf, 1.0, 0.0], 2.0, 200.0)
    seen = [nodes(server)[f"/efforts/m{k}"].visible for k in (1, 2, 3, 4)]
    assert seen == [False, False, True, False]


@pytest.mark.parametrize("assembly", list(Assembly))
@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("aspect", [0.6, 1.0, 1.6])
def test_presets_hold_the_robot_in_the_picture(
    name: str, assembly: Assembly, aspect: float
) -> None:
    sign = -assembly.sign
    posture = solved((0.0, 0.0, 0.1, sign * 0.45), assembly=assembly)
    view = preset(name, APPENDIX_4.geometry, assembly, posture, aspect)
    position, look = np.array(view.position), np.array(view.look_at)
    back = (position - look) / np.linalg.norm(position - look)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    legs = [int(name[-1]) - 1] if name.startswith("Leg") else [0, 1, 2]
    points = np.concatenate([posture.points[j][legs] for j in (2, 3, 4, 5, 7, 8, 9)]) - position
    depth = -points @ back
    limit = np.tan(view.fov / 2)
    assert (depth > 0.05).all()
    assert (np.abs(points @ up) < limit * depth).all()
    assert (np.abs(points @ right) < aspect * limit * depth).all()


def test_a_leg_is_seen_square_on() -> None:
    posture = solved()
    for leg in range(3):
        view = preset(f"Leg {leg + 1}", APPENDIX_4.geometry, posture=posture)
        sight = np.subtract(view.look_at, view.position)
        heading = [np.cos(posture.beta[leg]), np.sin(posture.beta[leg]), 0.0]
        assert sight @ heading == pytest.approx(0.0, abs=1e-9)


def test_unknown_preset() -> None:
    with pytest.raises(KeyError):
        preset("Leg 4", APPENDIX_4.geometry)


def test_a_curve_is_one_node(server: viser.ViserServer) -> None:
    curve = Curve(server.scene, "/circle")
    curve.draw([])
    assert "/circle" not in nodes(server)
    curve.draw([circle(0.3), circle(0.1)], height=-0.5, closed=True)
    node = nodes(server)["/circle"]
    assert node.points.shape == (256, 2, 3)
    assert np.unique(node.points[..., 2]) == pytest.approx([-0.5])
    curve.draw([circle(0.3, 16)], closed=True)
    assert nodes(server)["/circle"] is node
    assert node.points.shape == (16, 2, 3)
    curve.draw([])
    assert not node.visible
    curve.remove()
    assert "/circle" not in nodes(server)


def test_a_gap_breaks_a_curve() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [np.nan, 0.0], [2.0, 0.0], [3.0, 0.0]])
    assert segments(line, 0.5) == pytest.approx(
        np.array([[[0, 0, 0.5], [1, 0, 0.5]], [[2, 0, 0.5], [3, 0, 0.5]]])
    )


def test_dashes_cover_half_of_a_curve() -> None:
    lines = segments(circle(0.3, 400), closed=True)
    cut = dashes(lines, 0.02)
    drawn = np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1).sum()
    assert drawn == pytest.approx(np.pi * 0.3, rel=0.01)
    assert np.hypot(cut[..., 0], cut[..., 1]) == pytest.approx(0.3, abs=1e-4)


def test_a_scene_of_a_tab_will_do() -> None:
    """`RobotScene` asks a scene for nothing but to add nodes and set the light."""
    made: list[str] = []

    class Recorder(SimpleNamespace):
        def __getattr__(self, name: str):
            made.append(name)
            return lambda *a, **k: SimpleNamespace(visible=True, cast_shadow=False)

    RobotScene(Recorder(), APPENDIX_4)  # type: ignore[arg-type]
    assert all(name.startswith(("add_", "configure_", "set_")) for name in made)


def test_counterweights_hang_from_their_bars_and_no_pose_moves_them(
    server: viser.ViserServer, robot: RobotScene
) -> None:
    robot.pose(solved())
    bare = set(nodes(server))
    weights = (Counterweight("b8", 8, 0.2, 2.0), Counterweight("b3", 7, 0.1, 1.0))
    design = replace(APPENDIX_4, counterweights=weights)
    assert robot.change(design) == ()
    added = set(nodes(server)) - bare
    assert added == {
        f"{node_name(f'leg{leg}/{bar}')}/weight{number}"
        for leg in (1, 2, 3)
        for number, bar in ((1, "b8"), (2, "b3"))
    }
    with recorded(server) as messages:
        robot.pose(solved((0.0, 0.02, 0.1, -0.55)))
    assert not {m.name for m in messages} & added
    with recorded(server) as messages:
        heavier = (replace(weights[0], mass=3.0), weights[1])
        robot.change(replace(design, counterweights=heavier))
    assert {m.name for m in messages} == {name for name in added if name.endswith("1")}
    robot.change(replace(design, counterweights=weights[1:]))
    assert set(nodes(server)) - bare == {
        f"{node_name(f'leg{leg}/b3')}/weight1" for leg in (1, 2, 3)
    }
    robot.change(APPENDIX_4)
    assert set(nodes(server)) == bare


def test_mass_centres_know_counterweights(server: viser.ViserServer, robot: RobotScene) -> None:
    weight = Counterweight("b8", 8, 0.2, 2.0)
    design = replace(APPENDIX_4, counterweights=(weight,))
    at = counterweight_point(design.geometry, weight)
    for pose in random_poses(np.random.default_rng(5), n=3):
        posture = solved(pose)
        bare, loaded = mass_centres(APPENDIX_4, posture), mass_centres(design, posture)
        assert loaded.mass[-3:] == pytest.approx(2.0)
        assert len(loaded.mass) == len(bare.mass) + 3 == len(loaded.colour)
        z5, z9 = (posture.points[joint][:, 2] for joint in (5, 9))
        assert loaded.centre[-3:, 2] == pytest.approx(at.z5 * z5 + at.r9 * z9 + at.z0)
    robot.pose(posture)
    robot.show(Layer.MASSES)
    robot.change(design)  # more spheres than before: the node is made anew
    assert len(server.scene._handle_from_node_name["/masses/centres"].batched_positions) == len(
        loaded.mass
    )
