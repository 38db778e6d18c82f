"""Designs: their values with symbols and units, and in what two of them differ."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any, TypeAlias

from paminsa_viz.blocks.kinds import Block, Cell, Note, Row, Table, heading, rows
from paminsa_viz.files.design_schema import (
    CHOICE_MEANINGS,
    CHOICES,
    COUNTERWEIGHT_KEYS,
    DRIVE_KEYS,
    DRIVE_MEANINGS,
    DRIVES,
    KEY_OF,
    KEYS,
    DesignKey,
    choice,
)
from paminsa_viz.model.design import APPENDIX_4, PARAMETER, Design, stated_parameters
from paminsa_viz.model.drive import ACTUATORS, Drive, Envelope
from paminsa_viz.model.parameters import Parameter
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.units import (
    NONE,
    counted,
    display_unit,
    format_value,
    number,
    percent_change,
)

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

RIGID = ("geometry", "joints", "links", "inertias", "platform")
"""Tables of the rigid robot, whose values are of a size with Appendix 4's for any robot like it."""

FAR = 100.0
"""Factor from Appendix 4's value at which another unit may be meant, such as g for kg."""

MOST_FAR = 3
"""How many such values are named."""

_ROUNDING = 1e-9
"""Numbers that differ by no larger part are the same but for rounding."""

_UNUSED = ("friction", "load", "payload")
"""Groups that are left out while all their values are those of Appendix 4."""

Entry: TypeAlias = tuple[str, str, float | str, float | str, str]
"""Table and key of a design file, the values of two designs, and what it means."""

Cells: TypeAlias = tuple[str, str, str, str, str, str]
"""The same as text, with the change before what it means."""


def design_blocks(design: Design) -> list[Block]:
    """Return the values of a design, marked where Appendix 4 differs, and its counterweights."""
    stated = [KEY_OF[parameter.path] for parameter in stated_parameters(design)]
    differing = {
        key
        for key in stated
        if design.value(key.parameter.path) != APPENDIX_4.value(key.parameter.path)
    }
    values: list[Row] = []
    for table, title in GROUPS.items():
        keys = [key for key in stated if key.table == table]
        found = [_row(design, key, key in differing) for key in keys]
        found += [_choice_row(design, *each) for each in CHOICES if each[0] == table]
        if not keys or (table in _UNUSED and all(row.kind == "plain" for row in found)):
            continue
        values += [Row((title,), "group"), *found]
    changed = sum(row.kind == "marked" for row in values)
    blocks: list[Block] = [Note(_summary(design, changed))]
    if changed:
        head = ("Symbol", "Quantity", "Value", "Appendix 4", "Change")
        blocks.append(Table(head, tuple(values), "Values that differ are marked.", words=2))
    else:
        blocks.append(Table(("Symbol", "Quantity", "Value"), tuple(values), words=2))
    if design.counterweights:
        blocks.append(_counterweights(design))
    return blocks


def _summary(design: Design, changed: int) -> str:
    extra, driven = len(design.counterweights), any(design.drives)
    if not changed and not extra:
        values = "The design has drives; all other values" if driven else "All values"
        return f"{values} are those of the paper’s Appendix 4."
    text = f"{_differing(changed)} from the paper’s Appendix 4"
    if extra:
        text += f"; every leg carries {counted(extra, 'counterweight')}"
    return text + ("; it has drives." if driven else ".")


def _differing(count: int) -> str:
    return counted(count, "value differs", "values differ")


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


def _choice_row(design: Design, table: str, name: str) -> Row:
    now, before = (choice(each, table, name).value for each in (design, APPENDIX_4))
    cells = (name, CHOICE_MEANINGS[name], now)
    return Row(cells) if now == before else Row((*cells, before, ""), "marked")


def _counterweights(design: Design) -> Table:
    rows = tuple(
        Row((weight.place, format_value(weight.mass, "kg", 5)), color=ACTUATOR_COLORS[3])
        for weight in design.counterweights
    )
    return Table(("Counterweight", "Mass, each leg"), rows, "Counterweights, on every leg.")


def changes_text(design: Design) -> str:
    """Return how many entries of a design file differ from Appendix 4's."""
    count = sum(a != b for _, _, a, b, _ in _entries(APPENDIX_4, design))
    count += len(design.counterweights)
    count += sum(drive is not None for drive in design.drives)
    if not count:
        return "as Appendix 4"
    return f"{_differing(count)} from Appendix 4{_far_text(design)}"


def _far_text(design: Design) -> str:
    """Return which values are so far from Appendix 4's that they may be in another unit."""
    far = [
        f"{name} = {_text(after)} (instead of {_text(before)})"
        for table, name, before, after, _ in _changed(APPENDIX_4, design)
        if table in RIGID and isinstance(before, float) and isinstance(after, float)
        and before > 0 < after and not 1 / FAR < after / before < FAR
    ]  # fmt: skip
    if not far:
        return ""
    more = f" and {len(far) - MOST_FAR} more" if len(far) > MOST_FAR else ""
    return f"; check the unit of {', '.join(far[:MOST_FAR])}{more}"


