"""The command palette: cameras, layers of the scene, and frequent actions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import viser

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.actions import Action
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.calibration.actions import PROPOSE
from paminsa_viz.explorer.features.drives import tab as drives
from paminsa_viz.explorer.features.identification import actions as identify
from paminsa_viz.explorer.features.inspector.panel import inspect
from paminsa_viz.explorer.features.maps.tab import show_figure_3
from paminsa_viz.explorer.features.motion.simulation import simulate
from paminsa_viz.explorer.features.requirements import actions as requirements
from paminsa_viz.explorer.features.springs import actions as springs
from paminsa_viz.explorer.features.synthesis import actions as synthesis
from paminsa_viz.explorer.features.view.tab import THEMES, camera_run
from paminsa_viz.explorer.kit.bindings import perform
from paminsa_viz.explorer.kit.design_numbers import GROUPS, label
from paminsa_viz.explorer.kit.entries import Effect, Run, Then
from paminsa_viz.explorer.scene.cameras import CAMERAS
from paminsa_viz.explorer.state.balance import BalanceKind
from paminsa_viz.explorer.state.inspector import PARTS
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.typed import TypedCommand
from paminsa_viz.quantities import QUANTITIES


@dataclass(frozen=True)
class Command:
    """A line of the command palette.

    Attributes:
        key: Name of its action; see `paminsa_viz.explorer.kit.entries.Entry`.
        label: What the palette shows.
        effect: What it does.
        hotkey, modifier: Its keys, if it has any.
        undo: Whether it can be undone.
        words: What else it is found by; the palette shows them beside it.
        name: Typed alone, or begun, it makes the command the palette's first line; empty for none.
    """

    key: str
    label: str
    effect: Effect
    hotkey: str | None = None
    modifier: str | None = None
    undo: bool = True
    words: str = ""
    name: str = ""


def open_effect(name: str) -> Run:
    """Return the effect of a command that opens a tab, see `Session.open_tab`."""
    return Run(lambda session: session.open_tab(name), at_once=True)


def _toggle(layer: str, state: State) -> State:
    return actions.set_layers(state, **{layer: layer not in state.layers})


def jobs() -> tuple[tuple[str, Action, str, str], ...]:
    """Return the jobs that can be started: name, action, section, and words to find them by."""
    optimize = partial(balancing.start, task=BalanceKind.OPTIMUM)
    return (
        ("search for a robot", synthesis.start, "Synthesis", "lightest, smallest"),
        ("largest workspace", requirements.LARGEST.start, "Requirements", "proven, certificate"),
        ("suggested requirements", requirements.suggest, "Requirements", "bounds"),
        ("optimize the balance", optimize, "Balance", "counterweights, masses, torque"),
        ("fit springs", springs.FIT.start, "Balance", "gravity, stiffness of springs"),
        ("find drives", drives.SEARCH.start, "Drives", "motors, gears, catalog"),
        ("simulate the motion", simulate, "Simulate", "controller, errors"),
        ("find the best motion for a log", identify.SEARCH.start, "Excite", "identification"),
        ("propose poses to measure", PROPOSE.start, "Calibrate", "calibration, laser tracker"),
    )


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
                "appearance", f"Theme: {name}", partial(replace, appearance=theme),
                words="appearance, mode",
            )
            for name, theme in THEMES.items()
        ),
        *(
            Command(
                f"layers.{key}", f"Show or hide: {layer.label.lower()}", partial(_toggle, key),
                layer.shortcut, words=layer.hint,
            )
            for key, layer in LAYERS.items()
        ),
        *(
            Command(
                "inspect", f"Inspect: {part.title}", partial(inspect, part=part), undo=False,
                words=part.words,
            )
            for part in PARTS
        ),
        *(
            Command(
                f"map.{key}", f"Map: {quantity.label}",
                Then(partial(choose_quantity, quantity=key), opens="Single map"),
                words=quantity.title,
            )
            for key, quantity in QUANTITIES.items()
        ),
        Command(
            "figure 3", "Fig. 3 of the paper: torques at θ = 60°",
            Then(show_figure_3, opens="Torque maps"), words="torque maps",
        ),
        *(
            Command(
                f"design.{parameter.path}", f"Set: {label(parameter)}",
                open_effect(group.tab), words=f"{parameter.label}, section {group.tab}",
            )
            for group in GROUPS
            for parameter in group.parameters
        ),
        *(
            Command(f"start.{name}", f"Start: {name}", Then(start, opens=section), words=words)
            for name, start, section, words in jobs()
        ),
    )  # fmt: skip


def register_commands(session: Session, more: Sequence[Command]) -> None:
    """Put the commands on the page, below some more."""
    named: dict[str, viser.CommandHandle] = {}
    for command in (*more, *commands()):
        keys: dict[str, Any] = {"hotkey": command.hotkey, "modifier": command.modifier}
        handle = session.client.gui.add_command(
            command.label, description=command.words or None, **keys
        )
        handle.on_trigger(partial(_trigger, session, command))
        if command.name:
            named[command.name] = handle
    TypedCommand(session, named)


async def _trigger(session: Session, command: Command, event: Any) -> None:
    del event
    perform(session, command.key, command.effect, undo=command.undo)
