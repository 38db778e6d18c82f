"""The largest regular workspace over which a robot is proven to meet its requirements.

A region of a given shape grows about its center. Reach and singularities bound its scale in closed
form. For all else the bisection gives two bounds: no pose of a smaller scale breaks a requirement,
and at the larger one a pose does. Both are brought together in stages, so that there is an answer
at any time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace
from paminsa_viz.synthesis.bisection import Control, Gauge, Grows, Nearest, nearest_violation
from paminsa_viz.synthesis.certificate import region_of
from paminsa_viz.synthesis.evidence import Evidence, Pose, Proof, Verdict, pose_of
from paminsa_viz.synthesis.families import Group, Method, groups, method
from paminsa_viz.synthesis.margins import Progress
from paminsa_viz.synthesis.placement import Placement
from paminsa_viz.synthesis.pose_search import freedom, lowest
from paminsa_viz.synthesis.reach_proof import (
    home_path,
    prove_reach,
    reach_margin,
    regions_of,
)
from paminsa_viz.synthesis.region_margins import Region, region_margins
from paminsa_viz.synthesis.sampled import sample_requirement, sampled_evidence

TOLERANCE = 1e-3
"""Difference of extents that is aimed at [m]."""

FIRST_TOLERANCE = 0.064
"""Difference of extents of the first stage [m]."""

LARGEST = 100.0
"""No extent is larger: that is the longest bar [m]."""

_BISECTIONS = 60
_INSIDE = 1.0 - 1e-9


class Growth(Enum):
    """Which extents of a workspace are to be found; the others are kept."""

    ALL = "all extents, in proportion"
    HORIZONTAL = "extents along x and y, in proportion"
    VERTICAL = "height"

    @property
    def axes(self) -> Grows:
        """Whether the extents along (x, y, z) grow."""
        return (
            self is not Growth.VERTICAL,
            self is not Growth.VERTICAL,
            self is not Growth.HORIZONTAL,
        )


@dataclass(frozen=True, eq=False)
class LargestWorkspace:
    """The largest workspace that is proven.

    Attributes:
        workspace: The workspace. None if already its center breaks a requirement, which the proof
            then refutes; or if the time was too short, which leaves it undecided.
        theta: Headings (least, largest) [rad].
        proof: What is proven over it, and how.
        limit: Size (x, y, z) from which on poses break a requirement [m]: about this center, or, if
            that was free, about the best center that poses tell of.
        gap: Largest difference of ``limit`` to the workspace's size [m].
        pose: A pose just outside that breaks a requirement; None if none was found.
        cause: What it breaks: ``"reach"``, ``"singularity"``, the key of a quantity; ``"home"``
            if no path from home to the center was proven, ``"volume"`` if no position meets all.
        requirement: The requirement that it breaks; None for reach and singularity.
        boxes: Boxes bounded.
        seconds: Time that it took [s].
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


@dataclass
class _Bounds:
    """Two bounds of the scale, and what the upper one rests on."""

    lower: float
    upper: float
    pose: Array | None = None
    cause: str = ""
    requirement: Requirement | None = None

    def lowered(
        self, upper: float, pose: Array | None, cause: str, requirement: Requirement | None
    ) -> None:
        if upper < self.upper:
            self.upper, self.pose, self.cause = upper, pose, cause
            self.requirement = requirement


def largest_workspace(
    design: Design,
    requirements: Requirements,
    workspace: Workspace | None = None,
    *,
    growth: Growth = Growth.ALL,
    tolerance: float = TOLERANCE,
    time_limit: float = 15.0,
    both_sides: bool = False,
    progress: Progress | None = None,
) -> LargestWorkspace:
    """Find the largest workspace of a shape that is proven to meet requirements.

    Args:
        design: The robot.
        requirements: What has to hold.
        workspace: Shape, center and extents: those that grow give the proportions. Coordinates of
            the center that are open are chosen by poses. None for that of the requirements.
        growth: Which extents grow.
        tolerance: Difference of extents, of what is proven to where a pose breaks a requirement, at
            which to stop [m].
        time_limit: When to stop at the latest [s]; the gap then is what it is.
        both_sides: Whether an open height may be on the other side of the guides than home.
        progress: Is told what part of the time is over, and may end it.

    Raises:
        InvalidInput: If there is no workspace, or a number is not possible.
    """
    workspace = workspace or requirements.workspace
    if workspace is None:
        raise InvalidInput("workspace", "a shape with its proportions is needed")
    for name, number in (("tolerance", tolerance), ("time_limit", time_limit)):
        if not (np.isfinite(number) and number > 0.0):
            raise InvalidInput(name, f"a number above 0 is needed, not {number!r}")
    control = Control(time_limit, progress)
    grows = growth.axes
    region = region_of(workspace, requirements)
    x, y, z = (place is None for place in workspace.center)
    placed = np.inf
    if x or y or z:
        place = Placement(design, requirements, region, grows, (x, y, z), both_sides).find(control)
        if place is None:
            return _nothing(requirements, region, control, "volume")
        region, placed = replace(region, center=place.center), place.scale
    search = _Search(design, requirements, region, grows, control)
    search.run(tolerance)
    return search.answer(workspace, placed)