def values_table(design: Design) -> Table:
    """Return every entry of a design file, in SI units."""
    found = [
        (table, name, _text(value), what)
        for table, name, value, _, what in _entries(design, design)
    ]
    found += [
        ("counterweights", "mass_kg", _text(weight.mass), weight.place)
        for weight in design.counterweights
    ]
    for actuator, drive in _drives(design).items():
        found.append((DRIVES, actuator, "", drive.summary))
        found += [
            (f"{DRIVES}.{actuator}", DRIVE_KEYS[name], _text(value), DRIVE_MEANINGS[name])
            for name, value in vars(drive).items()
            if value != getattr(Drive, name)
        ]
    return Table(("",) * 4, rows(*found), words=4)


def values_data(design: Design) -> dict[str, Any]:
    """Return the same for JSON."""
    facts: dict[str, Any] = {
        "name": design.name,
        "knee": design.geometry.knee.value,
        "load_frame": design.load.frame.value,
        "values": {key.path: design.value(key.parameter.path) for key in KEYS},
        "counterweights": counterweights_data(design),
    }
    return facts | ({"drives": _drives_data(design)} if any(design.drives) else {})


def changes_table(
    first: Design, second: Design, names: tuple[str, str] = ("Before", "After"), *,
    under: str = "", caption: str = "",
) -> Table:  # fmt: skip
    """Return in what two robots differ, by symbols; differences of their files are others.

    A number that is set in one and left open in the other differs as well, as the stroke that
    follows l_B10 until it is set; one that differs by rounding does not.

    Args:
        first, second: The robots.
        names: Headings of their columns.
        under: How the paths of what is compared begin; empty for all, with what is no number.
        caption: What the table shows.
    """
    found = [
        Row(
            (
                heading(item.symbol, item.unit), item.label, item.path,
                _shown(first, item), _shown(second, item),
                percent_change(first.value(item.path), second.value(item.path)),
            )
        )
        for item in PARAMETER.values()
        if item.path.startswith(under) and _differs(first, second, item.path)
    ]  # fmt: skip
    if not under:
        found += _other_changes(first, second)
    return Table(("Symbol", "What", "Key", *names, "Change"), tuple(found), caption, words=3)


def _differs(first: Design, second: Design, path: str) -> bool:
    one, other = first.stored(path), second.stored(path)
    if one is None or other is None:
        return one is not other
    return not math.isclose(one, other, rel_tol=_ROUNDING, abs_tol=1e-12)


def _shown(design: Design, item: Parameter) -> str:
    value = design.value(item.path)
    if math.isinf(value):
        return "rigid"
    text = number(value * item.display.factor, 6)
    follows = item.path == "geometry.guide_stroke" and design.stored(item.path) is None
    return f"{text} (l_B10)" if follows else text


def _other_changes(first: Design, second: Design) -> list[Row]:
    """Return what differs besides numbers: choices, counterweights by place, drives."""
    found = []
    for table, name in CHOICES:
        words = [choice(design, table, name).value for design in (first, second)]
        if words[0] != words[1]:
            found.append(Row((f"{table} {name}", CHOICE_MEANINGS[name], f"{table}.{name}", *words)))
    for place, (one, other) in _weights_by_place(first, second).items():
        if not math.isclose(one, other, rel_tol=_ROUNDING):
            texts = (number(one, 6), number(other, 6), percent_change(one, other))
            found.append(Row((f"on {place} [kg]", "counterweight", "", *texts)))
    for actuator, *drives in zip(ACTUATORS, first.drives, second.drives, strict=True):
        if drives[0] != drives[1]:
            found += _drive_rows(actuator, *drives)
    return found


def _weights_by_place(first: Design, second: Design) -> dict[str, list[float]]:
    """Return what two designs carry on each leg [kg], by its place; 0 where one has nothing."""
    masses = {w.place: [0.0, 0.0] for each in (first, second) for w in each.counterweights}
    for index, design in enumerate((first, second)):
        for weight in design.counterweights:
            masses[weight.place][index] += weight.mass
    return masses


