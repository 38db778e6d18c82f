"""What cannot be balanced, or not as wished, and how it is told."""

from __future__ import annotations

import pytest

from paminsa_viz.balancing import InfeasibleBounds
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.jobs import CounterweightSlot, Goal
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.panels.balance_text import details_html
from paminsa_viz.explorer.state import State
from paminsa_viz.model import static_imbalance
from tests.explorer.balancing.balanced import solved, status


def test_impossible_bounds_are_told_with_what_to_relax(start: State) -> None:
    wished = balancing.change_settings(
        start, slot_b3=CounterweightSlot(0.1, 0.0), slot_b8=CounterweightSlot(0.1, 0.5)
    )
    after = solved(wished)
    assert after.document == start.document
    outcome = after.balancing.outcome
    assert outcome is not None
    assert isinstance(outcome.problem, InfeasibleBounds)
    text = status(after)
    assert "The bounds do not allow it" in text
    assert "<b>raise</b> weight on B8 past 8 from 0.5 to 3.896 kg" in text
    assert details_html(outcome) == ""
    # What it says would do does, and the refusal goes as soon as something is changed.
    relaxed = balancing.change_settings(after, slot_b8=CounterweightSlot(0.1, 3.897))
    assert relaxed.balancing.outcome is None
    assert static_imbalance(solved(relaxed).document.design) == pytest.approx(0, abs=1e-9)
    # An input that says again what it holds changes nothing.
    assert balancing.change_settings(after, slot_b8=CounterweightSlot(0.1, 0.5)) is after
    near = solved(balancing.change_settings(after, exact=False))
    assert static_imbalance(near.document.design) == pytest.approx(7.93255, abs=1e-5)
    assert "As near to balance" in status(near)


def test_without_a_motion_it_says_so(start: State) -> None:
    table = motions.choose_kind(start, motions.Kind.TABLE)
    after = solved(balancing.choose_goal(table, Goal.PEAK))
    assert "CSV" in status(after)
    # The balance itself needs none.
    assert "Statically balanced" in status(balancing.balance_now(table))
    assert "–" in details_html(balancing.balance_now(table).balancing.outcome)


def test_nothing_that_may_change_is_refused(start: State) -> None:
    none = balancing.change_settings(
        start, slot_b3=CounterweightSlot(), slot_b8=CounterweightSlot()
    )
    assert "give counterweights a mass" in status(solved(none))
