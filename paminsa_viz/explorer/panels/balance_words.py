"""What the page says of a balance: what changed, what it does, the proof that it is the best."""

from __future__ import annotations

import math
import re
from html import escape

import numpy as np

from paminsa_viz.balancing import ActiveConstraint, InfeasibleBounds, Optimum
from paminsa_viz.explorer.balancing.jobs import Outcome, Task
from paminsa_viz.explorer.balancing.settings import Goal
from paminsa_viz.explorer.panels.tables import FONT, dot, note, table
from paminsa_viz.explorer.state import State
from paminsa_viz.model import PARAMETER, Design, PaminsaError, static_imbalance
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.palette import BAD, MUTED, OK, WARN
from paminsa_viz.units import number, symbol_html, symbols_html, unit_text

BALANCED = 1e-9
"""Largest |M_p2| that counts as balanced [N]."""

_SIDES = {
    "low": "≥",
    "high": "≤",
    "nearest": "lever ≥",
    "farthest": "lever ≤",
    "limit": "≤",
}

_MOST_BOUNDS = 6


def status_html(state: State) -> str:
    """Say what came of the last task, in a line or two."""
    balancing = state.balancing
    running = balancing.running
    if running is not None and running.task in (Task.PAPER, Task.BEST):
        return block(MUTED, "Looking for the best masses …")
    outcome = balancing.outcome
    if outcome is None:
        return note(
            "Static torques of M1–M3 are <i>M</i><sub>p2</sub> times a map of the geometry: with "
            "<i>M</i><sub>p2</sub> = 0 gravity asks nothing of them, in every pose. One click "
            "finds the masses that do it with the least added mass; the design before is pinned "
            "as reference, and undo brings it back.",
            "balance-status",
            muted=True,
        )
    if outcome.problem is not None:
        return problem_html(outcome.problem)
    return "" if outcome.after is None else _headline(state, outcome, outcome.after)


def details_html(outcome: Outcome | None) -> str:
    """Return what was changed, what that does, and the proof; empty without a result."""
    if outcome is None or outcome.optimum is None or outcome.after is None:
        return ""
    parts = (
        _effects(outcome),
        _changes(outcome.job.design, outcome.after),
        _proof(outcome, outcome.optimum),
    )
    return f'<div data-testid="balance-result">{"".join(map(note, parts))}</div>'


def block(color: str, text: str, name: str = "balance-status") -> str:
    """Return a colored block with a text."""
    return (
        f'<div data-testid="{name}" style="border-left:5px solid {color};padding:4px 9px;'
        f"margin:2px 10px 8px 10px;background:{color}18;border-radius:4px;font-size:12.5px;"
        f'line-height:1.35">{text}</div>'
    )


def problem_html(problem: PaminsaError) -> str:
    """Say why there are no such masses, and which bounds to move."""
    if not isinstance(problem, InfeasibleBounds):
        return block(BAD, f"<b>Not possible</b><br>{escape(str(problem))}")
    asked = [
        f"{carrier(item.label)} of at most {number(item.limit, 4)} {unit_text(item.unit)} is asked "
        f"for; the least is {number(item.attainable, 4)} {unit_text(item.unit)}"
        for item in problem.limits
    ]
    remedy = [
        f"<b>{'raise' if item.side == 'high' else 'lower'}</b> {carrier(item.name)} "
        f"from {number(item.bound, 4)} to {number(item.needed, 4)} kg"
        for item in problem.relax
    ] or ["no other bounds on these masses would help: let others change"]
    lines = [*asked, "What would do:", *remedy]
    return block(BAD, "<b>The bounds do not allow it</b><br>" + "<br>".join(lines))


def carrier(name: str) -> str:
    """Return what may change, or is limited: its symbol, its words, or where a weight hangs."""
    if name in PARAMETER:
        return symbol_html(PARAMETER[name].symbol)
    head, _, rest = name.partition(".")
    if head == "counterweights":
        return f"counterweight {int(rest.partition('.')[0]) + 1}"
    name = name.replace("M1-M3", "M1–M3").replace(" on the trajectory", "")
    name = re.sub(r"counterweight on (B\d) from joint (\d)", r"weight on \1 past \2", name)
    return symbols_html(name)


def _headline(state: State, outcome: Outcome, after: Design) -> str:
    left = static_imbalance(after)
    paper = outcome.job.task is Task.PAPER
    goal = Goal.ADDED if paper else outcome.job.settings.goal
    color = OK
    if abs(left) <= BALANCED:
        head = "Balanced: gravity asks nothing of M1–M3"
        rest = "in every pose, on both branches of the knee (<i>M</i><sub>p2</sub> = 0)"
    elif goal.static:
        color = WARN
        head = f"As near to balance as the bounds allow: {number(left, 4)} N"
        rest = "what keeps it from zero stands below"
    else:
        head, rest = f"Least {escape(goal.value)}", ""
    present = state.document.design
    if after == outcome.job.design:
        rest = "the design is the best already; nothing was changed"
    elif after != present:
        color, head = MUTED, "Not the design that is shown"
        again = present == outcome.job.design
        rest = "the one before is shown again" if again else "it has been changed since"
    return block(color, f"<b>{head}</b><br>{rest}")


