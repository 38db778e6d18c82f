"""Scene layers: one registered entry reaches the page, the commands and the scene."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import viser

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.commands import commands
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.view_panel import ViewPanel
from paminsa_viz.explorer.scene.layers import LAYERS, Layer, SceneContext, build_views, register
from paminsa_viz.explorer.server.listening import open_server
from paminsa_viz.explorer.state import initial_state
from tests.explorer.panel_desk import desk_with


@pytest.fixture
def guarded() -> Iterator[viser.ViserServer]:
    """A server whose pages answer to a raw socket."""
    running = open_server(port=0)
    yield running
    running.stop()


@pytest.fixture
def grid_layer() -> Iterator[None]:
    """A layer that only this test knows."""

    class Grid:
        def __init__(self, context: SceneContext) -> None:
            self._node = context.scene.add_grid("/grid", visible=False)

        def draw(self, frame: Frame, moving: bool) -> None:
            del moving
            self._node.visible = "grid" in frame.state.layers

    before = dict(LAYERS)
    register(Layer("grid", "Grid", "Lines every 10 cm", Grid, shortcut="J"))
    yield
    LAYERS.clear()
    LAYERS.update(before)


@pytest.mark.usefixtures("grid_layer")
def test_one_entry_is_a_switch_a_command_and_a_node(guarded: viser.ViserServer) -> None:
    with desk_with(guarded, ViewPanel) as desk:
        scene = desk.session.client.scene
        context = SceneContext(scene, desk.session.dispatch)
        views = desk.session.immediate
        desk.session.submit(lambda: views.extend(build_views(context, animated=True)))
        boxes = desk.session.client.gui._gui_input_handle_from_uuid.values()
        box = next(handle for handle in boxes if getattr(handle, "label", "") == "Grid")
        desk.set(box, True)
        desk.until(lambda: "grid" in desk.state.layers)
        desk.until(lambda: scene._handle_from_node_name["/grid"].visible)
        (command,) = [c for c in commands(desk.session) if c.label == "Show or hide: grid"]
        assert command.key == "J"
        command.run()
        desk.until(lambda: not box.value)
        desk.until(lambda: not scene._handle_from_node_name["/grid"].visible)


@pytest.mark.parametrize("taken", [{"key": "mesh"}, {"shortcut": "K"}])
def test_a_key_or_shortcut_belongs_to_one_layer(taken: dict[str, str]) -> None:
    fields = {"key": "new", "label": "New", "hint": "", "view": "view:RobotView"}
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
