"""Handles in the scene that drag a pose: of the platform, and of what a motion is built from."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial
from typing import ClassVar

import numpy as np
import viser

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.model.arrays import Pose


class PoseHandle(ABC):
    """Arrows for x, y, z and an arc for theta, which a person drags."""

    name: ClassVar[str]
    """Of its node in the scene, and of the source of its actions."""
    scale: ClassVar[float]
    """Length of its arrows at Appendix 4's lengths [m]."""

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
        size = self.scale * symbol_size(frame.state.last_reachable.geometry)
        if size != self.handle.scale:
            self.handle.scale = size
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
        return actions.move_to(state, pose)

    def angle(self, state: State) -> float:
        return state.document.pose[2]
