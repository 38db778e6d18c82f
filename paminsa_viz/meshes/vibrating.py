"""Tubes that swing about their rest position, as a GLB whose animation the viewer plays itself.

The displacement is a morph target and its weight a sine of time (glTF 2.0, sections 3.7.2.2 and
3.11): a page that shows it computes and sends nothing while it moves.
"""

from __future__ import annotations

import json
import struct
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.meshes.part import srgb_to_linear
from paminsa_viz.model.arrays import Array

SIDES: Final = 8
"""Sides of a tube."""

KEYS: Final = 25
"""Instants of a cycle at which the weight is given; linear in between, to 1 % of a sine."""

_FLOAT, _INDEX = 5126, 5125
_VERTICES, _TRIANGLES = 34962, 34963


def tubes(lines: Array, radius: float) -> tuple[Array, NDArray[np.uint32]]:
    """Return vertices (n, points, `SIDES`, 3) and triangles of tubes around lines (n, points, 3).

    A line is taken as straight from its first to its last point.
    """
    along = lines[:, -1] - lines[:, 0]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    helper = np.where(np.abs(along[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(along, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = np.cos(angle)[:, None] * first[:, None]
    ring = ring + np.sin(angle)[:, None] * np.cross(along, first)[:, None]
    vertices = lines[:, :, None] + radius * ring[:, None]
    count, points = lines.shape[:2]
    i = np.arange(SIDES)
    j = (i + 1) % SIDES
    low = SIDES * np.arange(points - 1)[:, None]
    quads = np.stack([low + i, low + j, low + SIDES + j, low + SIDES + i], axis=-1).reshape(-1, 4)
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    whole = faces + (SIDES * points * np.arange(count))[:, None, None]
    return vertices, whole.reshape(-1, 3).astype(np.uint32)


def vibrating_glb(lines: Array, moves: Array, *, radius: float, color: str, period: float) -> bytes:
    """Return tubes around lines that swing by ``moves`` to both sides, as a GLB.

    Args:
        lines: (n, points, 3) center lines at rest [m].
        moves: (n, points, 3) displacements at the end of a swing [m].
        radius: Of the tubes [m].
        color: ``#rrggbb``.
        period: Time of a whole swing [s].
    """
    vertices, faces = tubes(lines, radius)
    delta = np.repeat(moves[:, :, None], SIDES, axis=2)
    times = np.linspace(0.0, period, KEYS)
    weights = np.sin(2 * np.pi * np.linspace(0.0, 1.0, KEYS))
    arrays = [
        (vertices.reshape(-1, 3).astype("<f4"), _VERTICES, "VEC3"),
        (delta.reshape(-1, 3).astype("<f4"), _VERTICES, "VEC3"),
        (faces.reshape(-1).astype("<u4"), _TRIANGLES, "SCALAR"),
        (times.astype("<f4"), None, "SCALAR"),
        (weights.astype("<f4"), None, "SCALAR"),
    ]
    views, accessors, offset = list[dict[str, Any]](), list[dict[str, Any]](), 0
    for data, target, kind in arrays:
        view = {"buffer": 0, "byteOffset": offset, "byteLength": data.nbytes}
        views.append(view if target is None else view | {"target": target})
        rows = data.reshape(len(data), -1)
        accessors.append(
            {
                "bufferView": len(accessors), "type": kind, "count": len(data),
                "componentType": _INDEX if data.dtype.kind == "u" else _FLOAT,
                "min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist(),
            }
        )  # fmt: skip
        offset += data.nbytes
    tree = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "mode"}],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}],
                        "indices": 2, "material": 0,
                    }
                ],
                "weights": [0.0],
            }
        ],
        "materials": [
            {
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*srgb_to_linear(color), 1.0],
                    "metallicFactor": 0.0, "roughnessFactor": 0.7,
                },
                "doubleSided": True,
            }
        ],
        "animations": [
            {
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
                "samplers": [{"input": 3, "output": 4, "interpolation": "LINEAR"}],
            }
        ],
        "bufferViews": views, "accessors": accessors, "buffers": [{"byteLength": offset}],
    }  # fmt: skip
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    blob = b"".join(data.tobytes() for data, _, _ in arrays)
    parts = struct.pack("<II", len(text), 0x4E4F534A) + text
    parts += struct.pack("<II", len(blob), 0x004E4942) + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(parts)) + parts
