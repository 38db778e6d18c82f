"""Clearance: the nearest bodies at a pose, by groups of pairs, and over many poses."""

from __future__ import annotations

import math
import re
from collections import Counter
from typing import Any

import numpy as np

from paminsa_viz.blocks.data import robot
from paminsa_viz.blocks.kinds import Block, Note, Table, rows
from paminsa_viz.clearance import Clearance, PairGroup, clearance, clearance_reason
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.resizing import is_comparable, length_ratio
from paminsa_viz.units import format_value, number

MOST = 12
"""Pairs of the list of nearest bodies."""


def by_group(design: Design, pose: Array) -> dict[PairGroup, Clearance]:
    """Return the clearance at a pose (4,) of each group of pairs."""
    return {group: clearance(design, pose, [group]) for group in PairGroup}


def size_advice(geometry: Geometry) -> str:
    """Return which size bodies should have that do not go with the lengths, "" for others.

    One that is not the prototype's was chosen.
    """
    times = length_ratio(geometry)
    if geometry.body_scale != 1.0 or is_comparable(times):
        return ""
    return (
        f"bodies are as large as the prototype’s, lengths {number(times, 3)} times as long: set "
        f"s_b, the size of the bodies among the lengths, to about {number(times, 2)}"
    )


def size_blocks(geometry: Geometry) -> list[Note]:
    """Return what distances say of a robot whose bodies do not go with its lengths."""
    advice = size_advice(geometry)
    if not advice:
        return []
    text = "These are not the distances of a machine that is built of parts of its own size: "
    return [Note(f"{text}{advice}.", "warn")]


def pose_blocks(
    design: Design, groups: dict[PairGroup, Clearance], here: Clearance, required: float = 0.0
) -> list[Block]:
    """Return the nearest bodies of each group at a pose, and whether they are apart enough.

    Args:
        design: The robot.
        groups: Clearance of each group.
        here: Clearance of all pairs.
        required: Least clearance [m].
    """
    names = here.pairs[int(here.pair)] if here.pair >= 0 else ("", "")
    cells = (
        (group.value, *found.pairs[int(found.pair)], format_value(float(found.least), "m"))
        for group, found in groups.items()
        if found.pair >= 0
    )
    head = ("Pairs", "Nearest", "To", "Distance")
    return [
        Table(head, rows(*cells), "Nearest bodies at the pose, as they are drawn.", words=3),
        verdict(float(here.least), names, required),
        *size_blocks(design.geometry),
    ]


def verdict(distance: float, names: tuple[str, str], required: float = 0.0) -> Note:
    """Return whether the nearest bodies of a pose are apart by what is required [m]."""
    if reason := clearance_reason(distance, names, required):
        return Note(f"{reason}.", "bad" if distance < 0 else "warn")
    if math.isnan(distance):
        return Note("The pose cannot be taken, or no pair of bodies is checked.", "muted")
    one, other = names
    return Note(f"Least clearance: {format_value(distance, 'm')}, {one} and {other}.", "ok")


def region_blocks(over: Clearance, required: float = 0.0, what: str = "poses") -> list[Block]:
    """Return how many of many poses (n,) are too close, and which bodies are nearest in them.

    Args:
        over: Clearance of the poses.
        required: Least clearance [m].
        what: What the poses are.
    """
    reached = over.least[np.isfinite(over.least)]
    text = f"{len(reached):,} of {over.least.size:,} {what} can be taken"
    if len(reached) == 0:
        return [Note(f"{text}.", "warn")]
    share = 100 * np.mean(reached < required)
    near = f"are less than {format_value(required, 'm')} apart" if required else "overlap"
    text += f"; bodies {near} in {share:.1f} % of them."
    cells = (
        (*names, f"{count:,}", format_value(least, "m"))
        for names, count, least in nearest_kinds(over)[:MOST]
    )
    head = ("Nearest", "To", "Poses", "Least")
    table = Table(head, rows(*cells), f"Bodies that are nearest in some of the {what}.", words=2)
    return [Note(text, "warn" if share else "ok"), table]


def nearest_kinds(found: Clearance) -> list[tuple[tuple[str, str], int, float]]:
    """Return the pairs that are nearest in some pose: kinds of bodies, in how many, least [m]."""
    taken = found.pair >= 0
    counts: Counter[tuple[str, str]] = Counter()
    least: dict[tuple[str, str], float] = {}
    for pair, distance in zip(found.pair[taken], found.least[taken], strict=True):
        one, other = (re.sub(r"( of leg)? ?\d$", "", name) for name in found.pairs[pair])
        counts[one, other] += 1
        least[one, other] = min(float(distance), least.get((one, other), np.inf))
    return [(kinds, count, least[kinds]) for kinds, count in counts.most_common()]


def clearance_data(
    design: Design, pose: Any, groups: dict[PairGroup, Clearance], here: Clearance,
    over: Clearance | None, required: float,
) -> dict[str, Any]:  # fmt: skip
    """Return the nearest bodies at a pose and over many, for JSON, in SI units."""

    def entry(found: Clearance) -> dict[str, Any] | None:
        if found.pair < 0:
            return None
        return {
            "bodies": found.pairs[int(found.pair)],
            "distance_m": found.least,
            "points_m": found.points,
        }

    data = {
        **robot(design),
        "pose": pose,
        "required_m": required,
        "least": entry(here),
        "groups": {group.value: entry(found) for group, found in groups.items()},
    }
    if over is None:
        return data
    reached = over.least[np.isfinite(over.least)]
    return data | {
        "poses": {
            "drawn": over.least.size,
            "reached": len(reached),
            "below": np.sum(reached < required),
            "nearest": [
                {"bodies": kinds, "poses": count, "least_m": least}
                for kinds, count, least in nearest_kinds(over)
            ],
        }
    }
