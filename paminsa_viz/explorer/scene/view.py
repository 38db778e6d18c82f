"""The robot of a session: follows its frames, layer by layer; and its cameras."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.placing import covered_share
from paminsa_viz.explorer.scene.cameras import VIEWS, View, preset, take
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.scene.robot import Layer, RobotScene
from paminsa_viz.explorer.session import Session
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    inverse_kinematics,
    lift_constant,
    lumped_coefficients,
)

CAMERAS = VIEWS
"""Names of the camera presets."""


def look(session: Session, name: str) -> None:
    """Move a tab's camera to a preset, with the robot in the part of the view that is free.

    Args:
        session: The tab; "Leg k" squares up to the leg as it stands.
        name: One of `CAMERAS`.
    """
    client, standing = session.client, session.state.standing
    configuration = inverse_kinematics(standing.geometry, standing.pose)
    width, height = client.camera.image_width, client.camera.image_height
    covered = covered_share(session.panel_width, height)
    aspect = width / (height * (1 - covered)) if height else 1.4
    view = preset(name, standing.geometry, configuration, aspect)
    take(client, raised(view, covered))


def raised(view: View, covered: float) -> View:
    """Return a view that shows the same in the upper part of the picture.

    Args:
        view: A camera for the whole picture.
        covered: Share of the picture's height that is covered from below.
    """
    position, target = np.array(view.position), np.array(view.look_at)
    back = position - target
    distance = float(np.linalg.norm(back)) / (1 - covered)
    back /= np.linalg.norm(back)
    right = np.cross(view.up, back)
    upward = np.cross(back, right / np.linalg.norm(right))
    shift = covered * distance * np.tan(view.fov / 2) * upward
    look_at = target - shift
    moved = look_at + distance * back
    return replace(view, position=tuple(map(float, moved)), look_at=tuple(map(float, look_at)))


def arrow_scales(design: Design) -> tuple[float, float]:
    """Return the torque [N m] and the force [N] that an arrow at full size stands for.

    They follow the weight of the design, so that the arrows of a balanced one are seen to shrink
    only because its torques do.
    """
    c = lumped_coefficients(design)
    weight = float(abs(c[0]) + abs(c[1]) + abs(c[2]))
    torque = 0.5 * weight * design.geometry.base_radius
    return max(torque, 1e-6), max(1.5 * lift_constant(design), 1e-6)


class RobotView:
    """Draws the standing robot and its layers."""

    def __init__(self, context: SceneContext) -> None:
        # Of the shape that most sessions have; the first frame brings the session's own.
        self.scene = RobotScene(context.scene, APPENDIX_4)
        self._layers: frozenset[str] | None = None
        self._efforts: object = None

    def draw(self, frame: Frame, moving: bool) -> None:
        """Move what moved; remake only bodies whose lengths changed."""
        del moving
        state = frame.state
        design = frame.standing_design
        if design != self.scene.design:
            self.scene.change(design)
            self._efforts = None
        if frame.configuration is not self.scene.configuration:
            self.scene.pose(frame.configuration)
        efforts = (tuple(frame.torques), arrow_scales(design))
        if efforts != self._efforts:
            self._efforts = efforts
            self.scene.efforts(frame.torques, *efforts[1])
        if state.layers != self._layers:
            self._layers = state.layers
            self._switch(state.layers)

    def _switch(self, layers: frozenset[str]) -> None:
        for layer, visible in (
            (Layer.MESH, "mesh" in layers),
            (Layer.SKELETON, "skeleton" in layers),
            (Layer.NUMBERS, "skeleton" in layers),
            (Layer.LABELS, "labels" in layers),
            (Layer.MASSES, "mass_centers" in layers),
            (Layer.GRAVITY, "gravity" in layers),
            (Layer.EFFORTS, "torques" in layers),
            (Layer.FINE, "fine" in layers),
            (Layer.SHADOWS, "shadows" in layers),
            # Over a map it would only dim the colors, and true shadows need no help.
            (Layer.SPOT, not layers & {"floor_map", "shadows"}),
        ):
            if self.scene.shown(layer) != visible:
                self.scene.show(layer, visible)
