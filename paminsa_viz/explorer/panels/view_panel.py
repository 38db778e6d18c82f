"""The View tab, and the command palette: cameras, layers of the scene, and frequent actions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.bindings import perform
from paminsa_viz.explorer.entries import ButtonGroup, Effect, Entry, Html, Run
from paminsa_viz.explorer.inputs import Dropdown, Slider, attribute
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.panels.clearance_panel import CLEARANCE
from paminsa_viz.explorer.scene.cameras import CAMERAS, look
from paminsa_viz.explorer.scene.layers import LAYERS
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.setting_inputs import layer_switch
from paminsa_viz.explorer.state import Appearance, State

LEGS = tuple(name for name in CAMERAS if name.startswith("Leg"))
WHOLE = tuple(name for name in CAMERAS if name not in LEGS)


def view_entries() -> tuple[Entry, ...]:
    """Return the entries of the tab for the layers that are registered."""
    return (
        Html("layers", content=lambda _: '<span class="pv-layers"></span>'),
        _cameras("camera", "Camera", WHOLE),
        _cameras("camera.leg", "Face leg", LEGS),
        Dropdown(
            "appearance", "Theme", hint="Light or dark; files that are exported stay light",
            options={"as the browser": Appearance.BROWSER, "light": Appearance.LIGHT,
                     "dark": Appearance.DARK},
            **attribute("appearance"),
        ),
        *(
            layer_switch(f"layers.{layer.key}", layer.key, layer.label, layer.hint)
            for layer in LAYERS.values()
        ),
        Slider(
            "floor_opacity", "Map opacity", range=(0.1, 1.0), step=0.05,
            hint="Of the map under the robot",
            **attribute("floor_opacity"),
        ),
        *CLEARANCE,
    )  # fmt: skip


def _cameras(key: str, label: str, names: Iterable[str]) -> ButtonGroup:
    return ButtonGroup(key, label, choices={name: _camera(name) for name in names})


def _camera(name: str) -> Run:
    return Run(lambda session: session.submit(lambda: look(session, name)), at_once=True)


@dataclass(frozen=True)
class Command:
    """A line of the command palette.

    Attributes:
        key: Name of its action; see `paminsa_viz.explorer.entries.Entry`.
        label: What the palette shows.
        effect: What it does.
        hotkey, modifier: Its keys, if it has any.
        undo: Whether it can be undone.
    """

    key: str
    label: str
    effect: Effect
    hotkey: str | None = None
    modifier: str | None = None
    undo: bool = True


def _toggle(layer: str, state: State) -> State:
    return actions.set_layers(state, **{layer: layer not in state.layers})


def commands() -> tuple[Command, ...]:
    """Return every command; those of the layers follow their registry."""
    return (
        Command("home", "Home pose", actions.go_home, "H"),
        Command("undo", "Undo", Run(Session.undo, at_once=True), "Z", "cmd/ctrl"),
        Command("redo", "Redo", Run(Session.redo, at_once=True), "Z", "cmd/ctrl+shift"),
        Command("reference", "Pin the design as reference", actions.pin_reference, "P"),
        Command("reference", "Unpin the reference", actions.unpin_reference, "P", "shift"),
        Command("balance", "Balance as in the paper", balancing.balance_now, "B"),
        Command(
            "playback.play", "Play or pause the motion", motions.play_or_pause, "M", undo=False
        ),
        *(
            Command(f"camera.{name}", f"Camera: {name}", _camera(name), str(number))
            for number, name in enumerate(CAMERAS, start=1)
        ),
        *(
            Command(
                f"layers.{key}", f"Show or hide: {layer.label.lower()}", partial(_toggle, key),
                layer.shortcut,
            )
            for key, layer in LAYERS.items()
        ),
    )  # fmt: skip


def register_commands(session: Session) -> None:
    """Put the commands on the page."""
    for command in commands():
        keys: dict[str, Any] = {"hotkey": command.hotkey, "modifier": command.modifier}
        handle = session.client.gui.add_command(command.label, **keys)
        handle.on_trigger(partial(_trigger, session, command))


async def _trigger(session: Session, command: Command, event: Any) -> None:
    del event
    perform(session, command.key, command.effect, undo=command.undo)
