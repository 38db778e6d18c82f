"""The design: every number, and where it differs from the paper's Appendix 4."""

from __future__ import annotations

from paminsa_viz.files.design_schema import KEYS, DesignKey
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.report.blocks import Block, Note, Row, Section, Table
from paminsa_viz.units import format_value, percent_change

GROUPS: dict[str, str] = {
    "geometry": "Lengths",
    "joints": "Masses of joints, one leg",
    "links": "Masses of links, one leg",
    "inertias": "Moments of inertia of links, one leg",
    "platform": "Platform",
    "payload": "Payload",
    "friction": "Friction of the actuators",
    "": "Surroundings",
}
"""Tables of a design file and their headings."""

_UNUSED = ("friction", "payload")
"""Groups that are left out while all their values are those of Appendix 4."""


def design_section(design: Design) -> Section:
    """Return the section."""
    differing = {key for key in KEYS if _differs(design, key)}
    rows: list[Row] = []
    for table, heading in GROUPS.items():
        keys = [key for key in KEYS if key.table == table]
        if table in _UNUSED and differing.isdisjoint(keys):
            continue
        rows.append(Row((heading,), "group"))
        rows += [_row(design, key, key in differing) for key in keys]
    blocks: list[Block] = [Note(_summary(design, len(differing)))]
    if differing:
        head = ("Symbol", "Quantity", "Value", "Appendix 4", "Change")
        blocks.append(Table(head, tuple(rows), "Values that differ are marked.", words=2))
    else:
        blocks.append(Table(("Symbol", "Quantity", "Value"), tuple(rows), words=2))
    if design.counterweights:
        blocks.append(_counterweights(design))
    return Section("design", "Design", tuple(blocks))


def _summary(design: Design, changed: int) -> str:
    extra = len(design.counterweights)
    if not changed and not extra:
        return "All values are those of the paper's Appendix 4."
    text = (
        f"{changed} value{' differs' if changed == 1 else 's differ'} from the paper's Appendix 4"
    )
    if extra:
        text += f"; every leg carries {extra} counterweight{'' if extra == 1 else 's'}"
    return text + "."


def _differs(design: Design, key: DesignKey) -> bool:
    path = key.parameter.path
    return design.value(path) != APPENDIX_4.value(path)


def _row(design: Design, key: DesignKey, differs: bool) -> Row:
    parameter = key.parameter
    now, before = design.value(parameter.path), APPENDIX_4.value(parameter.path)
    cells = (parameter.symbol, parameter.label, format_value(now, parameter.unit, 6))
    if not differs:
        return Row(cells)
    return Row(
        (*cells, format_value(before, parameter.unit, 6), percent_change(before, now)), "marked"
    )


def _counterweights(design: Design) -> Table:
    rows = tuple(
        Row((weight.place, format_value(weight.mass, "kg", 5)), color=ACTUATOR_COLORS[3])
        for weight in design.counterweights
    )
    return Table(("Counterweight", "Mass, each leg"), rows, "Counterweights, on every leg.")
