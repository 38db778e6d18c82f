"""The texts of the balance: its status, what changed, its effects, its certificate."""

from __future__ import annotations

import math
import re
from html import escape
from itertools import groupby
from operator import attrgetter

from markupsafe import Markup

from paminsa_viz.balancing import ActiveConstraint, InfeasibleBounds
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.balance.actions import FRONT, OPTIMUM, SENSITIVITY
from paminsa_viz.explorer.kit.robot_texts import weights_by_place
from paminsa_viz.explorer.kit.text import render, status
from paminsa_viz.explorer.state.balance import (
    Balanced,
    BalanceKind,
    BalanceOutcome,
    Effect,
    Goal,
    WeightClearance,
)
from paminsa_viz.kept import kept
from paminsa_viz.model import PARAMETER, Design, PaminsaError, static_imbalance
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.units import number, percent_change, symbol_html, symbols_html, unit_text

BALANCED = 1e-9
"""Largest |M_p2| that counts as balanced [N]."""

MAX_BOUNDS = 6
"""Most active bounds that are listed."""

NOTABLE = 0.005
"""Share by which an actuator's load may grow without being pointed out."""

_SIDES = {"low": "≥", "high": "≤", "nearest": "lever ≥", "farthest": "lever ≤", "limit": "≤"}


def status_html(frame: Frame) -> str:
    """Return what came of the last optimization, in a line or two."""
    state, outcome = frame.state, frame.state.balance.outcome
    if OPTIMUM.runs(state):
        return status("balance-status", "plain", "Optimizing …")
    if outcome is None:
        return render("balance/intro.j2")
    if outcome.error is not None:
        return problem_html(outcome.error)
    headline = _headline(outcome, state.document.design)
    return status("balance-status", *headline, OPTIMUM.stale_text(state))


def problem_html(problem: PaminsaError, testid: str = "balance-status") -> str:
    """Return why there is no result, and which bounds to move."""
    if not isinstance(problem, InfeasibleBounds):
        return status(testid, "bad", "Not possible", str(problem))
    return render(
        "balance/infeasible.j2", testid=testid, limits=problem.limits, relax=problem.relax,
        variable=variable_html,
    )  # fmt: skip


def _headline(outcome: BalanceOutcome, current: Design) -> tuple[str, ...]:
    """Return level, title and a line of a result."""
    found, before, goal = outcome.result, outcome.job.design, _goal(outcome)
    if found is None:
        return "plain", ""
    left = static_imbalance(found.after)
    level, head, rest = "ok", f"Least {goal.value}", ""
    if abs(left) <= BALANCED:
        head = "Statically balanced"
        rest = Markup("in every pose, on both branches of the knee (<i>M</i><sub>p2</sub> = 0)")
    elif goal.static:
        level, head = "warn", f"As near to balance as the bounds allow: {number(left)} N"
        rest = "what keeps it from zero is listed below"
    if found.after == before:
        return level, head, "the design is optimal already; nothing was changed"
    if found.after == current:
        price = price_text(found)
        return level, head, rest, f"The price: {price}" if price else ""
    again = current == before
    rest = "the one before is shown again" if again else "it has been changed since"
    return "plain", "Not the design that is shown", rest


def _goal(outcome: BalanceOutcome) -> Goal:
    return Goal.ADDED if outcome.job.task is BalanceKind.PAPER else outcome.job.settings.goal


def variable_html(name: str) -> Markup:
    """Return what may change, or is limited: its symbol, its name, or where a counterweight is."""
    if name in PARAMETER:
        return Markup(symbol_html(PARAMETER[name].symbol))
    head, _, rest = name.partition(".")
    if head == "counterweights":
        return Markup(f"counterweight {int(rest.partition('.')[0]) + 1}")
    name = name.replace("M1-M3", "M1–M3").replace(" on the trajectory", "")
    name = re.sub(r"counterweight on (B\d) from joint (\d)", r"weight on \1 past \2", name)
    return Markup(symbols_html(name))


