"""The texts of the balance: its status, what changed, its effects, its certificate."""

from __future__ import annotations

from dataclasses import replace

from markupsafe import Markup

from paminsa_viz.balancing import InfeasibleBounds
from paminsa_viz.blocks.balance import (
    BALANCED,
    RULE,
    bound_name,
    bounds_table,
    certificate_note,
    effects_table,
    grown,
    masses_block,
)
from paminsa_viz.blocks.kinds import Table
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.balance.actions import FRONT, OPTIMUM, SENSITIVITY
from paminsa_viz.explorer.kit.text import render, status
from paminsa_viz.explorer.state.balance import (
    Balanced,
    BalanceKind,
    BalanceOutcome,
    Goal,
    WeightClearance,
)
from paminsa_viz.kept import kept
from paminsa_viz.model import Design, PaminsaError, static_imbalance
from paminsa_viz.model.singular_limit import serial_clearance
from paminsa_viz.units import (
    as_sentence,
    counted,
    format_pose,
    format_value,
    number,
    percent,
    percent_change,
    symbols_html,
)

MAX_BOUNDS = 6
"""Most active bounds that are listed."""


def status_html(frame: Frame) -> str:
    """Return what came of the last optimization, in a line or two."""
    state, outcome = frame.state, frame.state.balance.outcome
    if OPTIMUM.runs(state):
        return status("balance-status", "plain", "Optimizing …")
    if outcome is None:
        return render("balance/intro.j2", rule=RULE)
    if outcome.error is not None:
        return problem_html(outcome.error)
    headline = _headline(outcome, state.document.design)
    return status("balance-status", *headline, OPTIMUM.stale_text(state))


def problem_html(problem: PaminsaError, testid: str = "balance-status") -> str:
    """Return why there is no result, and which bounds to move."""
    if not isinstance(problem, InfeasibleBounds):
        return status(testid, "bad", "Not possible", as_sentence(str(problem)))
    lines = (Markup(symbols_html(text)) for text in problem.sentences(bound_name))
    return status(testid, "bad", "The bounds do not allow it", *lines)


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


@kept(4)
def details_html(outcome: BalanceOutcome | None) -> str:
    """Return what was changed, what that does, and the certificate; empty without a result."""
    found = None if outcome is None else outcome.result
    if outcome is None or found is None:
        return ""
    bounds, changes = bounds_table(found.optimum), masses_block(outcome.job.design, found.after)
    if isinstance(changes, Table):
        changes = changes.columns(0, 3, 4, 5, hint=1)
    return render(
        "balance/result.j2", job=outcome.job,
        theta=format_value(outcome.job.theta, "rad"), z=format_value(outcome.job.z, "m"),
        clearance=format_value(serial_clearance(outcome.job.design.geometry), "m", 3),
        effects=effects_table(found.effects), changes=changes,
        certificate=certificate_note(found.optimum).text, seconds=found.optimum.seconds,
        bounds=replace(bounds, rows=bounds.rows[:MAX_BOUNDS]).columns(0, 2, 3, 4),
        hit=Markup(weights_html(found.weights)),
    )  # fmt: skip


def weights_html(found: WeightClearance | None) -> str:
    """Return whether the counterweights hit another body; empty without counterweights."""
    if found is None:
        return ""
    one, other = found.names
    place = format_pose(found.pose)
    if found.distance < 0:
        level, title = "bad", "A counterweight hits another body"
        lines = [
            f"{one} and {other} overlap by {format_value(-found.distance, 'm', 3)} at {place}",
            f"in {percent(found.touching)} of {counted(found.poses, 'pose')}; give it a shorter "
            "lever, or leave it out",
        ]
    else:
        level, title = "ok", f"Counterweights are clear by {format_value(found.distance, 'm', 3)}"
        lines = [f"nearest: {one} and {other}, at {place}; {counted(found.poses, 'pose')} checked"]
    return status("weight-clearance", level, title, *lines)


def price_text(found: Balanced) -> str:
    """Return which actuators have to give more than before, and by how much; empty for none."""
    parts: dict[str, list[str]] = {}
    for effect in found.effects:
        if grown(effect) and not effect.group.startswith("RMS"):
            change = percent_change(effect.before, effect.after)
            parts.setdefault(effect.label, []).append(f"{effect.group} {change}")
    return "; ".join(f"{name}: {', '.join(texts)}" for name, texts in parts.items())


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
