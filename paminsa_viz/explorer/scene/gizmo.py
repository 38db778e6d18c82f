"""A handle on the platform: drag it, and the robot follows."""

from __future__ import annotations

import numpy as np
import viser

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.state import State
from paminsa_viz.model import InvalidInput


class Gizmo:
    """Arrows for x, y, z and an arc for theta, at the platform's center."""

    def __init__(self, context: SceneContext) -> None:
        self._dispatch = context.dispatch
        free, locked = (-1000.0, 1000.0), (0.0, 0.0)
        self.handle = context.scene.add_transform_controls(
            "/gizmo",
            scale=0.22,
            line_width=3.0,
            rotation_limits=(locked, locked, free),
            depth_test=False,
            opacity=0.85,
            visible=False,
        )
        self._held = False
        self.handle.on_update(self._dragged)

    def _dragged(self, event: viser.TransformControlsEvent) -> None:
        self._held = event.phase != "end"
        self._dispatch("gizmo", self._intent)

    def _intent(self, state: State) -> State:
        x, y, z = (float(v) for v in self.handle.position)
        w, _, _, k = (float(v) for v in self.handle.wxyz)
        if not np.isfinite((x, y, z, w, k)).all():
            raise InvalidInput("handle", "finite numbers are needed")
        turn = 2 * np.arctan2(k, w)
        # the quaternion knows the angle but for whole turns
        before = state.document.pose[2]
        theta = before + float(np.remainder(turn - before + np.pi, 2 * np.pi) - np.pi)
        return actions.move(state, x=x, y=y, theta=theta, z=z)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Stand at the platform, unless it is being dragged."""
        self.handle.visible = "gizmo" in frame.state.layers
        if (self._held and dragging) or not frame.drawable:
            return
        x, y, theta, z = frame.state.standing.pose
        self.handle.position = (x, y, z)
        self.handle.wxyz = (float(np.cos(theta / 2)), 0.0, 0.0, float(np.sin(theta / 2)))
