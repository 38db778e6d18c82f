"""Static balance: M_p2 body by body, and the effect of the paper's balance."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from paminsa_viz.balancing import Optimum, TermValue, balance, whole_mass
from paminsa_viz.balancing.effects import IN_MOTION, Effect, effects, sizes_in_motion
from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.design import changes_table, counterweights_data
from paminsa_viz.blocks.kinds import (
    Block,
    Cell,
    Fact,
    Note,
    Row,
    Table,
    heading,
    rows,
    series_figure,
)
from paminsa_viz.dimensions.attached import disc_radius
from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.design import PARAMETER, Design, Geometry, KneeBranch
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.leg_points import counterweight_clearance
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.statics import imbalance_parts, shown_imbalance, static_imbalance
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.trajectory import TrajectoryAnalysis, analyze
from paminsa_viz.units import (
    MM,
    display_unit,
    fixed,
    format_value,
    number,
    percent_change,
    unit_text,
)

MP2 = 1
"""Place of M_p2 among the lumped coefficients."""

BALANCED = 1e-9
"""|M_p2| below which a design counts as balanced [N]."""

NOTABLE = 0.005
"""Share by which an actuator's load may grow without being pointed out."""

LEAST_PRICE = 1e-9
"""What a bound costs at least that is named, a unit of its own."""

RULE = (
    "The static torques of M1 to M3 are M_p2 times a map of the geometry (Eqs. 5 and 8): with "
    "M_p2 = 0 they carry no weight, anywhere, on either branch of the knee."
)
"""What static balance is."""


def mass_facts(design: Design) -> list[Fact]:
    """Return how heavy a robot is, and how far from balance."""
    return [
        Fact("Moving mass", format_value(whole_mass(design), "kg"), "legs, platform, payload"),
        Fact("M_p2", format_value(shown_imbalance(design), "N", 3), "0 is static balance"),
    ]


def balance_blocks(analysis: TrajectoryAnalysis) -> list[Block]:
    """Return M_p2 body by body, and the paper's balance, compared on the motion."""
    design = analysis.design
    blocks: list[Block] = [Note(RULE), _contributions(design)]
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
    rows.append(Row(("M_p2", "all together", format_value(shown_imbalance(design), "N")), "total"))
    head = ("Symbol", "Body", "Part of M_p2")
    return Table(head, tuple(rows), "M_p2, body by body.", words=2)


def _balanced(analysis: TrajectoryAnalysis) -> list[Block]:
    """Return the changes by the paper's balance, and their effect on the motion."""
    try:
        optimum = balance(analysis.design)
    except PaminsaError as error:
        return [Note(f"No balance was found: {error}.", "warn")]
    before, after = optimum.before, optimum.after
    caption = (
        "The paper’s balance with the least added mass, by changing masses that M_p2 contains."
        if abs(static_imbalance(after)) < BALANCED
        else "Within these bounds M_p2 cannot become zero; this comes nearest."
    )
    blocks: list[Block] = [changes_table(before, after, caption=caption)]
    solved = analysis.solved
    lighter = analyze(after, solved.trajectory, clearance=solved.clearance, keep=solved)
    sizes = zip(*map(sizes_in_motion, (analysis, lighter)), strict=True)
    found = effects(before, after, dict(zip(IN_MOTION, sizes, strict=True)))
    blocks.append(effects_table(found))
    if analysis.summary and lighter.summary:
        title, alt = "Balanced design, and the design before (dashed)", "torques over time"
        blocks.append(
            series_figure("torques", lighter, f"{title}: {alt}.", reference=analysis, title=title)
        )
    return blocks


def effects_table(found: Sequence[Effect]) -> Table:
    """Return what a change of masses does, an actuator that has to give more in red."""
    cells, group = [], ""
    for item in found:
        if item.group != group:
            group = item.group
            cells.append(Row((group,), "group"))
        change = Cell(
            percent_change(item.before, item.after), kind="bad" if grown(item) else "plain"
        )
        name, unit = heading(item.label, item.unit), display_unit(item.unit)
        color = ACTUATOR_COLORS[ACTUATORS.index(item.label)] if item.group else ""
        values = (_tidy(value * unit.factor, 4, padded=True) for value in (item.before, item.after))
        cells.append(Row((name, *values, change), color=color))
    caption = "What the masses change."
    if any(grown(item) for item in found if item.group in IN_MOTION):
        caption += " Balance adds inertia, so that a fast motion may need more torque."
    return Table(("", "Before", "After", "Change"), tuple(cells), caption)


def grown(effect: Effect) -> bool:
    """Whether an actuator has to give more than before, by more than `NOTABLE`."""
    return bool(effect.group) and effect.after > (1 + NOTABLE) * effect.before + 1e-9


def optimum_blocks(found: Optimum) -> list[Block]:
    """Return goals and limits, the masses that change, active bounds, and the certificate."""
    goals = tuple(
        Row(
            (
                value.label
                + ("" if value.limit is None else f", at most {number(value.limit, 6)}"),
                *(_tidy(each, 6) for each in (value.before, value.after)), unit_text(value.unit),
            )
        )
        for value in found.values
    )  # fmt: skip
    blocks: list[Block] = [
        Table(("", "Before", "After", "Unit"), goals),
        masses_block(found.before, found.after),
    ]
    if (bounds := bounds_table(found)).rows:
        blocks.append(bounds)
    blocks += [
        Note(f"{weight.place}: {room_text(found.after.geometry, weight)}")
        for weight in found.after.counterweights
    ]
    return [*blocks, certificate_note(found)]


