"""Why a node is not in a volume."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from paminsa_viz.model.reach import MARGINS
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirements


class CauseKind(Enum):
    """Kind of a cause."""

    INSIDE = "inside"
    OTHER_SIDE = "other side"
    SINGULAR = "singularity"
    DISCONNECTED = "not connected"
    REACH = "reach"
    REQUIREMENT = "requirement"


class VolumeCause(NamedTuple):
    """Why a node is not in a volume.

    Attributes:
        code: Its number, the index in `Volume.causes`.
        kind: Its kind.
        text: For people.
        word: For tables, without blanks.
        requirement: Index of the requirement, None for other causes.
        leg: Index of the leg, None where no leg is the cause.
    """

    code: int
    kind: CauseKind
    text: str
    word: str
    requirement: int | None = None
    leg: int | None = None


INSIDE, OTHER_SIDE, SINGULAR, DISCONNECTED, FIRST_REACH = range(5)
FIRST_REQUIREMENT = FIRST_REACH + 3 * len(MARGINS)
"""Codes: reach is FIRST_REACH + 4 * leg + limit, requirements count from FIRST_REQUIREMENT."""

_FIXED = (
    VolumeCause(INSIDE, CauseKind.INSIDE, "all requirements hold", "inside"),
    VolumeCause(OTHER_SIDE, CauseKind.OTHER_SIDE, "on the other side of the guides", "other-side"),
    VolumeCause(
        SINGULAR, CauseKind.SINGULAR, "at a singularity, or beyond one from home", "singular"
    ),
    VolumeCause(DISCONNECTED, CauseKind.DISCONNECTED, "not connected to home", "not-connected"),
    *(
        VolumeCause(
            FIRST_REACH + len(MARGINS) * leg + index,
            CauseKind.REACH,
            limit.reason(leg),
            f"{limit.word}:leg{leg + 1}",
            leg=leg,
        )
        for leg in range(3)
        for index, limit in enumerate(MARGINS)
    ),
)


def causes_of(requirements: Requirements) -> tuple[VolumeCause, ...]:
    """Return every cause by its code: those of all volumes, then the requirements."""
    broken = (
        VolumeCause(
            FIRST_REQUIREMENT + index,
            CauseKind.REQUIREMENT,
            requirement_label(bound),
            f"requirement{index + 1}:{bound.quantity}",
            requirement=index,
        )
        for index, bound in enumerate(requirements.bounds)
    )
    return (*_FIXED, *broken)
