"""What ends a volume, in groups that the page tells apart: reach, singularities, requirements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.synthesis.volume.causes import CauseKind, VolumeCause
from paminsa_viz.synthesis.volume.surface import cause_color


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
