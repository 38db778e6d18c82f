"""From a request to one HTML file that needs nothing else."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup, escape

import paminsa_viz
from paminsa_viz.balancing import whole_mass
from paminsa_viz.engines.verification import Verification
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.palette import ACTUATOR_COLORS, BAD, INK, MUTED, OK, WARN
from paminsa_viz.plots.curves_words import written
from paminsa_viz.report.balance_section import balance_section
from paminsa_viz.report.blocks import NONE, Fact, Section, measured
from paminsa_viz.report.design_section import design_section
from paminsa_viz.report.maps_section import maps_section
from paminsa_viz.report.provenance_section import provenance_section
from paminsa_viz.report.request import Progress, ReportRequest, silent
from paminsa_viz.report.trajectory_section import trajectory_section
from paminsa_viz.report.verification_section import checked, verification_section
from paminsa_viz.report.workspace_section import workspace_section
from paminsa_viz.trajectory import TrajectoryAnalysis, analyze


def report_html(request: ReportRequest, progress: Progress = silent) -> str:
    """Return the report.

    Args:
        request: What to report on.
        progress: Called when the next piece of work begins.

    Raises:
        UnreachablePose: If the robot cannot take the request's pose.
    """
    require_reachable(request.design.geometry, request.pose)
    analysis = analyze(request.design, request.trajectory)
    progress("design and workspace")
    sections = [design_section(request.design), workspace_section(request)]
    progress("torque maps")
    sections.append(maps_section(request))
    progress("trajectory")
    sections.append(trajectory_section(analysis))
    progress("verification")
    found = checked(request)
    sections.append(verification_section(found))
    progress("balance")
    sections += [balance_section(analysis), provenance_section(request, found)]
    return _template().render(
        title=f"PAMINSA design report: {request.design.name}",
        design=request.design.name,
        lines=_head(request),
        opening=_facts(request, analysis, found),
        sections=tuple(_numbered(sections)),
        colors={"ink": INK, "muted": MUTED, "ok": OK, "warn": WARN, "bad": BAD},
        actuators=ACTUATOR_COLORS,
        version=paminsa_viz.__version__,
        made=request.made.strftime("%Y-%m-%d %H:%M %Z"),
    )


@lru_cache(maxsize=1)
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("paminsa_viz.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["symbols"] = symbols
    return environment.get_template("report.html")


_SYMBOL = re.compile(r"\b([A-Za-z])_([A-Za-z]{0,4}\d{0,2})\b(?:\^\((\w+)\))?")


def symbols(text: str) -> Markup:
    """Return a text as HTML, symbols such as ``l_B3`` and ``I_XX^(B4)`` set as in the paper."""

    def typeset(found: re.Match[str]) -> str:
        letter, below, above = found.groups()
        raised = f"<sup>({above})</sup>" if above else ""
        return f"<i>{letter}</i><sub>{below}</sub>{raised}" if below else found[0]

    if len(text) == 1 and text.isalpha():
        return Markup("<i>{}</i>").format(text)
    return Markup(_SYMBOL.sub(typeset, str(escape(text))))


def _numbered(sections: list[Section]) -> list[tuple[int, Section]]:
    return list(enumerate(sections, 1))


def _head(request: ReportRequest) -> list[str]:
    x, y, theta, z = request.pose
    return [
        f"{request.design.geometry.knee.label.capitalize()}, pose x {measured(x, 'm')}, "
        f"y {measured(y, 'm')}, θ {written(math.degrees(theta), 4)}°, z {measured(z, 'm')}",
        f"Trajectory “{request.trajectory.name}”, {request.trajectory.duration:.3g} s",
    ]


def _facts(
    request: ReportRequest, analysis: TrajectoryAnalysis, found: Verification | str
) -> list[Fact]:
    """Return the numbers that the report opens with."""
    design = request.design
    torque = force = NONE
    if analysis.summary:
        top = max(analysis.summary[:3], key=lambda summary: abs(summary.peak))
        torque = measured(abs(top.peak), "N m", 3)
        force = measured(abs(analysis.summary[3].peak), "N", 4)
    runs = analysis.check.first is None
    facts = [
        Fact("Moving mass", measured(whole_mass(design), "kg"), "legs, platform, payload"),
        Fact("M_p2", measured(static_imbalance(design), "N", 3), "0 is static balance"),
        Fact("Peak torque", torque, "M1 to M3 on the trajectory"),
        Fact("Peak force", force, "M4 on the trajectory"),
    ]
    if not runs:
        facts.append(Fact("Trajectory", "fails", "the robot cannot run it", "bad"))
    if isinstance(found, str):
        facts.append(Fact("Verification", NONE, "not done"))
    else:
        kind = "ok" if found.passed else "bad"
        word = "passed" if found.passed else "failed"
        note = f"largest difference {written(found.worst, 2)} of the largest torque"
        facts.append(Fact("Verification", word, note, kind))
    return facts
