"""Requirements of a session: which hold, and the volume with its surface."""

from __future__ import annotations

from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.state.requirements import Placed, VolumeOutcome
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.check import RequirementsCheck, check_requirements

CHEAP = 3e-6
"""Cost of all quantities [s a pose] up to which a given workspace is checked at once: some 5 ms."""


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
