"""What is known of a workspace: verdicts, and what they rest on."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.families import Method
from paminsa_viz.synthesis.region_margins import PoseRegion

Pose = tuple[float, float, float, float]


class Verdict(Enum):
    """What a proof came to."""

    PROVEN = "proven"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    SAMPLED = "holds at samples"


@dataclass(frozen=True)
class Evidence:
    """What is known of one requirement over a region.

    Attributes:
        name: ``"reach"``, ``"singularity"``, ``"home"``, or the key of the quantity.
        method: How it was answered for.
        verdict: What it came to.
        margin: Proven: no pose has a smaller margin. Refuted: the margin of ``pose``. Sampled: the
            least of the samples. In the quantity's SI unit; NaN where it is not known.
        pose: A pose that breaks it, or the worst of the samples; None for none.
        requirement: The requirement; None for reach, singularity and home.
        boxes: Boxes bounded.
    """

    name: str
    method: Method
    verdict: Verdict
    margin: float = np.nan
    pose: Pose | None = None
    requirement: Requirement | None = None
    boxes: int = 0

    @property
    def bound(self) -> float:
        """The worst value that the margin stands for [SI]; NaN without one bound to compare to."""
        r = self.requirement
        if r is None:
            return self.margin
        if r.low is None:
            return (r.high or 0.0) - self.margin
        return r.low + self.margin if r.high is None else np.nan


@dataclass(frozen=True, eq=False)
class Proof:
    """What is known of a workspace.

    Attributes:
        verdict: Proven, if everything that can be proven is, and nothing sampled breaks a bound.
        region: The positions and headings.
        evidence: Reach, singularity, home, then the requirements in their order.
        path: (n, 4) poses from home into the region, straight between them, all proven; empty if
            none was found.
        remaining: (n, 2, 4) least and largest poses of the boxes that are not decided.
        boxes: Boxes bounded in all.
        seconds: Time that it took [s].
    """

    verdict: Verdict
    region: PoseRegion
    evidence: tuple[Evidence, ...]
    path: Array = field(default_factory=lambda: np.zeros((0, 4)))
    remaining: Array = field(default_factory=lambda: np.zeros((0, 2, 4)))
    boxes: int = 0
    seconds: float = 0.0

    @property
    def pose(self) -> Pose | None:
        """A pose that breaks a requirement; None if none is known."""
        found = (item.pose for item in self.evidence if item.verdict is Verdict.REFUTED)
        return next(found, None)

    @property
    def sampled(self) -> tuple[Requirement, ...]:
        """Requirements that are only sampled."""
        return tuple(
            item.requirement
            for item in self.evidence
            if item.requirement is not None and item.method is Method.SAMPLED
        )


def pose_of(pose: Array) -> Pose:
    """Return a pose (4,) as a tuple."""
    x, y, theta, z = (float(value) for value in pose)
    return x, y, theta, z
