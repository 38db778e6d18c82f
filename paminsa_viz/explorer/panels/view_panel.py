"""The View tab: camera presets, and a switch for every layer of the scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.entries import ButtonGroup, Checkbox, Entry, Run, Slider
from paminsa_viz.explorer.scene.cameras import CAMERAS, look
from paminsa_viz.explorer.scene.layers import LAYERS, Layer

LEGS = tuple(name for name in CAMERAS if name.startswith("Leg"))
WHOLE = tuple(name for name in CAMERAS if name not in LEGS)


def view_entries() -> tuple[Entry, ...]:
    """Return the entries of the tab for the layers that are registered."""
    return (
        _cameras("camera", "Camera", WHOLE),
        _cameras("camera.leg", "Face leg", LEGS),
        *map(_switch, LAYERS.values()),
        Slider(
            "floor_opacity", "Map opacity", range=(0.1, 1.0), step=0.05,
            hint="Of the map under the robot",
            read=lambda state: state.floor_opacity,
            apply=lambda state, value: replace(state, floor_opacity=value),
        ),
    )  # fmt: skip


def _cameras(key: str, label: str, names: Iterable[str]) -> ButtonGroup:
    def turn(name: str) -> Run:
        return Run(lambda session: session.submit(lambda: look(session, name)))

    return ButtonGroup(key, label, choices={name: turn(name) for name in names})


def _switch(layer: Layer) -> Checkbox:
    return Checkbox(
        f"layers.{layer.key}", layer.label, hint=layer.hint,
        read=lambda state: layer.key in state.layers,
        apply=lambda state, visible: actions.set_layers(state, **{layer.key: visible}),
    )  # fmt: skip
