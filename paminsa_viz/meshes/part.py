"""A part: solids in one frame, each of a named surface; and how parts go into a glTF scene."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from paminsa_viz import palette
from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.meshes.solids import Array, is_plain, moved

ACCENT = "accent"
"""Material of a part's colored faces; each leg and M4 put their own color in its place."""


@dataclass(frozen=True)
class Surface:
    """A color (``#rrggbb``, as seen) with the two numbers of the metal-rough model, 0 to 1.

    A surface that is not ``lit`` shows its color as it is; it is the cheapest to draw.
    """

    color: str
    metallic: float
    roughness: float
    lit: bool = True


SURFACES: dict[str, Surface] = {
    "frame": Surface("#b7bfc8", 0.1, 0.48),
    "body": Surface("#3b434c", 0.15, 0.5),
    "dark": Surface("#20252b", 0.1, 0.6),
    "steel": Surface("#c3c9d0", 0.25, 0.32),
    "platform": Surface(palette.PLATFORM, 0.1, 0.42),
    "floor": Surface("#edf1f6", 0.0, 0.85, lit=False),
    "rim": Surface("#bcc4ce", 0.0, 0.85, lit=False),
    "line": Surface("#d3d9e0", 0.0, 0.85, lit=False),
    "dark floor": Surface("#7d858e", 0.0, 0.85, lit=False),
    "dark rim": Surface("#5d656e", 0.0, 0.85, lit=False),
    "dark line": Surface("#6d757e", 0.0, 0.85, lit=False),
    "load": Surface("#c39a4c", 0.2, 0.4),
    ACCENT: Surface("#8a929b", 0.1, 0.42),
}
"""Every material that a part may carry, by name."""

COMMON = Surface("#ffffff", 0.12, 0.46)
"""The surface of all lit faces where each point has its own color."""

NORMAL_DECIMALS = 9
"""Of normals in files, whose single precision has seven."""


def srgb_to_linear(color: str) -> tuple[float, float, float]:
    """Return ``#rrggbb`` as linear light, 0 to 1: what glTF wants in a base color factor."""
    levels = (channel / 255 for channel in palette.rgb(color))
    red, green, blue = (
        level / 12.92 if level <= 0.04045 else ((level + 0.055) / 1.055) ** 2.4 for level in levels
    )
    return red, green, blue


_UNLIT = "KHR_materials_unlit"


@dataclass(frozen=True)
class Solid:
    """One solid of a part and the name of its material, a key of `SURFACES`."""

    material: str
    mesh: trimesh.Trimesh


