"""Static balance: M_p2 body by body, and the effect of the paper's balance."""

from __future__ import annotations

from typing import Any

from paminsa_viz.balancing import Optimum, balance, whole_mass
from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.kinds import (
    Block,
    Note,
    Row,
    Table,
    actuator_rows,
    series_figure,
)
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.design_writer import differences
from paminsa_viz.meshes.loads import clearance_text
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.statics import imbalance_parts, static_imbalance
from paminsa_viz.trajectory import TrajectoryAnalysis, analyze
from paminsa_viz.units import format_value, number, percent_change, unit_text

MP2 = 1
"""Place of M_p2 among the lumped coefficients."""

BALANCED = 1e-9
"""|M_p2| below which a design counts as balanced [N]."""


def balance_blocks(analysis: TrajectoryAnalysis) -> list[Block]:
    """Return M_p2 body by body, and the paper's balance, compared on the motion."""
    design = analysis.design
    blocks: list[Block] = [
        Note(
            "The static torques of M1 to M3 are M_p2 times a map of the geometry (Eqs. 5 and 8): "
            "with M_p2 = 0 they carry no weight, anywhere, on either branch of the knee."
        ),
        _contributions(design),
    ]
    if abs(static_imbalance(design)) < BALANCED:
        blocks.append(Note("The design is balanced: M1 to M3 carry no weight.", "ok"))
    else:
        blocks += _balanced(analysis)
    return blocks


def contributions(design: Design) -> list[tuple[str, str, float]]:
    """Return what each body adds to M_p2 [N], with its symbol and name; they add up to it."""
    parts = imbalance_parts(design)
    found = [
        (PARAMETER[path].symbol, PARAMETER[path].label, parts[path])
        for path in MASS_PATHS
        if parts[path] != 0
    ]
    for place, weight in enumerate(design.counterweights):
        part = parts[f"counterweights.{place}.mass"]
        found.append(("m_c", f"counterweight on {weight.place}", part))
    return found


def _contributions(design: Design) -> Table:
    rows = [
        Row((symbol, label, format_value(share, "N")))
        for symbol, label, share in contributions(design)
    ]
    rows.append(Row(("M_p2", "all together", format_value(static_imbalance(design), "N")), "total"))
    head = ("Symbol", "Body", "Part of M_p2")
    return Table(head, tuple(rows), "M_p2, body by body.", words=2)


def _balanced(analysis: TrajectoryAnalysis) -> list[Block]:
    """Return the changes by the paper's balance, and their effect on the motion."""
    try:
        optimum = balance(analysis.design)
    except PaminsaError as error:
        return [Note(f"No balance was found: {error}.", "warn")]
    before, after = optimum.before, optimum.after
    left = static_imbalance(after)
    if reached := abs(left) < BALANCED:
        left = 0.0
    rows = [
        Row(
            (
                key.parameter.symbol, key.parameter.label,
                format_value(a, "kg"), format_value(b, "kg"), percent_change(a, b),
            ),
            "marked",
        )
        for key, a, b in differences(before, after)
    ]  # fmt: skip
    old, new = whole_mass(before), whole_mass(after)
    whole = (format_value(old, "kg"), format_value(new, "kg"), percent_change(old, new))
    rows.append(Row(("", "all that moves: three legs and the platform", *whole)))
    rows.append(
        Row(
            ("M_p2", "", format_value(static_imbalance(before), "N"), format_value(left, "N")),
            "total",
        )
    )
    caption = (
        "The paper’s balance with the least added mass, by changing masses that M_p2 contains."
        if reached
        else "Within these bounds M_p2 cannot become zero; this comes nearest."
    )
    table = Table(("Symbol", "Mass", "Before", "After", "Change"), tuple(rows), caption, words=2)
    blocks: list[Block] = [table]
    lighter = analyze(after, analysis.trajectory, keep=analysis.solved)
    if analysis.summary and lighter.summary:
        blocks.append(_on_the_motion(analysis, lighter))
        title, alt = "Balanced design, and the design before (dashed)", "torques over time"
        blocks.append(
            series_figure("torques", lighter, f"{title}: {alt}.", reference=analysis, title=title)
        )
    return blocks


