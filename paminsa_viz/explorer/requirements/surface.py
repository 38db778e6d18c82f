"""The surface of a volume in parts, one for each group of causes that end it there."""

from __future__ import annotations

import numpy as np

from paminsa_viz.explorer.requirements.causes import group_of
from paminsa_viz.explorer.requirements.jobs import SurfacePart
from paminsa_viz.synthesis.volume.solve import Volume
from paminsa_viz.synthesis.volume.surface import volume_surface

MOST_FACES = 6000
"""Triangles that are sent: some 100 kB, and what a browser without a graphics card can draw."""


def surface_parts(volume: Volume) -> tuple[SurfacePart, ...]:
    """Return the surface where requirements end to hold, by what ends them; nothing if empty."""
    found: dict[str, SurfacePart] = {}
    for cause, (vertices, faces) in volume_surface(volume, faces=MOST_FACES).parts().items():
        color = group_of(cause).color
        known = found.get(color)
        if known is not None:
            faces = np.concatenate([known.faces, faces + len(known.vertices)])
            vertices = np.concatenate([known.vertices, vertices])
        found[color] = SurfacePart(vertices, faces.astype(np.uint32), color)
    return tuple(found.values())
