"""The largest workspace that is proven to meet the requirements, a folder of its tab."""

from __future__ import annotations

from viser import Icon

from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.entries import Button, Custom, Html, Progress
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import Checkbox, Dropdown, Number, attribute
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.requirements import largest
from paminsa_viz.explorer.requirements.jobs import LargestJob, LargestOutcome
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from paminsa_viz.synthesis.proof.evidence import Evidence, Verdict
from paminsa_viz.synthesis.proof.largest import LargestWorkspace
from paminsa_viz.synthesis.proof.regions import Growth
from paminsa_viz.units import format_value, number

LONGEST = 600.0
"""Longest time that can be asked for [s]."""


def workspace_text(workspace: Workspace) -> str:
    """Return a workspace for people: ``cylinder ⌀ 300 × 400 mm``."""
    x, y, z = (number(1e3 * extent) for extent in workspace.size)
    if workspace.shape is WorkspaceShape.CYLINDER:
        return f"cylinder ⌀ {x} × {z} mm"
    return f"box {x} × {y} × {z} mm"


def result_html(frame: Frame) -> str:
    """Return what is proven, how far it is from what cannot be, and why it ends there."""
    outcome = frame.state.requiring.largest
    if outcome is None or frame.state.requiring.running is not None:
        return ""
    found = outcome.found
    if found is None:
        return render("note.j2", testid="largest-problem", muted=False, text=outcome.problem)
    workspace = found.workspace
    place = ""
    if workspace is not None:
        x, y, z = (format_value(float(at or 0.0), "m") for at in workspace.center)
        place = f"x {x}, y {y}, z {z}"
    return render(
        "requirements_largest.j2", text="" if workspace is None else workspace_text(workspace),
        place=place, gap=format_value(found.gap, "m", 2), seconds=number(found.seconds, 2),
        cause=cause_text(found), stale=not outcome.job.serves(frame.state.document),
        rows=[_row(item) for item in found.proof.evidence],
    )  # fmt: skip


def cause_text(found: LargestWorkspace) -> str:
    """Return why the workspace is not larger."""
    if found.requirement is not None:
        return requirement_label(found.requirement)
    texts = {"home": "no path from home", "volume": "no position meets all requirements"}
    return texts.get(found.cause, found.cause)


def _row(item: Evidence) -> dict[str, str]:
    label, unit = item.name, "m"
    if item.requirement is not None:
        label, unit = requirement_label(item.requirement), item.requirement.entry.unit
    marks = {Verdict.PROVEN: ("✓", "pv-ok"), Verdict.SAMPLED: ("~", "pv-warn")}
    mark, level = marks.get(item.verdict, ("✗", "pv-bad"))
    bound = item.bound if item.requirement is not None else item.margin
    return {
        "mark": mark, "level": level, "label": label, "method": item.method.value,
        "bound": format_value(float(bound), unit, 4),
    }  # fmt: skip


def _busy(state: State) -> bool:
    return state.requiring.running is not None


def _idle(state: State) -> bool:
    return state.requiring.running is None


def _is_proven(state: State) -> bool:
    outcome = state.requiring.largest
    return outcome is not None and outcome.proven is not None and _idle(state)


class LargestSolver:
    """Runs the searches for the largest workspace of a session."""

    def __init__(self, session: Session) -> None:
        self._job: BackgroundJob[LargestJob, LargestOutcome] = BackgroundJob(
            session, "requirements.largest", largest.find_largest, largest.receive,
            failed=lambda job, problem: LargestOutcome(job, problem=problem),
            progress=largest.report_progress, undo=False,
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start the search that is wanted."""
        self._job.request(frame.state.requiring.running)


LARGEST_WORKSPACE = (
    Dropdown(
        "largest.shape", "Shape", options={shape.value: shape for shape in WorkspaceShape},
        hint="Its proportions, and its center unless that is free, are those of the required one",
        **attribute("requiring.shape"),
    ),
    Dropdown(
        "largest.growth", "Grows", options={growth.value: growth.name for growth in Growth},
        hint="The other extents are those of the required workspace",
        **attribute("requiring.growth"),
    ),
    Checkbox(
        "largest.free", "Free center", hint="Otherwise the required workspace's, or home",
        **attribute("requiring.free"),
    ),
    Number(
        "largest.seconds", "Time limit [s]", range=(1.0, LONGEST), step=1.0,
        hint="Longer proofs leave a smaller gap", **attribute("requiring.seconds"),
    ),
    Button(
        "largest.start", "Find the largest", icon=Icon.CERTIFICATE, effect=largest.start,
        visible=_idle, undo=False,
        hint="Reach and singularities in closed form, condition number, torques and F₄ by interval "
        "bisection",
    ),
    Progress("largest.progress", visible=_busy, read=lambda state: state.requiring.done),
    Button("largest.stop", "Stop", color="gray", visible=_busy, effect=largest.stop, undo=False),
    Html("largest.result", content=result_html),
    Button(
        "largest.use", "Use as required workspace", visible=_is_proven, effect=largest.use,
    ),
    Custom("largest.job", make=LargestSolver),
)  # fmt: skip
