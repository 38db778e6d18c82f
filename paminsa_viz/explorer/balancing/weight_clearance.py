"""Whether counterweights hit anything: over the plane of the maps, and along the motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.clearance import PairGroup, clearance
from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Array

WEIGHTS = (PairGroup.COUNTERWEIGHTS,)


@dataclass(frozen=True)
class WeightClearance:
    """The least distance of a counterweight to another body.

    Attributes:
        distance: Negative where they overlap [m].
        names: The two bodies.
        pose: Where it is, (x, y, theta, z) [m, m, rad, m].
        touching: Part of the poses where a counterweight overlaps another body, 0 to 1.
        poses: Poses that were looked at.
    """

    distance: float
    names: tuple[str, str]
    pose: tuple[float, float, float, float]
    touching: float
    poses: int


def weight_clearance(design: Design, poses: Array) -> WeightClearance | None:
    """Return the least clearance of counterweights over poses (n, 4); None if there are none."""
    if not any(weight.mass > 0 for weight in design.counterweights) or not len(poses):
        return None
    found = clearance(design, poses, WEIGHTS)
    known = np.isfinite(found.least)
    if not known.any():
        return None
    low = int(np.nanargmin(found.least))
    x, y, theta, z = (float(value) for value in poses[low])
    return WeightClearance(
        float(found.least[low]), found.pairs[found.pair[low]], (x, y, theta, z),
        float((found.least[known] < 0).mean()), int(known.sum()),
    )  # fmt: skip
