"""From a request to one HTML file that needs nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, lru_cache, partial
from importlib.resources import files

from jinja2 import Template
from markupsafe import Markup

from paminsa_viz.blocks.balance import mass_facts
from paminsa_viz.blocks.trajectory import trajectory_facts
from paminsa_viz.blocks.verification import verification_fact
from paminsa_viz.checks import kinds_checked
from paminsa_viz.engines.verification import Verification
from paminsa_viz.identification.findings import investigate
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.palette import BAD, INK, MUTED, OK, WARN
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.report.design_section import design_section, provenance_section
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.report.sections import (
    accuracy_section,
    balance_section,
    calibration_section,
    checked,
    clearance_section,
    drives_section,
    forces_section,
    identification_section,
    loads_section,
    requirements_section,
    stiffness_section,
    synthesis_section,
    trajectory_section,
    verification_section,
)
from paminsa_viz.report.workspace_section import maps_section, workspace_section
from paminsa_viz.templates import html_environment
from paminsa_viz.trajectory import TrajectoryAnalysis, analyze
from paminsa_viz.units import format_pose, symbols_html, tied
from paminsa_viz.version import __version__

COLORS = {"ink": INK, "muted": MUTED, "ok": OK, "warn": WARN, "bad": BAD}
"""Colors of a report's page."""


@kinds_checked
def report_html(request: ReportRequest, progress: Progress = go_on) -> str:
    """Return the report.

    Args:
        request: What to report on.
        progress: Called before each section with the ``step`` that makes it; true ends the work.

    Raises:
        UnreachablePose: If the robot cannot take the request's pose.
        InvalidLog: If the request's log cannot be used.
        InvalidMeasurement: If the request's measured poses cannot be used.
        Canceled: If ``progress`` says so.
    """

    require_reachable(request.design.geometry, request.pose)
    analysis = analyze(request.design, request.trajectory)
    verified = cache(lambda: checked(request))
    steps, sections = list(_steps(request, analysis, verified)), list[Section]()
    for done, (step, make) in enumerate(steps):
        if step:
            keep_on(progress, done / len(steps), step=step)
        sections.append(make())
    found = verified()
    return template().render(
        kind="design report",
        title=f"PAMINSA design report: {request.design.name}",
        design=request.design.name,
        lines=_head(request),
        opening=[
            *mass_facts(request.design),
            *trajectory_facts(analysis),
            verification_fact(None if isinstance(found, str) else found),
        ],
        sections=list(enumerate((section for section in sections if section.blocks), 1)),
        colors=COLORS,
        version=__version__,
        made=request.made.strftime("%Y-%m-%d %H:%M %Z"),
    )


def _steps(
    request: ReportRequest, motion: TrajectoryAnalysis, verified: Callable[[], Verification | str]
) -> Iterator[tuple[str, Callable[[], Section]]]:
    """Yield all that is asked for in its order: what is said meanwhile, and what makes a section.

    Of a section that only says why it is empty nothing is said.

    Args:
        request: What to report on.
        motion: Its motion, analyzed.
        verified: Compares with the engines, once, or says why not.
    """
    design, pose, other = request.design, request.pose, request.reference
    compared = None if other is None else analyze(other, request.trajectory)
    yield "design", partial(design_section, design, other)
    yield "workspace", partial(workspace_section, request)
    if request.requirements is not None:
        yield "requirements", partial(requirements_section, design, request.requirements)
    if request.synthesis is not None:
        yield "synthesis", partial(synthesis_section, request.synthesis)
    yield "torque maps", partial(maps_section, request)
    yield "forces and capability", partial(forces_section, request)
    yield "stiffness", partial(stiffness_section, request)
    yield "accuracy", partial(accuracy_section, request)
    if request.measured is not None:
        yield "calibration", partial(calibration_section, design, request.measured)
    yield "trajectory", partial(trajectory_section, motion, compared)
    yield "drives", partial(drives_section, motion)
    yield "joint forces", partial(loads_section, motion, pose)
    yield "clearance", partial(clearance_section, motion, pose)
    if request.log is not None:
        log = request.log
        yield "identification", lambda: identification_section(investigate(log, design))
    meanwhile = "verification" if request.verified else ""
    yield meanwhile, lambda: verification_section(verified())
    yield "balance", partial(balance_section, motion)
    yield "provenance", lambda: provenance_section(request, verified())


@lru_cache(maxsize=1)
def template() -> Template:
    """Return the template of a report's page."""
    environment = html_environment([files("paminsa_viz.report") / "templates"])
    environment.filters["symbols"] = lambda text: Markup(symbols_html(text))
    environment.filters["tied"] = tied
    return environment.get_template("report.html")


def _head(request: ReportRequest) -> list[str]:
    return [
        f"{request.design.geometry.knee.label.capitalize()}, pose {format_pose(request.pose)}",
        f"Trajectory “{request.trajectory.name}”, {request.trajectory.duration:.3g} s",
    ]
