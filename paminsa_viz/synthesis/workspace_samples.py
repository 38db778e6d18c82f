"""Sample poses of a regular workspace, and the best place for one that is free to move."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import ndimage

from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume import Volume

Center = tuple[float, float, float]

DIRECTIONS = 12
"""Directions of samples on the innermost ring; the legs' own are among them."""


class Samples(NamedTuple):
    """Positions and heights, on the boundary of a workspace and within.

    Attributes:
        positions: (n, 2) [m].
        z: (heights,) [m].
    """

    positions: Array
    z: Array


def sample_workspace(workspace: Workspace, center: Center, density: int) -> Samples:
    """Return samples of a workspace at a center [m]; its boundary and corners are among them.

    Args:
        workspace: Shape and size.
        center: Its center (x, y, z) [m].
        density: Samples from the center to the boundary.
    """
    x, y, height = (0.5 * extent for extent in workspace.size)
    if workspace.shape is WorkspaceShape.CYLINDER:
        rings = []
        for radius in np.linspace(0.0, x, density + 1)[1:]:
            count = DIRECTIONS * max(1, round(density * radius / x / 2))
            angle = np.radians(30.0) + 2.0 * np.pi * np.arange(count) / count
            rings.append(radius * np.column_stack([np.cos(angle), np.sin(angle)]))
        flat = np.concatenate([np.zeros((1, 2)), *rings])
    else:
        side = np.linspace(-1.0, 1.0, 2 * density + 1)
        flat = np.stack(np.meshgrid(x * side, y * side, indexing="ij"), axis=-1).reshape(-1, 2)
    z = center[2] + height * np.linspace(-1.0, 1.0, 2 * density + 1)
    return Samples(flat + np.array(center[:2]), z)


def best_center(workspace: Workspace, volume: Volume) -> Center:
    """Return the center at which a workspace lies deepest in a volume, to a node [m].

    Coordinates that the workspace gives are kept. Where it does not fit, it is where it sticks out
    least.
    """
    step = volume.cell
    free = [place is None for place in workspace.center]
    axes = (volume.x, volume.y, volume.z)
    reach = [round(0.5 * extent / step) for extent in workspace.size]
    outside = -float(np.abs(volume.depth).max()) - max(workspace.size)
    depth = ndimage.minimum_filter1d(
        volume.depth, 2 * reach[2] + 1, axis=2, mode="constant", cval=outside
    )
    offset = [step * np.arange(-count, count + 1) for count in reach[:2]]
    if workspace.shape is WorkspaceShape.CYLINDER:
        disc = np.hypot(offset[0][:, None], offset[1]) <= 0.5 * workspace.size[0] + 1e-9 * step
    else:
        disc = np.ones((len(offset[0]), len(offset[1])), np.bool_)
    if any(free[:2]):
        depth = ndimage.minimum_filter(
            depth, footprint=disc[..., None], mode="constant", cval=outside
        )
        chosen = [
            slice(None) if place is None else _near(axis, place)
            for axis, place in zip(axes, workspace.center, strict=True)
        ]
        part = depth[chosen[0], :, :] if isinstance(chosen[0], slice) else depth[chosen[0]][None]
        part = part[:, chosen[1]] if isinstance(chosen[1], slice) else part[:, [chosen[1]]]
        part = part[..., chosen[2]] if isinstance(chosen[2], slice) else part[..., [chosen[2]]]
        index = np.unravel_index(int(part.argmax()), part.shape)
        found = [
            float(axis[i]) if place is None else place
            for axis, i, place in zip(axes, index, workspace.center, strict=True)
        ]
    else:
        i, j = (
            _near(axis, place or 0.0)
            for axis, place in zip(axes, workspace.center[:2], strict=False)
        )
        dx, dy = np.nonzero(disc)
        rows, columns = i + dx - reach[0], j + dy - reach[1]
        held = (rows >= 0) & (rows < len(axes[0])) & (columns >= 0) & (columns < len(axes[1]))
        column = depth[rows[held], columns[held]].min(axis=0)
        found = [*workspace.center[:2], float(axes[2][int(column.argmax())])]
    x, y, z = (float(place or 0.0) for place in found)
    return x, y, z if workspace.center[2] is None else workspace.center[2]


def _near(axis: Array, place: float) -> int:
    return int(np.abs(axis - place).argmin())
