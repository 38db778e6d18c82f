"""Layers: registered once, up to date when shown, free when hidden."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.commands import commands
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.view.tab import view_entries
from paminsa_viz.explorer.kit.bindings import perform
from paminsa_viz.explorer.kit.entries import Folder
from paminsa_viz.explorer.scene.build import build_views
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.mechanism import sticks
from paminsa_viz.explorer.scene.nodes import Node
from paminsa_viz.explorer.state.layers import LAYERS, Layer, register
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model.design import APPENDIX_4
from tests.support.desk import desk_with
from tests.support.scene import Scene, solved

ANIMATED = [key for key, layer in LAYERS.items() if layer.animated]
OWN_NODES = {
    "mesh": "/robot",
    "skeleton": "/skeleton/lines",
    "mass_centers": "/masses/centers",
    "gravity": "/masses/gravity",
    "torques": "/efforts/m4",
    "labels": "/actuators/m1",
    "gizmo": "/gizmo",
}


@pytest.fixture
def grid_layer() -> Iterator[None]:
    """A layer that only this test knows."""

    def grid(_frame: Frame) -> list[Node]:
        return [Node("/grid", "grid", {"cell_size": 0.1})]

    before = dict(LAYERS)
    register(Layer("grid", "Grid", "Lines every 10 cm", grid, shortcut="J"), folder="Motion")
    yield
    LAYERS.clear()
    LAYERS.update(before)


@pytest.mark.slow
@pytest.mark.usefixtures("grid_layer")
def test_registered_layer_is_a_switch_a_command_and_a_node(server: viser.ViserServer) -> None:
    folders = {one.label: one.entries for one in view_entries() if isinstance(one, Folder)}
    assert "layers.grid" in [one.key for one in folders["Motion"]]
    with desk_with(server, view_entries()) as desk:
        scene = desk.session.client.scene
        context = SceneContext(scene, desk.session.dispatch)
        desk.session.submit(
            lambda: desk.session.immediate.extend(build_views(context, animated=True))
        )
        nodes = scene._handle_from_node_name
        box = desk.handle("layers.grid")
        desk.set("layers.grid", True)
        desk.until(lambda: "grid" in desk.state.layers)
        desk.until(lambda: "/grid" in nodes)
        (command,) = [c for c in commands() if c.label == "Show or hide: grid"]
        assert command.hotkey == "J"
        perform(desk.session, command.key, command.effect)
        desk.until(lambda: not box.value)
        desk.until(lambda: "/grid" not in nodes)


@pytest.mark.parametrize("taken", [{"key": "mesh"}, {"shortcut": "K"}])
def test_key_and_shortcut_belong_to_one_layer(taken: dict[str, str]) -> None:
    fields = {"key": "new", "label": "New", "hint": "", "view": "bodies:Bodies"}
    with pytest.raises(ValueError, match="taken"):
        register(Layer(**(fields | taken)))
    assert "new" not in LAYERS


def test_layers_are_switched_by_their_keys_only() -> None:
    state = initial_state()
    assert state.layers == {key for key, layer in LAYERS.items() if layer.default}
    changed = actions.set_layers(state, path=True, mesh=False)
    assert changed.layers == (state.layers | {"path"}) - {"mesh"}
    with pytest.raises(KeyError):
        actions.set_layers(state, no_such_layer=True)


@pytest.mark.slow
def test_layers_switch_on_and_off(scene: Scene) -> None:
    scene.draw(layers=ANIMATED)
    first = set(scene.nodes)
    for key, name in OWN_NODES.items():
        scene.draw(layers=[key])
        assert scene.shown & set(OWN_NODES.values()) == {name}, key
    scene.draw((0.0, 0.0, 0.0, -0.5), layers=[])
    scene.draw(layers=ANIMATED)
    assert set(scene.nodes) == first


def test_shadows_or_the_floor_map_replace_the_soft_shadow(scene: Scene) -> None:
    for layers, soft, true in (([], True, False), (["floor_map"], False, False),
                               (["shadows"], False, True)):  # fmt: skip
        scene.draw(layers=layers)
        assert scene.nodes["/stage/ground/below"].visible is soft
        assert scene.nodes["/stage/key"].cast_shadow is true


@pytest.mark.slow
def test_hidden_layers_cost_nothing(scene: Scene) -> None:
    scene.draw(layers=ANIMATED)
    scene.draw(layers=["mesh"])
    with scene.sent() as messages:
        scene.draw((0.0, 0.0, 0.1, -0.5), APPENDIX_4.vary({"links.b3": 2.0}), ["mesh"])
    assert all(m.name.startswith(("/robot/", "/stage/", "/gizmo")) for m in messages)


def test_layer_shown_late_is_up_to_date(scene: Scene) -> None:
    scene.draw(layers=["skeleton"])
    scene.draw(layers=[])
    pose = (0.1, 0.0, 0.0, -0.45)
    scene.draw(pose, layers=[])
    scene.draw(pose, layers=["skeleton"])
    points = scene.nodes["/skeleton/lines"].points
    assert points == pytest.approx(sticks(solved(pose)).reshape(-1, 2, 3), abs=1e-6)


def test_the_handle_is_at_the_platform_and_turned_as_it_is(scene: Scene) -> None:
    for theta in (0.3, -0.4):
        scene.draw((0.02, 0.01, theta, -0.5), layers=["gizmo"])
        handle = scene.nodes["/gizmo"]
        assert tuple(handle.position) == pytest.approx((0.02, 0.01, -0.5))
        assert handle.wxyz == pytest.approx((np.cos(theta / 2), 0.0, 0.0, np.sin(theta / 2)))


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
