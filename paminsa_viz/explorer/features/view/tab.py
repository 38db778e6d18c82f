"""The View panel: cameras, the theme, layers of the scene."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from paminsa_viz.explorer.core.actions import set_layers
from paminsa_viz.explorer.kit.entries import ButtonGroup, Entry, Folder, Html, Run
from paminsa_viz.explorer.kit.inputs import Dropdown, Slider, attribute
from paminsa_viz.explorer.kit.setting_inputs import layer_switch
from paminsa_viz.explorer.scene.cameras import CAMERAS, look
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.view import Appearance

LEGS = tuple(name for name in CAMERAS if name.startswith("Leg"))
WHOLE = tuple(name for name in CAMERAS if name not in LEGS)

PLAIN = ("mesh", "labels", "pinned_design", "wanted_pose")

PRESETS = {
    "Plain": PLAIN,
    "Torques": (*PLAIN, "torques", "load", "floor_map", "workspace", "singularity"),
    "Forces": (*PLAIN, "load", "joint_forces", "utilization"),
    "Workspace": (*PLAIN, "volume", "required_workspace", "proven_workspace", "joint_limits"),
    "Motion": (*PLAIN, "path", "points", "torques", "escape_twist"),
}
"""Keys of the layers that a button shows; how fine the picture is stays as it is."""

KEPT = ("fine", "shadows")

THEMES = {
    "as the browser": Appearance.BROWSER, "light": Appearance.LIGHT, "dark": Appearance.DARK,
}  # fmt: skip


def grouped_layers() -> dict[str, list[str]]:
    """Return the keys of all registered layers by their folders."""
    found: dict[str, list[str]] = {}
    for key, layer in LAYERS.items():
        found.setdefault(layer.folder, []).append(key)
    return found


def show_only(state: State, layers: Iterable[str]) -> State:
    """Show these layers and no others."""
    shown = frozenset(layers)
    return set_layers(state, **{key: key in shown for key in LAYERS if key not in KEPT})


def view_entries() -> tuple[Entry, ...]:
    """Return the entries of the tab for the layers that are registered."""
    return (
        _cameras("camera", "Camera", WHOLE, "Of the whole robot (keys: 1 to 3)"),
        _cameras("camera.leg", "Face leg", LEGS, "From its side, near (keys: 4 to 6)"),
        Dropdown(
            "appearance", "Theme", hint="Light or dark; files that are exported stay light",
            options=THEMES,
            **attribute("appearance"),
        ),
        ButtonGroup(
            "layers.presets", "Show",
            choices={name: partial(show_only, layers=keys) for name, keys in PRESETS.items()},
            hint="Switches the layers below to a set of them",
        ),
        *(
            Folder(
                f"layers.{name}", name, open=number == 0,
                entries=(
                    Html(f"layers.{name}.mark", content='<span class="pv-layers"></span>'),
                    *(
                        layer_switch(f"layers.{key}", key, LAYERS[key].label, LAYERS[key].hint)
                        for key in keys
                    ),
                ),
            )
            for number, (name, keys) in enumerate(grouped_layers().items())
        ),
        Slider(
            "floor_opacity", "Map opacity", range=(0.1, 1.0), step=0.05,
            hint="Of the map under the robot",
            **attribute("floor_opacity"),
        ),
    )  # fmt: skip


def _cameras(key: str, label: str, names: Iterable[str], hint: str) -> ButtonGroup:
    return ButtonGroup(key, label, choices={name: camera_run(name) for name in names}, hint=hint)


def camera_run(name: str) -> Run:
    """Return the effect of a button or a command that chooses a camera preset."""
    return Run(lambda session: session.submit(lambda: look(session, name)), at_once=True)
