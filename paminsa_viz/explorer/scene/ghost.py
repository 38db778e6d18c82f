"""Robots that are seen through, next to the robot itself."""

from __future__ import annotations

import json
import struct
from abc import ABC, abstractmethod
from typing import ClassVar, Final

import numpy as np

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.bodies import Robot
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.model.kinematics import Configuration

OPACITY: Final = 0.45

_JSON: Final = 20
"""Where the description in a GLB starts, after its header and the head of the first chunk."""


@kept(64)
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


class Ghost(ABC):
    """A translucent robot without what stands, made when it is first seen."""

    root: ClassVar[str]
    """Name of its node."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._robot: Robot | None = None

    @abstractmethod
    def seen(self, frame: Frame) -> tuple[Design, Configuration] | None:
        """Return a robot and its configuration of shape (), or None where nothing is shown."""

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the frame."""
        del dragging
        found = self.seen(frame)
        if found is None or not np.isfinite(found[1].actuators).all():
            if self._robot is not None:
                self._robot.show(False)
            return
        if self._robot is None:
            self._robot = Robot(self._scene, self.root, standing=False, drawn=translucent)
        self._robot.put(*found, fine=False)
        self._robot.show(True)
