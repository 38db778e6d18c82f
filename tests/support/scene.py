"""Frames to draw, and what a browser is sent of a scene or would see."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import viser
from trimesh.transformations import quaternion_matrix

from paminsa_viz.explorer.core.frame import Frame, compute
from paminsa_viz.explorer.state.document import LastReachable
from paminsa_viz.explorer.state.layers import default_layers
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics

POSE = (0.05, -0.03, 0.4, -0.6)
UPPER = replace(APPENDIX_4, geometry=replace(APPENDIX_4.geometry, knee=KneeBranch.UPPER))


def solved(pose=POSE, design=APPENDIX_4):
    """Return the configuration at a pose."""
    return inverse_kinematics(design.geometry, pose)


def frame_at(
    pose: Iterable[float] = POSE,
    design: Design = APPENDIX_4,
    layers: Iterable[str] | None = None,
) -> Frame:
    """Return the frame of a robot at a pose."""
    x, y, theta, z = map(float, pose)
    shown = default_layers() if layers is None else frozenset(layers)
    last_reachable = LastReachable(design.geometry, (x, y, theta, z))
    return compute(replace(initial_state(design), last_reachable=last_reachable, layers=shown))


class Scene:
    """Views of layers in a scene."""

    def __init__(self, scene: viser.SceneApi, views: list[Any]) -> None:
        self._scene, self._views = scene, views

    def draw(
        self,
        pose: Iterable[float] = POSE,
        design: Design = APPENDIX_4,
        layers: Iterable[str] | None = None,
    ) -> Frame:
        """Draw a frame, as a session does, and return it."""
        frame = frame_at(pose, design, layers)
        self.show(frame.state)
        return frame

    def show(self, state: State, *, dragging: bool = False) -> None:
        """Draw what a state shows."""
        frame = compute(state)
        for view in self._views:
            view.draw(frame, dragging)

    @property
    def nodes(self) -> dict[str, Any]:
        """The nodes of the scene by their names, as they are now."""
        return dict(self._scene._handle_from_node_name)

    @property
    def shown(self) -> set[str]:
        """The names of the nodes that are visible themselves."""
        return {name for name, node in self.nodes.items() if node.visible}

    @contextmanager
    def sent(self) -> Iterator[list[Any]]:
        """Collect the messages that are queued for the browser."""
        seen: list[Any] = []
        queue = self._scene._queue_scene_message

        def record(message, *rest, **more):
            seen.append(message)
            return queue(message, *rest, **more)

        self._scene._queue_scene_message = record  # type: ignore[method-assign]
        try:
            yield seen
        finally:
            del self._scene._queue_scene_message

    def world(self, name: str) -> np.ndarray:
        """Return a node's transform, composed from its parents' as the browser does."""
        out = np.eye(4)
        parts = name.strip("/").split("/")
        for depth in range(1, len(parts) + 1):
            node = self.nodes["/" + "/".join(parts[:depth])]
            local = quaternion_matrix(node.wxyz)
            local[:3, 3] = node.position
            out = out @ local
        return out
