"""Springs next to the design: where they are, their fit, and what the actuators hold with them.

Springs are no part of a design: all else on the page is of the robot without them.
"""

from __future__ import annotations

from paminsa_viz.balancing import (
    SpringFit,
    fit_springs,
    spring_torques,
)
from paminsa_viz.explorer.core.actions import plane_job, set_layers
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.plane import PlaneJob
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array

CELLS = 41
"""Poses along each side of the map that springs are fitted on."""


def fit(job: PlaneJob, _: object) -> SpringFit:
    """Fit the springs.

    Raises:
        PaminsaError: If there are none, or no pose to fit them on.
    """
    return fit_springs(job.design, [job.settings.place], job.poses(CELLS))


def receive(state: State, outcome: Outcome[PlaneJob, SpringFit]) -> State:
    """Keep what came of a fit, and show the springs in the scene."""
    return set_layers(state.updated("springs", outcome=outcome), springs=True)


FIT = Task(
    Place(lambda state: state.springs),
    lambda state: plane_job(PlaneJob, state, state.springs.settings),
    fit,
    receive=receive,
)
"""Fits the springs of the current settings to the current design."""


def relieved(state: State, torques: Array) -> Array | None:
    """Return static torques at the last reachable pose with the springs, (4,) [N m, N].

    Args:
        state: The state; its springs may have been fitted to another design.
        torques: The same without springs.

    Returns:
        None without springs.
    """
    found, last = state.springs.result, state.last_reachable
    if found is None:
        return None
    return torques + spring_torques(last.geometry, found.springs, last.pose)
