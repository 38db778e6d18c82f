"""The escape twist where a motion crosses a singularity, as arrows of the platform."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model import Geometry, inverse_kinematics
from paminsa_viz.palette import BAD
from paminsa_viz.trajectory import CrossingPlan

Array = NDArray[np.float64]

LONGEST: Final = 0.2
"""Longest arrow [m]."""

BELOW: Final = 0.12
"""Distance of a label below the platform [m]."""


def twist_arrows(geometry: Geometry, found: CrossingPlan) -> Array:
    """Return the motions of the platform's center and joints 5 along t_s, (4 k, 2, 3) [m].

    The crossings are after each other, the longest arrow of each is `LONGEST`.
    """
    arrows = [np.zeros((0, 2, 3))]
    for item in found.crossings:
        pose, twist = np.array(item.crossing.pose), np.array(item.condition.twist)
        center = pose[[0, 1, 3]]
        joints = inverse_kinematics(geometry, pose).points[5]
        starts = np.concatenate([center[None], joints])
        arms = starts - center
        moves = np.array([twist[0], twist[1], twist[3]]) + twist[2] * np.stack(
            [-arms[:, 1], arms[:, 0], np.zeros(4)], axis=1
        )
        moves *= LONGEST / np.linalg.norm(moves, axis=1).max()
        arrows.append(np.stack([starts, starts + moves], axis=1))
    return np.concatenate(arrows)


class EscapeTwist:
    """The layer ``escape_twist``: arrows at every planned crossing of the motion, with a label."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: CrossingPlan | None = None
        self._nodes: list[Any] = []

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the motion."""
        del dragging
        state = frame.state
        shown = {"escape_twist", "path"} <= state.layers and state.document.motion.crosses
        found = motions.planned(state).crossing if shown else None
        if found is self._drawn:
            return
        self._drawn = found
        for node in self._nodes:
            node.remove()
        self._nodes = []
        if found is None or not found.crossings:
            return
        arrows = twist_arrows(state.document.design.geometry, found)
        self._nodes.append(
            self._scene.add_arrows(
                "/escape/arrows",
                arrows.astype(np.float32),
                linear_colors(BAD)[0],
                shaft_radius=0.006,
                head_radius=0.014,
                head_length=0.035,
            )
        )
        for index, item in enumerate(found.crossings):
            x, y, _, z = item.crossing.pose
            self._nodes.append(
                self._scene.add_label(
                    f"/escape/label{index}",
                    f"t_s at the {item.crossing.locus.label}",
                    position=(x, y, z - BELOW),
                    font_screen_scale=0.9,
                    anchor="top-center",
                )
            )
