"""The largest regular workspace over which a robot is proven to meet its requirements.

A region of a given shape grows about its center. Reach and singularities bound its scale in closed
form. For all else the bisection gives two bounds: no pose of a smaller scale breaks a requirement,
and at the larger one a pose does. Both are brought together in stages, so that there is an answer
at any time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.checks import require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, Pose
from paminsa_viz.model.design import Design
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace
from paminsa_viz.synthesis.proof.bisection import Control, Gauge, Nearest, nearest_violation
from paminsa_viz.synthesis.proof.certificate import (
    evidence_of_samples,
    region_of,
    sample_requirement,
)
from paminsa_viz.synthesis.proof.evidence import (
    Evidence,
    Proof,
    Verdict,
    home_path,
    in_order,
    pose_of,
    prove_reach,
    reach_margin,
    reach_scale,
    regions_of,
)
from paminsa_viz.synthesis.proof.families import BoundGroup, Method, groups, method
from paminsa_viz.synthesis.proof.placement import CenterSearch, PlacedCenter
from paminsa_viz.synthesis.proof.regions import Grows, Growth, PoseRegion, least_free

TOLERANCE = 1e-3
"""Difference of extents that is aimed at, at Appendix 4's lengths [m]."""


FIRST_TOLERANCE = 0.064
"""Difference of extents of the first stage, at Appendix 4's lengths [m]."""

_BISECTIONS = 56
"""Binary digits of the scale of reach."""

_INSIDE = 1.0 - 1e-9
"""Share of the lower bound that is taken, so that rounding of the extents counts for nothing."""

NOTHING = 1e-6
"""Scale of a workspace that is none."""


