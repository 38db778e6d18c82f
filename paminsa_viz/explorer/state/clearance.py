"""Clearances: what is checked, and what is known of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from paminsa_viz.clearance import (
    ALL_PAIRS,
    NearestPoints,
    PairGroup,
)
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.settings import MILLIMETERS, Settings, followed, setting
from paminsa_viz.model import Design, Geometry
from paminsa_viz.plots.series_builders import MotionClearance
from paminsa_viz.trajectory import Trajectory, TrajectoryAnalysis

_REQUIRED: Final = (0.0, 0.1)
"""Ends of the least distance [m]."""


@dataclass(frozen=True)
class ClearanceSettings(Settings):
    """What is checked.

    Attributes:
        pairs: Groups of pairs of bodies.
        required: [m].
    """

    pairs: frozenset[PairGroup] = ALL_PAIRS
    required: float = setting(
        0.005, "Warn below [mm]",
        "Least distance of two bodies; less is a warning at the pose and along the motion",
        range=_REQUIRED, unit=MILLIMETERS,
    )  # fmt: skip


def sized_clearance(settings: ClearanceSettings, was: Geometry, now: Geometry) -> ClearanceSettings:
    """Return a least distance that follows the size of the bodies, unless it was chosen."""
    powers = {"required": (1, _REQUIRED)}
    return followed(settings, ClearanceSettings(), powers, was.body_scale, now.body_scale)


@dataclass(frozen=True)
class PoseJob:
    """The nearest bodies of a design at a pose."""

    design: Design
    pose: tuple[float, ...]
    pairs: frozenset[PairGroup]


@dataclass(frozen=True)
class MotionJob:
    """The least clearance of a design along its motion."""

    design: Design
    trajectory: Trajectory
    pairs: frozenset[PairGroup]
    analysis: TrajectoryAnalysis = field(compare=False)


@dataclass(frozen=True)
class ClearanceState:
    """What is checked, and what is known of clearances.

    Attributes:
        settings: What a person set.
        pose, motion: The last results; they may be of another pose or motion. The nearest bodies
            are None where there are none.
    """

    settings: ClearanceSettings = field(default_factory=ClearanceSettings)
    pose: Outcome[PoseJob, NearestPoints | None] | None = None
    motion: Outcome[MotionJob, MotionClearance] | None = None
