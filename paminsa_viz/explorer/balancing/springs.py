"""Springs next to the design: the fit, and what the actuators hold with them.

Springs are no part of a design: all else on the page is of the robot without them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.balancing import fit_springs, spring_torques
from paminsa_viz.explorer.balancing.spring_settings import (
    HEIGHTS,
    LENGTHS,
    SpringJob,
    SpringOutcome,
    SpringSettings,
)
from paminsa_viz.explorer.state import State
from paminsa_viz.model import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.singular_limit import counting
from paminsa_viz.plots.map_data import workspace_field

CELLS = 41
"""Poses along each side of the map that springs are fitted on."""


def change_settings(state: State, **changes: Any) -> State:
    """Change where springs are.

    Raises:
        InvalidInput: If a number is out of its range.
    """
    settings = replace(state.springing.settings, **changes)
    numbers = (
        ("height", settings.height, HEIGHTS),
        ("radius", settings.radius, LENGTHS),
        ("free length", settings.least, LENGTHS),
        ("free length", settings.most, LENGTHS),
    )
    for name, value, (low, high) in numbers:
        if not low <= value <= high:
            text = f"{1e3 * low:g} to {1e3 * high:g} mm is possible, not {1e3 * value:g}"
            raise InvalidInput(name, text)
    if settings.least > settings.most:
        raise InvalidInput("free length", "its range has to end above where it starts")
    return state.updated("springing", settings=settings)


def wanted(state: State) -> SpringJob:
    """Return the fit of the current state."""
    document = state.document
    _, _, theta, z = document.pose
    return SpringJob(
        document.design, theta, z, state.springing.settings, state.condition_limit
    )  # fmt: skip


def start(state: State) -> State:
    """Start the fit of the current state."""
    return state.updated("springing", running=wanted(state))


def clear(state: State) -> State:
    """Forget the springs."""
    return state.updated("springing", running=None, outcome=None)


def receive(state: State, outcome: SpringOutcome) -> State:
    """Take over the result of the fit that runs; that of an older one is dropped."""
    if state.springing.running is not outcome.job:
        return state
    return state.updated("springing", running=None, outcome=outcome)


def run(job: SpringJob) -> SpringOutcome:
    """Fit; raises nothing that is the robot's or the person's fault."""
    try:
        field = workspace_field(job.design.geometry, job.theta, job.z, CELLS)
        poses = field.grid.poses()[counting(field, job.condition_limit)]
        place: SpringSettings = job.settings
        return SpringOutcome(job, fit_springs(job.design, [place.place], poses))
    except PaminsaError as error:
        return SpringOutcome(job, None, str(error))


def is_current(state: State) -> bool:
    """Whether the springs were fitted to the current design, plane and settings."""
    outcome = state.springing.outcome
    return outcome is not None and outcome.job.same(wanted(state))


def relieved(state: State, torques: Array) -> Array | None:
    """Return static torques at the last reachable pose with the springs, (4,) [N m, N].

    Args:
        state: The state; its springs may have been fitted to another design.
        torques: The same without springs.

    Returns:
        None without springs.
    """
    outcome = state.springing.outcome
    if outcome is None or outcome.fit is None:
        return None
    geometry, pose = state.last_reachable.geometry, state.last_reachable.pose
    return torques + spring_torques(geometry, outcome.fit.springs, pose)
