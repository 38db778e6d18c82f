"""What ends a volume, in groups that the page tells apart: on its surface and on a map."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.state.requirements import SurfacePart
from paminsa_viz.model import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.outside import Outside
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.causes import CauseKind, VolumeCause, cause_slice
from paminsa_viz.synthesis.volume.solve import Volume
from paminsa_viz.synthesis.volume.surface import cause_color, volume_surface

MOST_FACES = 6000
"""Triangles that are sent: some 100 kB, and what a browser without a graphics card can draw."""


class CauseGroup(NamedTuple):
    """Causes that the page does not tell apart.

    Attributes:
        text: For people.
        color: ``#rrggbb``.
        requirement: Index of the requirement, None for others.
    """

    text: str
    color: str
    requirement: int | None = None


_TEXTS = {
    CauseKind.INSIDE: "",
    CauseKind.REACH: "reach",
    CauseKind.SINGULAR: "singularity",
    CauseKind.OTHER_SIDE: "level of the guides",
    CauseKind.DISCONNECTED: "not connected to home",
}


def group_of(cause: VolumeCause) -> CauseGroup:
    """Return the group of a cause."""
    return CauseGroup(_TEXTS.get(cause.kind, cause.text), cause_color(cause), cause.requirement)


def cause_groups(
    causes: tuple[VolumeCause, ...],
) -> tuple[tuple[CauseGroup, ...], NDArray[np.uint8]]:
    """Return the groups of causes, that of what is inside first, and the group of each code."""
    groups = tuple(dict.fromkeys(group_of(cause) for cause in causes))
    return groups, np.array([groups.index(group_of(cause)) for cause in causes], np.uint8)


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


def outside_of(field: Field, design: Design, requirements: Requirements) -> Outside:
    """Return which cells of a solved map break a requirement, and which one the most.

    Cells that cannot be reached are not among them; maps show those in another way.
    """
    (_, y), (_, x) = field.grid.axes
    theta, z = field.grid.fixed[2:]
    found = cause_slice(design, requirements, x, y, float(theta), float(z), field=field)
    groups, index = cause_groups(found.causes)
    code = index[found.cause]
    code[(field.status != Limit.OK) | ~found.broken.any(axis=0)] = 0
    return Outside(
        code, tuple(group.text for group in groups), tuple(group.color for group in groups)
    )
