"""Requirements of a session: which hold, and the volume with its surface."""

from __future__ import annotations

import math

from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.requirements import Placed, VolumeOutcome
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.model.reach import home_pose, workspace_radius
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume.check import RequirementsCheck, check_requirements

CHEAP = 3e-6
"""Cost of all quantities [s a pose] up to which a given workspace is checked at once: some 5 ms."""


SHARE = 0.5
"""Radius of the workspace that is suggested, over that of the singular circle."""


def default_workspace(document: Document) -> Workspace:
    """Return a cylinder within the singular circles of the required headings, about home."""
    geometry, theta = document.design.geometry, document.requirements.theta
    reach = workspace_radius(geometry)
    circle = min(float(singular_radius(geometry, angle)) for angle in (*theta, 0.0))
    z = home_pose(geometry)[3]
    width, height = 2 * SHARE * min(circle, 0.5 * reach), 0.4 * reach
    width, height = map(_two_digits, (width, height))
    return Workspace(WorkspaceShape.CYLINDER, (width, width, height), (0.0, 0.0, z))


def _two_digits(extent: float) -> float:
    """Return a length to 10 mm, and to two digits below 100 mm [m]."""
    extent = max(extent, 1e-4)
    return round(float(extent), max(2, 1 - math.floor(math.log10(extent))))


@kept(4)
def _at_once(design: Design, requirements: Requirements) -> RequirementsCheck:
    return check_requirements(design, requirements)


def is_quick(requirements: Requirements) -> bool:
    """Whether requirements are checked so fast that nothing has to wait."""
    workspace = requirements.workspace
    cost = sum({bound.entry.formula: bound.entry.cost for bound in requirements.bounds}.values())
    return workspace is not None and None not in workspace.center and cost <= CHEAP


def current_check(state: State) -> RequirementsCheck | None:
    """Return which requirements hold, as finely as is known; None if nothing is known yet."""
    document = state.document
    if not asked(document.requirements):
        return None
    for outcome in (state.requirements.fine, state.requirements.quick):
        if outcome is not None and outcome.result is not None and outcome.job.serves(document):
            return outcome.result.check
    if is_quick(document.requirements):
        return _at_once(document.design, document.requirements)
    return None


def last_check(state: State) -> tuple[RequirementsCheck, Requirements] | None:
    """Return the check before the last change and what it was of, while the new one is awaited."""
    if not asked(state.document.requirements) or current_volume(state) is not None:
        return None
    for outcome in (state.requirements.quick, state.requirements.fine):
        if outcome is not None and outcome.result is not None:
            return outcome.result.check, outcome.job.requirements
    return None


def current_volume(state: State) -> VolumeOutcome | None:
    """Return the volume of the current design, the fine one if it is there."""
    for outcome in (state.requirements.fine, state.requirements.quick):
        if outcome is not None and outcome.job.serves(state.document):
            return outcome
    return None


def placed_workspace(state: State) -> Placed | None:
    """Return the required workspace where it is or, if it is free, where it fits best."""
    workspace = state.document.requirements.workspace
    if workspace is None:
        return None
    x, y, z = workspace.center
    if x is None or y is None or z is None:
        check = current_check(state)
        if check is None or check.center is None:
            return None
        x, y, z = check.center
    return workspace.shape, workspace.size, (x, y, z)
