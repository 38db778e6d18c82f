"""Switches for the layers of the scene, and camera presets."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.cameras import CAMERAS, look
from paminsa_viz.explorer.scene.layers import LAYERS
from paminsa_viz.explorer.session import Session


class ViewPanel:
    """Camera buttons and a switch for every layer."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui

        def turn(event) -> None:  # type: ignore[no-untyped-def]
            name = event.target.value
            if name in CAMERAS:
                session.submit(lambda: look(session, name))

        legs = tuple(name for name in CAMERAS if name.startswith("Leg"))
        whole = tuple(name for name in CAMERAS if name not in legs)
        gui.add_button_group("Camera", whole).on_click(turn)
        gui.add_button_group("Square to", legs).on_click(turn)

        self._controls = []
        for key, layer in LAYERS.items():
            box = gui.add_checkbox(layer.label, key in session.state.layers, hint=layer.hint)
            self._controls.append(
                Control(
                    session,
                    box,
                    f"layers.{key}",
                    lambda s, value, key=key: actions.set_layers(s, **{key: bool(value)}),
                    lambda s, key=key: key in s.layers,
                )
            )
        opacity = gui.add_slider("Map opacity", 0.1, 1.0, 0.05, session.state.floor_opacity)
        self._controls.append(
            Control(
                session,
                opacity,
                "floor_opacity",
                lambda s, value: replace(s, floor_opacity=min(max(value, 0.0), 1.0)),
                lambda s: s.floor_opacity,
            )
        )

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for control in self._controls:
            control.draw(frame, moving)
