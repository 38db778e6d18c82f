"""A part: pieces of mesh with a material each, in one frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.visual import TextureVisuals

from paminsa_viz.meshes.glb import compact_glb
from paminsa_viz.meshes.materials import ACCENT, SURFACES, material
from paminsa_viz.meshes.solids import moved

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Piece:
    """One solid of a part and the name of its material (see `paminsa_viz.meshes.materials`)."""

    material: str
    mesh: trimesh.Trimesh


@dataclass
class Part:
    """Meshes that move as one body. Coordinates [m] in the body's own frame, z up.

    Attributes:
        pieces: The meshes, each with its material.
    """

    pieces: list[Piece] = field(default_factory=list)

    def add(self, material_name: str, *meshes: trimesh.Trimesh) -> Part:
        """Append meshes of one material and return the part itself."""
        if material_name not in SURFACES:
            raise KeyError(material_name)
        self.pieces.extend(Piece(material_name, mesh) for mesh in meshes)
        return self

    def join(self, *others: Part) -> Part:
        """Append the pieces of other parts and return the part itself."""
        for other in others:
            self.pieces.extend(other.pieces)
        return self

    def copy(self) -> Part:
        """Return a part of the same pieces, to which others can be added."""
        return Part(list(self.pieces))

    def moved(
        self,
        offset: tuple[float, float, float] | Array = (0.0, 0.0, 0.0),
        rotation: Array | None = None,
    ) -> Part:
        """Return a copy turned by ``rotation`` (3, 3), then shifted by ``offset`` [m]."""
        return Part([Piece(p.material, moved(p.mesh, offset, rotation)) for p in self.pieces])

    def merged(self) -> Iterator[tuple[str, trimesh.Trimesh]]:
        """Yield one mesh for each material, in the order of first use."""
        for name in dict.fromkeys(piece.material for piece in self.pieces):
            yield name, _stacked([p.mesh for p in self.pieces if p.material == name])

    def without_small(self, size: float) -> Part:
        """Return the part without pieces that are in every direction smaller than ``size`` [m]."""
        return Part([p for p in self.pieces if np.ptp(p.mesh.bounds, axis=0).max() >= size])

    def bounds(self) -> Array:
        """Return the lower and upper corner of all pieces, (2, 3) [m]."""
        corners = np.array([piece.mesh.bounds for piece in self.pieces])
        return np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])

    def colored(self, accent: str | None = None) -> list[tuple[str, trimesh.Trimesh]]:
        """Return one mesh for each material with its material set, colored faces in ``accent``."""
        out = []
        for name, mesh in self.merged():
            mesh.visual = TextureVisuals(material=material(name, accent))
            out.append((name, mesh))
        return out

    def glb(self, accent: str | None = None, *, plain: bool = False) -> bytes:
        """Return the part as a `compact_glb` in its own frame, axes as they are (z up)."""
        return compact_glb(dict(self.merged()), {ACCENT: accent} if accent else {}, plain=plain)


def _stacked(meshes: list[trimesh.Trimesh]) -> trimesh.Trimesh:
    """Return the meshes as one, vertices and normals kept as they are."""
    shift = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return trimesh.Trimesh(
        vertices=np.vstack([mesh.vertices for mesh in meshes]),
        faces=np.vstack([mesh.faces + s for mesh, s in zip(meshes, shift, strict=True)]),
        vertex_normals=np.vstack([mesh.vertex_normals for mesh in meshes]),
        process=False,
    )


def joined(parts: Iterable[Part]) -> Part:
    """Return all pieces of several parts as one part."""
    return Part().join(*parts)
