"""Jobs on requirements and what they find: plain data of the state."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.state.outcome import Outcome, TaskState
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape

if TYPE_CHECKING:
    from paminsa_viz.explorer.state.document import Document
    from paminsa_viz.synthesis.proof.largest import LargestWorkspace  # noqa: F401 - a type argument
    from paminsa_viz.synthesis.volume.check import RequirementsCheck
    from paminsa_viz.synthesis.volume.solve import Volume

Placed = tuple[WorkspaceShape, tuple[float, float, float], tuple[float, float, float]]
"""Shape, size and center of a workspace [m]."""


@dataclass(frozen=True)
class VolumeJob:
    """The volume of a design, and which requirements hold.

    Attributes:
        design: The robot.
        requirements: What it has to do.
        fine: Whether finely sampled, with the surface.
    """

    design: Design
    requirements: Requirements
    fine: bool = False

    def serves(self, document: Document) -> bool:
        """Whether its result is about a document's design and requirements."""
        return self.design == document.design and self.requirements == document.requirements


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
class VolumeResult:
    """A volume.

    Attributes:
        volume: Where all requirements hold.
        check: Which requirements hold.
        surface: Its surface, a part for each cause; nothing if it is coarse.
        conflict: Which requirements leave nothing, or no place for the workspace; what would help.
    """

    volume: Volume
    check: RequirementsCheck
    surface: tuple[SurfacePart, ...] = ()
    conflict: tuple[str, ...] = ()


VolumeOutcome = Outcome[VolumeJob, VolumeResult]


@dataclass(frozen=True)
class LargestJob:
    """The largest workspace that is proven.

    Attributes:
        design: The robot.
        requirements: What it has to do.
        workspace: Its proportions, and its center as far as it is given.
        growth: Name of the extents that grow, of `synthesis.proof.regions.Growth`.
        seconds: Time limit [s].
    """

    design: Design
    requirements: Requirements
    workspace: Workspace
    growth: str
    seconds: float

    def serves(self, document: Document) -> bool:
        """Whether its result is about a document's design and bounds."""
        held, now = self.requirements, document.requirements
        same = (held.bounds, held.theta) == (now.bounds, now.theta)
        return same and self.design == document.design


LargestOutcome = Outcome[LargestJob, "LargestWorkspace"]


@dataclass(frozen=True)
class LargestSettings(Settings):
    """What a person set for the search for the largest workspace."""

    shape: WorkspaceShape = setting(
        WorkspaceShape.CYLINDER, "Shape",
        "Its proportions, and its center unless that is free, are those of the required one",
    )  # fmt: skip
    growth: str = setting(
        "ALL", "Grows", "The other extents are those of the required workspace"
    )  # fmt: skip
    free: bool = setting(False, "Free center", "Otherwise the required workspace’s, or home")
    seconds: float = setting(
        15.0, "Time limit [s]", "Longer proofs leave a smaller gap", range=(1.0, 600.0)
    )

    @property
    def possible(self) -> bool:
        if self.growth == LargestSettings.growth:
            return True
        # Late: a page that proves nothing does without.
        from paminsa_viz.synthesis.proof.regions import Growth

        return self.growth in Growth.__members__


@dataclass(frozen=True)
class LargestState(TaskState[LargestJob, "LargestWorkspace"]):
    """The search for the largest workspace.

    Attributes:
        settings: What a person set.
    """

    settings: LargestSettings = field(default_factory=LargestSettings)

    @property
    def proven(self) -> Placed | None:
        """Shape, size and center of the workspace that was proven last, or None."""
        workspace = None if self.result is None else self.result.workspace
        if workspace is None:
            return None
        x, y, z = (float(place or 0.0) for place in workspace.center)
        return workspace.shape, workspace.size, (x, y, z)


@dataclass(frozen=True)
class RequirementsState:
    """What the tab *Requirements* shows.

    Attributes:
        selected: Index of the requirement that is edited.
        quick, fine: The last volumes, coarse and fine, or None.
        largest: The search for the largest workspace.
    """

    selected: int = 0
    quick: VolumeOutcome | None = None
    fine: VolumeOutcome | None = None
    largest: LargestState = LargestState()
