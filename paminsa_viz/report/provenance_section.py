"""Where the report comes from: the command, the programs, and the design as a file."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

import paminsa_viz
from paminsa_viz.engines.verification import Verification
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.report.blocks import Listing, Note, Section, Table, columns
from paminsa_viz.report.request import ReportRequest

PACKAGES = ("numpy", "scipy", "numba", "matplotlib", "mujoco", "pin")
"""Packages whose versions are stated, where they are installed."""

PAPER = (
    "V. Arakelian, S. Guégan and S. Briot, “Static and Dynamic Analysis of the PAMINSA”, "
    "DETC2005-84679."
)


def provenance_section(request: ReportRequest, found: Verification | str) -> Section:
    """Return the section."""
    rows = [
        ("Made", request.made.strftime("%Y-%m-%d %H:%M %Z")),
        ("By", f"paminsa_viz {paminsa_viz.__version__}"),
        ("Command", request.command),
        ("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}"),
        ("Packages", ", ".join(_versions())),
        ("Seed of random poses", str(request.seed)),
        ("Verified", _verdict(found)),
        ("Paper", PAPER),
    ]
    return Section(
        "provenance",
        "Provenance",
        (
            Table(("", ""), columns(*rows), words=2, literal=True),
            Note(
                "The formulas are the paper’s with its misprints corrected. Lengths are shown in "
                "mm and angles in degrees; files are in SI units. The design below, saved as a "
                "file, gives the same numbers again."
            ),
            Listing("Design file", write_design(request.design)),
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


def _verdict(found: Verification | str) -> str:
    if isinstance(found, str):
        return "no"
    return "passed" if found.passed else "failed"