@kept(4)
def details_html(outcome: BalanceOutcome | None) -> str:
    """Return what was changed, what that does, and the certificate; empty without a result."""
    found = None if outcome is None else outcome.result
    if outcome is None or found is None:
        return ""
    optimum, goal = found.optimum, _goal(outcome)
    unit = "" if goal is Goal.BOTH else unit_text(optimum.values[-1 if goal.static else 0].unit)
    near = goal.static and abs(static_imbalance(found.after)) > BALANCED
    return render(
        "balance/result.j2", job=outcome.job, optimum=optimum, degrees=math.degrees, unit=unit,
        groups=[(name, list(rows)) for name, rows in groupby(found.effects, attrgetter("group"))],
        grown=grown, change=lambda effect: percent_change(effect.before, effect.after),
        goal=_goal_text(goal), changes=_changes(outcome.job.design, found.after),
        bounds=[item for item in optimum.active if _relaxable(item)][:MAX_BOUNDS],
        worth="N" if near else unit, variable=variable_html, sides=_SIDES,
        hit=Markup(weights_html(found.weights)),
    )  # fmt: skip


def weights_html(found: WeightClearance | None) -> str:
    """Return whether the counterweights hit another body; empty without counterweights."""
    if found is None:
        return ""
    one, other = found.names
    x, y, theta, z = found.pose
    at = [number(round(1e3 * value), 6) for value in (x, y, z)]
    place = f"x = {at[0]}, y = {at[1]}, z = {at[2]} mm, θ = {number(math.degrees(theta), 3)}°"
    if found.distance < 0:
        level, title = "bad", "A counterweight hits another body"
        lines = [
            f"{one} and {other} overlap by {1e3 * -found.distance:.1f} mm at {place}",
            f"in {100 * found.touching:.0f} % of {found.poses} poses; give it a shorter lever, "
            "or leave it out",
        ]
    else:
        level, title = "ok", f"Counterweights are clear by {1e3 * found.distance:.1f} mm"
        lines = [f"nearest: {one} and {other}, at {place}; {found.poses} poses checked"]
    return status("weight-clearance", level, title, *lines)


def grown(effect: Effect) -> bool:
    """Whether an actuator has to give more than before, by more than `NOTABLE`."""
    return bool(effect.group) and effect.after > (1 + NOTABLE) * effect.before + 1e-9


def price_text(found: Balanced) -> str:
    """Return which actuators have to give more than before, and by how much; empty for none."""
    parts: dict[str, list[str]] = {}
    for effect in found.effects:
        if grown(effect) and not effect.group.startswith("RMS"):
            change = percent_change(effect.before, effect.after)
            parts.setdefault(effect.label, []).append(f"{effect.group} {change}")
    return "; ".join(f"{name}: {', '.join(texts)}" for name, texts in parts.items())


def _goal_text(goal: Goal) -> str:
    known = {
        Goal.ADDED: "added mass",
        Goal.MOVED: "mass moved",
        Goal.BOTH: "weighted sum, relative to before,",
    }
    return known.get(goal, goal.value.partition(",")[0])


def _changes(before: Design, after: Design) -> list[tuple[str | Markup, float, float]]:
    """Return the masses that differ, those of counterweights by their places: name, old, new."""
    rows: list[tuple[str | Markup, float, float]] = []
    for path in MASS_PATHS:
        known = PARAMETER[path]
        symbol = f'<span title="{escape(known.label)}">{symbol_html(known.symbol)}</span>'
        name = Markup(f"{symbol} [{unit_text(known.unit)}]")
        rows.append((name, before.value(path), after.value(path)))
    places = weights_by_place(before, after).items()
    rows += [(f"on {place} [kg]", old, new) for place, (old, new) in places]
    return [row for row in rows if not math.isclose(*row[1:], rel_tol=1e-9, abs_tol=1e-12)]


def _relaxable(item: ActiveConstraint) -> bool:
    """Whether a bound costs something, and is not that masses and levers are at least zero."""
    return item.price > 1e-9 and not (item.side in ("low", "nearest") and item.bound == 0)


def front_html(frame: Frame) -> str:
    """Return what the Pareto front is, or why there is none."""
    balance = frame.state.balance
    if balance.front is not None and balance.front.error is not None:
        return problem_html(balance.front.error, "front")
    return render(
        "balance/front.j2", count=len(balance.points), stale=FRONT.stale_text(frame.state)
    )


def sensitivity_html(frame: Frame) -> str:
    """Return what the tornado chart is of, or that it is being computed, or why there is none."""
    balance = frame.state.balance
    outcome = balance.tornado
    if SENSITIVITY.runs(frame.state):
        return status("tornado", "plain", "Computing …")
    if outcome is not None and outcome.error is not None:
        return problem_html(outcome.error, "tornado")
    return render(
        "balance/sensitivity.j2", outcome=outcome, output=balance.output,
        stale=SENSITIVITY.stale_text(frame.state),
    )  # fmt: skip
