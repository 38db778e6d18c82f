"""The largest errors by the drives over a workspace: what they are of."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.model import DriveAccuracy, Geometry
from paminsa_viz.quantities.requirements import Range, Workspace


@dataclass(frozen=True)
class WorstErrorsJob:
    """Where errors are looked for, with all that they depend on.

    Attributes:
        geometry: Lengths of the robot.
        accuracy: Accuracy of its drives.
        theta: Headings [rad].
        workspace: The required one, or that of a suggestion.
    """

    geometry: Geometry
    accuracy: DriveAccuracy
    theta: Range
    workspace: Workspace
