"""The largest errors that the drives leave over a workspace, and the poses where they are."""

from __future__ import annotations

from functools import partial
from typing import Any, Final

from viser import Icon

from paminsa_viz.blocks.kinds import heading, shown
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.requirements import default_workspace
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.entries import Answer, Button, Entry, Html, Message
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.accuracy import WorstErrorsJob
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Design
from paminsa_viz.progress import Progress
from paminsa_viz.quantities.requirement_text import shape_text
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.workspace import RequirementCheck
from paminsa_viz.units import display_unit, format_pose

ERRORS: Final = {"error_horizontal": "position", "error_z": "z", "error_theta": "θ"}
"""Quantities whose largest value is found, and their names."""

ANY: Final = 1e3
"""A bound that no error of a robot comes near to [m or rad]."""

GO: Final = "worst error"
"""Message of the page: the pose of one of `ERRORS`, by its place in the table, was clicked."""


def find_worst(job: WorstErrorsJob, progress: Progress) -> tuple[RequirementCheck, ...]:
    """Return the largest of each of `ERRORS`, as the check of a requirement that any one keeps."""
    bounds = tuple(Requirement(key, high=ANY) for key in ERRORS)
    asked = Requirements(bounds=bounds, theta=job.theta, workspace=job.workspace)
    design = Design(geometry=job.geometry, accuracy=job.accuracy)
    found = check_requirements(design, asked, progress=progress)
    return tuple(item for item in found.items if item.requirement is not None)


def _job(state: State) -> WorstErrorsJob:
    document = state.document
    return WorstErrorsJob(
        document.design.geometry, document.design.accuracy, document.requirements.theta,
        document.requirements.workspace or default_workspace(document),
    )  # fmt: skip


WORST: Final = Task(Place(lambda state: state.worst_errors), _job, find_worst)
"""Finds the largest errors over the workspace of the requirements, or a suggested one."""


def worst_html(frame: Frame) -> str:
    """Return the largest errors with links to their poses."""
    outcome = WORST.outcome(frame.state)
    if outcome is None:
        return ""
    rows = []
    for name, item in zip(ERRORS.values(), outcome.result or (), strict=False):
        pose = item.pose and format_pose(item.pose)
        rows.append((heading(name, item.unit), shown(item.value, item.unit), pose, item.reason))
    low, high = (display_unit("rad").factor * end for end in outcome.job.theta)
    return render(
        "accuracy/worst.j2", rows=rows, problem=outcome.problem, message=GO, low=low, high=high,
        where=shape_text(outcome.job.workspace), stale=WORST.stale_text(frame.state),
    )  # fmt: skip


def go_to_worst(state: State, index: int) -> State:
    """Go to the pose where one of `ERRORS` is largest."""
    found = WORST.result(state) or ()
    return actions.move_to(state, found[index].pose if index < len(found) else None)


def _go(session: Session, data: Any) -> None:
    """Go to the pose that was clicked; ``data`` comes from the page."""
    if isinstance(data, str) and data in map(str, range(len(ERRORS))):
        session.dispatch("accuracy.worst", partial(go_to_worst, index=int(data)))


WORST_ERRORS: Final[tuple[Entry, ...]] = (
    *WORST.buttons(
        Button(
            "accuracy.worst", "Worst in the workspace", icon=Icon.ARROWS_MAXIMIZE,
            effect=WORST.start, undo=False,
            hint="The largest errors over the workspace of the requirements, or a suggested one",
        ),
    ),
    WORST.worker,
    Message(GO, receive=_go),
    Answer(
        "accuracy.worst_answer", "Errors over the workspace", found=WORST.outcome,
        entries=(Html("accuracy.worst_found", content=worst_html, idle=True),),
    ),
)  # fmt: skip
