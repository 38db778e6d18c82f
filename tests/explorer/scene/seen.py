"""What tests of a scene share: configurations, and what the browser is told or would see."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import viser
from trimesh.transformations import quaternion_matrix

from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics

POSE = (0.05, -0.03, 0.4, -0.6)


def solved(pose=POSE, design=APPENDIX_4, knee=KneeBranch.LOWER):
    """Return the configuration at a pose."""
    return inverse_kinematics(design.with_knee(knee).geometry, pose)


def nodes(server: viser.ViserServer) -> dict[str, object]:
    """Return the nodes of the scene by their names, as they are now."""
    return dict(server.scene._handle_from_node_name)


@contextmanager
def recorded(server: viser.ViserServer) -> Iterator[list]:
    """Collect the messages that are queued for the browser."""
    seen: list = []
    queue = server.scene._queue_scene_message

    def record(message, *rest, **more):
        seen.append(message)
        return queue(message, *rest, **more)

    server.scene._queue_scene_message = record  # type: ignore[method-assign]
    try:
        yield seen
    finally:
        del server.scene._queue_scene_message


def world(server: viser.ViserServer, name: str) -> np.ndarray:
    """The node's transform in the world, composed from its parents' as the browser does."""
    out = np.eye(4)
    parts = name.strip("/").split("/")
    for depth in range(1, len(parts) + 1):
        node = server.scene._handle_from_node_name["/" + "/".join(parts[:depth])]
        local = quaternion_matrix(node.wxyz)
        local[:3, 3] = node.position
        out = out @ local
    return out
