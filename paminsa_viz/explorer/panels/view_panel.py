"""Switches for the layers of the scene, and camera presets."""

from __future__ import annotations

from dataclasses import fields

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.view import CAMERAS, look
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import Layers

LAYER_LABELS = {
    "mesh": ("Robot", "The machine itself"),
    "skeleton": ("Skeleton", "Bars as lines, with the paper's joint numbers"),
    "mass_centers": ("Mass centers", "A ball for each mass, its volume in proportion"),
    "gravity": ("Weights", "The weight of each body as an arrow"),
    "torques": ("Actuator torques", "Static torques as arrows about the leg axes, and F₄"),
    "labels": ("Labels", "Names of the actuators"),
    "workspace": ("Workspace edge", "Positions within reach at the present θ and z"),
    "singularity": ("Singular circle", "Where the platform escapes the actuators at this θ"),
    "floor_map": ("Floor map", "The chosen map, under the robot; click it to go there"),
    "path": ("Path of the motion", "Colored by torque, and on the maps"),
    "gizmo": ("Platform handle", "Drag the platform in the scene"),
    "fine": ("Fine detail", "Round edges and bolts; on by itself where there is a graphics card"),
    "shadows": ("Shadows", "Shadows and reflections; slow without a graphics card"),
}


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
        known = {item.name for item in fields(Layers)}
        for name, (label, hint) in LAYER_LABELS.items():
            assert name in known
            box = gui.add_checkbox(label, getattr(session.state.layers, name), hint=hint)
            self._controls.append(
                Control(
                    session,
                    box,
                    f"layers.{name}",
                    lambda s, value, name=name: actions.set_layers(s, **{name: bool(value)}),
                    lambda s, name=name: getattr(s.layers, name),
                )
            )
        opacity = gui.add_slider("Map opacity", 0.1, 1.0, 0.05, session.state.layers.floor_opacity)
        self._controls.append(
            Control(
                session,
                opacity,
                "layers.floor_opacity",
                lambda s, value: actions.set_layers(s, floor_opacity=min(max(value, 0.0), 1.0)),
                lambda s: s.layers.floor_opacity,
            )
        )

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for control in self._controls:
            control.draw(frame, moving)