def _drive_rows(actuator: str, first: Drive | None, second: Drive | None) -> list[Row]:
    """Return in what two drives differ by ratio, else by name, else by their values."""
    if first is None or second is None or first.gear_ratio != second.gear_ratio:
        cells = (
            "no drive" if drive is None else Cell(f"{drive.gear_ratio:g}:1", hint=drive.summary)
            for drive in (first, second)
        )
        return [Row((actuator, "drive", "", *cells))]
    if first.summary != second.summary:
        return [Row((actuator, "drive", "", first.summary, second.summary))]
    found = []
    for item in fields(Drive):
        facts, pair = item.metadata, [getattr(drive, item.name) for drive in (first, second)]
        if pair[0] == pair[1]:
            continue
        if not facts:
            what = DRIVE_MEANINGS[item.name]
            found.append(Row((f"{actuator} {item.name}", what, "", *map(_text, pair))))
            continue
        factor = display_unit(facts["unit"]).factor
        texts = [NONE if value is None else number(factor * value, 6) for value in pair]
        name = heading(f"{actuator} {facts['symbol']}", facts["unit"])
        found.append(Row((name, facts["label"], "", *texts, _change(*pair))))
    return found


def difference_blocks(first: Design, second: Design, names: tuple[str, str]) -> list[Block]:
    """Return in what the files of two designs differ, in SI units, with a name for each."""
    found = []
    for table, name, a, b, what in _changed(first, second):
        found.append((table, name, _text(a), _text(b), _change(a, b), what))
    for place, masses in _weights_by_place(first, second).items():
        if masses[0] != masses[1]:
            texts = (*map(_text, masses), _change(*masses))
            found.append(("counterweights", "mass_kg", *texts, place))
    for actuator, *pair in zip(ACTUATORS, first.drives, second.drives, strict=True):
        if pair[0] != pair[1]:
            texts = [NONE if drive is None else drive.summary for drive in pair]
            found.append((DRIVES, actuator, *texts, "", ""))
            found += _drive_changes(actuator, *pair)
    if not found:
        return [Note("the designs have the same values")]
    return [Table(("", "", *names, "Change", ""), rows(*found), words=6)]


def difference_data(first: Design, second: Design) -> dict[str, Any]:
    """Return the same for JSON."""
    facts: dict[str, Any] = {"first": first.name, "second": second.name}
    facts["differences"] = {
        f"{table}.{name}" if table else name: {"first": a, "second": b}
        for table, name, a, b, _ in _changed(first, second)
    }
    if first.counterweights != second.counterweights:
        pair = map(counterweights_data, (first, second))
        facts["counterweights"] = dict(zip(("first", "second"), pair, strict=True))
    if first.drives != second.drives:
        facts["drives"] = {"first": _drives_data(first), "second": _drives_data(second)}
    return facts


def _entries(first: Design, second: Design) -> list[Entry]:
    """Return table, key, both values and the meaning of everything that a design file holds."""
    found: list[Entry] = []
    for key in KEYS:
        parameter = key.parameter
        values = (first.value(parameter.path), second.value(parameter.path))
        found.append((key.table, key.name, *values, f"{parameter.symbol}, {parameter.label}"))
    for table, name in CHOICES:
        last = max(place for place, row in enumerate(found) if row[0] == table)
        words = [choice(design, table, name).value for design in (first, second)]
        found.insert(last + 1, (table, name, *words, CHOICE_MEANINGS[name]))
    return found


def _changed(first: Design, second: Design) -> list[Entry]:
    return [entry for entry in _entries(first, second) if entry[2] != entry[3]]


def _drive_changes(actuator: str, first: Drive | None, second: Drive | None) -> list[Cells]:
    """Return in which values two drives of an actuator differ; nothing where one is missing."""
    if first is None or second is None:
        return []
    found = []
    for name, meaning in DRIVE_MEANINGS.items():
        a, b = getattr(first, name), getattr(second, name)
        if a != b:
            place = (f"{DRIVES}.{actuator}", DRIVE_KEYS[name])
            found.append((*place, _text(a), _text(b), _change(a, b), meaning))
    return found


def _change(before: object, after: object) -> str:
    """Return a change as a percentage, nothing of what is no number."""
    if isinstance(before, float) and isinstance(after, float):
        return percent_change(before, after)
    return ""


def _text(value: float | str | Envelope | None) -> str:
    """Return a value of a design file in SI units, of a drive as well."""
    if value is None or value in ("", ()):
        return NONE
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return "; ".join(f"{speed:.10g} {torque:.10g}" for speed, torque in value)
    return f"{value:.10g}" if math.isfinite(value) else "rigid"


def counterweights_data(design: Design) -> list[dict[str, Any]]:
    """Return the counterweights by the keys of a design file, for JSON."""
    return [
        {key: getattr(weight, name) for name, key in COUNTERWEIGHT_KEYS.items()}
        for weight in design.counterweights
    ]


def _drives_data(design: Design) -> dict[str, dict[str, Any]]:
    """Return the drives by actuator and by the keys of a design file, for JSON."""
    return {
        actuator: {DRIVE_KEYS[name]: value for name, value in vars(drive).items()}
        for actuator, drive in _drives(design).items()
    }


def _drives(design: Design) -> dict[str, Drive]:
    """Return the drives by actuator."""
    pairs = zip(ACTUATORS, design.drives, strict=True)
    return {name: drive for name, drive in pairs if drive is not None}
