"""One cursor: what the pointer is over in a map or a motion plot is marked in the others.

The page marks places in its maps by itself. Here is what only the server knows: where the robot is
at a time of the motion, and the mark in the scene.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Final

from trimesh.creation import icosphere

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.browser.bridge import finite, finite_place
from paminsa_viz.explorer.core.planning import planned, pose_at
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.maps.floor import ABOVE, RING
from paminsa_viz.explorer.features.maps.pictures import HOVER
from paminsa_viz.explorer.scene.curves import circles
from paminsa_viz.explorer.scene.nodes import Node, Nodes, flat_curves, mesh
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.palette import WARN

POINT: Final = 0.009
"""Radius of the point at the platform's height, at Appendix 4's lengths [m]."""


def marked_place(state: State, data: Any) -> tuple[float, float, float] | None:
    """Return the place of the platform's center that a message means, (x, y, z) [m], or None.

    Args:
        state: What is shown.
        data: What the page sent.
    """
    if not isinstance(data, dict):
        return None
    time = finite(data.get("time"))
    if time is not None:
        document = state.document
        trajectory = planned(document.motion, document.design).trajectory
        pose = None if trajectory is None else pose_at(trajectory, document.design.geometry, time)
        return None if pose is None else (pose[0], pose[1], pose[3])
    place = finite_place(data)
    return None if place is None else (place[0] / 1e3, place[1] / 1e3, state.document.pose[3])


@kept(4)
def _marks(size: float) -> tuple[Node, ...]:
    """Return the ring and the point for symbols of a size."""
    ball = icosphere(subdivisions=2, radius=POINT * size)
    return (
        flat_curves("/cursor/ring", circles([0.6 * RING * size]), WARN, 0.2 * RING * size),
        mesh("/cursor/point/ball", ball.vertices, ball.faces, WARN),
    )


class Cursor:
    """The mark in the scene: a ring on the ground and a point at the platform's height."""

    def __init__(self, session: Session, scene: Any) -> None:
        self._session = session
        self._newest: Any = None
        self._frame = scene.add_frame("/cursor", show_axes=False, visible=False)
        self._point = scene.add_frame("/cursor/point", show_axes=False)
        self._nodes = Nodes(scene)
        session.bridge.on(HOVER, self._receive)

    def _receive(self, data: Any) -> None:
        """Take what the page says; of several that wait only the newest is shown."""
        self._newest = data
        self._session.submit(partial(self._show, data))

    def _show(self, data: Any) -> None:
        if data is not self._newest:
            return
        state = self._session.state
        place = marked_place(state, data)
        self._frame.visible = place is not None
        if isinstance(data, dict) and "time" in data:
            millimeters = place and {"x": 1e3 * place[0], "y": 1e3 * place[1]}
            self._session.bridge.call("showPlace", millimeters)
        if place is None:
            return
        last = state.last_reachable.geometry
        self._nodes.show(_marks(symbol_size(last)))
        ground = layout(last).ground + last.body_scale * ABOVE["ring"]
        self._frame.position = (place[0], place[1], ground)
        height = place[2] + last.platform_joint_height - ground
        self._point.position = (0.0, 0.0, height)
