"""A region that grows about its center until a pose breaks a requirement: between two bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.proof.bisection import Control, Gauge, Nearest, nearest_violation
from paminsa_viz.synthesis.proof.certificate import sample_requirement, sampled_evidence
from paminsa_viz.synthesis.proof.evidence import (
    Evidence,
    Verdict,
    home_path,
    prove_reach,
    reach_scale,
    regions_of,
)
from paminsa_viz.synthesis.proof.families import BoundGroup, Method, groups, method
from paminsa_viz.synthesis.proof.pose_search import freedom, lowest
from paminsa_viz.synthesis.proof.regions import Grows, PoseRegion

FIRST_TOLERANCE = 0.064
"""Difference of extents of the first stage [m]."""

_BISECTIONS = 56
"""Binary digits of the scale of reach."""

_INSIDE = 1.0 - 1e-9
"""Share of the lower bound that is taken, so that rounding of the extents counts for nothing."""

NOTHING = 1e-6
"""Scale of a workspace that is none."""


@dataclass
class ScaleBounds:
    """Two bounds of the scale of the largest region, and what they rest on.

    Attributes:
        lower: Up to it everything is proven.
        upper: At it ``pose`` breaks a requirement, or reach ends.
        pose: (4,) the pose; None if none was found.
        cause: What it breaks: ``"reach"``, ``"singularity"`` or the key of a quantity.
        requirement: The requirement that it breaks; None for reach and singularity.
    """

    lower: float
    upper: float
    pose: Array | None = None
    cause: str = ""
    requirement: Requirement | None = None

    def lowered(
        self, upper: float, pose: Array | None, cause: str, requirement: Requirement | None
    ) -> None:
        """Take an upper bound if it is a lower one."""
        if upper < self.upper:
            self.upper, self.pose, self.cause = upper, pose, cause
            self.requirement = requirement


class GrowingRegion:
    """The search for the scale of the largest region about one center.

    Args:
        design: The robot.
        requirements: What has to hold.
        region: The region at scale 1.
        grows: Which of its extents grow.
        control: When to stop.

    Attributes:
        region: The region at scale 1.
        bounds: What is known of the scale.
    """

    def __init__(
        self,
        design: Design,
        requirements: Requirements,
        region: PoseRegion,
        grows: Grows,
        control: Control,
    ) -> None:
        self._design, self._requirements, self.region = design, requirements, region
        self._gauge, self._grows, self._control = Gauge(region, grows), grows, control
        self._groups = groups(design, requirements)
        self._nearest: list[Nearest | None] = [None] * len(self._groups)
        self._extent = 2.0 * max(h for h, g in zip(region.half, grows, strict=True) if g)
        reach = self._reach()
        self.bounds = ScaleBounds(reach, reach)

    def run(self, tolerance: float) -> None:
        """Bring the bounds together."""
        bounds, control = self.bounds, self._control
        if bounds.upper <= 0.0:
            return
        self._name_limit_of_reach()
        self._sample()
        bounds.lower = min(bounds.lower, bounds.upper)
        # an answer of the first stage at once, and finer ones while there is time
        step = min(FIRST_TOLERANCE, 0.25 * bounds.upper * self._extent)
        while True:
            step = max(step, tolerance)
            for index, group in enumerate(self._groups):
                self._advance(index, group, step / self._extent)
            if control.over or step <= tolerance:
                break
            step *= 0.25
        lowers = [found.lower for found in self._nearest if found is not None]
        bounds.lower = min([bounds.lower, bounds.upper, *lowers])
        self._sample_inside()

    def _advance(self, index: int, group: BoundGroup, tolerance: float) -> None:
        bounds, control = self.bounds, self._control
        before = self._nearest[index]
        if before is not None and before.lower >= bounds.upper - tolerance:
            return
        # what is not known yet of the other requirements has to have its share of the time
        waiting = sum(found is None for found in self._nearest)
        share = control.left / max(1, waiting) if before is None else np.inf
        found = nearest_violation(group, self._gauge, bounds.upper, tolerance, control, share)
        if found.pose is not None:
            broken = group.requirements[found.requirement]
            bounds.lowered(found.upper, found.pose, broken.quantity, broken)
        if before is None or found.lower > before.lower:
            self._nearest[index] = found

    def _reach(self) -> float:
        """Return the largest scale at which reach and singularities hold, in closed form."""
        if not len(home_path(self._design.geometry, self.region.scaled(0.0, self._grows))):
            return 0.0
        return reach_scale(self._design, self._requirements, self.region, self._grows, _BISECTIONS)

    def _name_limit_of_reach(self) -> None:
        """Find a pose just outside of the largest region of reach that cannot be taken."""
        bounds = self.bounds
        whole = self.region.scaled(bounds.upper * (1.0 + 1e-6), self._grows)
        for part in regions_of(self._requirements, whole):
            pose, value = lowest(lambda p: freedom(self._design.geometry, p).min(axis=0), part)
            if value <= 0.0:
                reach, singular = freedom(self._design.geometry, pose[None])[:, 0]
                bounds.pose, bounds.cause = pose, "reach" if reach <= singular else "singularity"
                return
        low = [r for r in self._requirements.bounds if r.quantity == "reach_margin"]
        if low:
            bounds.cause, bounds.requirement = "reach_margin", low[0]

    def _sample(self) -> None:
        """Lower the upper bound to where samples break a requirement that cannot be proven."""
        for requirement in self._requirements.bounds:
            while method(requirement) is Method.SAMPLED and not self._control.over:
                if not self._sampled(requirement, self.bounds.upper):
                    break

    def _sample_inside(self) -> None:
        """Shrink what is proven until no sample in it breaks a requirement."""
        bounds = self.bounds
        for requirement in self._requirements.bounds:
            while method(requirement) is Method.SAMPLED and bounds.lower > NOTHING:
                if not self._sampled(requirement, bounds.lower * _INSIDE):
                    break
                bounds.lower = min(0.999 * bounds.lower, bounds.upper)

    def _sampled(self, requirement: Requirement, scale: float) -> bool:
        """Say whether a sample of a scale breaks a requirement; the upper bound then follows."""
        whole = self.region.scaled(scale, self._grows)
        poses, margins = sample_requirement(self._design, self._requirements, requirement, whole)
        poses = poses[~(margins >= 0.0)]
        scales = self._gauge.of_poses(poses)
        inside = scales < self.bounds.upper
        if inside.any():
            row = int(np.argmin(scales))
            self.bounds.lowered(float(scales[row]), poses[row], requirement.quantity, requirement)
        return bool(inside.any())

    @property
    def found(self) -> PoseRegion | None:
        """The largest region that is proven; None if none is."""
        scale = self.bounds.lower * _INSIDE
        return self.region.scaled(scale, self._grows) if scale > NOTHING else None

    def evidence(self, region: PoseRegion) -> tuple[Evidence, ...]:
        """Return what is proven over the region that was found, and how."""
        found: dict[Requirement | str, Evidence] = dict(
            prove_reach(self._design, self._requirements, region)
        )
        found["home"] = Evidence("home", Method.CLOSED_FORM, Verdict.PROVEN)
        for group, nearest in zip(self._groups, self._nearest, strict=True):
            for index, requirement in enumerate(group.requirements if nearest else ()):
                assert nearest is not None
                found[requirement] = Evidence(
                    requirement.quantity, Method.BISECTION, Verdict.PROVEN,
                    float(nearest.margins[index]), None, requirement, nearest.boxes,
                )  # fmt: skip
        for item in sampled_evidence(self._design, self._requirements, region):
            if item.requirement is not None:
                found[item.requirement] = item
        order: list[Requirement | str] = ["reach", "singularity", "home"]
        return tuple(found[key] for key in dict.fromkeys([*order, *self._requirements.bounds]))
