"""The largest workspace that is proven: asked for, found, and used as the required one."""

from __future__ import annotations

from typing import Any

from paminsa_viz.explorer.background import Report
from paminsa_viz.explorer.requirements.actions import change
from paminsa_viz.explorer.requirements.jobs import LargestJob, LargestOutcome, Placed
from paminsa_viz.explorer.requirements.suggestions import default_workspace
from paminsa_viz.explorer.state import Document, State
from paminsa_viz.model import InvalidInput, PaminsaError
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape


def proportions(document: Document, shape: WorkspaceShape, free: bool) -> Workspace:
    """Return the workspace that gives the proportions and, unless it is free, the center."""
    held = document.requirements.workspace or default_workspace(document)
    x, y, z = held.size
    center: Any = (None, None, None) if free else held.center
    return Workspace(shape, (x, x if shape is WorkspaceShape.CYLINDER else y, z), center)


def change_search(state: State, **changes: Any) -> State:
    """Change what is searched for."""
    return state.updated("requiring", **changes)


def start(state: State) -> State:
    """Search for the largest workspace that is proven.

    Raises:
        InvalidInput: If nothing is required.
    """
    document, requiring = state.document, state.requiring
    if not document.requirements.bounds:
        raise InvalidInput("requirements", "add one first: nothing but reach bounds the workspace")
    job = LargestJob(
        document.design, document.requirements,
        proportions(document, requiring.shape, requiring.free),
        requiring.growth, requiring.seconds,
    )  # fmt: skip
    return state.updated("requiring", running=job, done=0.0)


def stop(state: State) -> State:
    """End the search, without an answer."""
    return state.updated("requiring", running=None)


def report_progress(state: State, job: LargestJob, done: float) -> State:
    """Take over what part is done."""
    return state.updated("requiring", done=done) if state.requiring.running is job else state


def receive(state: State, outcome: LargestOutcome) -> State:
    """Take over a result."""
    return state.updated("requiring", running=None, largest=outcome)


def find_largest(job: LargestJob, report: Report) -> LargestOutcome:
    """Find the largest workspace; what is the robot's fault is no error."""
    from paminsa_viz.synthesis.proof.largest import largest_workspace
    from paminsa_viz.synthesis.proof.regions import Growth

    try:
        found = largest_workspace(
            job.design, job.requirements, job.workspace, growth=Growth[job.growth],
            time_limit=job.seconds, progress=report,
        )  # fmt: skip
    except PaminsaError as error:
        return LargestOutcome(job, problem=str(error))
    return LargestOutcome(job, placed(found.workspace), found)


def placed(workspace: Workspace | None) -> Placed | None:
    """Return shape, size and center of a workspace that was found."""
    if workspace is None:
        return None
    x, y, z = (float(place or 0.0) for place in workspace.center)
    return workspace.shape, workspace.size, (x, y, z)


def use(state: State) -> State:
    """Require the workspace that was found.

    Raises:
        InvalidInput: If none was proven.
    """
    outcome = state.requiring.largest
    if outcome is None or outcome.proven is None:
        raise InvalidInput("workspace", "none is proven")
    shape, size, center = outcome.proven
    return change(state, workspace=Workspace(shape, size, center))
