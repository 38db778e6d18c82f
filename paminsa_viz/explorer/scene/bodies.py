"""The robot's bodies as scene nodes, hung from each other as in the machine.

A pose moves nodes and sends nothing else. Each leg is a frame that turns about its axis; within it
the shaft and the slider slide, the bars swing from them, and B4 swings from the end of B8. One
message a body is enough that way, where free-standing bodies would need two.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from viser import FrameHandle, GlbHandle, SceneApi

from paminsa_viz.meshes import bodies as shapes
from paminsa_viz.meshes import load
from paminsa_viz.meshes.placement import about_z, elevated
from paminsa_viz.meshes.weights import counterweight_glb
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.counterweight import Counterweight
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.kinematics import Configuration

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
"""What each body of a leg hangs from; empty for the leg's own frame."""


def node_name(body: str, root: str = "/robot") -> str:
    """Return the scene name of a body, for example ``/robot/leg1/slider/b8``."""
    if not body.startswith("leg"):
        return f"{root}/{body}"
    leg, _, kind = body.partition("/")
    return f"{root}/{leg}/{PARENT[kind]}{kind}" if kind else f"{root}/{leg}"


class BodyNodes:
    """All bodies of one robot in one scene.

    Args:
        scene: Scene of a client or a server.
        geometry: Lengths to build the bodies for.
        root: Name of the node that holds all others.
    """

    def __init__(self, scene: SceneApi, geometry: Geometry, root: str = "/robot") -> None:
        self._scene = scene
        self._root = root
        self._top = scene.add_frame(root, show_axes=False)
        self._legs: list[FrameHandle] = [
            scene.add_frame(node_name(f"leg{leg}", root), show_axes=False) for leg in (1, 2, 3)
        ]
        self._nodes: dict[str, GlbHandle] = {}
        self._built: dict[str, tuple[object, ...]] = {}
        self._payload_mass = 0.0
        self._weights: tuple[Counterweight, ...] = ()
        self._hung: dict[str, GlbHandle] = {}
        self._hung_data: dict[str, bytes] = {}
        self._geometry = geometry
        self._fine = False
        self.rebuild(geometry)

    @property
    def visible(self) -> bool:
        """Whether the bodies are shown."""
        return self._top.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._top.visible = visible

    @property
    def fine(self) -> bool:
        """Whether the bodies have all their details; they begin plain, and are there sooner."""
        return self._fine

    @fine.setter
    def fine(self, fine: bool) -> None:
        if fine != self._fine:
            self._fine = fine
            for body in self._built:
                self._make(body)

    def rebuild(self, geometry: Geometry) -> tuple[str, ...]:
        """Remake the bodies whose defining lengths differ; return their names.

        The nodes keep their place until the next `pose`.
        """
        self._geometry = geometry
        changed = []
        for body in (*STANDING, *_HANGING_ORDER):
            wanted = shapes.lengths_of(body, geometry)
            if self._built.get(body) != wanted:
                self._make(body)
                self._built[body] = wanted
                changed.append(body)
        for leg, frame in enumerate(self._legs):
            frame.position = shapes.leg_axis(geometry, leg)
            knee = self._nodes[f"leg{leg + 1}/b4"]
            knee.position = (geometry.crank_length, 0.0, 0.0)
        self._place_payload(remake="platform" in changed)
        self._hang_weights()
        return tuple(changed)

    def _make(self, body: str) -> None:
        """Make or replace one node; a replaced one keeps its pose and what hangs from it."""
        data = shapes.body_glb(body, self._geometry, fine=self._fine)
        old = self._nodes.get(body)
        if old is not None:
            old.glb_data = data
            return
        self._nodes[body] = self._scene.add_glb(node_name(body, self._root), data)

    def pose(self, configuration: Configuration) -> None:
        """Move the bodies to a solved configuration of shape (); the caller opens ``atomic()``."""
        positions, turns = self.places(configuration)
        for body, position in positions.items():
            self._nodes[body].position = position
        for body, turn in turns.items():
            leg = body.removeprefix("leg")
            node = self._legs[int(leg) - 1] if leg.isdigit() else self._nodes[body]
            node.wxyz = turn

    def places(
        self, configuration: Configuration
    ) -> tuple[dict[str, Position], dict[str, Quaternion]]:
        """Return what a configuration of shape () moves, by body, each in its parent's frame.

        Returns:
            Positions [m] of the bodies that slide, and quaternions (w, x, y, z) of those that turn;
            the legs' own frames are ``leg1`` to ``leg3``.
        """
        x, y, theta, z = configuration.pose
        positions = {
            "carriage": (0.0, 0.0, float(configuration.actuators[3])),
            "platform": (float(x), float(y), float(z)),
        }
        turns = {"platform": about_z(theta)}
        legs = about_z(configuration.beta)
        b3, b7 = elevated(configuration.phi + np.pi), elevated(configuration.psi)
        b8, b4 = elevated(configuration.phi), elevated(configuration.psi - configuration.phi)
        along = self._along(configuration)
        for leg in range(3):
            name = f"leg{leg + 1}"
            positions[f"{name}/shaft"] = (0.0, 0.0, float(configuration.points[3][leg, 2]))
            positions[f"{name}/slider"] = (along[8][leg], 0.0, 0.0)
            positions[f"{name}/swivel"] = (
                along[5][leg],
                0.0,
                float(configuration.points[5][leg, 2]),
            )
            turns[name] = legs[leg]
            for bar, turn in (("b3", b3), ("b7", b7), ("b8", b8), ("b4", b4)):
                turns[f"{name}/{bar}"] = turn[leg]
        return positions, turns

    def _along(self, configuration: Configuration) -> dict[int, list[float]]:
        """Return r of joints 5 and 8 in each leg plane [m]."""
        heading = np.stack([np.cos(configuration.beta), np.sin(configuration.beta)], axis=-1)
        axis = configuration.points[3][:, :2]
        return {
            joint: np.einsum(
                "ij,ij->i", configuration.points[joint][:, :2] - axis, heading
            ).tolist()
            for joint in (5, 8)
        }

    def payload(self, mass: float) -> None:
        """Show a payload of a mass [kg]: its volume is in proportion, at 0 it is hidden."""
        self._payload_mass = mass
        self._place_payload()

    def _place_payload(self, remake: bool = False) -> None:
        node = self._nodes.get("payload")
        if self._payload_mass <= 0:
            if node is not None:
                node.visible = False
            return
        if node is None:
            name = f"{node_name('platform', self._root)}/payload"
            node = self._scene.add_glb(name, load.payload_glb())
            self._nodes["payload"] = node
        node.position = load.payload_offset(self._geometry)
        over = self._geometry.knee is KneeBranch.UPPER
        node.wxyz = (0.0, 1.0, 0.0, 0.0) if over else (1.0, 0.0, 0.0, 0.0)
        node.scale = load.payload_scale(self._payload_mass)
        node.visible = True

    def counterweights(self, weights: tuple[Counterweight, ...]) -> None:
        """Show counterweights on every leg; one without mass is not drawn."""
        self._weights = weights
        self._hang_weights()

    def _hang_weights(self) -> None:
        """Make, remake or remove what differs; they hang from the bars, and no pose moves them."""
        wanted: dict[str, bytes] = {}
        for leg in (1, 2, 3):
            for number, weight in enumerate(self._weights, 1):
                if weight.mass > 0:
                    bar = f"leg{leg}/{weight.bar}"
                    name = f"{node_name(bar, self._root)}/weight{number}"
                    color = shapes.color_of(bar)
                    wanted[name] = counterweight_glb(self._geometry, weight, color)
        for name in [name for name in self._hung if name not in wanted]:
            self._hung.pop(name).remove()
            del self._hung_data[name]
        for name, data in wanted.items():
            if name not in self._hung:
                self._hung[name] = self._scene.add_glb(name, data)
            elif self._hung_data[name] != data:
                self._hung[name].glb_data = data
            self._hung_data[name] = data

    @property
    def node_count(self) -> int:
        """Number of nodes that exist, frames included."""
        return len(self._nodes) + len(self._hung) + len(self._legs) + 1


STANDING: Final = tuple(body for body in shapes.STANDING if body != "ground")
"""Bodies that do not move; the ground belongs to the stage."""

_HANGING_ORDER: Final = (
    "carriage",
    "platform",
    *(f"leg{leg}/{kind}" for leg in (1, 2, 3) for kind in PARENT),
)
"""Moving bodies, each after the one it hangs from."""
