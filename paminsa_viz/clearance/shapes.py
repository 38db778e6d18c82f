"""The bodies of a design as solids, the pairs that are checked, and why others are not."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from itertools import combinations, pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.clearance.frame_shapes import frame_bodies, moving_bodies
from paminsa_viz.clearance.leg_shapes import leg_bodies
from paminsa_viz.clearance.solids import WORLD, Body, BodyPart
from paminsa_viz.dimensions.body_scale import design_over_scale
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.kept import kept
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry, KneeBranch
from paminsa_viz.model.parameters import Counterweight, Payload

Integers = NDArray[np.int64]

FRAMES: Final = (*BODIES, WORLD)
"""Frames in the order of the kernels' arrays."""


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


class ShapeArrays(NamedTuple):
    """Bodies and their solids as the kernels take them; solids of a body follow each other."""

    kind: Integers  # (solids,)
    size: Array  # (solids, 3)
    radius: Array  # (solids,)
    first: Integers  # (solids,) rows of corners
    last: Integers
    corners: Array  # (all corners, 2)
    local: Array  # (solids, 12) rotation and center in the body's frame
    rod: Array  # (solids, 7) enclosing capsule in the body's frame: two ends, radius
    low: Array  # (solids,) range across the leg plane
    high: Array
    joint: Integers  # (solids,) the joint as a bit
    start: Integers  # (bodies + 1,) where its solids start
    frame: Integers  # (bodies,)
    center: Array  # (solids, 3) of the enclosing box in the body's frame
    half: Array  # (solids, 3) its half extents
    body_rod: Array  # (bodies, 7)
    body_center: Array  # (bodies, 3)
    body_half: Array  # (bodies, 3)
    leg: Integers  # (bodies,) its leg where it stays in the leg plane, else 0
    joints: Integers  # (bodies,) joints that it is mounted around, as bits


@dataclass(frozen=True, eq=False)
class Shapes:
    """The bodies of a design and the pairs that are checked.

    Attributes:
        bodies: All bodies.
        pairs: Indices of the bodies of every pair that is checked.
        groups: Group of each pair.
        excluded: Indices of the bodies of every other pair, and why it is not checked.
        arrays: The same for the kernels.
    """

    bodies: tuple[Body, ...]
    pairs: tuple[tuple[int, int], ...]
    groups: tuple[PairGroup, ...]
    excluded: tuple[tuple[int, int, Exclusion], ...]
    arrays: ShapeArrays

    @cached_property
    def names(self) -> tuple[tuple[str, str], ...]:
        """Names of the bodies of every pair that is checked."""
        return tuple((self.bodies[i].name, self.bodies[j].name) for i, j in self.pairs)

    def of_groups(self, groups: Iterable[PairGroup]) -> Integers:
        """Return the indices of the pairs of some groups (n,)."""
        chosen = frozenset(groups)
        return np.array([i for i, g in enumerate(self.groups) if g in chosen], dtype=np.int64)


@of_design
def shapes_of(design: Design) -> Shapes:
    """Return the bodies of a design and the pairs that are checked; the last ones are kept.

    They follow from the geometry, the payload's mass and the counterweights.
    """
    return _kept_shapes(design.geometry, design.payload.mass, design.counterweights)


def build_shapes(
    geometry: Geometry, payload: float, counterweights: tuple[Counterweight, ...]
) -> Shapes:
    """Return the same from what it follows from: geometry, mass of the payload, counterweights."""
    design = design_over_scale(
        Design(geometry, payload=Payload(payload), counterweights=counterweights)
    )
    bodies = (*leg_bodies(design), *moving_bodies(design), *frame_bodies(design))
    if geometry.body_scale != 1.0:
        bodies = _enlarged(bodies, geometry.body_scale)
    # Lengths change no pair: layers, joints and frames are the same for all of them.
    structure = (
        geometry.knee, payload > 0, tuple((w.bar, w.mass > 0) for w in counterweights)
    )  # fmt: skip
    if structure not in _KNOWN_PAIRS:
        if len(_KNOWN_PAIRS) >= MOST_STRUCTURES:
            _KNOWN_PAIRS.clear()
        _KNOWN_PAIRS[structure] = _pairs(bodies, geometry.knee)
    return Shapes(bodies, *_KNOWN_PAIRS[structure], arrays_of(bodies))