def masses_block(before: Design, after: Design) -> Table | Note:
    """Return the masses and inertias that change, or that none does."""
    table = changes_table(before, after, caption="What changes, of each leg.")
    return table if table.rows else Note("No mass changes.", "muted")


def bounds_table(found: Optimum) -> Table:
    """Return the bounds that are reached, and what one unit more of room would save.

    Left out are those that cost nothing, and that masses and levers are at least zero.
    """
    goal, left = _minimized(found), static_imbalance(found.after)
    worth = "" if goal is None else unit_text(goal.unit)
    if found.values[0].label == "M_p2" and abs(left) > BALANCED:
        worth = "N"  # the bounds keep M_p2 from zero: see `paper_balance.balance`
    cells = []
    for item in found.active:
        if item.price <= LEAST_PRICE or (item.side in ("low", "nearest") and item.bound == 0):
            continue
        step, text = (0.01, "10 mm") if item.unit == "m" else (1.0, unit_text(item.unit))
        saved = f"{number(item.price * step, 3)} {worth}".rstrip()
        name, at = bound_name(item.name), format_value(item.bound, item.unit, 6)
        cells.append((name, item.name, _SIDES[item.side], at, f"{saved} / {text}"))
    caption = "Bounds that are reached, and what one unit more of room would save."
    return Table(("Bound", "Key", "", "At", "Saves"), rows(*cells), caption, words=3)


_SIDES = {"low": "≥", "high": "≤", "nearest": "lever ≥", "farthest": "lever ≤", "limit": "≤"}


def bound_name(name: str) -> str:
    """Return what may change, or is limited: its symbol, its name, or where a counterweight is."""
    if name in PARAMETER:
        return PARAMETER[name].symbol
    head, _, rest = name.partition(".")
    if head == "counterweights":
        return f"counterweight {int(rest.partition('.')[0]) + 1}"
    name = name.replace("M1-M3", "M1–M3").replace(" on the trajectory", "")
    return re.sub(r"counterweight on (B\d) from joint (\d)", r"weight on \1 past \2", name)


def certificate_note(found: Optimum) -> Note:
    """Return that no masses are better, and by how much they could be."""
    goal = _minimized(found)
    what, unit = ("weighted sum", "") if goal is None else (goal.label, unit_text(goal.unit))
    low, reached = (
        f"{number(end, 6)} {unit}".rstrip() for end in (found.lower_bound, found.objective)
    )
    text = f"within the bounds no {what} is below {low}; this is {reached}"
    return Note(f"Certified optimal (duality gap {number(found.gap, 2)}): {text}.", "ok")


def _minimized(found: Optimum) -> TermValue | None:
    """Return the term that is least, None for a sum of several."""
    goal = [value for value in found.values if value.limit is None][-1]
    return goal if math.isclose(goal.after, found.objective, rel_tol=1e-6, abs_tol=1e-9) else None


def changed_masses(found: Optimum) -> list[tuple[str, float, float]]:
    """Return paths of masses and inertias that differ, with their values before and after."""
    held = range(len(found.before.counterweights))
    paths = [*MASS_PATHS, *(f"counterweights.{place}.mass" for place in held)]
    pairs = [(path, found.before.value(path), found.after.value(path)) for path in paths]
    return [item for item in pairs if item[1] != item[2]]


def _tidy(value: float, digits: int, *, padded: bool = False) -> str:
    return number(0.0 if abs(value) <= 1e-9 else value, digits, padded=padded)


def optimum_data(found: Optimum) -> dict[str, Any]:
    """Return goals, changes, active bounds and the certificate, for JSON."""
    after = found.after
    return {
        **robot(found.before),
        "values": found.values,
        "changes": {path: {"before": a, "after": b} for path, a, b in changed_masses(found)},
        "counterweights": [
            data | {"room": room_text(after.geometry, weight)}
            for data, weight in zip(counterweights_data(after), after.counterweights, strict=True)
        ],
        "active_bounds": found.active,
        **record(found, "objective", "lower_bound", "gap", "seconds"),
    }


def room_text(geometry: Geometry, weight: Counterweight) -> str:
    """Return a text on the clearance of a counterweight as a disc of steel.

    See `counterweight_clearance`; the text holds in every pose.
    """
    radius = disc_radius(weight.mass, geometry.body_scale)
    room = counterweight_clearance(geometry, weight, radius)
    if room is None:
        return "The robot can take no pose."
    extent = (
        f"A steel disc of {_mm(radius)} radius there reaches at most {_mm(room.inward)} inward and "
        f"{_mm(room.outward)} outward of its leg axis, {_mm(-room.low)} below and "
        f"{_mm(room.high)} above the guides."
    )
    meet = "can meet neither the platform nor the robot’s axis, where M4 is"
    if room.clear_depth == 0:
        return f"{extent} It {meet}."
    if not np.isfinite(room.clear_depth):
        return f"{extent} It may run into the platform, or M4, at any height."
    z = -geometry.knee.sign * room.clear_depth - geometry.platform_joint_height
    side, bound = ("below", np.floor) if geometry.knee is KneeBranch.LOWER else ("above", np.ceil)
    return f"{extent} It {meet}, while the platform is {side} z = {_mm(z, bound)}."


def _mm(length: float, rounded: Callable[[float], float] = np.ceil) -> str:
    """Return a length in whole mm, rounded to the safe side."""
    return f"{fixed(rounded(round(MM * length, 6)), 0)} mm"
