"""The volume where all requirements hold, and regular workspaces: required, and proven."""

from __future__ import annotations

from typing import Final

import numpy as np
from viser import MeshHandle

from paminsa_viz import palette
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.requirements.checking import placed_workspace
from paminsa_viz.explorer.requirements.jobs import SurfacePart, VolumeOutcome
from paminsa_viz.explorer.scene.curves import Curve
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import WorkspaceShape

OPACITY: Final = 0.4
CORNERS: Final = 64
"""Points around a cylinder."""

Place = tuple[float, float, float]


class VolumeLayer:
    """The layer ``volume``: the surface, a mesh for each cause in its color.

    It is sent when the page is idle, and hidden while it is of another design or of other
    requirements.
    """

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: VolumeOutcome | None = None
        self._meshes: list[MeshHandle] = []

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the result; nothing is sent while hidden."""
        outcome = frame.state.requiring.fine
        shown = "volume" in frame.state.layers and outcome is not None
        shown = shown and outcome is not None and outcome.job.serves(frame.state.document)
        if shown and outcome is not None and outcome is not self._drawn and not dragging:
            self._drawn = outcome
            self._draw(() if outcome.result is None else outcome.result.surface)
        for mesh in self._meshes:
            mesh.visible = shown and outcome is self._drawn

    def _draw(self, surface: tuple[SurfacePart, ...]) -> None:
        for mesh in self._meshes:
            mesh.remove()
        self._meshes = [
            self._scene.add_mesh_simple(
                f"/requirements/volume/{index}", part.vertices.astype(np.float32), part.faces,
                color=palette.rgb(part.color), opacity=OPACITY, side="double",
                cast_shadow=False, receive_shadow=False,
            )
            for index, part in enumerate(surface)
        ]  # fmt: skip


class WorkspaceOutlines:
    """The layers ``required_workspace`` and ``proven_workspace``: outlines."""

    def __init__(self, context: SceneContext) -> None:
        scene = context.scene
        self._required = Curve(scene, "/requirements/required", palette.INK, 2.0)
        self._proven = Curve(scene, "/requirements/proven", palette.OK, 3.0)
        self._drawn: dict[str, object] = {}

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the requirements and the proof."""
        del dragging
        state = frame.state
        required = placed_workspace(state)
        proven = None
        largest = state.requiring.largest
        if largest.outcome is not None and largest.outcome.job.serves(state.document):
            proven = largest.proven
        for key, curve, placed in (
            ("required_workspace", self._required, required),
            ("proven_workspace", self._proven, proven),
        ):
            curve.visible = key in state.layers and placed is not None
            if not curve.visible or placed == self._drawn.get(key) or placed is None:
                continue
            self._drawn[key] = placed
            curve.draw(outline(*placed))


def outline(shape: WorkspaceShape, size: Place, center: Place) -> list[Array]:
    """Return the edges of a workspace as lines (n, 3) [m]."""
    if shape is WorkspaceShape.BOX:
        around = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)], np.float64)
        uprights = slice(0, 4)
    else:
        angle = np.linspace(0, 2 * np.pi, CORNERS + 1)
        around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        uprights = slice(0, CORNERS, CORNERS // 8)
    low, high = (
        np.hstack([around, np.full((len(around), 1), side)]) * np.array(size) / 2 + center
        for side in (-1.0, 1.0)
    )
    return [low, high, *np.stack([low[uprights], high[uprights]], axis=1)]
