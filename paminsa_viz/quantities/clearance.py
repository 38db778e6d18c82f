"""Quantities of the clearance between the robot's bodies."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace

import numpy as np

from paminsa_viz.clearance import PairGroup, clearance, group_clearance, shapes_of
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.quantities.quantity import Missing, Quantity, in_family, kept_over_poses

COST = 3e-5
"""Time for the least clearance of a pose [s]."""

GROUPS_COST = 2e-4
"""Time for that of every group of pairs [s]."""


def _sizes(design: Design) -> Hashable:
    """Return what the sizes of payload and counterweights follow from."""
    return design.payload.mass, design.counterweights


_LEAST = kept_over_poses("clearance", lambda design, poses: clearance(design, poses).least, _sizes)
_GROUPS = kept_over_poses("clearance_groups", group_clearance, _sizes)

_TEXTS = ("", "no such bodies: there is no payload, or no counterweight")
_WORDS = ("", "no-such-bodies")


def _group(group: PairGroup, key: str, symbol: str, title: str) -> Quantity:
    index = list(PairGroup).index(group)

    def missing(field: Field, design: Design) -> Missing:
        pairs = shapes_of(replace(design, geometry=field.geometry)).of_groups([group])
        code = (field.status == Limit.OK) & (len(pairs) == 0)
        return Missing(code.astype(np.uint8), _TEXTS, _WORDS)

    return Quantity(
        f"clearance_{key}", f"d {symbol}", f"clearance, {group.value}",
        f"Least distance {title}; negative where they overlap", "m", LEAST_MARGIN,
        lambda field, design: _GROUPS(field, design)[..., index],
        signed=True, bounded=True, cost=GROUPS_COST, missing=missing,
    )  # fmt: skip


CLEARANCE = in_family(
    "clearance",
    Quantity(
        "clearance", "d", "least clearance",
        "Least distance of two bodies as they are drawn; negative where they overlap",
        "m", LEAST_MARGIN, _LEAST, signed=True, bounded=True, cost=COST,
    ),
    _group(PairGroup.BETWEEN_LEGS, "legs", "legs", "between bodies of two legs"),
    _group(PairGroup.SAME_LEG, "same_leg", "leg", "between bodies of one leg"),
    _group(PairGroup.CARRIAGE, "arms", "arms", "of a leg to M4’s carriage and the arms B1"),
    _group(PairGroup.PLATFORM, "platform", "platf", "of the platform to legs and arms"),
    _group(PairGroup.FRAME, "frame", "frame", "of what moves to the frame"),
    _group(PairGroup.PAYLOAD, "payload", "load", "of the payload to another body"),
    _group(PairGroup.COUNTERWEIGHTS, "counterweights", "cw", "of a counterweight to another body"),
)  # fmt: skip
