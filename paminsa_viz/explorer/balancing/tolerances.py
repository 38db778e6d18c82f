"""A balance within tolerances: of masses at a pose, of lengths on the map."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from paminsa_viz.balancing.tolerance import (
    LengthTolerance,
    MassTolerance,
    length_tolerance,
    mass_tolerance,
)
from paminsa_viz.explorer.balancing.plane import PlaneJob
from paminsa_viz.explorer.settings import PERCENT, Settings, setting
from paminsa_viz.explorer.tasks import TaskState
from paminsa_viz.model import Design

CELLS = 21
"""Poses along each side of the map that lengths are looked at on."""

ROBOTS = 200
"""Robots that are drawn."""


@dataclass(frozen=True)
class ToleranceSettings(Settings):
    """Relative tolerances, each even to both sides."""

    mass: float = setting(
        0.02, "Masses ± [%]",
        "Of every mass of joints, links and counterweights, in each leg by itself",
        range=(0.0, 0.5), step=0.5, unit=PERCENT,
    )  # fmt: skip
    length: float = setting(
        0.001, "Lengths ± [%]",
        "Of k, R_b, R_pl, the bars, l_B5 and the places of counterweights, in all legs alike",
        range=(0.0, 0.1), step=0.05, unit=PERCENT,
    )  # fmt: skip


@dataclass(frozen=True)
class Tolerating(TaskState[PlaneJob, LengthTolerance]):
    """Tolerances of a session, and the robots that are drawn within that of lengths."""

    settings: ToleranceSettings = ToleranceSettings()


@lru_cache(maxsize=4)
def of_masses(design: Design, pose: tuple[float, ...], mass: float) -> MassTolerance:
    """Return the spread of M_p2 and of the torques at a pose from the tolerance of masses."""
    return mass_tolerance(replace(design, name=""), mass, pose)


def draw_robots(job: PlaneJob, _: object) -> LengthTolerance:
    """Draw robots within the tolerance of lengths, the settings of the job."""
    return length_tolerance(job.design, job.settings, job.poses(CELLS), samples=ROBOTS)
