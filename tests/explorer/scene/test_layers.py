"""Layers of the scene: shown or hidden, up to date when shown, and free when hidden."""

from __future__ import annotations

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.scene.robot import SHOWN_AT_START, Layer, RobotScene
from paminsa_viz.explorer.scene.skeleton import sticks
from paminsa_viz.meshes.bodies import body_glb
from paminsa_viz.model.design import APPENDIX_4
from tests.explorer.scene.seen import nodes, recorded, solved


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
    configuration = solved((0.1, 0.0, 0.0, -0.45))
    robot.pose(configuration)
    robot.show(Layer.SKELETON)
    points = nodes(server)["/skeleton/lines"].points
    assert points == pytest.approx(sticks(configuration).reshape(-1, 2, 3), abs=1e-6)


def test_sticks_join_the_papers_joints() -> None:
    configuration = solved()
    lines = sticks(configuration)
    assert lines.shape == (3, 9, 2, 3)
    lengths = np.linalg.norm(lines[:, :, 1] - lines[:, :, 0], axis=-1)
    g = APPENDIX_4.geometry
    bars = [
        g.coupler_length, g.crank_length, g.short_coupler_length, g.crank_length, g.shaft_length,
        g.arm_length, g.guide_link_length, g.platform_joint_height,
        np.sqrt(3) * g.platform_radius,
    ]  # fmt: skip
    assert lengths == pytest.approx(np.tile(bars, (3, 1)))
