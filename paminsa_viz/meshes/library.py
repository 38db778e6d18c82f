"""The mesh files of the fixed parts: finding and reading them.

In a checkout they lie in ``assets/meshes`` at the top of the repository, where
``assets/make_parts.py`` writes them; in an installed wheel in ``paminsa_viz/assets/meshes``. Files
follow glTF's convention (y up): the top node, "z_up", turns the part's own frame, in which z is up.
"""

from __future__ import annotations

import io
from functools import cache, lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Final, cast

import numpy as np
import trimesh

from paminsa_viz.checks import kinds_checked
from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.meshes.solids import is_plain

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
        KeyError: If no part has this name.
        MissingMeshes: If the mesh files are not there.
    """
    if not name.isidentifier() or not mesh_folder().joinpath(f"{name}.glb").is_file():
        raise KeyError(name)
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
