"""Robots that are seen through: where a simulated motion should be, and the pinned design."""

from __future__ import annotations

import json
import struct
from functools import lru_cache
from typing import Final

import numpy as np

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion.simulated import wanted_pose
from paminsa_viz.explorer.scene.bodies import Robot
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model import Design
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics

OPACITY: Final = 0.45

_JSON: Final = 20
"""Where the description in a GLB starts, after its header and the head of the first chunk."""


@lru_cache(maxsize=64)
def translucent(glb: bytes) -> bytes:
    """Return a GLB whose materials are seen through."""
    length = struct.unpack_from("<I", glb, 12)[0]
    tree = json.loads(glb[_JSON : _JSON + length])
    for material in tree.get("materials", ()):
        surface = material.setdefault("pbrMetallicRoughness", {})
        color = surface.get("baseColorFactor", [1.0, 1.0, 1.0, 1.0])
        surface["baseColorFactor"] = [*color[:3], OPACITY]
        material["alphaMode"] = "BLEND"
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[_JSON + length :]
    total = _JSON + len(text) + len(rest)
    return glb[:8] + struct.pack("<II", total, len(text)) + glb[16:_JSON] + text + rest


class Ghost:
    """A translucent robot without what stands, made when it is first seen.

    Args:
        context: The scene.
        root: Name of its node.
    """

    def __init__(self, context: SceneContext, root: str) -> None:
        self._scene, self._root = context.scene, root
        self._robot: Robot | None = None

    def hide(self) -> None:
        """Show nothing."""
        if self._robot is not None:
            self._robot.show(False)

    def put(self, design: Design, configuration: Configuration) -> None:
        """Show a design at a configuration of shape ()."""
        if self._robot is None:
            self._robot = Robot(self._scene, self._root, standing=False, drawn=translucent)
        self._robot.put(design, configuration, fine=False)
        self._robot.show(True)


class WantedPose:
    """The layer ``wanted_pose``: where the robot should be, while a simulation is shown."""

    def __init__(self, context: SceneContext) -> None:
        self._ghost = Ghost(context, "/wanted")

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the instant that is shown."""
        del dragging
        state = frame.state
        pose = wanted_pose(state) if "wanted_pose" in state.layers else None
        configuration = None
        if pose is not None:
            configuration = inverse_kinematics(frame.shown_design.geometry, pose)
        if configuration is None or not np.isfinite(configuration.actuators).all():
            self._ghost.hide()
        else:
            self._ghost.put(frame.shown_design, configuration)


class PinnedDesign:
    """The layer ``pinned_design``: the reference at the robot's pose, where it differs in shape."""

    def __init__(self, context: SceneContext) -> None:
        self._ghost = Ghost(context, "/pinned")

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the pose and the reference; nothing is shown where it cannot be."""
        del dragging
        state = frame.state
        reference = state.document.reference if "pinned_design" in state.layers else None
        if reference is None or same_look(reference, frame.shown_design):
            self._ghost.hide()
            return
        configuration = inverse_kinematics(reference.geometry, state.last_reachable.pose)
        if bool(configuration.reach.ok) and np.isfinite(configuration.actuators).all():
            self._ghost.put(reference, configuration)
        else:
            self._ghost.hide()


def same_look(one: Design, other: Design) -> bool:
    """Whether two designs are drawn the same, so that one would only flicker in the other."""
    return (one.geometry, one.payload, one.counterweights) == (
        other.geometry, other.payload, other.counterweights
    )  # fmt: skip
