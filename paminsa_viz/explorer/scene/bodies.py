"""The robot's bodies as scene nodes, attached to each other as in the machine.

A pose moves nodes and sends nothing else. Each leg is a frame that turns about its axis; within it
the shaft and the slider slide, the bars swing from them, and B4 swings from the end of B8. One
message a body is enough that way, where separate bodies would need two.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any, Final

import numpy as np
from viser import FrameHandle, GlbHandle, SceneApi

from paminsa_viz.dimensions import attached
from paminsa_viz.dimensions.layout import polar
from paminsa_viz.dimensions.placement import about_z, elevated
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.motion import is_drawing
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.picking import can_be_picked, picked
from paminsa_viz.meshes import bodies as shapes
from paminsa_viz.meshes import loads
from paminsa_viz.meshes.loads import counterweight_glb
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration

Position = tuple[float, float, float]
Quaternion = Array

PARENT: Final = {
    "guide": "",
    "shaft": "",
    "slider": "",
    "swivel": "",
    "b3": "shaft/",
    "b7": "slider/",
    "b8": "slider/",
    "b4": "slider/b8/",
}
"""What each body of a leg is attached to; empty for the leg's own frame."""


@cache
def node_name(body: str, root: str = "/robot") -> str:
    """Return the scene name of a body, for example ``/robot/leg1/slider/b8``."""
    if not body.startswith("leg"):
        return f"{root}/{body}"
    leg, _, kind = body.partition("/")
    return f"{root}/{leg}/{PARENT[kind]}{kind}" if kind else f"{root}/{leg}"


class Robot:
    """A robot's bodies in a scene, below a node of their own.

    They start plain, and are there sooner.
    """

    def __init__(
        self,
        scene: SceneApi,
        root: str = "/robot",
        *,
        standing: bool = True,
        drawn: Callable[[bytes], bytes] | None = None,
        click: Callable[[str, Any], None] | None = None,
    ) -> None:
        """Prepare an empty robot.

        Args:
            scene: Where it goes.
            root: Name of its node.
            standing: Whether the bodies that do not move are part of it.
            drawn: Makes the GLB that is drawn out of a body's own, for another look.
            click: Called with the body that was clicked and viser's event, for those that mean a
                part, see `picking`.
        """
        self._scene, self._root = scene, root
        self._drawn, self._click = drawn, click
        self._bodies = (*STANDING, *_MOVING) if standing else _MOVING
        self._top = scene.add_frame(root, show_axes=False)
        self._nodes: dict[str, FrameHandle | GlbHandle] = {
            name: scene.add_frame(name, show_axes=False)
            for name in (self._name(f"leg{leg}") for leg in (1, 2, 3))
        }
        self._data: dict[str, bytes] = {}
        self._built: dict[str, object] = {}
        self._fine = False
        self._design: Design | None = None
        self._configuration: Configuration | None = None

    def _name(self, body: str) -> str:
        return node_name(body, self._root)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._top.visible = visible

    def put(self, design: Design, configuration: Configuration | None, *, fine: bool) -> None:
        """Move what has moved; remake only bodies whose lengths have changed.

        Args:
            design: Whose bodies, payload and counterweights are drawn.
            configuration: Where they are, of shape (); None leaves them.
            fine: Whether bodies have round edges and bolts.
        """
        if fine != self._fine or self._design is None or design.geometry != self._design.geometry:
            self._fine = fine
            self._build(design.geometry)
            self._configuration = None
        if design != self._design:
            self._design = design
            self._attach_payload(design)
            self._attach_counterweights(design)
        if configuration is not None and configuration is not self._configuration:
            self._configuration = configuration
            positions, turns = self.places(configuration)
            for name, position in positions.items():
                self._nodes[name].position = position
            for name, turn in turns.items():
                self._nodes[name].wxyz = turn

    def _build(self, geometry: Geometry) -> None:
        """Make or replace the bodies whose defining lengths or detail differ."""
        for body in self._bodies:
            wanted = (shapes.lengths_of(geometry, body), self._fine)
            if self._built.get(body) != wanted:
                self._built[body] = wanted
                made = self._name(body) not in self._nodes
                data = shapes.body_glb(geometry, body, fine=self._fine)
                node = self._put(self._name(body), data)
                if made and self._click is not None and can_be_picked(body):
                    node.on_click(partial(self._clicked, body))
        for leg, angle in enumerate(AXIS_ANGLES, 1):
            self._nodes[self._name(f"leg{leg}")].position = polar(geometry.base_radius, angle)
            self._nodes[self._name(f"leg{leg}/b4")].position = (geometry.crank_length, 0.0, 0.0)

    async def _clicked(self, body: str, event: Any) -> None:
        assert self._click is not None
        self._click(body, event)

    def _put(self, name: str, data: bytes) -> Any:
        """Make or replace one node; a replaced one keeps its pose and what is attached to it."""
        node = self._nodes.get(name)
        if node is not None and self._data[name] == data:
            return node
        drawn = data if self._drawn is None else self._drawn(data)
        if node is None:
            node = self._nodes[name] = self._scene.add_glb(name, drawn)
        else:
            node.glb_data = drawn  # pyright: ignore[reportAttributeAccessIssue]
        self._data[name] = data
        return node

    def places(
        self, configuration: Configuration
    ) -> tuple[dict[str, Position], dict[str, Quaternion]]:
        """Return what a configuration of shape () moves, by scene node, in its parent's frame.

        Returns:
            Positions [m] of the nodes that slide, quaternions (w, x, y, z) of those that turn.
        """
        x, y, theta, z = configuration.pose
        positions = {
            self._name("carriage"): (0.0, 0.0, float(configuration.actuators[3])),
            self._name("platform"): (float(x), float(y), float(z)),
        }
        turns = {self._name("platform"): about_z(theta)}
        legs = about_z(configuration.beta)
        bars = {
            "b3": elevated(configuration.phi + np.pi),
            "b7": elevated(configuration.psi),
            "b8": elevated(configuration.phi),
            "b4": elevated(configuration.psi - configuration.phi),
        }
        radius5, radius8 = (_radius_in_leg_plane(configuration, joint) for joint in (5, 8))
        height3, height5 = (configuration.points[joint][:, 2] for joint in (3, 5))
        for leg in range(3):
            name = f"leg{leg + 1}"
            for kind, r, height in (
                ("shaft", 0.0, height3[leg]),
                ("slider", radius8[leg], 0.0),
                ("swivel", radius5[leg], height5[leg]),
            ):
                positions[self._name(f"{name}/{kind}")] = (float(r), 0.0, float(height))
            turns[self._name(name)] = legs[leg]
            for bar, turn in bars.items():
                turns[self._name(f"{name}/{bar}")] = turn[leg]
        return positions, turns

    def _attach_payload(self, design: Design) -> None:
        """Show a payload, its volume in proportion to its mass; without mass it is hidden."""
        name, mass = f"{self._name('platform')}/payload", design.payload.mass
        if mass > 0:
            node = self._put(name, loads.payload_glb())
            node.position = attached.payload_offset(design.geometry)
            over = design.geometry.knee is KneeBranch.UPPER
            node.wxyz = (0.0, 1.0, 0.0, 0.0) if over else (1.0, 0.0, 0.0, 0.0)
            node.scale = attached.payload_scale(mass)
        if name in self._nodes:
            self._nodes[name].visible = mass > 0

    def _attach_counterweights(self, design: Design) -> None:
        """Attach counterweights to the bars of every leg; one without mass is not drawn."""
        wanted = {
            f"{self._name(bar)}/weight{number}": counterweight_glb(
                design.geometry, weight, shapes.color_of(bar)
            )
            for leg in (1, 2, 3)
            for number, weight in enumerate(design.counterweights, 1)
            if weight.mass > 0
            for bar in (f"leg{leg}/{weight.bar}",)
        }
        attached = [name for name in self._nodes if "/weight" in name]
        for name in attached:
            if name not in wanted:
                self._nodes.pop(name).remove()
        for name, data in wanted.items():
            self._put(name, data)


