"""The surface of a volume, and which cause cuts it where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import palette
from paminsa_viz.model.arrays import Array
from paminsa_viz.synthesis.causes import INSIDE, CauseKind, VolumeCause
from paminsa_viz.synthesis.distance import zero_surface
from paminsa_viz.synthesis.volume import Volume

FACES = 20_000
"""Faces of a surface, at most, unless another number is asked for."""

_BEYOND = (CauseKind.SINGULAR, CauseKind.REACH)
"""Causes at nodes where requirements are not evaluated."""

_KIND_COLORS = {
    CauseKind.INSIDE: palette.OK,
    CauseKind.OTHER_SIDE: palette.PLATFORM,
    CauseKind.SINGULAR: palette.BAD,
    CauseKind.DISCONNECTED: palette.INK,
    CauseKind.REACH: palette.MUTED,
}
_REQUIREMENT_COLORS = (
    "#E69F00", "#56B4E9", "#CC79A7", "#009E73", "#F0E442", "#7A5195", "#0072B2", "#D55E00",
)  # fmt: skip


def cause_color(cause: VolumeCause) -> str:
    """Return the color ``#rrggbb`` of a cause: one a requirement, one for all limits of reach."""
    if cause.requirement is None:
        return _KIND_COLORS[cause.kind]
    return _REQUIREMENT_COLORS[cause.requirement % len(_REQUIREMENT_COLORS)]


@dataclass(frozen=True, eq=False)
class VolumeSurface:
    """The closed surface of a volume; its faces' normals point outward.

    Attributes:
        vertices: (n, 3) [m].
        faces: (m, 3) indices of vertices.
        cause: (n,) code of what cuts at a vertex, see `Volume.causes`.
        causes: What the codes mean.
    """

    vertices: Array
    faces: NDArray[np.int64]
    cause: NDArray[np.uint8]
    causes: tuple[VolumeCause, ...]

    @property
    def face_cause(self) -> NDArray[np.uint8]:
        """Code of what cuts at a face (m,): that of two of its vertices, or of the first."""
        a, b, c = self.cause[self.faces].T
        return np.where(b == c, b, a)

    def parts(self) -> dict[VolumeCause, tuple[Array, NDArray[np.int64]]]:
        """Return vertices (n, 3) [m] and faces (m, 3) of the part that each cause cuts."""
        found, code = {}, self.face_cause
        for each in np.unique(code):
            used, faces = np.unique(self.faces[code == each], return_inverse=True)
            found[self.causes[each]] = (self.vertices[used], faces.reshape(-1, 3))
        return found

    def areas(self) -> dict[VolumeCause, float]:
        """Return the area that each cause cuts [m^2], the largest first."""
        found = {}
        for cause, (vertices, faces) in self.parts().items():
            a, b, c = (vertices[faces[:, i]] for i in range(3))
            found[cause] = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
        return dict(sorted(found.items(), key=lambda item: -item[1]))


def volume_surface(volume: Volume, *, faces: int = FACES) -> VolumeSurface:
    """Return the surface of a volume, by marching cubes, with fewer faces where it is flat.

    Args:
        volume: The volume; if it is empty, so is the surface.
        faces: Largest number of faces.
    """
    if volume.empty:
        none = np.zeros((0, 3))
        return VolumeSurface(none, none.astype(np.int64), np.zeros(0, np.uint8), volume.causes)
    nodes, triangles = zero_surface(volume.depth)
    cause = _cause_at(volume, nodes)
    vertices = nodes * volume.cell + [volume.x[0], volume.y[0], volume.z[0]]
    if len(triangles) > faces:
        # Late: needed only for surfaces, and it takes its time to load.
        import fast_simplification

        fewer, fewer_triangles = fast_simplification.simplify(
            vertices, triangles.astype(np.int32), target_count=max(faces, 4)
        )[:2]
        cause = cause[_nearest(vertices, fewer)]
        vertices, triangles = np.asarray(fewer, float), np.asarray(fewer_triangles, np.int64)
    return VolumeSurface(vertices, triangles, cause, volume.causes)


def _cause_at(volume: Volume, nodes: Array) -> NDArray[np.uint8]:
    """Return what cuts the volume at points on edges of the grid.

    It is the cause at the edge's node outside. Where that cannot be reached, requirements are not
    known there, and one may end the volume before reach or the singularity does: then it is what
    is nearest to the node inside.
    """
    top = np.array(volume.cause.shape) - 1
    first, second = (
        tuple(np.clip(round_(nodes).astype(int), 0, top).T) for round_ in (np.floor, np.ceil)
    )
    swapped = volume.cause[first] != INSIDE
    inner = tuple(np.where(swapped, b, a) for a, b in zip(first, second, strict=True))
    outer = tuple(np.where(swapped, a, b) for a, b in zip(first, second, strict=True))
    cause = volume.cause[outer]
    kinds = np.array([each.kind in _BEYOND for each in volume.causes])
    hidden = kinds[cause] & (volume.depth[inner] < volume.cell)
    return np.where(hidden | (cause == INSIDE), volume.nearest[inner], cause)


def _nearest(points: Array, queries: Array) -> NDArray[np.intp]:
    """Return the index of the nearest of some points to each other point."""
    # Late: needed only for surfaces, and it takes its time to load.
    from scipy.spatial import KDTree

    return np.asarray(KDTree(points).query(queries)[1], np.intp)