def _effects(outcome: Outcome) -> str:
    rows = []
    for item in outcome.effects:
        label = symbols_html(item.label)
        cells = [_number(value) for value in (item.before, item.after, item.after - item.before)]
        unit = unit_text(item.unit)
        rows.append([f"{label} [{unit}]", cells[0], f"<b>{cells[1]}</b>", cells[2]])
    theta, z = np.degrees(outcome.job.theta), 1e3 * outcome.job.z
    where = (
        f'<div style="color:{MUTED};padding-top:2px">standing: at all x, y with '
        f"θ = {number(round(theta, 2))}°, z = {number(round(z, 1))} mm that are in reach and not "
        f"near a singularity</div>"
    )
    return table(["of M1–M3", "before", "after", "Δ"], rows) + where


def _number(value: float) -> str:
    if not np.isfinite(value):
        return "–"
    return "0" if abs(value) < 1e-9 else number(value, 4)


def _changes(before: Design, after: Design) -> str:
    rows = []
    for path in MASS_PATHS:
        old, new = before.value(path), after.value(path)
        if differs(old, new):
            known = PARAMETER[path]
            name = f'<span title="{escape(known.label)}">{symbol_html(known.symbol)}</span>'
            rows.append([f"{name} [{unit_text(known.unit)}]", *_row(old, new)])
    for place, (old, new) in _weights(before, after).items():
        if differs(old, new):
            rows.append([f"on {escape(place)} [kg]", *_row(old, new)])
    if not rows:
        return f'<span style="color:{MUTED}">No mass is changed.</span>'
    return table(["changed, of each leg", "before", "after", "Δ"], rows)


def differs(old: float, new: float) -> bool:
    """Whether two masses or inertias differ by more than rounding."""
    return not math.isclose(old, new, rel_tol=1e-9, abs_tol=1e-12)


def _row(old: float, new: float) -> list[str]:
    sign = "+" if new > old else ""
    return [number(old, 4), f"<b>{number(new, 4)}</b>", sign + number(new - old, 4)]


def _weights(before: Design, after: Design) -> dict[str, tuple[float, float]]:
    """Return the mass of the counterweights at each place, before and after."""
    found: dict[str, tuple[float, float]] = {}
    for index, design in enumerate((before, after)):
        for weight in design.counterweights:
            old, new = found.get(weight.place, (0.0, 0.0))
            more = weight.mass
            found[weight.place] = (old + more, new) if index == 0 else (old, new + more)
    return found


def _proof(outcome: Outcome, optimum: Optimum) -> str:
    goal = Goal.ADDED if outcome.job.task is Task.PAPER else outcome.job.settings.goal
    unit = "" if goal is Goal.BOTH else unit_text(optimum.values[-1 if goal.static else 0].unit)
    what = {
        Goal.ADDED: "added mass",
        Goal.MOVED: "mass moved",
        Goal.BOTH: "weighted sum, relative to before,",
    }.get(goal, goal.value.partition(",")[0])
    bound, reached = (
        f"{number(value, 6)} {unit}".rstrip() for value in (optimum.lower_bound, optimum.objective)
    )
    text = (
        f'<div style="{FONT};padding-bottom:4px">{dot(OK)}<b>Proved</b> by duality: within the '
        f"bounds no {what} is below {bound}; this is {reached} (gap {number(optimum.gap, 2)}), "
        f"found in {1e3 * optimum.seconds:.0f} ms.</div>"
    )
    near = goal.static and abs(static_imbalance(outcome.after or optimum.after)) > BALANCED
    worth = "N" if near else unit
    active = [item for item in optimum.active if _relaxable(item)][:_MOST_BOUNDS]
    if not active:
        return text
    rows = [[f"{carrier(item.name)} {_SIDES[item.side]}", *_bound(item, worth)] for item in active]
    return text + table(["bounds reached", "", "moving it saves"], rows)


def _relaxable(item: ActiveConstraint) -> bool:
    """Whether a bound costs something, and is not that masses and levers have no less than none."""
    return item.price > 1e-9 and not (item.side in ("low", "nearest") and item.bound == 0)


def _bound(item: ActiveConstraint, worth: str) -> list[str]:
    """Return a bound, and what its movement saves."""
    if item.unit == "m":
        saves = f"{number(item.price / 100, 3)} {worth} / 10 mm"
        return [f"{number(1e3 * item.bound, 4)} mm", saves]
    unit = unit_text(item.unit)
    return [f"{number(item.bound, 4)} {unit}", f"{number(item.price, 3)} {worth} / {unit}"]
