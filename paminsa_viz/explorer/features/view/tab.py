"""The View tab: cameras, the theme, layers of the scene."""

from __future__ import annotations

from collections.abc import Iterable

from paminsa_viz.explorer.kit.entries import ButtonGroup, Entry, Html, Run
from paminsa_viz.explorer.kit.inputs import Dropdown, Slider, attribute
from paminsa_viz.explorer.kit.setting_inputs import layer_switch
from paminsa_viz.explorer.scene.cameras import CAMERAS, look
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.view import Appearance

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
    )  # fmt: skip


def _cameras(key: str, label: str, names: Iterable[str]) -> ButtonGroup:
    return ButtonGroup(key, label, choices={name: camera_run(name) for name in names})


def camera_run(name: str) -> Run:
    """Return the effect of a button or a command that chooses a camera preset."""
    return Run(lambda session: session.submit(lambda: look(session, name)), at_once=True)
