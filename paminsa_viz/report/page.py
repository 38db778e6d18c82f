"""From a request to one HTML file that needs nothing else."""

from __future__ import annotations

from functools import lru_cache
from importlib.resources import files

from jinja2 import Template
from markupsafe import Markup

from paminsa_viz.blocks.balance import mass_facts
from paminsa_viz.blocks.trajectory import trajectory_facts
from paminsa_viz.blocks.verification import verification_fact
from paminsa_viz.checks import kinds_checked
from paminsa_viz.identification.findings import investigate
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.palette import BAD, INK, MUTED, OK, WARN
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.report.design_section import design_section, provenance_section
from paminsa_viz.report.request import ReportRequest
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
from paminsa_viz.trajectory import analyze
from paminsa_viz.units import format_pose, symbols_html, tied
from paminsa_viz.version import __version__

STEPS = (
    "design and workspace", "requirements", "torque maps", "forces and capability", "stiffness",
    "accuracy", "calibration", "trajectory", "joint forces", "clearance", "identification",
    "verification", "balance",
)  # fmt: skip
"""What is worked out, in this order; some only where they are asked for."""


COLORS = {"ink": INK, "muted": MUTED, "ok": OK, "warn": WARN, "bad": BAD}
"""Colors of a report's page."""


@kinds_checked
def report_html(request: ReportRequest, progress: Progress = go_on) -> str:
    """Return the report.

    Args:
        request: What to report on.
        progress: Called before each of `STEPS` with that ``step``; true ends the work.

    Raises:
        UnreachablePose: If the robot cannot take the request's pose.
        InvalidLog: If the request's log cannot be used.
        InvalidMeasurement: If the request's measured poses cannot be used.
        Canceled: If ``progress`` says so.
    """

    def began(step: str) -> None:
        keep_on(progress, STEPS.index(step) / len(STEPS), step=step)

    require_reachable(request.design.geometry, request.pose)
    design, reference = request.design, request.reference
    analysis = analyze(design, request.trajectory)
    compared = None if reference is None else analyze(reference, request.trajectory)
    began("design and workspace")
    sections = [design_section(design, reference), workspace_section(request)]
    if request.requirements is not None:
        began("requirements")
        sections.append(requirements_section(request.design, request.requirements))
    if request.synthesis is not None:
        sections.append(synthesis_section(request.synthesis))
    began("torque maps")
    sections.append(maps_section(request))
    began("forces and capability")
    sections.append(forces_section(request))
    began("stiffness")
    sections.append(stiffness_section(request))
    began("accuracy")
    sections.append(accuracy_section(request))
    if request.measured is not None:
        began("calibration")
        sections.append(calibration_section(request.design, request.measured))
    began("trajectory")
    sections.append(trajectory_section(analysis, compared))
    sections.append(drives_section(analysis))
    began("joint forces")
    sections.append(loads_section(analysis, request.pose))
    began("clearance")
    sections.append(clearance_section(analysis, request.pose))
    if request.log is not None:
        began("identification")
        sections.append(identification_section(investigate(request.log, request.design)))
    if request.verified:
        began("verification")
    found = checked(request)
    sections.append(verification_section(found))
    began("balance")
    sections += [balance_section(analysis), provenance_section(request, found)]
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
