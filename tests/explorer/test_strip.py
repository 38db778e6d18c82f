"""The strip above all tabs: what it offers to start again after a reload."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain
from typing import Any

from paminsa_viz.explorer.core import tab_store
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.clearance.tab import CLEARANCE
from paminsa_viz.explorer.features.compare.tab import COMPARISON
from paminsa_viz.explorer.features.drives import tab as drives
from paminsa_viz.explorer.features.files.tab import FILE
from paminsa_viz.explorer.features.identification import actions as identification
from paminsa_viz.explorer.features.view.tab import view_entries
from paminsa_viz.explorer.kit.entries import Button, ButtonGroup, Upload, given
from paminsa_viz.explorer.kit.inputs import Input
from paminsa_viz.explorer.state.balance import BalanceKind
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.strip import STRIP, restartable
from paminsa_viz.explorer.tabs import sections
from paminsa_viz.model import InvalidInput
from tests.support.entries import flat


def reloaded(state: State) -> State:
    """Return the state of a page that is loaded again."""
    return tab_store.restore(initial_state(), tab_store.dump(state))


def started_again(state: State, label: str) -> State:
    """Return the state after the only task that is offered, which has a label, was started."""
    choices = restartable(state)
    assert list(choices) == [label, "Leave it"]
    again: Any = choices[label]
    return again(state)


def test_a_task_of_the_balance_is_started_again_as_the_one_that_ran() -> None:
    labels = {"OPTIMUM": "Balance", "FRONT": "Pareto front", "SENSITIVITY": "Sensitivity"}
    for name, label in labels.items():
        running = balancing.start(initial_state(), BalanceKind[name])
        again = started_again(reloaded(running), label)
        assert again.balance.running is not None, name
        assert again.balance.running.task is BalanceKind[name], name
        assert again.ended == (), name


def test_the_search_for_a_motion_to_record_is_offered_again() -> None:
    running = identification.SEARCH.start(initial_state())
    again = started_again(reloaded(running), "Motion for a log")
    assert identification.SEARCH.runs(again)


def test_a_search_for_drives_is_offered_again_unless_a_reload_loses_what_it_was_for() -> None:
    """Motions of a cycle and a catalog are not kept: without them it would be another search."""
    running = drives.SEARCH.start(initial_state())
    assert drives.SEARCH.runs(started_again(reloaded(running), "Search for drives"))
    outcome = Outcome[Any, Any](running.drives.running, result=object())
    found = drives.SEARCH.deliver(running, running.drives.ticket, outcome)
    assert drives.SEARCH.runs(started_again(reloaded(found), "Search for drives"))
    cycle = drives.SEARCH.start(drives.add_motion(initial_state()))
    assert restartable(reloaded(cycle)) == {}


def test_a_task_that_is_started_is_offered_no_more_and_the_others_still_are() -> None:
    running = balancing.start(initial_state(), BalanceKind.FRONT)
    both = reloaded(identification.SEARCH.start(running))
    assert list(restartable(both)) == ["Motion for a log", "Pareto front", "Leave it"]
    started = identification.SEARCH.start(both)  # as the button of its section does
    assert list(restartable(started)) == ["Pareto front", "Leave it"]


def test_a_search_whose_result_is_lost_is_offered_again() -> None:
    """One that has failed is not: nothing is lost with it."""
    start = initial_state()
    found = start.updated("requirements.largest", outcome=Outcome(job=None, result=object()))
    assert list(restartable(reloaded(found))) == ["Largest workspace", "Leave it"]
    failed = Outcome[Any, Any](job=None, error=InvalidInput("requirements", "there are none"))
    assert restartable(reloaded(start.updated("requirements.largest", outcome=failed))) == {}


def test_without_anything_that_ran_nothing_is_offered() -> None:
    assert restartable(reloaded(initial_state())) == {}


def test_a_front_and_a_sensitivity_that_are_lost_are_offered_again_and_a_balance_is_not() -> None:
    """The masses that a balance found are those of the design, which is kept."""
    found = Outcome[Any, Any](job=None, result=object())
    failed = Outcome[Any, Any](job=None, error=InvalidInput("design", "there is no such one"))
    start = initial_state()
    both = start.updated("balance", front=found, tornado=found, outcome=found)
    assert list(restartable(reloaded(both))) == ["Pareto front", "Sensitivity", "Leave it"]
    again = started_again(reloaded(start.updated("balance", front=found)), "Pareto front")
    assert again.balance.running is not None
    assert again.balance.running.task is BalanceKind.FRONT
    assert restartable(reloaded(start.updated("balance", front=failed, outcome=found))) == {}


STOPS = {
    "Search for drives": "drives.find.stop",
    "Motion for a log": "identify.search.stop",
    "Balance": "balance.stop",
    "Pareto front": "front.compute.stop",
    "Sensitivity": "tornado.compute.stop",
}
"""Buttons that stop what is started again, each beside the one that starts it."""


def test_what_can_be_started_again_can_be_stopped_in_its_place() -> None:
    kinds = [tab_store.task_name("balance", kind.name) for kind in BalanceKind]
    state = replace(initial_state(), ended=(*kinds, "drives", "identification.excitation"))
    tables = [section.entries() for section in sections().values()]
    entries: Any = {entry.key: entry for table in tables for entry in flat(table)}
    for label, key in STOPS.items():
        start: Any = restartable(state)[label]
        running, stop = start(state), entries[key]
        assert list(tab_store.unkept_tasks(running)), label
        assert stop.visible(running), label
        assert not stop.visible(state), label
        assert not list(tab_store.unkept_tasks(stop.effect(running))), label


def test_every_button_and_input_says_under_the_pointer_what_it_does() -> None:
    state = initial_state()
    own = (*FILE, *view_entries(), *CLEARANCE, *STRIP, COMPARISON)
    tables = [own, *(section.entries() for section in sections().values())]
    for entry in flat(tuple(chain(*tables))):
        if isinstance(entry, Button | ButtonGroup | Upload | Input):
            hint = entry.tooltip if isinstance(entry, Button) else entry.hint
            assert given(hint, state), entry.key
