"""A balance within tolerances: of masses at a pose, of lengths on the map."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.balancing.tolerance import (
    LengthTolerance,
    MassTolerance,
    length_tolerance,
    mass_tolerance,
)
from paminsa_viz.explorer.core.actions import plane_job
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.plane import PlaneJob
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.tolerances import ToleranceSettings
from paminsa_viz.kept import kept
from paminsa_viz.model import Design

CELLS = 21
"""Poses along each side of the map that lengths are looked at on."""

ROBOTS = 200
"""Robots that are drawn."""


@kept(4)
def of_masses(design: Design, pose: tuple[float, ...], mass: float) -> MassTolerance:
    """Return the spread of M_p2 and of the torques at a pose from the tolerance of masses."""
    return mass_tolerance(replace(design, name=""), mass, pose)


def draw_robots(job: PlaneJob, _: object) -> LengthTolerance:
    """Draw robots within the tolerance of lengths, the settings of the job."""
    return length_tolerance(job.design, job.settings.length, job.poses(CELLS), samples=ROBOTS)


def _job(state: State) -> PlaneJob:
    settings = ToleranceSettings(length=state.tolerances.settings.length)
    return plane_job(PlaneJob, state, settings)


DRAW = Task(Place(lambda state: state.tolerances), _job, draw_robots)
"""Draws robots of the current design."""