@dataclass(eq=False)
class GrowingRegion:
    """The search for the scale of the largest region about one center.

    Attributes:
        design: The robot.
        requirements: What has to hold.
        region: The region at scale 1.
        grows: Which of its extents grow.
        control: When to stop.
        lower: Scale up to which everything is proven that can be, and no sample breaks the rest.
        upper: Scale at which ``pose`` breaks a requirement, or reach ends.
        pose: (4,) the pose; None if none was found.
        cause: What it breaks: ``"reach"``, ``"singularity"`` or the key of a quantity.
        requirement: The requirement that it breaks; None for reach and singularity.
    """

    design: Design
    requirements: Requirements
    region: PoseRegion
    grows: Grows
    control: Control
    lower: float = 0.0
    upper: float = 0.0
    pose: Array | None = None
    cause: str = ""
    requirement: Requirement | None = None

    def __post_init__(self) -> None:
        self._gauge = Gauge(self.region, self.grows)
        self._groups = groups(self.design, self.requirements)
        self._nearest: list[Nearest | None] = [None] * len(self._groups)
        # the scale at which a requirement was last found to hold at all samples, and what they say
        self._holds: dict[Requirement, tuple[float, Evidence]] = {}
        self._tolerance = TOLERANCE
        self._extent = 2.0 * max(np.extract(self.grows, self.region.half).tolist())
        if len(home_path(self.design.geometry, self.region)):
            self.lower = self.upper = reach_scale(
                self.design, self.requirements, self.region, self.grows, _BISECTIONS
            )

    def run(self, tolerance: float) -> None:
        """Bring the bounds together."""
        self._name_limit_of_reach()
        if self.upper <= 0.0:
            return
        self._tolerance = tolerance
        self._sample()
        # an answer of the first stage at once, and finer ones while there is time
        first = FIRST_TOLERANCE * length_ratio(self.design.geometry)
        step = min(first, 0.25 * self.upper * self._extent)
        while True:
            step = max(step, tolerance)
            for index, group in enumerate(self._groups):
                self._advance(index, group, step / self._extent)
            if self.control.over or step <= tolerance:
                break
            step *= 0.25
        lowers = [found.lower for found in self._nearest if found is not None]
        self.lower = min([self.lower, self.upper, *lowers])
        self._sample_inside()

    def _lower(self, upper: float, pose: Array, requirement: Requirement) -> None:
        """Take an upper bound if it is a lower one."""
        if upper < self.upper:
            self.upper, self.pose = upper, pose
            self.cause, self.requirement = requirement.quantity, requirement

    def _advance(self, index: int, group: BoundGroup, tolerance: float) -> None:
        control, before = self.control, self._nearest[index]
        if before is not None and before.lower >= self.upper - tolerance:
            return
        # what is not known yet of the other requirements has to have its share of the time
        waiting = sum(found is None for found in self._nearest)
        share = control.left / max(1, waiting) if before is None else np.inf
        found = nearest_violation(group, self._gauge, self.upper, tolerance, control, share)
        if found.pose is not None:
            self._lower(found.upper, found.pose, group.requirements[found.requirement])
        if before is None or found.lower > before.lower:
            self._nearest[index] = found

    def _name_limit_of_reach(self) -> None:
        """Find a pose just outside of the largest region of reach that cannot be taken."""
        whole = self.region.scaled(self.upper * (1.0 + 1e-6), self.grows)
        for part in regions_of(self.requirements, whole):
            pose, value, cause = least_free(self.design.geometry, part)
            if value <= 0.0:
                self.pose, self.cause = pose, cause
                return
        for bound in self.requirements.bounds:
            least = method(bound) is Method.CLOSED_FORM
            if least and reach_margin(self.design, self.requirements, bound, whole) < 0.0:
                self.cause, self.requirement = "reach_margin", bound
                return

    def _sample(self) -> None:
        """Lower the upper bound to where samples break a requirement that cannot be proven."""
        for requirement in self.requirements.bounds:
            if method(requirement) is Method.SAMPLED and not self.control.over:
                self._bisect_samples(requirement, self.upper, hurry=True)

    def _sample_inside(self) -> None:
        """Shrink what is proven until no sample in it breaks a requirement."""
        sampled = [r for r in self.requirements.bounds if method(r) is Method.SAMPLED]
        before = np.inf
        # samples lie elsewhere after it has shrunk for another requirement
        while sampled and NOTHING < self.lower < before:
            before = self.lower
            for requirement in sampled:
                self.lower = self._bisect_samples(requirement, self.lower)

    def _bisect_samples(
        self, requirement: Requirement, scale: float, *, hurry: bool = False
    ) -> float:
        """Return a scale up to another at which no sample breaks a requirement, to the tolerance.

        The upper bound follows to the least scale of a sample that breaks it, and holds wherever
        the search ends. When the time is over that is at the first scale at which it holds, and if
        there is a hurry at once, with the scale 0 if none is known.
        """
        low = self._holds[requirement][0] if requirement in self._holds else 0.0
        if scale <= NOTHING or scale == low or not self._sampled(requirement, scale):
            return scale
        high = min(scale, self.upper)
        low = low if low < high else 0.0
        while (high - low) * self._extent > self._tolerance and high > NOTHING:
            if self.control.over and (hurry or low > 0.0):
                break
            middle = 0.5 * (low + high)
            if self._sampled(requirement, middle):
                high = min(middle, self.upper)
            else:
                low = middle
        if low == 0.0 and not self.control.over:  # no scale is known at which it holds
            self._sampled(requirement, NOTHING)
        return min(low, high)

    def _sampled(self, requirement: Requirement, scale: float) -> bool:
        """Say whether a sample of a scale breaks a requirement; the upper bound then follows."""
        whole = self.region.scaled(scale * _INSIDE, self.grows)
        poses, margins = sample_requirement(self.design, self.requirements, requirement, whole)
        breaking = poses[~(margins >= 0.0)]
        if not len(breaking):
            self._holds[requirement] = scale, evidence_of_samples(requirement, poses, margins)
            return False
        scales = self._gauge.of_poses(breaking)
        row = int(np.argmin(scales))
        self._lower(float(scales[row]), breaking[row], requirement)
        return True

    @property
    def found(self) -> PoseRegion | None:
        """The largest region that is proven; None if none is."""
        scale = self.lower * _INSIDE
        return self.region.scaled(scale, self.grows) if scale > NOTHING else None

    def evidence(self, region: PoseRegion) -> tuple[Evidence, ...]:
        """Return what is proven over the region that was found, and how."""
        found = prove_reach(self.design, self.requirements, region)
        found["home"] = Evidence("home", Method.CLOSED_FORM, Verdict.PROVEN)
        for group, nearest in zip(self._groups, self._nearest, strict=True):
            if nearest is not None:
                for requirement, margin in zip(
                    group.requirements, nearest.margins.tolist(), strict=True
                ):
                    found[requirement] = Evidence.of(
                        requirement, Method.BISECTION, Verdict.PROVEN, margin, boxes=nearest.boxes
                    )
        found |= {requirement: evidence for requirement, (_, evidence) in self._holds.items()}
        return in_order(found, self.requirements)


