"""A compact GLB of one body for the browser: one mesh node, 16-bit indices.

Normals go as plain floats: the viewer computes them again in place, which bytes would not survive.
Files meant for other programs are written by trimesh, see `paminsa_viz.meshes.library` and
`paminsa_viz.meshes.posed`.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import trimesh

from paminsa_viz.meshes.materials import COMMON, SURFACES, Surface, linear

_UNLIT = "KHR_materials_unlit"
_FLOAT, _UINT16, _UINT32 = 5126, 5123, 5125


class _Chunk:
    """The binary part of a GLB under construction, with the views and accessors into it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, object]] = []

    def add(self, array: np.ndarray, component: int, kind: str, target: int, **more: object) -> int:
        """Append an array and return its accessor's index."""
        raw = array.tobytes()
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw), "target": target}
        self.data += raw + b"\0" * (-len(raw) % 4)
        self.views.append(view)
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": component,
                "count": len(array),
                "type": kind,
                **more,
            }
        )
        return len(self.accessors) - 1


def compact_glb(
    meshes: Mapping[str, trimesh.Trimesh], colors: Mapping[str, str], *, plain: bool = False
) -> bytes:
    """Return a GLB with one mesh for each material.

    Args:
        meshes: By material name (see `paminsa_viz.meshes.materials`).
        colors: Colors (``#rrggbb``) that replace those of named materials.
        plain: Make one mesh of all lit materials and one of all others, colored by their points
            and with `COMMON` for a surface: every mesh of every picture has its price.
    """
    chunk = _Chunk()
    primitives: list[dict[str, object]] = []
    materials: list[dict[str, object]] = []
    if plain:
        for lit in (True, False):
            group = {name: mesh for name, mesh in meshes.items() if SURFACES[name].lit is lit}
            if group:
                primitives.append(_primitive(chunk, group, colors, len(materials), by_point=True))
                materials.append(_material("plain", replace(COMMON, lit=lit), "#ffffff"))
    else:
        for name, mesh in meshes.items():
            primitives.append(_primitive(chunk, {name: mesh}, colors, len(materials)))
            materials.append(_material(name, SURFACES[name], _color(name, colors)))
    tree = {
        "asset": {"version": "2.0"},
        "extensionsUsed": [_UNLIT],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": materials,
        "accessors": chunk.accessors,
        "bufferViews": chunk.views,
        "buffers": [{"byteLength": len(chunk.data)}],
    }
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(chunk.data)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, total),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(chunk.data), b"BIN\0"),
            bytes(chunk.data),
        ]
    )


def _color(name: str, colors: Mapping[str, str]) -> str:
    return colors.get(name, SURFACES[name].color)


def _material(name: str, surface: Surface, color: str) -> dict[str, object]:
    red, green, blue = linear(color)
    return {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [round(red, 4), round(green, 4), round(blue, 4), 1.0],
            "metallicFactor": surface.metallic,
            "roughnessFactor": surface.roughness,
        },
        **({} if surface.lit else {"extensions": {_UNLIT: {}}}),
    }


def _primitive(
    chunk: _Chunk,
    meshes: Mapping[str, trimesh.Trimesh],
    colors: Mapping[str, str],
    material: int,
    *,
    by_point: bool = False,
) -> dict[str, object]:
    """Append meshes as one, with a color at each point if asked for."""
    counts = [len(mesh.vertices) for mesh in meshes.values()]
    shifts = np.cumsum([0, *counts[:-1]])
    points = np.vstack([mesh.vertices for mesh in meshes.values()]).astype("<f4")
    normals = np.vstack([mesh.vertex_normals for mesh in meshes.values()]).astype("<f4")
    faces = np.concatenate(
        [mesh.faces.reshape(-1) + s for mesh, s in zip(meshes.values(), shifts, strict=True)]
    )
    attributes = {
        "POSITION": chunk.add(
            points, _FLOAT, "VEC3", 34962,
            min=points.min(axis=0).tolist(), max=points.max(axis=0).tolist(),
        ),
        "NORMAL": chunk.add(normals, _FLOAT, "VEC3", 34962),
    }  # fmt: skip
    if by_point:
        shades = np.array([linear(_color(name, colors)) for name in meshes], dtype="<f4")
        attributes["COLOR_0"] = chunk.add(np.repeat(shades, counts, axis=0), _FLOAT, "VEC3", 34962)
    small = len(points) <= 65535
    index = chunk.add(
        faces.astype("<u2" if small else "<u4"),
        _UINT16 if small else _UINT32, "SCALAR", 34963,
    )  # fmt: skip
    return {"attributes": attributes, "indices": index, "material": material}
