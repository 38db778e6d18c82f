"""What a person does often: in the command palette, and on keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.scene.cameras import CAMERAS, look
from paminsa_viz.explorer.scene.layers import LAYERS
from paminsa_viz.explorer.session import Session


class Command(NamedTuple):
    """A line of the command palette."""

    label: str
    key: str | None
    modifier: str | None
    run: Callable[[], None]


def _toggle(session: Session, name: str) -> Callable[[], None]:
    return lambda: session.dispatch(
        f"layers.{name}",
        lambda s: actions.set_layers(s, **{name: name not in s.layers}),
    )


def commands(session: Session) -> list[Command]:
    """Return every command of a session."""

    def camera(name: str) -> Callable[[], None]:
        return lambda: session.submit(lambda: look(session, name))

    return [
        Command("Home pose", "H", None, lambda: session.dispatch("home", actions.go_home)),
        Command("Undo", "Z", "cmd/ctrl", session.undo),
        Command("Redo", "Z", "cmd/ctrl+shift", session.redo),
        Command(
            "Pin the design as reference",
            "P",
            None,
            lambda: session.dispatch("reference", actions.pin_reference),
        ),
        Command(
            "Unpin the reference",
            "P",
            "shift",
            lambda: session.dispatch("reference", actions.unpin_reference),
        ),
        Command(
            "Balance as in the paper",
            "B",
            None,
            lambda: session.dispatch("balance", balancing.balance_now),
        ),
        Command(
            "Play or pause the motion",
            "M",
            None,
            lambda: session.dispatch("playback.play", motions.play_or_pause, step=False),
        ),
        *(
            Command(f"Camera: {name}", str(number), None, camera(name))
            for number, name in enumerate(CAMERAS, start=1)
        ),
        *(
            Command(
                f"Show or hide: {layer.label.lower()}", layer.shortcut, None, _toggle(session, key)
            )
            for key, layer in LAYERS.items()
        ),
    ]


def register(session: Session) -> None:
    """Put the commands on the page."""
    for command in commands(session):
        keys: dict[str, Any] = {"hotkey": command.key, "modifier": command.modifier}
        handle = session.client.gui.add_command(command.label, **keys)
        handle.on_trigger(lambda _, run=command.run: run())
