"""The poses that a motion is built from, in the scene: balls, and a handle that drags one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.motion import points
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.nodes import Node, Nodes, label
from paminsa_viz.explorer.scene.pose_handles import PoseHandle
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Pose
from paminsa_viz.palette import Theme, rgb


class PointHandle(PoseHandle):
    """Drags the pose of the motion that is edited; hidden while the motion is played."""

    name = "point_handle"
    scale = 0.14

    def pose(self, frame: Frame) -> Pose | None:
        state = frame.state
        shown = "points" in state.layers and not state.playback.playing
        return points.selected_pose(state) if shown else None

    def put(self, state: State, pose: Pose) -> State:
        x, y, theta, z = (round(value, 6) + 0.0 for value in pose)
        return points.put(state, (x, y, theta, z))

    def angle(self, state: State) -> float:
        pose = points.selected_pose(state)
        return 0.0 if pose is None else pose[2]


class MotionPoints:
    """The layer ``points``: the poses that a motion is built from, as balls with their names.

    A click on one lets it be edited, and its handle appears.
    """

    RADIUS = 0.011
    """Of a ball at Appendix 4's lengths [m]."""

    def __init__(self, context: SceneContext) -> None:
        self._dispatch = context.dispatch
        self._handle = PointHandle(context)
        self._nodes = Nodes(context.scene)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the motion's description."""
        state = frame.state
        self._handle.draw(frame, dragging)
        size = self.RADIUS * symbol_size(state.document.design.geometry)
        found = points.listed(state) if "points" in state.layers else ()
        self._nodes.show(self._marks(found, points.selected(state), size, state.theme))

    def _marks(
        self, found: Sequence[points.Point], chosen: int | None, radius: float, theme: Theme
    ) -> Iterator[Node]:
        names: dict[tuple[float, ...], list[str]] = {}
        for index, point in enumerate(found):
            x, y, _, z = point.pose
            names.setdefault((round(x, 3), round(y, 3), round(z, 3)), []).append(point.name)
            color = rgb(theme.reference if index == chosen else theme.ink)
            live = {"position": (x, y, z), "color": color, "radius": radius}
            fixed = {"subdivisions": 2, "cast_shadow": False}
            click = partial(self._select, index)
            yield Node(f"/points/{index}", "icosphere", live, fixed, click=click)
        for index, ((x, y, z), same) in enumerate(names.items()):  # poses may differ in theta only
            place = (x, y, z + 2 * radius)
            yield label(f"/point_names/{index}", ", ".join(same), place, "bottom-center", 1.0)

    async def _select(self, index: int, _event: Any) -> None:
        self._dispatch("motion.point", partial(points.select, index=index))
