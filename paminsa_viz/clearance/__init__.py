"""Clearance between the robot's bodies, as they are drawn.

`clearance` gives the least distance of two bodies in every pose, and which two; `nearest_points`
the two points of one pose; `shapes_of` the bodies as solids and the pairs that are checked.
"""

from paminsa_viz.clearance.clearance import (
    Clearance,
    NearestPoints,
    clearance,
    clearance_reason,
    group_clearance,
    nearest_points,
    pair_clearance,
)
from paminsa_viz.clearance.kernels import compile_in_background
from paminsa_viz.clearance.shapes import ALL_PAIRS, Exclusion, PairGroup, Shapes, shapes_of
from paminsa_viz.clearance.solids import Body, BodyPart, Primitive

__all__ = [
    "ALL_PAIRS",
    "Body",
    "BodyPart",
    "Clearance",
    "Exclusion",
    "NearestPoints",
    "PairGroup",
    "Primitive",
    "Shapes",
    "clearance",
    "clearance_reason",
    "compile_in_background",
    "group_clearance",
    "nearest_points",
    "pair_clearance",
    "shapes_of",
]
