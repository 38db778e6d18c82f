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
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace
from paminsa_viz.synthesis.proof.bisection import Control
from paminsa_viz.synthesis.proof.certificate import region_of
from paminsa_viz.synthesis.proof.evidence import Pose, Proof, Verdict, home_path, pose_of
from paminsa_viz.synthesis.proof.growing import GrowingRegion, ScaleBounds
from paminsa_viz.synthesis.proof.placement import CenterSearch
from paminsa_viz.synthesis.proof.regions import Grows, PoseRegion
from paminsa_viz.synthesis.volume.margins import Progress

TOLERANCE = 1e-3
"""Difference of extents that is aimed at [m]."""


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
        place = CenterSearch(design, requirements, region, grows, (x, y, z), both_sides).find(
            control
        )
        if place is None:
            return _nothing(requirements, region, control, "volume")
        region, placed = replace(region, center=place.center), place.scale
    growing = GrowingRegion(design, requirements, region, grows, control)
    growing.run(tolerance)
    bounds, found = growing.bounds, growing.found
    upper = bounds.upper if placed == np.inf else max(bounds.upper, placed)
    limit = _size(region.scaled(upper, grows))
    if found is None:
        cause = bounds.cause or "home"
        return _nothing(requirements, region, control, cause, bounds, limit)
    size = _size(found)
    evidence, path = growing.evidence(found), home_path(design.geometry, found)
    return LargestWorkspace(
        Workspace(workspace.shape, size, found.center),
        requirements.theta,
        Proof(Verdict.PROVEN, found, evidence, path, boxes=control.boxes, seconds=control.elapsed),
        limit,
        max(a - b for a, b in zip(limit, size, strict=True)),
        None if bounds.pose is None else pose_of(bounds.pose),
        bounds.cause,
        bounds.requirement,
        control.boxes,
        control.elapsed,
    )


def _size(region: PoseRegion) -> tuple[float, float, float]:
    a, b, c = (2.0 * half for half in region.half)
    return a, b, c


def _nothing(
    requirements: Requirements,
    region: PoseRegion,
    control: Control,
    cause: str,
    bounds: ScaleBounds | None = None,
    limit: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> LargestWorkspace:
    """Return the answer that no such workspace is proven."""
    pose = None if bounds is None or bounds.pose is None else pose_of(bounds.pose)
    none = replace(region, half=(0.0, 0.0, 0.0))
    verdict = Verdict.UNDECIDED if max(limit) > 0.0 else Verdict.REFUTED
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