@dataclass(frozen=True, eq=False)
class LargestWorkspace:
    """The largest workspace that is proven.

    Attributes:
        workspace: The workspace. None if already its center, or what is kept of its extents, breaks
            a requirement, which the proof then refutes: of a free center so does every one that was
            tried. None as well if the time was too short, which leaves it undecided.
        theta: Headings (least, largest) [rad].
        proof: What is proven over it, and how.
        limit: Size (x, y, z) from which on poses break a requirement [m]: about this center, or, if
            that was free, about the best center that poses tell of.
        gap: Largest difference of ``limit`` to the workspace's size [m]. It bounds what is proven
            alone: where requirements are only sampled (`Proof.sampled`), no sample of the workspace
            breaks them, but a pose between its samples may.
        pose: A pose just outside that breaks a requirement; None if none was found.
        cause: What it breaks: ``"reach"``, ``"singularity"``, the key of a quantity; ``"home"``
            if no path from home to the center was proven, ``"volume"`` if no position meets all.
        requirement: The requirement that it breaks; None for reach and singularity.
        boxes: Boxes bounded.
        seconds: Time that it took, without that of compiling [s].
    """

    workspace: Workspace | None
    theta: tuple[float, float]
    proof: Proof
    limit: tuple[float, float, float]
    gap: float
    pose: Pose | None
    cause: str
    requirement: Requirement | None
    boxes: int
    seconds: float


@of_design
def largest_workspace(
    design: Design,
    requirements: Requirements,
    workspace: Workspace | None = None,
    *,
    growth: Growth = Growth.ALL,
    tolerance: float | None = None,
    time_limit: float = 15.0,
    both_sides: bool = False,
    progress: Progress = go_on,
) -> LargestWorkspace:
    """Find the largest workspace of a shape that is proven to meet requirements.

    Requirements that cannot be proven are sampled, as by `prove`.

    Args:
        design: The robot.
        requirements: What has to hold.
        workspace: Shape, center and extents: those that grow give the proportions. Coordinates of
            the center that are open are chosen by poses. None for that of the requirements.
        growth: Which extents grow.
        tolerance: Difference of extents, of what is proven (or, where there is no proof, of what
            no sample breaks) to where a pose breaks a requirement, at which to stop [m]. None for
            `TOLERANCE` in proportion to crank plus coupler.
        time_limit: When to stop at the latest, without the time that compiling takes [s]; the gap
            then is what it is.
        both_sides: Whether an open height may be on the other side of the guides than home.
        progress: Is told what part of the time is over, and may end it.

    Raises:
        InvalidInput: If there is no workspace, or a number is not possible.
    """
    workspace = workspace or requirements.workspace
    if workspace is None:
        raise InvalidInput("workspace", "a shape with its proportions is needed")
    if tolerance is None:  # a millimeter is all of the workspace of a robot of some millimeters
        tolerance = TOLERANCE * length_ratio(design.geometry)
    for name, number in (("tolerance", tolerance), ("time_limit", time_limit)):
        require_positive(number, name)
    control = Control(time_limit, progress)
    grows, region = growth.axes, region_of(workspace, requirements)
    free = [place is None for place in workspace.center]
    growing, place = None, PlacedCenter(region.center, 0.0)
    if any(free):
        search = CenterSearch(design, requirements, region, grows, free, both_sides)
        place = search.find(control)
    found, limit, scale = None, (0.0, 0.0, 0.0), 0.0
    if place is not None:
        region = replace(region, center=place.center)
        growing = GrowingRegion(design, requirements, region, grows, control)
        growing.run(tolerance)
        found = growing.found
        scale = max(growing.upper, place.scale)
        limit = _size(region.scaled(scale, grows))
    if growing is None or found is None:
        verdict = Verdict.UNDECIDED if scale > NOTHING else Verdict.REFUTED
        largest, size = None, (0.0, 0.0, 0.0)
        proof = Proof(verdict, replace(region, half=size), ())
        cause = "volume" if growing is None else growing.cause or "home"
    else:
        size, cause = _size(found), growing.cause
        largest = Workspace(workspace.shape, size, found.center)
        evidence, path = growing.evidence(found), home_path(design.geometry, found)
        proof = Proof(Verdict.PROVEN, found, evidence, path)
    proof = replace(proof, boxes=control.boxes, seconds=control.elapsed)
    pose = growing and growing.pose
    gap = max(a - b for a, b in zip(limit, size, strict=True))
    return LargestWorkspace(
        largest, requirements.theta, proof, limit, gap,
        None if pose is None else pose_of(pose), cause,
        growing and growing.requirement, proof.boxes, proof.seconds,
    )  # fmt: skip


def _size(region: PoseRegion) -> tuple[float, float, float]:
    a, b, c = (2.0 * half for half in region.half)
    return a, b, c