def _on_the_motion(before: TrajectoryAnalysis, after: TrajectoryAnalysis) -> Table:
    rows = []
    each = zip(ACTUATORS, TORQUE_UNITS, before.summary, after.summary, strict=True)
    for name, unit, a, b in each:
        cells = [name]
        for one, two in ((abs(a.peak), abs(b.peak)), (a.rms, b.rms)):
            cells += [format_value(one, unit), format_value(two, unit), percent_change(one, two)]
        rows.append(cells)
    head = ("", "Peak before", "After", "Change", "RMS before", "After", "Change")
    worse = any(abs(b.rms) > abs(a.rms) for a, b in zip(before.summary, after.summary, strict=True))
    caption = "The trajectory, before and after."
    if worse:
        caption += " Balance adds inertia, so that a fast motion may need more torque."
    return Table(head, actuator_rows(*rows), caption)


def optimum_blocks(found: Optimum) -> list[Block]:
    """Return goals and limits, the masses that change, active bounds, and the certificate."""
    goals = tuple(
        Row(
            (
                value.label
                + ("" if value.limit is None else f", at most {number(value.limit, 6)}"),
                *(_tidy(each) for each in (value.before, value.after)), unit_text(value.unit),
            )
        )
        for value in found.values
    )  # fmt: skip
    head = ("", "Before", "After", "Unit")
    blocks: list[Block] = [Table(head, goals, literal=True)]
    if changes := _changes(found):
        head = ("Of each leg", "Before", "After", "Change", "Unit")
        blocks.append(Table(head, changes, literal=True))
    else:
        blocks.append(Note("No mass changes."))
    if costly := [item for item in found.active if item.price > 0]:
        bounds = tuple(
            Row((item.name, item.side, f"{number(item.bound, 6)} {item.unit}", number(item.price)))
            for item in costly
        )
        caption = "Bounds that are reached, and what one unit more of room would save."
        blocks.append(Table(("Bound", "Side", "At", "Saves"), bounds, caption, 2, literal=True))
    blocks += [
        Note(f"{weight.place}: {clearance_text(found.after.geometry, weight)}")
        for weight in found.after.counterweights
    ]
    bound, reached = (number(value, 10) for value in (found.lower_bound, found.objective))
    certificate = f"No masses within the bounds do better than {bound}; these reach {reached}."
    return [*blocks, Note(certificate, "ok")]


def changed_masses(found: Optimum) -> list[tuple[str, float, float]]:
    """Return paths of masses and inertias that differ, with their values before and after."""
    held = range(len(found.before.counterweights))
    paths = [*MASS_PATHS, *(f"counterweights.{place}.mass" for place in held)]
    pairs = [(path, found.before.value(path), found.after.value(path)) for path in paths]
    return [item for item in pairs if item[1] != item[2]]


def _changes(found: Optimum) -> tuple[Row, ...]:
    rows = []
    for path, before, after in changed_masses(found):
        unit = PARAMETER[path].unit if path in PARAMETER else "kg"
        change = number(after - before, 6, sign=True)
        rows.append(Row((path, _tidy(before), _tidy(after), change, unit_text(unit))))
    for weight in found.after.counterweights[len(found.before.counterweights) :]:
        mass = number(weight.mass, 6)
        rows.append(Row((weight.place, "", mass, f"+{mass}", "kg")))
    return tuple(rows)


def _tidy(value: float) -> str:
    return number(0.0 if abs(value) <= 1e-12 else value, 6)


def optimum_data(found: Optimum) -> dict[str, Any]:
    """Return goals, changes, active bounds and the certificate, for JSON."""
    after = found.after
    return {
        "values": found.values,
        "changes": {path: {"before": a, "after": b} for path, a, b in changed_masses(found)},
        "counterweights": [
            vars(weight) | {"room": clearance_text(after.geometry, weight)}
            for weight in after.counterweights
        ],
        "active_bounds": found.active,
        **record(found, "objective", "lower_bound", "gap", "seconds"),
    }