@dataclass
class MeshPart:
    """Meshes that move as one body. Coordinates [m] in the body's own frame, z up.

    Attributes:
        solids: The meshes, each with its material.
    """

    solids: list[Solid] = field(default_factory=list)

    def add(self, material_name: str, *meshes: trimesh.Trimesh) -> MeshPart:
        """Append meshes of one material and return the part itself.

        Raises:
            InvalidInput: If there is no such material.
        """
        if material_name not in SURFACES:
            hint = name_hint(material_name, SURFACES)
            raise InvalidInput("material_name", f"there is no {material_name!r:.60}; {hint}")
        self.solids.extend(Solid(material_name, mesh) for mesh in meshes)
        return self

    def join(self, *others: MeshPart) -> MeshPart:
        """Append the solids of other parts and return the part itself."""
        for other in others:
            self.solids.extend(other.solids)
        return self

    def copy(self) -> MeshPart:
        """Return a part of the same solids, to which others can be added."""
        return MeshPart(list(self.solids))

    def moved(
        self,
        offset: tuple[float, float, float] | Array = (0.0, 0.0, 0.0),
        rotation: Array | None = None,
    ) -> MeshPart:
        """Return a copy turned by ``rotation`` (3, 3), then shifted by ``offset`` [m]."""
        return MeshPart([Solid(s.material, moved(s.mesh, offset, rotation)) for s in self.solids])

    def times(self, scale: float) -> MeshPart:
        """Return a copy enlarged about its origin, the part itself for a scale of 1."""
        if scale == 1.0:
            return self
        return MeshPart(
            [
                Solid(
                    s.material,
                    trimesh.Trimesh(
                        vertices=scale * s.mesh.vertices, faces=s.mesh.faces,
                        vertex_normals=s.mesh.vertex_normals, process=False,
                    ),
                )
                for s in self.solids
            ]
        )  # fmt: skip

    def renamed(self, prefix: str) -> MeshPart:
        """Return a copy whose materials are those of the same names after a prefix."""
        out = MeshPart()
        for solid in self.solids:
            out.add(f"{prefix} {solid.material}", solid.mesh)
        return out

    def merged(self) -> Iterator[tuple[str, trimesh.Trimesh]]:
        """Yield one mesh for each material, in the order of first use."""
        for name in dict.fromkeys(solid.material for solid in self.solids):
            yield name, _stacked([s.mesh for s in self.solids if s.material == name])

    def without_small(self, size: float) -> MeshPart:
        """Return the part without solids that are in every direction smaller than ``size`` [m]."""
        return MeshPart([s for s in self.solids if np.ptp(s.mesh.bounds, axis=0).max() >= size])

    def bounds(self) -> Array:
        """Return the lower and upper corner of all solids, (2, 3) [m]."""
        corners = np.array([solid.mesh.bounds for solid in self.solids])
        return np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])

    def colored(self, accent: str | None = None) -> dict[str, trimesh.Trimesh]:
        """Return one mesh for each material with its material set, colored faces in ``accent``."""
        out = dict(self.merged())
        for name, mesh in out.items():
            mesh.visual = _visual(name, SURFACES[name], _color(name, accent))
        return out

    def colored_by_point(self, accent: str | None) -> dict[str, trimesh.Trimesh]:
        """Return one mesh of all lit materials and one of all others, colored at their vertices.

        `COMMON` is the surface of both: fewer meshes are faster to draw.
        """
        out = {}
        for label, lit in (("lit", True), ("unlit", False)):
            group = {name: mesh for name, mesh in self.merged() if SURFACES[name].lit is lit}
            if group:
                mesh = out[label] = _stacked(list(group.values()))
                colors = [srgb_to_linear(_color(name, accent)) for name in group]
                counts = [len(each.vertices) for each in group.values()]
                shades = np.repeat([(*color, 1.0) for color in colors], counts, axis=0)
                mesh.visual = _visual(label, COMMON, COMMON.color)
                mesh.visual.vertex_attributes["color"] = np.rint(255 * shades).astype(np.uint8)
        return out

    def glb(self, accent: str | None = None, *, plain: bool = False) -> bytes:
        """Return the part as a GLB for the browser in its own frame, axes as they are (z up).

        Args:
            accent: Color (``#rrggbb``) of the colored faces.
            plain: See `colored_by_point`.
        """
        scene = trimesh.Scene()
        meshes = self.colored_by_point(accent) if plain else self.colored(accent)
        for name, mesh in meshes.items():
            scene.add_geometry(mesh, node_name=name, geom_name=name)
        return glb_bytes(scene, tree_postprocessor=_mark_unlit)


def glb_bytes(scene: trimesh.Scene, **options: Any) -> bytes:
    """Return a scene as a GLB with its normals."""
    return cast(bytes, export_glb(scene, include_normals=True, **options))


def add_part(
    scene: trimesh.Scene, part: MeshPart, node: str, matrix: Array, parent: str,
    accent: str | None = None,
) -> None:  # fmt: skip
    """Add a part to a scene below a node, as a node of its own with one mesh for each material."""
    scene.graph.update(frame_to=node, frame_from=parent, matrix=matrix)
    for name, mesh in part.colored(accent).items():
        label = f"{node}.{name}"
        scene.add_geometry(mesh, node_name=label, geom_name=label, parent_node_name=node)


def _color(name: str, accent: str | None) -> str:
    return accent if name == ACCENT and accent else SURFACES[name].color