class _Search:
    """The search about one center."""

    def __init__(
        self,
        design: Design,
        requirements: Requirements,
        region: Region,
        grows: Grows,
        control: Control,
    ) -> None:
        self._design, self._requirements, self._region = design, requirements, region
        self._gauge, self._grows, self._control = Gauge(region, grows), grows, control
        self._groups = groups(design, requirements)
        self._nearest: list[Nearest | None] = [None] * len(self._groups)
        self._extent = 2.0 * max(h for h, g in zip(region.half, grows, strict=True) if g)
        reach = self._reach()
        self._bounds = _Bounds(reach, reach)

    def run(self, tolerance: float) -> None:
        """Bring the bounds together."""
        bounds, control = self._bounds, self._control
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

    def _advance(self, index: int, group: Group, tolerance: float) -> None:
        bounds, control = self._bounds, self._control
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
        requirements, geometry = self._requirements, self._design.geometry
        least = [
            r
            for r in requirements.bounds
            if r.quantity == "reach_margin" and method(r) is Method.CLOSED_FORM
        ]
        if not len(home_path(geometry, self._region.scaled(0.0, self._grows))):
            return 0.0

        def holds(scale: float) -> bool:
            whole = self._region.scaled(scale, self._grows)
            parts = regions_of(requirements, whole)
            return all(region_margins(geometry, part).holds() for part in parts) and all(
                reach_margin(self._design, requirements, bound, whole) >= 0.0 for bound in least
            )

        low, high = 0.0, LARGEST / self._extent
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if holds(middle) else (low, middle)
        return low

    def _name_limit_of_reach(self) -> None:
        """Find a pose just outside of the largest region of reach that cannot be taken."""
        bounds = self._bounds
        whole = self._region.scaled(bounds.upper * (1.0 + 1e-6), self._grows)
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
            if method(requirement) is not Method.SAMPLED:
                continue
            for _ in range(4):
                whole = self._region.scaled(self._bounds.upper, self._grows)
                poses, margins = sample_requirement(
                    self._design, self._requirements, requirement, whole
                )
                poses = poses[~(margins >= 0.0)]
                if not len(poses) or self._control.over:
                    break
                scales = self._gauge.of_poses(poses)
                row = int(np.argmin(scales))
                self._bounds.lowered(
                    float(scales[row]), poses[row], requirement.quantity, requirement
                )

    def answer(self, workspace: Workspace, placed: float) -> LargestWorkspace:
        """Return the answer; ``placed`` is the scale that poses tell of for the best center."""
        bounds, control = self._bounds, self._control
        upper = bounds.upper if placed == np.inf else max(bounds.upper, placed)
        limit = self._size(upper)
        scale = bounds.lower * _INSIDE
        if scale <= 0.0:
            cause = bounds.cause or "home"
            return _nothing(self._requirements, self._region, control, cause, bounds, limit)
        region = self._region.scaled(scale, self._grows)
        size = self._size(scale)
        return LargestWorkspace(
            Workspace(workspace.shape, size, region.center),
            self._requirements.theta,
            Proof(
                Verdict.PROVEN, region, self._evidence(region),
                home_path(self._design.geometry, region), boxes=control.boxes,
                seconds=control.elapsed,
            ),
            limit,
            max(a - b for a, b in zip(limit, size, strict=True)),
            None if bounds.pose is None else pose_of(bounds.pose),
            bounds.cause,
            bounds.requirement,
            control.boxes,
            control.elapsed,
        )  # fmt: skip

    def _size(self, scale: float) -> tuple[float, float, float]:
        a, b, c = (2.0 * half for half in self._region.scaled(scale, self._grows).half)
        return a, b, c

    def _evidence(self, region: Region) -> tuple[Evidence, ...]:
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


def _nothing(
    requirements: Requirements,
    region: Region,
    control: Control,
    cause: str,
    bounds: _Bounds | None = None,
    limit: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> LargestWorkspace:
    """Return the answer that no such workspace is proven."""
    pose = None if bounds is None or bounds.pose is None else pose_of(bounds.pose)
    none = replace(region, half=(0.0, 0.0, 0.0))
    open_ = bounds is not None and bounds.upper > 0.0
    verdict = Verdict.UNDECIDED if open_ else Verdict.REFUTED
    return LargestWorkspace(
        None,
        requirements.theta,
        Proof(verdict, none, (), boxes=control.boxes, seconds=control.elapsed),
        limit,
        max(limit),
        pose,
        cause,
        None if bounds is None else bounds.requirement,
        control.boxes,
        control.elapsed,
    )
