"""The two nearest bodies in the scene: a line between their nearest points, with the distance."""

from __future__ import annotations

from typing import Final

import numpy as np
import viser

from paminsa_viz.explorer import clearing
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.curves import Curve
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.palette import BAD, INK, WARN
from paminsa_viz.units import format_value

WIDTH: Final = 4.0
RADIUS: Final = 0.006
"""Of the balls at the nearest points [m]."""


class ClearanceView:
    """The layer ``clearance``."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._lines = {
            color: Curve(context.scene, f"/clearance/{name}", color, WIDTH)
            for name, color in (("enough", INK), ("little", WARN), ("overlap", BAD))
        }
        self._label: viser.LabelHandle | None = None
        self._drawn: object = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the result; a pose whose clearance is not known yet has no line."""
        del dragging
        state = frame.state
        found = clearing.nearest(state) if "clearance" in state.layers else None
        required = state.clearance_view.required
        if (found, required) == self._drawn:
            return
        self._drawn = (found, required)
        for line in self._lines.values():
            line.visible = False
        if self._label is not None:
            self._label.visible = False
        if found is None:
            return
        few = WARN if found.distance < required else INK
        line = self._lines[BAD if found.distance < 0 else few]
        line.draw([found.points])
        line.visible = True
        text = f"{found.names[0]} – {found.names[1]}: {format_value(found.distance, 'm', 3)}"
        place = tuple(found.points.mean(axis=0) + np.array([0.0, 0.0, 2 * RADIUS]))
        if self._label is None:
            self._label = self._scene.add_label(
                "/clearance/label", text, font_screen_scale=0.9, anchor="bottom-center"
            )
        self._label.text, self._label.position, self._label.visible = text, place, True
