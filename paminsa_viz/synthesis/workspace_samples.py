"""Sample poses of a regular workspace, and the best place for one that is free to move."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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
    depth = least_within(volume.depth, workspace, volume)
    return center_at(workspace, volume, int(depth.argmax()))


def center_at(workspace: Workspace, volume: Volume, candidate: int) -> Center:
    """Return the center [m] of a candidate by its flat index in the result of `least_within`."""
    axes = _candidates(workspace, volume)
    index = np.unravel_index(candidate, [len(axis) for axis in axes])
    x, y, z = (
        float(coordinate[axis[i]]) if place is None else place
        for axis, i, place, coordinate in zip(
            axes, index, workspace.center, (volume.x, volume.y, volume.z), strict=True
        )
    )
    return x, y, z


def least_within(values: Array, workspace: Workspace, volume: Volume) -> Array:
    """Return the least value within a workspace at each of its possible centers, (x, y, z).

    Coordinates that the workspace gives have one center, the nearest node.

    Args:
        values: (x, y, z) on the volume's nodes; NaN counts as minus infinite, as does what lies
            beyond the nodes.
        workspace: Shape, size and center.
        volume: The volume.
    """
    # Late: it takes a third of a second to load.
    from scipy import ndimage

    step = volume.cell
    found = np.where(np.isnan(values), -np.inf, values)
    reach = [round(0.5 * extent / step) for extent in workspace.size]
    found = ndimage.minimum_filter1d(found, 2 * reach[2] + 1, axis=2, mode="constant", cval=-np.inf)
    rows, columns, heights = _candidates(workspace, volume)
    found = found[..., heights]
    offset = [step * np.arange(-count, count + 1) for count in reach[:2]]
    if workspace.shape is WorkspaceShape.CYLINDER:
        disc = np.hypot(offset[0][:, None], offset[1]) <= 0.5 * workspace.size[0] + 1e-9 * step
    else:
        disc = np.ones((len(offset[0]), len(offset[1])), np.bool_)
    if len(rows) > 1 or len(columns) > 1:
        found = ndimage.minimum_filter(
            found, footprint=disc[..., None], mode="constant", cval=-np.inf
        )
        return found[np.ix_(rows, columns)]
    i, j = np.nonzero(disc)
    i, j = i + rows[0] - reach[0], j + columns[0] - reach[1]
    held = (i >= 0) & (i < len(volume.x)) & (j >= 0) & (j < len(volume.y))
    if not held.all():
        return np.full((1, 1, len(heights)), -np.inf)
    return found[i, j].min(axis=0)[None, None]


def _candidates(workspace: Workspace, volume: Volume) -> list[NDArray[np.intp]]:
    """Return the indices of the nodes at which a center may lie, along each axis."""
    return [
        np.arange(len(axis)) if place is None else np.array([np.abs(axis - place).argmin()])
        for axis, place in zip((volume.x, volume.y, volume.z), workspace.center, strict=True)
    ]
