"""Jobs on requirements and what came of them: plain data of the state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape

if TYPE_CHECKING:
    from paminsa_viz.explorer.state import Document
    from paminsa_viz.synthesis.proof.largest import LargestWorkspace
    from paminsa_viz.synthesis.volume.check import RequirementsCheck
    from paminsa_viz.synthesis.volume.solve import Volume

Placed = tuple[WorkspaceShape, tuple[float, float, float], tuple[float, float, float]]
"""Shape, size and center of a workspace [m]."""


@dataclass(frozen=True, eq=False)
class AboutRequirements:
    """A job on a design and what it has to do.

    Attributes:
        design: The robot.
        requirements: What it has to do.
    """

    design: Design
    requirements: Requirements

    def serves(self, document: Document) -> bool:
        """Whether its result is about a document's design and requirements."""
        return self.design == document.design and self.requirements == document.requirements


@dataclass(frozen=True, eq=False)
class VolumeJob(AboutRequirements):
    """The volume and what holds.

    Attributes:
        fine: Whether finely sampled, with the surface.
    """

    fine: bool = False


@dataclass(frozen=True, eq=False)
class SurfacePart:
    """What one cause cuts of the surface.

    Attributes:
        vertices: (n, 3) [m].
        faces: (m, 3) indices of vertices.
        color: ``#rrggbb``.
    """

    vertices: Array
    faces: NDArray[np.uint32]
    color: str


@dataclass(frozen=True, eq=False)
class VolumeOutcome:
    """What came of a volume.

    Attributes:
        job: The job.
        volume: Where all requirements hold, or None.
        check: Which requirements hold, or None.
        surface: Its surface, a part for each cause.
        conflict: Which requirements leave nothing, or no place for the workspace; what would help.
        seconds: How long it took.
        problem: Why there is none.
    """

    job: VolumeJob
    volume: Volume | None = None
    check: RequirementsCheck | None = None
    surface: tuple[SurfacePart, ...] = ()
    conflict: str = ""
    seconds: float = 0.0
    problem: str = ""


@dataclass(frozen=True, eq=False)
class LargestJob(AboutRequirements):
    """The largest workspace that is proven.

    Attributes:
        workspace: Its proportions, and its center as far as it is given.
        growth: Name of the extents that grow, of `synthesis.largest.Growth`.
        seconds: Time limit [s].
    """

    workspace: Workspace
    growth: str
    seconds: float

    def serves(self, document: Document) -> bool:
        """Whether its result is about a document's design and bounds."""
        held, now = self.requirements, document.requirements
        return self.design == document.design and (held.bounds, held.theta) == (
            now.bounds,
            now.theta,
        )


@dataclass(frozen=True, eq=False)
class LargestOutcome:
    """What came of it.

    Attributes:
        job: The job.
        proven: The region, or None.
        found: What is proven and how, or None.
        problem: Why there is none.
    """

    job: LargestJob
    proven: Placed | None = None
    found: LargestWorkspace | None = None
    problem: str = ""


@dataclass(frozen=True)
class Requiring:
    """What the tab *Requirements* shows.

    Attributes:
        selected: Index of the requirement that is edited.
        quick, fine: The last volumes, coarse and fine, or None.
        shape, growth, free, seconds: Of the largest workspace that is asked for: its shape, which
            extents grow, whether its center is free, and the time limit [s].
        running: The job on the largest workspace that runs, or None.
        done: What part of it is done, 0 to 1.
        largest: The last largest workspace, or None.
    """

    selected: int = 0
    quick: VolumeOutcome | None = None
    fine: VolumeOutcome | None = None
    shape: WorkspaceShape = WorkspaceShape.CYLINDER
    growth: str = "ALL"
    free: bool = False
    seconds: float = 15.0
    running: LargestJob | None = None
    done: float = 0.0
    largest: LargestOutcome | None = None
