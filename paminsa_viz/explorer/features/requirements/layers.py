"""The volume where all requirements hold, and regular workspaces: required, and proven."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.requirements import placed_workspace
from paminsa_viz.explorer.scene.nodes import Node, curves, mesh
from paminsa_viz.explorer.state.requirements import VolumeResult
from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import WorkspaceShape

OPACITY: Final = 0.4

Place = tuple[float, float, float]


def volume(frame: Frame) -> tuple[Node, ...]:
    """Draw the layer ``volume``: the surface, a mesh for each cause in its color.

    Nothing is drawn that is of another design or of other requirements.
    """
    outcome = frame.state.requirements.fine
    if outcome is None or outcome.result is None or not outcome.job.serves(frame.state.document):
        return ()
    return _surface(outcome.result)


@kept(2)
def _surface(found: VolumeResult) -> tuple[Node, ...]:
    return tuple(
        mesh(f"/requirements/volume/{i}", part.vertices, part.faces, part.color, opacity=OPACITY)
        for i, part in enumerate(found.surface)
    )


def required_workspace(frame: Frame) -> Iterator[Node]:
    """Draw the outline of the required workspace."""
    placed = placed_workspace(frame.state)
    if placed is not None:
        yield curves("/requirements/required", outline(*placed), frame.state.theme.ink)


def proven_workspace(frame: Frame) -> Iterator[Node]:
    """Draw the outline of the largest workspace that is proven."""
    largest = frame.state.requirements.largest
    outcome = largest.outcome
    if largest.proven and outcome is not None and outcome.job.serves(frame.state.document):
        color = frame.state.theme.good_fill
        yield curves("/requirements/proven", outline(*largest.proven), color, 3.0)


def outline(shape: WorkspaceShape, size: Place, center: Place) -> list[Array]:
    """Return the edges of a workspace as lines (n, 3) [m]."""
    around, uprights = shape.section.edge()
    low, high = (
        np.hstack([around, np.full((len(around), 1), side)]) * np.array(size) / 2 + center
        for side in (-1.0, 1.0)
    )
    return [low, high, *np.stack([low[uprights], high[uprights]], axis=1)]