def _visual(name: str, surface: Surface, color: str) -> TextureVisuals:
    return TextureVisuals(
        material=PBRMaterial(
            name=name,
            baseColorFactor=[round(v, 4) for v in srgb_to_linear(color)] + [1.0],
            metallicFactor=surface.metallic,
            roughnessFactor=surface.roughness,
        )
    )


def _mark_unlit(tree: dict[str, Any]) -> None:
    """Let the materials that are not lit show their color as it is."""
    for each in tree["materials"]:
        if each["name"] == "unlit" or (each["name"] in SURFACES and not SURFACES[each["name"]].lit):
            each["extensions"] = {_UNLIT: {}}
            tree["extensionsUsed"] = [_UNLIT]


def _stacked(meshes: list[trimesh.Trimesh]) -> trimesh.Trimesh:
    """Return the meshes as one, vertices kept as they are.

    Normals are rounded: what is left of zero depends on how a processor adds.
    """
    normals = np.vstack([mesh.vertex_normals for mesh in meshes])
    shift = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return trimesh.Trimesh(
        vertices=np.vstack([mesh.vertices for mesh in meshes]),
        faces=np.vstack([mesh.faces + s for mesh, s in zip(meshes, shift, strict=True)]),
        vertex_normals=np.round(normals, NORMAL_DECIMALS) + 0.0,  # no zero has a sign
        process=False,
    )


# -------------------------------------------------------------------- mesh files of the fixed parts
# In a checkout they lie in ``assets/meshes`` at the top of the repository, where
# ``assets/make_parts.py`` writes them; in an installed wheel in ``paminsa_viz/assets/meshes``.
# Files follow glTF's convention (y up): the top node, "z_up", turns the part's own frame, in which
# z is up.

Z_UP: Final = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""Transform that takes coordinates with z up to glTF's, with y up."""

PLAIN: Final = "plain"
"""Folder of the parts with few faces; a part that has nothing large has no file there."""


class MissingMeshes(FileNotFoundError):
    """The mesh files are neither in the package nor in the checkout."""


def checkout_folder() -> Path:
    """Return where the mesh files lie in a checkout of the repository."""
    return Path(__file__).resolve().parents[2] / "assets" / "meshes"


@lru_cache(maxsize=1)
def mesh_folder() -> Traversable:
    """Return the folder that holds the mesh files.

    Raises:
        MissingMeshes: If there is none.
    """
    packaged = resources.files("paminsa_viz").joinpath("assets", "meshes")
    for folder in (packaged, checkout_folder()):
        if folder.joinpath("barrel.glb").is_file():
            return folder
    raise MissingMeshes(
        "the mesh files are missing; `python assets/make_parts.py` in a checkout writes them to "
        f"{checkout_folder()}"
    )


@kinds_checked
def fixed_part(name: str) -> MeshPart:
    """Return a fixed part from its mesh file, in the part's own frame (z up) [m].

    Within `plain_shapes` it is a plain one.

    Raises:
        InvalidInput: If no part has this name.
        MissingMeshes: If the mesh files are not there.
    """
    folder = mesh_folder()
    if not name.isidentifier() or not folder.joinpath(f"{name}.glb").is_file():
        known = sorted(item.name[:-4] for item in folder.iterdir() if item.name.endswith(".glb"))
        raise InvalidInput("name", f"there is no {name!r:.60}; {name_hint(name, known)}")
    return _read(name, is_plain()).copy()


@cache
def _read(name: str, plain: bool) -> MeshPart:
    folder = mesh_folder().joinpath(PLAIN) if plain else mesh_folder()
    file = folder.joinpath(f"{name}.glb")
    part = MeshPart()
    if plain and not file.is_file():
        return part
    scene = trimesh.load_scene(io.BytesIO(file.read_bytes()), file_type="glb", process=False)
    for material, mesh in scene.geometry.items():
        mesh = cast(trimesh.Trimesh, mesh)
        clean = trimesh.Trimesh(
            vertices=np.asarray(mesh.vertices, dtype=np.float64),
            faces=mesh.faces,
            vertex_normals=np.asarray(mesh.vertex_normals, dtype=np.float64),
            process=False,
        )
        part.add(material, clean)
    return part
