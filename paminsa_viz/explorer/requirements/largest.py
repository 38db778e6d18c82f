"""The largest workspace that is proven: asked for, found, and used as the required one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from paminsa_viz.explorer import tasks
from paminsa_viz.explorer.requirements.actions import change
from paminsa_viz.explorer.requirements.jobs import LargestJob
from paminsa_viz.explorer.requirements.suggestions import default_workspace
from paminsa_viz.explorer.state import Document, State
from paminsa_viz.explorer.tasks import Report
from paminsa_viz.model import InvalidInput
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape

if TYPE_CHECKING:
    from paminsa_viz.synthesis.proof.largest import LargestWorkspace


def proportions(document: Document, shape: WorkspaceShape, free: bool) -> Workspace:
    """Return the workspace that gives the proportions and, unless it is free, the center."""
    held = document.requirements.workspace or default_workspace(document)
    x, y, z = held.size
    center: Any = (None, None, None) if free else held.center
    return Workspace(shape, (x, x if shape is WorkspaceShape.CYLINDER else y, z), center)


def start(state: State) -> State:
    """Search for the largest workspace that is proven.

    Raises:
        InvalidInput: If nothing is required.
    """
    document, asked = state.document, state.requiring.largest
    if not document.requirements.bounds:
        raise InvalidInput("requirements", "add one first: nothing but reach bounds the workspace")
    job = LargestJob(
        document.design, document.requirements,
        proportions(document, asked.shape, asked.free), asked.growth, asked.seconds,
    )  # fmt: skip
    return tasks.start(state, "requiring.largest", job)


def find_largest(job: LargestJob, report: Report) -> LargestWorkspace:
    """Find the largest workspace."""
    from paminsa_viz.synthesis.proof.largest import largest_workspace
    from paminsa_viz.synthesis.proof.regions import Growth

    return largest_workspace(
        job.design, job.requirements, job.workspace, growth=Growth[job.growth],
        time_limit=job.seconds, progress=report,
    )  # fmt: skip


def use(state: State) -> State:
    """Require the workspace that was found.

    Raises:
        InvalidInput: If none was proven.
    """
    proven = state.requiring.largest.proven
    if proven is None:
        raise InvalidInput("workspace", "none is proven")
    return change(state, workspace=Workspace(*proven))
