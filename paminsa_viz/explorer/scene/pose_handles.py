"""Handles in the scene that drag a pose: of the platform, and of what a motion is built from."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, ClassVar

import numpy as np
import viser

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import points
from paminsa_viz.explorer.motion.description import Pose
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.scene.nodes import Node, Nodes, label
from paminsa_viz.explorer.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.palette import INK, REFERENCE, rgb


class PoseHandle(ABC):
    """Arrows for x, y, z and an arc for theta, which a person drags."""

    name: ClassVar[str]
    """Of its node in the scene, and of the source of its actions."""
    scale: ClassVar[float]
    """Length of its arrows [m]."""

    def __init__(self, context: SceneContext) -> None:
        self._dispatch: Callable[..., None] = context.dispatch
        free, locked = (-1000.0, 1000.0), (0.0, 0.0)
        self.handle = context.scene.add_transform_controls(
            f"/{self.name}",
            scale=self.scale,
            line_width=3.0,
            rotation_limits=(locked, locked, free),
            depth_test=False,
            opacity=0.85,
            visible=False,
        )
        self._held = False
        self.handle.on_update(self._dragged)

    @abstractmethod
    def pose(self, frame: Frame) -> Pose | None:
        """Return the pose that is dragged, or None where the handle is hidden."""

    @abstractmethod
    def put(self, state: State, pose: Pose) -> State:
        """Return the state with the pose elsewhere."""

    async def _dragged(self, event: viser.TransformControlsEvent) -> None:
        self._held = event.phase != "end"
        move = partial(self._move, tuple(self.handle.position), tuple(self.handle.wxyz))
        self._dispatch(self.name, move, overtakes=True)

    def _move(self, place: tuple[float, ...], turned: tuple[float, ...], state: State) -> State:
        x, y, z = (float(v) for v in place)
        w, _, _, k = (float(v) for v in turned)
        if not np.isfinite((x, y, z, w, k)).all():
            raise InvalidInput("handle", "finite numbers are needed")
        turn = 2 * np.arctan2(k, w)
        # the quaternion knows the angle but for whole turns
        before = self.angle(state)
        theta = before + float(np.remainder(turn - before + np.pi, 2 * np.pi) - np.pi)
        return self.put(state, (x, y, theta, z))

    @abstractmethod
    def angle(self, state: State) -> float:
        """Return theta of the pose that is dragged, with its whole turns [rad]."""

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the pose, unless it is being dragged."""
        pose = self.pose(frame)
        self.handle.visible = pose is not None
        if pose is None or (self._held and dragging):
            return
        x, y, theta, z = pose
        self.handle.position = (x, y, z)
        self.handle.wxyz = (float(np.cos(theta / 2)), 0.0, 0.0, float(np.sin(theta / 2)))


class Gizmo(PoseHandle):
    """The layer ``gizmo``: drags the platform."""

    name = "gizmo"
    scale = 0.22

    def pose(self, frame: Frame) -> Pose | None:
        shown = "gizmo" in frame.state.layers and frame.drawable
        return frame.state.last_reachable.pose if shown else None

    def put(self, state: State, pose: Pose) -> State:
        x, y, theta, z = pose
        return actions.move(state, x=x, y=y, theta=theta, z=z)

    def angle(self, state: State) -> float:
        return state.document.pose[2]


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
    """Of a ball [m]."""

    def __init__(self, context: SceneContext) -> None:
        self._dispatch = context.dispatch
        self._handle = PointHandle(context)
        self._nodes = Nodes(context.scene)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the motion's description."""
        state = frame.state
        self._handle.draw(frame, dragging)
        found = points.listed(state) if "points" in state.layers else ()
        self._nodes.show(self._marks(found, points.selected(state)))

    def _marks(self, found: Sequence[points.Point], chosen: int | None) -> Iterator[Node]:
        names: dict[tuple[float, ...], list[str]] = {}
        for index, point in enumerate(found):
            x, y, _, z = point.pose
            names.setdefault((round(x, 3), round(y, 3), round(z, 3)), []).append(point.name)
            color = rgb(REFERENCE if index == chosen else INK)
            live = {"position": (x, y, z), "color": color}
            fixed = {"radius": self.RADIUS, "subdivisions": 2, "cast_shadow": False}
            click = partial(self._select, index)
            yield Node(f"/points/{index}", "icosphere", live, fixed, click=click)
        for index, ((x, y, z), same) in enumerate(names.items()):  # poses may differ in theta only
            place = (x, y, z + 2 * self.RADIUS)
            yield label(f"/point_names/{index}", ", ".join(same), place, "bottom-center", 1.0)

    async def _select(self, index: int, _event: Any) -> None:
        self._dispatch("motion.point", partial(points.select, index=index))
