"""Which pairs of bodies are checked, in which group each is, and why others are not."""

from __future__ import annotations

from enum import Enum
from typing import Final

from paminsa_viz.clearance.solids import Body, BodyPart
from paminsa_viz.model.design import KneeBranch


class PairGroup(Enum):
    """Groups of pairs of bodies; each pair is in one, the last that fits in this order."""

    BETWEEN_LEGS = "between legs"
    SAME_LEG = "same leg"
    CARRIAGE = "carriage and arms B1"
    PLATFORM = "platform"
    FRAME = "frame"
    PAYLOAD = "payload"
    COUNTERWEIGHTS = "counterweights"


ALL_PAIRS: Final = frozenset(PairGroup)
"""All groups."""


class Exclusion(Enum):
    """Why a pair of bodies is not checked."""

    RIGID = "fixed to each other"
    JOINED = "joined by a joint"
    GUIDED = "one turns or slides inside the other"
    LAYERS = "side by side across the leg plane in every pose"


_JOINED: Final = frozenset(
    frozenset(pair)
    for pair in (
        ("shaft_end", "b3"), ("guide", "slider"), ("slider", "b7"), ("slider", "b8"),
        ("b8", "b4"), ("b4", "b3"), ("b3", "b7"), ("b4", "swivel"),
    )
)  # fmt: skip
"""Bodies of one leg that a joint holds together."""

_GUIDED: Final = frozenset(frozenset(pair) for pair in (("shaft", "quill"), ("shaft", "guide")))
_RIGID: Final = frozenset(frozenset(pair) for pair in (("guide", "quill"), ("shaft", "shaft_end")))


def group_of(one: Body, other: Body) -> PairGroup:
    """Return the group of a pair of bodies."""
    parts = {one.part, other.part}
    for part, group in (
        (BodyPart.COUNTERWEIGHT, PairGroup.COUNTERWEIGHTS),
        (BodyPart.PAYLOAD, PairGroup.PAYLOAD),
        (BodyPart.FRAME, PairGroup.FRAME),
        (BodyPart.PLATFORM, PairGroup.PLATFORM),
        (BodyPart.CARRIAGE, PairGroup.CARRIAGE),
    ):
        if part in parts:
            return group
    return PairGroup.SAME_LEG if one.leg == other.leg else PairGroup.BETWEEN_LEGS


def in_one_plane(one: Body, other: Body) -> bool:
    """Whether both bodies stay at their places across the same leg plane."""
    planar = (BodyPart.LEG, BodyPart.COUNTERWEIGHT)
    return one.leg == other.leg and one.part in planar and other.part in planar


def exclusion(one: Body, other: Body, knee: KneeBranch) -> Exclusion | None:
    """Return why a pair of bodies is not checked, None for one that is."""
    keys = frozenset((one.key, other.key))
    parts = {one.part, other.part}
    if parts == {BodyPart.FRAME} or (one.frame == other.frame and parts != {BodyPart.LEG}):
        return Exclusion.RIGID
    if in_one_plane(one, other):
        if keys in _RIGID:
            return Exclusion.RIGID
        if keys in _JOINED:
            return Exclusion.JOINED
        if keys in _GUIDED:
            return Exclusion.GUIDED
        return None if _share_a_layer(one, other) else Exclusion.LAYERS
    if keys == {"swivel", "platform"}:
        return Exclusion.JOINED
    if keys == {"arm", "shaft"} and one.leg == other.leg:
        return Exclusion.JOINED
    if keys & {"quill", "shaft"} and (
        "base" in keys or keys & {f"m{leg}" for leg in (one.leg, other.leg) if leg}
    ):
        return Exclusion.GUIDED
    if "column" in keys and keys & {"carriage", "arm"}:
        return Exclusion.GUIDED
    if keys == {"carriage", "m4"} and knee is KneeBranch.UPPER:
        return Exclusion.GUIDED
    return None


def _share_a_layer(one: Body, other: Body) -> bool:
    """Whether two bodies of a leg can meet at all: solids overlap across the leg plane."""
    return any(
        max(a.extent[0, 1], b.extent[0, 1]) < min(a.extent[1, 1], b.extent[1, 1])
        for a in one.solids
        for b in other.solids
        if a.joint not in other.joints and b.joint not in one.joints
    )