class Bodies(Robot):
    """The robot of the page: the layers ``mesh`` and ``fine``."""

    def __init__(self, context: SceneContext) -> None:
        super().__init__(context.scene, click=self._inspect)
        self._dispatch = context.dispatch

    def _inspect(self, body: str, event: Any) -> None:
        """Inspect what was clicked, unless clicks add waypoints."""
        where = self._configuration
        if where is None:
            return
        part = picked(where, body, event.ray_origin, event.ray_direction)
        if part is not None:
            self._dispatch(
                "inspect",
                lambda state: state if is_drawing(state) else replace(state, inspected=part),
                step=False,
            )

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the design and the pose."""
        del dragging
        layers = frame.state.layers
        self.show("mesh" in layers)
        configuration = frame.configuration if frame.drawable else None
        self.put(frame.shown_design, configuration, fine="fine" in layers)


def _radius_in_leg_plane(configuration: Configuration, joint: int) -> Array:
    """Return the distance of a joint from the axis of its leg, (3,) [m]."""
    heading = np.stack([np.cos(configuration.beta), np.sin(configuration.beta)], axis=-1)
    from_axis = configuration.points[joint][:, :2] - configuration.points[3][:, :2]
    return np.einsum("ij,ij->i", from_axis, heading)


STANDING: Final = tuple(body for body in shapes.STANDING if body != "ground")
"""Bodies that do not move; the ground belongs to the stage."""

_MOVING: Final = (
    "carriage",
    "platform",
    *(f"leg{leg}/{kind}" for leg in (1, 2, 3) for kind in PARENT),
)
"""Moving bodies, each after the one it is attached to."""
