"""Steps back and forth."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.session import DEPTH, PAUSE, History
from paminsa_viz.explorer.state import Document
from paminsa_viz.model import APPENDIX_4
from tests.support.documents import DOCUMENTS


@given(documents=st.lists(DOCUMENTS, min_size=2, max_size=8, unique_by=lambda d: d.pose))
def test_undo_takes_every_step_back_and_redo_takes_it_again(documents: list[Document]) -> None:
    history = History()
    for number, (before, after) in enumerate(pairwise(documents)):
        history.record(before, after, f"control {number}", float(number))
    present = documents[-1]
    for expected in documents[-2::-1]:
        found = history.undo(present)
        assert found is expected
        present = found
    assert history.undo(present) is None
    for expected in documents[1:]:
        found = history.redo(present)
        assert found is expected
        present = found
    assert history.redo(present) is None


def test_a_drag_is_one_step_and_a_pause_or_another_control_begins_a_new_one() -> None:
    history, present = History(), Document()
    at = [replace(present, pose=(0.0, 0.0, 0.0, float(i))) for i in range(6)]
    history.record(present, at[0], "z", 0.0)
    history.record(at[0], at[1], "z", 0.9 * PAUSE)
    history.record(at[1], at[2], "z", 1.8 * PAUSE)
    assert history.past == [present]
    history.record(at[2], at[3], "z", 3 * PAUSE)
    history.record(at[3], at[4], "x", 3 * PAUSE)
    assert history.past == [present, at[2], at[3]]
    assert history.undo(at[4]) is at[3]
    history.record(at[3], at[5], "x", 3.1 * PAUSE)  # after undo, a new step
    assert history.past[-1] is at[3]
    assert history.redo(at[5]) is None


def test_history_forgets_what_did_not_change_and_what_is_too_old() -> None:
    history = History()
    history.record(Document(), Document(), "nothing", 0.0)
    assert history.past == []
    renamed = replace(Document(), design=replace(APPENDIX_4, name="mine"))
    history.record(Document(), renamed, "name", 0.0)
    assert len(history.past) == 1  # a name is a change, though equality leaves it out
    for i in range(DEPTH + 10):
        a, b = (Document(pose=(float(i + j), 0.0, 0.0, 0.0)) for j in (0, 1))
        history.record(a, b, str(i), 0.0)
    assert len(history.past) == DEPTH
    assert history.past[-1].pose[0] == DEPTH + 9
