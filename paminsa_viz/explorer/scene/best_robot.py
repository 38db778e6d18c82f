"""The best robot of a search so far, as a stick figure next to the robot."""

from __future__ import annotations

from typing import Final

import numpy as np
from viser import LineSegmentsHandle

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.scene.mechanism import sticks
from paminsa_viz.explorer.synthesis.jobs import BestSoFar, Shown
from paminsa_viz.model import inverse_kinematics

COLOR: Final = "#CC79A7"
"""A hue of the Okabe-Ito set that no leg has."""

NODE: Final = "/synthesis/best"


class BestRobot:
    """The layer ``best_so_far``."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: BestSoFar | None = None
        self._lines: LineSegmentsHandle | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the search."""
        del dragging
        synthesizing = frame.state.synthesizing
        best = synthesizing.best
        shown = (
            "best_so_far" in frame.state.layers
            and synthesizing.settings.shown is Shown.GHOST
            and synthesizing.running is not None
        )
        if shown and best is not None and best.design is not None and best is not self._drawn:
            self._drawn = best
            self._draw(best)
        if self._lines is not None:
            self._lines.visible = shown and self._drawn is not None

    def _draw(self, best: BestSoFar) -> None:
        if best.design is None:
            return
        x, y, z = best.center
        lines = sticks(inverse_kinematics(best.design.geometry, (x, y, 0.0, z)))
        lines = lines.reshape(-1, 2, 3).astype(np.float32)
        if self._lines is None:
            colors = np.broadcast_to(linear_colors(COLOR)[0], lines.shape).copy()
            self._lines = self._scene.add_line_segments(
                NODE, lines, colors, thickness=4.0, thickness_units="screen"
            )
        self._lines.points = lines
