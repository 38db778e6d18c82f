"""The command palette: cameras, layers of the scene, and frequent actions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.view.tab import camera_run
from paminsa_viz.explorer.kit.bindings import perform
from paminsa_viz.explorer.kit.entries import Effect, Run
from paminsa_viz.explorer.scene.cameras import CAMERAS
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.state import State


@dataclass(frozen=True)
class Command:
    """A line of the command palette.

    Attributes:
        key: Name of its action; see `paminsa_viz.explorer.kit.entries.Entry`.
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
            Command(f"camera.{name}", f"Camera: {name}", camera_run(name), str(number))
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
