"""Where bars of a leg would touch if their center lines lay in one plane: balls and labels."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from trimesh.creation import icosphere

from paminsa_viz import palette
from paminsa_viz.elastostatics.contacts import contacts, pair_name
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.layers import SceneContext

RADIUS: Final = 0.028
"""Radius of a ball [m]: more than that of a bar, so that it can be seen."""

COLOR: Final = palette.BAD


class ContactView:
    """The layer ``contacts``: balls where two bars would touch, and a label for each leg."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: tuple[object, ...] = ()
        self._nodes: list[Any] = []
        self._ball = icosphere(subdivisions=2, radius=RADIUS)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow pose, lengths and tubes; nothing is sent while hidden."""
        del dragging
        shown = "contacts" in frame.state.layers
        design, pose = frame.shown_design, frame.configuration.pose
        key = (shown, *((design.geometry, design.elastic, tuple(pose.tolist())) if shown else ()))
        if key == self._drawn:
            return
        self._drawn = key
        for node in self._nodes:
            node.remove()
        self._nodes.clear()
        if not shown or not np.isfinite(pose).all():
            return
        found = contacts(design, pose)
        for leg, gap in enumerate(found.gap):
            pairs = np.flatnonzero(gap < 0)
            for pair in pairs:
                self._nodes.append(
                    self._scene.add_mesh_simple(
                        f"/contacts/{leg + 1}-{pair}", np.asarray(self._ball.vertices, np.float32),
                        np.asarray(self._ball.faces, np.uint32), color=palette.rgb(COLOR),
                        opacity=0.5, position=found.point[leg, pair], cast_shadow=False,
                        receive_shadow=False,
                    )
                )  # fmt: skip
            if pairs.size:
                top = max(found.point[leg, pairs], key=lambda place: place[2])
                self._nodes.append(
                    self._scene.add_label(
                        f"/contacts/{leg + 1}", ", ".join(map(pair_name, pairs.tolist())),
                        font_screen_scale=0.8, anchor="bottom-center",
                        position=top + np.array([0.0, 0.0, RADIUS]),
                    )
                )  # fmt: skip