def _enlarged(bodies: tuple[Body, ...], scale: float) -> tuple[Body, ...]:
    """Return the bodies enlarged about the origins of their frames; legs share their solids."""
    solids = {id(body.solids): body.solids for body in bodies}
    large = {key: tuple(solid.times(scale) for solid in own) for key, own in solids.items()}
    return tuple(replace(body, solids=large[id(body.solids)]) for body in bodies)


Pairs = tuple[
    tuple[tuple[int, int], ...], tuple[PairGroup, ...], tuple[tuple[int, int, Exclusion], ...]
]

_KNOWN_PAIRS: dict[tuple[object, ...], Pairs] = {}
MOST_STRUCTURES: Final = 64
"""Sets of bodies whose pairs are kept."""


def _pairs(bodies: tuple[Body, ...], knee: KneeBranch) -> Pairs:
    """Return the pairs that are checked, their groups, and the others with their reasons."""
    pairs, groups, excluded = [], [], []
    for i, j in combinations(range(len(bodies)), 2):
        reason = exclusion(bodies[i], bodies[j], knee)
        if reason is None:
            pairs.append((i, j))
            groups.append(group_of(bodies[i], bodies[j]))
        else:
            excluded.append((i, j, reason))
    return tuple(pairs), tuple(groups), tuple(excluded)


_kept_shapes = kept(32)(build_shapes)


def arrays_of(bodies: tuple[Body, ...]) -> ShapeArrays:
    solids = [solid for body in bodies for solid in body.solids]
    counts = np.array([len(solid.corners) for solid in solids])
    last = np.cumsum(counts)
    rods = np.array([solid.rod for solid in solids])
    start = np.cumsum([0, *(len(body.solids) for body in bodies)])
    extents = np.array([solid.extent for solid in solids])
    pieces = [slice(a, b) for a, b in pairwise(start)]
    common = np.array([(extents[a, 0].min(axis=0), extents[a, 1].max(axis=0)) for a in pieces])
    # the three legs have their solids in common
    enclosing = {id(body.solids): a for body, a in zip(bodies, pieces, strict=True)}
    enclosing = {key: _common_rod(rods[a]) for key, a in enclosing.items()}
    return ShapeArrays(
        kind=np.array([solid.kind for solid in solids]),
        size=np.array([solid.size for solid in solids]),
        radius=np.array([solid.radius for solid in solids]),
        first=last - counts,
        last=last,
        corners=np.vstack([solid.corners for solid in solids]),
        local=np.array([[*solid.rotation.ravel(), *solid.center] for solid in solids]),
        rod=rods,
        low=extents[:, 0, 1].copy(),
        high=extents[:, 1, 1].copy(),
        joint=np.array([_bits([solid.joint]) for solid in solids]),
        start=start,
        frame=np.array([FRAMES.index(body.frame) for body in bodies]),
        center=extents.mean(axis=1),
        half=np.diff(extents, axis=1)[:, 0] / 2,
        body_rod=np.array([enclosing[id(body.solids)] for body in bodies]),
        body_center=common.mean(axis=1),
        body_half=np.diff(common, axis=1)[:, 0] / 2,
        leg=np.array([body.leg if in_one_plane(body, body) else 0 for body in bodies]),
        joints=np.array([_bits(body.joints) for body in bodies]),
    )


def _bits(joints: Iterable[int]) -> int:
    return sum(1 << joint for joint in joints if joint)


def _common_rod(rods: Array) -> Array:
    """Return a capsule about several, along the longest of them (7,) [m]."""
    ends = rods[:, :6].reshape(-1, 2, 3)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    longest = int(np.argmax(lengths))
    if lengths[longest] > 0:
        axis = (ends[longest, 1] - ends[longest, 0]) / lengths[longest]
    else:
        axis = np.array([0.0, 0.0, 1.0])
    origin = ends[longest].mean(axis=0)
    points, radii = ends.reshape(-1, 3), np.repeat(rods[:, 6], 2)
    along = (points - origin) @ axis
    low, high = along.min(), along.max()
    nearest = origin + np.outer(along, axis)
    radius = float((np.linalg.norm(points - nearest, axis=1) + radii).max())
    return np.array([*(origin + low * axis), *(origin + high * axis), radius])
