"""The design, compared with the paper's Appendix 4; and where the report comes from."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from paminsa_viz.blocks.design import changes_table, design_blocks
from paminsa_viz.blocks.kinds import Listing, Note, Table, rows
from paminsa_viz.engines.verification import Verification
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.design import Design
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.units import as_sentence
from paminsa_viz.version import MADE_BY

PACKAGES = ("numpy", "scipy", "numba", "matplotlib", "mujoco", "pin")
"""Packages whose versions are stated, where they are installed."""

PAPER = (
    "V. Arakelian, S. Guégan and S. Briot, “Static and Dynamic Analysis of the PAMINSA”, "
    "DETC2005-84679."
)


def design_section(design: Design, reference: Design | None = None) -> Section:
    """Return the section, with what differs from a reference if there is one."""
    blocks = design_blocks(design)
    if note := equal_legs_note(design.deviations):
        text = f"But for errors of the pose by tolerances and the calibration, {note}"
        blocks.append(Note(as_sentence(text)))
    if reference is not None:
        caption = f"What differs from the reference “{reference.name}”."
        table = changes_table(reference, design, ("Reference", "Design"), caption=caption)
        same = Note(f"No value differs from the reference “{reference.name}”.")
        blocks.append(table if table.rows else same)
    return Section("design", "Design", tuple(blocks))


def provenance_section(request: ReportRequest, found: Verification | str) -> Section:
    """Return the section."""
    verdict = "no" if isinstance(found, str) else "passed" if found.passed else "failed"
    facts = [
        ("Made", request.made.strftime("%Y-%m-%d %H:%M %Z")),
        ("By", MADE_BY),
        ("Command", request.command),
        ("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}"),
        ("Packages", ", ".join(_versions())),
        ("Seed of random poses", str(request.seed)),
        ("Verified", verdict),
        ("Paper", PAPER),
    ]
    return Section(
        "provenance",
        "Provenance",
        (
            Table(("", ""), rows(*facts), words=2, literal=True),
            Note(
                "The formulas are the paper’s with its misprints corrected. Lengths are shown in "
                "mm and angles in degrees; files are in SI units. The design below, saved as a "
                "file, gives the same numbers again."
            ),
            Listing("Design file", write_design(request.design, requirements=request.requirements)),
        ),
    )


def _versions() -> list[str]:
    found = []
    for package in PACKAGES:
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            continue
    return found
