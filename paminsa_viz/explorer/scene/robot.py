"""The robot in the 3D view, with its layers. One object for everything a session shows in 3D."""

from __future__ import annotations

from enum import Enum

import numpy as np
from numpy.typing import ArrayLike
from viser import SceneApi

from paminsa_viz.explorer.scene.bodies import BodyNodes, Position, Quaternion, node_name
from paminsa_viz.explorer.scene.efforts import EffortArrows
from paminsa_viz.explorer.scene.labels import ActuatorLabels
from paminsa_viz.explorer.scene.masses import MassLayers
from paminsa_viz.explorer.scene.skeleton import Skeleton
from paminsa_viz.explorer.scene.stage import SHADOW, Stage
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import Configuration


class Layer(Enum):
    """What can be shown and hidden; the value is the name a person sees."""

    MESH = "Robot"
    SKELETON = "Skeleton"
    NUMBERS = "Joint numbers"
    LABELS = "Actuator names"
    MASSES = "Mass centers"
    GRAVITY = "Gravity arrows"
    EFFORTS = "Torque arrows"
    GROUND = "Ground"
    FINE = "Fine detail"
    SHADOWS = "Shadows and reflections"
    SPOT = "Soft spot below the platform"


SHOWN_AT_START = frozenset({Layer.MESH, Layer.LABELS, Layer.GROUND, Layer.SPOT})


class RobotScene:
    """The robot of one session: made once, then posed.

    All calls send messages; the caller wraps them in ``atomic()`` and flushes.

    Args:
        scene: Scene of a client or a server.
        design: Lengths and masses to draw.
    """

    def __init__(self, scene: SceneApi, design: Design) -> None:
        geometry = design.geometry
        self._design = design
        self._posture: Configuration | None = None
        self._stage = Stage(scene, geometry)
        self._bodies = BodyNodes(scene, geometry)
        self._labels = ActuatorLabels(scene, geometry)
        self._skeleton = Skeleton(scene)
        self._masses = MassLayers(scene, design)
        self._efforts = EffortArrows(scene, geometry)
        self._bodies.payload(design.payload.mass)
        self._bodies.counterweights(design.counterweights)

    @property
    def design(self) -> Design:
        """The design that is drawn."""
        return self._design

    @property
    def configuration(self) -> Configuration | None:
        """The configuration that is shown; None before the first."""
        return self._posture

    def pose(self, configuration: Configuration) -> bool:
        """Move the robot to a solved configuration of shape (); existing nodes move, none is made.

        Returns:
            False if the bars cannot close there: the robot then stays where it was.

        Raises:
            ValueError: If the configuration is of another geometry than that drawn.
        """
        if configuration.geometry != self._design.geometry:
            raise ValueError("the configuration belongs to another robot; call change() first")
        if not _drawable(configuration):
            return False
        self._posture = configuration
        self._bodies.pose(configuration)
        self._stage.pose(float(configuration.pose[0]), float(configuration.pose[1]))
        self._skeleton.pose(configuration)
        self._masses.pose(configuration)
        self._efforts.pose(float(configuration.actuators[3]))
        return True

    def places(
        self, configuration: Configuration
    ) -> tuple[dict[str, Position], dict[str, Quaternion]]:
        """Return where `pose` would move bodies and shadow, by scene node, in its parent's frame.

        Returns:
            Positions [m], and quaternions (w, x, y, z); only of nodes that slide or turn.
        """
        positions, turns = self._bodies.places(configuration)
        named = {node_name(body): place for body, place in positions.items()}
        named[SHADOW] = self._stage.shadow_place(
            float(configuration.pose[0]), float(configuration.pose[1])
        )
        return named, {node_name(body): turn for body, turn in turns.items()}

    def change(self, design: Design) -> tuple[str, ...]:
        """Take another design; remake only what differs in shape.

        A changed geometry needs a `pose` afterwards.

        Returns:
            Names of the bodies that were remade.
        """
        before, self._design = self._design, design
        remade: tuple[str, ...] = ()
        if design.geometry != before.geometry:
            remade = self._bodies.rebuild(design.geometry)
            if self._stage.rebuild(design.geometry):
                remade = ("ground", *remade)
            self._labels.rebuild(design.geometry)
            self._efforts.rebuild(design.geometry)
        if design.payload.mass != before.payload.mass or remade:
            self._bodies.payload(design.payload.mass)
        if design.counterweights != before.counterweights:
            self._bodies.counterweights(design.counterweights)
        if design != before:
            self._masses.design(design)
        return remade

    def efforts(self, values: ArrayLike, full_torque: float, full_force: float) -> None:
        """Draw actuator efforts (4,) [N m, N m, N m, N]; see `EffortArrows.values`."""
        self._efforts.values(values, full_torque, full_force)

    def show(self, layer: Layer, visible: bool = True) -> None:
        """Show or hide a layer."""
        owner, attribute = self._switch(layer)
        setattr(owner, attribute, visible)

    def shown(self, layer: Layer) -> bool:
        """Return whether a layer is shown."""
        owner, attribute = self._switch(layer)
        return bool(getattr(owner, attribute))

    def _switch(self, layer: Layer) -> tuple[object, str]:
        return {
            Layer.MESH: (self._bodies, "visible"),
            Layer.SKELETON: (self._skeleton, "visible"),
            Layer.NUMBERS: (self._skeleton, "numbered"),
            Layer.LABELS: (self._labels, "visible"),
            Layer.MASSES: (self._masses, "centers_visible"),
            Layer.GRAVITY: (self._masses, "gravity_visible"),
            Layer.EFFORTS: (self._efforts, "visible"),
            Layer.GROUND: (self._stage, "visible"),
            Layer.FINE: (self._bodies, "fine"),
            Layer.SHADOWS: (self._stage, "shadows"),
            Layer.SPOT: (self._stage, "spot"),
        }[layer]


def _drawable(configuration: Configuration) -> bool:
    """Return whether every joint of a configuration has a place."""
    return bool(
        np.isfinite(configuration.pose).all()
        and all(np.isfinite(configuration.points[joint]).all() for joint in (5, 8, 9))
    )
