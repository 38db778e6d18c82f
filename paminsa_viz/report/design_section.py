"""The design, compared with the paper's Appendix 4; and where the report comes from."""

from __future__ import annotations

import math
import platform
from importlib.metadata import PackageNotFoundError, version

from paminsa_viz.blocks.kinds import Block, Listing, Note, Row, Table, rows
from paminsa_viz.engines.verification import Verification
from paminsa_viz.files.design_schema import KEY_OF, DesignKey
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model.design import APPENDIX_4, Design, stated_parameters
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.units import format_value, percent_change
from paminsa_viz.version import MADE_BY

GROUPS: dict[str, str] = {
    "geometry": "Lengths",
    "joints": "Masses of joints, one leg",
    "links": "Masses of links, one leg",
    "inertias": "Moments of inertia of links, one leg",
    "platform": "Platform",
    "payload": "Payload",
    "friction": "Friction of the actuators",
    "load": "External load on the platform",
    "": "Surroundings",
    "accuracy": "Accuracy of the drives",
    "leg1": "Deviations of leg 1",
    "leg2": "Deviations of leg 2",
    "leg3": "Deviations of leg 3",
    "tolerances": "Tolerances and clearances",
    "elastic": "Material, sections and stiffnesses",
}
"""Tables of a design file and their headings."""

PACKAGES = ("numpy", "scipy", "numba", "matplotlib", "mujoco", "pin")
"""Packages whose versions are stated, where they are installed."""

PAPER = (
    "V. Arakelian, S. Guégan and S. Briot, “Static and Dynamic Analysis of the PAMINSA”, "
    "DETC2005-84679."
)

_UNUSED = ("friction", "load", "payload")
"""Groups that are left out while all their values are those of Appendix 4."""


def design_section(design: Design) -> Section:
    """Return the section."""
    stated = [KEY_OF[parameter.path] for parameter in stated_parameters(design)]
    differing = {
        key
        for key in stated
        if design.value(key.parameter.path) != APPENDIX_4.value(key.parameter.path)
    }
    values: list[Row] = []
    for table, heading in GROUPS.items():
        keys = [key for key in stated if key.table == table]
        if not keys or (table in _UNUSED and differing.isdisjoint(keys)):
            continue
        values.append(Row((heading,), "group"))
        values += [_row(design, key, key in differing) for key in keys]
    blocks: list[Block] = [Note(_summary(design, len(differing)))]
    if differing:
        head = ("Symbol", "Quantity", "Value", "Appendix 4", "Change")
        blocks.append(Table(head, tuple(values), "Values that differ are marked.", words=2))
    else:
        blocks.append(Table(("Symbol", "Quantity", "Value"), tuple(values), words=2))
    if design.counterweights:
        blocks.append(_counterweights(design))
    return Section("design", "Design", tuple(blocks))


def _summary(design: Design, changed: int) -> str:
    extra, driven = len(design.counterweights), any(design.drives)
    if not changed and not extra:
        text = "All values are those of the paper's Appendix 4"
        return f"{text}{', which has no drives' if driven else ''}."
    text = (
        f"{changed} value{' differs' if changed == 1 else 's differ'} from the paper's Appendix 4"
    )
    if extra:
        text += f"; every leg carries {extra} counterweight{'' if extra == 1 else 's'}"
    return text + ("; it has drives." if driven else ".")


def _row(design: Design, key: DesignKey, differs: bool) -> Row:
    parameter = key.parameter
    now, before = design.value(parameter.path), APPENDIX_4.value(parameter.path)
    texts = [
        "rigid" if math.isinf(value) else format_value(value, parameter.unit, 6)
        for value in (now, before)
    ]
    cells = (parameter.symbol, parameter.label, texts[0])
    if not differs:
        return Row(cells)
    return Row((*cells, texts[1], percent_change(before, now)), "marked")


def _counterweights(design: Design) -> Table:
    rows = tuple(
        Row((weight.place, format_value(weight.mass, "kg", 5)), color=ACTUATOR_COLORS[3])
        for weight in design.counterweights
    )
    return Table(("Counterweight", "Mass, each leg"), rows, "Counterweights, on every leg.")


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
