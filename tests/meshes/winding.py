"""Whether points lie inside closed meshes, by winding numbers: for tests of clearance."""

from __future__ import annotations

import numpy as np
import trimesh

from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.model.arrays import Array


def winding_numbers(points: Array, triangles: Array) -> Array:
    """Return how often a closed mesh (m, 3, 3) winds around each point (n, 3): 1 inside, 0 out."""
    a, b, c = (triangles[None, :, i] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    volume = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    shape = (
        la * lb * lc
        + np.einsum("ijk,ijk->ij", a, b) * lc
        + np.einsum("ijk,ijk->ij", b, c) * la
        + np.einsum("ijk,ijk->ij", c, a) * lb
    )
    return np.arctan2(volume, shape).sum(axis=1) / (2 * np.pi)


class SolidBody:
    """A body's solids, and points spread over their surfaces."""

    def __init__(self, part: MeshPart, spacing: float = 0.005) -> None:
        self.solids = [p.mesh.vertices[p.mesh.faces] for p in part.solids]
        self.low = np.array([s.min(axis=(0, 1)) for s in self.solids])
        self.high = np.array([s.max(axis=(0, 1)) for s in self.solids])
        clouds = []
        for solid in part.solids:
            count = int(np.clip(solid.mesh.area / spacing**2, 60, 4000))
            clouds.append(trimesh.sample.sample_surface(solid.mesh, count, seed=0)[0])
        self.points = np.vstack(clouds)

    def holds(self, points: Array) -> Array:
        """Return which of the points (n, 3), in the body's frame, lie inside one of its solids."""
        out = np.zeros(len(points), dtype=bool)
        for solid, low, high in zip(self.solids, self.low, self.high, strict=True):
            near = np.flatnonzero(((points > low) & (points < high)).all(axis=1) & ~out)
            for part in np.array_split(near, len(near) // 400 + 1):
                if len(part):
                    out[part] = winding_numbers(points[part], solid) > 0.5
        return out
