"""The mesh files of the fixed parts: writing them, finding them, reading them.

In a checkout they lie in ``assets/meshes`` at the top of the repository; in an installed wheel in
``paminsa_viz/assets/meshes``. Files follow glTF's convention (y up): the top node, "z_up", turns
the part's own frame, in which z is up.
"""

from __future__ import annotations

import io
from functools import cache, lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import cast

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb

from paminsa_viz.meshes.catalog import CATALOGUE
from paminsa_viz.meshes.part import Part, Piece
from paminsa_viz.meshes.shading import is_plain

Z_UP = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""Transform that takes coordinates with z up to glTF's, with y up."""


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
        if folder.joinpath(f"{CATALOGUE[0].name}.glb").is_file():
            return folder
    raise MissingMeshes(
        "the mesh files are missing; `python -m paminsa_viz.meshes` writes them "
        f"to {checkout_folder()}"
    )


def part_glb(part: Part) -> bytes:
    """Return a part as a GLB file with y up, one named mesh for each material."""
    scene = trimesh.Scene()
    scene.graph.update(frame_to="z_up", frame_from=scene.graph.base_frame, matrix=Z_UP)
    for name, mesh in part.colored():
        scene.add_geometry(mesh, node_name=name, geom_name=name, parent_node_name="z_up")
    return cast(bytes, export_glb(scene, include_normals=True))


@cache
def _read(name: str) -> Part:
    data = mesh_folder().joinpath(f"{name}.glb").read_bytes()
    scene = trimesh.load_scene(io.BytesIO(data), file_type="glb", process=False)
    pieces = []
    for material, mesh in scene.geometry.items():
        mesh = cast(trimesh.Trimesh, mesh)
        clean = trimesh.Trimesh(
            vertices=np.asarray(mesh.vertices, dtype=np.float64),
            faces=mesh.faces,
            vertex_normals=np.asarray(mesh.vertex_normals, dtype=np.float64),
            process=False,
        )
        pieces.append(Piece(material, clean))
    return Part(pieces)


_MAKERS = {fitting.name: fitting.make for fitting in CATALOGUE}


def fixed_part(name: str) -> Part:
    """Return a fixed part from its mesh file, in the part's own frame (z up) [m].

    Within `plain_shapes` it is a plain one.

    Raises:
        KeyError: If no part has this name.
        MissingMeshes: If the mesh files are not there.
    """
    if name not in _MAKERS:
        raise KeyError(name)
    return (_plain(name) if is_plain() else _read(name)).copy()


@cache
def _plain(name: str) -> Part:
    """Make a fixed part with few faces; there is no file of it."""
    return _MAKERS[name]()


def write_meshes(folder: Path) -> list[Path]:
    """Write every fixed part and the table that lists them; return the paths written.

    The same program writes the same bytes every time.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths, rows = [], []
    for fitting in CATALOGUE:
        part = fitting.make()
        path = folder / f"{fitting.name}.glb"
        path.write_bytes(part_glb(part))
        paths.append(path)
        low, high = part.bounds() * 1e3
        size = " x ".join(f"{length:.0f}" for length in high - low)
        faces = sum(len(piece.mesh.faces) for piece in part.pieces)
        rows.append(f"| `{path.name}` | {fitting.purpose} | {fitting.frame} | {size} | {faces} |")
    table = folder / "README.md"
    table.write_text(_TABLE_HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    return [*paths, table]


_TABLE_HEAD = """# Parts of fixed shape

Written by `python -m paminsa_viz.meshes`; do not edit by hand. Bars, arms, shafts, guide links,
the platform's plate and the frame follow the lengths of the design and are made when needed
(`paminsa_viz/meshes/bodies.py`, `frame.py`).

Lengths are in meters. Each part's own frame has z up; as glTF wants y up, the node `z_up` of each
file turns it. Each mesh is named after its material; `accent` takes the color of a leg or of M4.

| file | what it is | origin and axes | size x, y, z [mm] | triangles |
|---|---|---|---|---|
"""
