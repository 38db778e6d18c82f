"""What is known of a workspace; what reach and the path from home come to, in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise, permutations

import numpy as np

from paminsa_viz.model.arrays import Array, Pose
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.proof.families import EVERYWHERE, Method, method
from paminsa_viz.synthesis.proof.regions import (
    Grows,
    PoseRegion,
    box,
    freedom,
    least_free,
    lowest,
    region_margins,
)


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

    @classmethod
    def of(
        cls,
        requirement: Requirement,
        method: Method,
        verdict: Verdict,
        margin: float = np.nan,
        pose: Array | None = None,
        boxes: int = 0,
    ) -> Evidence:
        """Return what is known of a requirement, with a pose (4,) if there is one."""
        place = None if pose is None else pose_of(pose)
        return cls(requirement.quantity, method, verdict, margin, place, requirement, boxes)

    @property
    def key(self) -> Requirement | str:
        """The requirement, or the name where there is none."""
        return self.name if self.requirement is None else self.requirement

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
        seconds: Time that it took, without that of compiling [s].
    """

    verdict: Verdict
    region: PoseRegion
    evidence: tuple[Evidence, ...]
    path: Array = field(default_factory=lambda: np.empty((0, 4)))
    remaining: Array = field(default_factory=lambda: np.empty((0, 2, 4)))
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


def in_order(
    found: Mapping[Requirement | str, Evidence], requirements: Requirements
) -> tuple[Evidence, ...]:
    """Return reach, singularity, home, then the requirements, each once, as far as found."""
    keys = dict.fromkeys(["reach", "singularity", "home", *requirements.bounds])
    return tuple(found[key] for key in keys if key in found)


LARGEST = 50.0
"""No half extent is larger: half the longest bar [m]."""


def part_of(
    requirements: Requirements, requirement: Requirement, region: PoseRegion
) -> PoseRegion | None:
    """Return the poses of a region's positions over which a requirement holds; None for none."""
    low, high = requirement.z or EVERYWHERE
    low, high = max(region.low[2], low), min(region.high[2], high)
    if low > high:
        return None
    center = (*region.center[:2], 0.5 * (low + high))
    half = (*region.half[:2], 0.5 * (high - low))
    if requirement.z is None:
        center, half = region.center, region.half
    return replace(region, center=center, half=half, theta=requirements.headings(requirement))


def regions_of(requirements: Requirements, region: PoseRegion) -> list[PoseRegion]:
    """Return the poses that have to be taken: the region, and those of single requirements."""
    parts = [part_of(requirements, bound, region) for bound in requirements.bounds]
    return list(dict.fromkeys([region, *(part for part in parts if part is not None)]))


def prove_reach(
    design: Design, requirements: Requirements, region: PoseRegion
) -> dict[Requirement | str, Evidence]:
    """Return what is known of reach and singularities over a region, all of it in closed form."""
    regions = regions_of(requirements, region)
    margins = [region_margins(design.geometry, part) for part in regions]
    least = {
        "reach": min(item.least_reach for item in margins),
        "singularity": min(min(item.circle, item.turn) for item in margins),
    }
    found: dict[Requirement | str, Evidence] = {}
    for name, margin in least.items():
        verdict = Verdict.PROVEN if margin > 0.0 else Verdict.UNDECIDED
        found[name] = Evidence(name, Method.CLOSED_FORM, verdict, margin)
    for part, item in zip(regions, margins, strict=True):
        if item.holds():
            continue
        pose, value, name = least_free(design.geometry, part)
        # a guide may be used to its end
        if value < 0.0 or (value == 0.0 and name == "singularity"):
            found[name] = Evidence(name, Method.CLOSED_FORM, Verdict.REFUTED, value, pose_of(pose))
    for requirement in requirements.bounds:
        if method(requirement) is Method.CLOSED_FORM:
            found[requirement] = _reach_margin(design, requirements, requirement, region)
    return found


def reach_margin(
    design: Design, requirements: Requirements, requirement: Requirement, region: PoseRegion
) -> float:
    """Return how far a least margin of reach is kept over a region, in closed form [m]."""
    part = part_of(requirements, requirement, region)
    if part is None:
        return np.inf
    return region_margins(design.geometry, part).least_reach - (requirement.low or 0.0)


def _reach_margin(
    design: Design, requirements: Requirements, requirement: Requirement, region: PoseRegion
) -> Evidence:
    """Return what is known of a least margin of reach, over its own headings and heights."""
    margin = reach_margin(design, requirements, requirement, region)
    part = part_of(requirements, requirement, region)
    if part is None or margin >= 0.0:
        return Evidence.of(requirement, Method.CLOSED_FORM, Verdict.PROVEN, margin)
    pose, value = lowest(lambda poses: freedom(design.geometry, poses)[0], part)
    value -= requirement.low or 0.0
    verdict = Verdict.REFUTED if value < 0.0 else Verdict.UNDECIDED
    return Evidence.of(requirement, Method.CLOSED_FORM, verdict, value, pose)


def reach_scale(
    design: Design, requirements: Requirements, region: PoseRegion, grows: Grows, digits: int
) -> float:
    """Return the scale up to which reach and singularities hold over a growing region.

    Args:
        design: The robot.
        requirements: Of which headings and margins of reach count.
        region: The region at scale 1.
        grows: Which of its extents grow.
        digits: Binary digits of the scale.
    """
    least = [bound for bound in requirements.bounds if method(bound) is Method.CLOSED_FORM]

    def holds(scale: float) -> bool:
        whole = region.scaled(scale, grows)
        parts = regions_of(requirements, whole)
        return all(region_margins(design.geometry, part).holds() for part in parts) and all(
            reach_margin(design, requirements, bound, whole) >= 0.0 for bound in least
        )

    extent = max(half for half, grow in zip(region.half, grows, strict=True) if grow)
    low, high = 0.0, LARGEST / extent
    for _ in range(digits):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def home_path(geometry: Geometry, region: PoseRegion) -> Array:
    """Return a path from home to a region's center, (n, 4), empty if none is proven.

    It moves one of z, (x, y) and theta at a time, in the first order for which every pose on the
    way, in closed form, can be taken without a singularity. Headings of the region that are a whole
    turn and more from home's are turned back: 350 degrees are as near to it as -10.
    """
    start = np.array(home_pose(geometry))
    x, y, z = region.center
    turns = 2.0 * np.pi * np.round(np.mean(region.theta) / (2.0 * np.pi))
    goal = np.array([x, y, np.clip(0.0, *np.subtract(region.theta, turns)), z])
    moves = ([3], [0, 1], [2])
    for order in permutations(moves):
        path = [start]
        for coordinates in order:
            step = path[-1].copy()
            step[coordinates] = goal[coordinates]
            if (step != path[-1]).any():
                path.append(step)
        legs = pairwise(path) if len(path) > 1 else [(start, start)]
        if all(_proven_between(geometry, first, last) for first, last in legs):
            return np.array(path)
    return np.empty((0, 4))


def _proven_between(geometry: Geometry, first: Array, last: Array) -> bool:
    low, high = np.minimum(first, last), np.maximum(first, last)
    poses = box(
        (low[0], low[1], low[3]), (high[0], high[1], high[3]), (float(low[2]), float(high[2]))
    )
    return region_margins(geometry, poses).holds()
