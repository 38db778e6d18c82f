"""The file of a search: what is read again as it was, what is refused, and how it is locked."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import FileError
from paminsa_viz.files import atomic
from paminsa_viz.synthesis import Effort, Regime
from paminsa_viz.synthesis.masses.case import InnerCase
from paminsa_viz.synthesis.search import checkpoint
from paminsa_viz.synthesis.search.checkpoint import LEAST_POPULATION, Checkpoint, fingerprint
from paminsa_viz.synthesis.search.outer import RegimeState
from tests.synthesis.inner_cases import motion
from tests.synthesis.search_cases import CYLINDER

LOW, HIGH = CYLINDER.bounds.T
FEW = np.random.default_rng(1).uniform(size=(LEAST_POPULATION, len(LOW)))
FEW[0], FEW[1] = 0.0, 1.0  # the ends of the ranges are within them
STATES = (
    RegimeState(
        Regime.SMALLER, 2, 1, tuple(map(tuple, FEW.tolist())), tuple(LOW.tolist()), (2e9, 0.7)
    ),
    RegimeState(
        Regime.LARGER, 1, 352, tuple(map(tuple, FEW.tolist())), tuple(HIGH.tolist()), (-0.3,), True
    ),
)
"""States of which all that can be at a limit is."""


def written(path: Path) -> dict[str, Any]:
    """The file of the states as data."""
    with Checkpoint(path, CYLINDER) as file:
        file.save(STATES)
    return json.loads(path.read_text())


def read(path: Path, data: Any) -> tuple[RegimeState, ...]:
    path.write_text(data if isinstance(data, str) else json.dumps(data))
    with Checkpoint(path, CYLINDER) as file:
        return file.states


def test_states_are_read_as_they_were_written(tmp_path: Path) -> None:
    path = tmp_path / "at.json"
    data = written(path)
    with Checkpoint(path, CYLINDER) as file:
        assert file.states == STATES
    assert not path.stat().st_mode & 0o111  # no program
    # the form that files of people have: it has to be read as long as there are any
    assert data.keys() == {"format", "case", "states"}
    assert data["format"] == 1
    assert [state["regime"] for state in data["states"]] == ["SMALLER", "LARGER"]


@pytest.mark.parametrize(
    ("change", "taken"),
    [
        (lambda s: s.update(generation=0, history=[]), False),
        (lambda s: s.update(trials=0), False),
        (lambda s: s.update(trials=-1), False),
        (lambda s: s["population"].pop(), False),
        (lambda s: s.update(population=[]), False),
        (lambda s: s["population"].append([0.5] * len(LOW)), True),
        (lambda s: [row.pop() for row in s["population"]], False),
        (lambda s: s["population"][2].__setitem__(0, -1e-9), False),
        (lambda s: s["population"][2].__setitem__(0, 1 + 1e-9), False),
        (lambda s: s["population"][2].__setitem__(0, "a"), False),
        (lambda s: s["best"].pop(), False),
        (lambda s: s["best"].__setitem__(1, off(1, -1.0)), True),
        (lambda s: s["best"].__setitem__(1, off(1, -1.2)), False),
        (lambda s: s["best"].__setitem__(1, off(1, 1.0, HIGH)), True),
        (lambda s: s["best"].__setitem__(1, off(1, 1.2, HIGH)), False),
        (lambda s: s.update(history=[]), False),
        (lambda s: s.update(history=[0.7]), True),
        (lambda s: s.update(history=[0.9, 0.8, 0.7]), False),
        (lambda s: s.update(history=[float("inf"), 0.7]), False),
        (lambda s: s.update(history=[0.7, float("nan")]), False),
        (lambda s: s.update(regime="LARGER"), False),
        (lambda s: s.update(regime="OTHER"), False),
        (lambda s: s.pop("done"), True),
    ],
    ids=count(),
)
def test_a_search_goes_on_from_what_it_can_have_reached_alone(
    change: Callable[[dict[str, Any]], object], taken: bool, tmp_path: Path
) -> None:
    path = tmp_path / "at.json"
    data = written(path)
    change(data["states"][0])
    if taken:
        assert len(read(path, data)) == 2
        return
    with pytest.raises(FileError, match="no checkpoint of a search, or is damaged"):
        read(path, data)


def off(place: int, share: float, end: Any = LOW) -> float:
    """A number beyond an end of its range by a share of what is put down to rounding."""
    return float(end[place] + share * checkpoint.ROUNDING * (HIGH - LOW)[place])


def test_other_files_are_told_from_checkpoints_and_from_those_of_other_cases(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "at.json"
    data = written(path)
    for other in ("[]", "3", "{", json.dumps(data | {"format": 7}), json.dumps(data)[:-2]):
        with pytest.raises(FileError, match=r"is no checkpoint of a search$"):
            read(path, other)
    with pytest.raises(FileError, match="of another case"):
        read(path, data | {"case": "0"})
    assert read(path, data) == STATES
    monkeypatch.setattr(checkpoint, "LARGEST_FILE", path.stat().st_size)
    assert read(path, data) == STATES
    with pytest.raises(FileError, match=r"is no checkpoint of a search$"):
        read(path, data | {"name": "a"})


def test_a_case_is_another_one_but_for_how_long_it_is_searched() -> None:
    moving = InnerCase(motions=(motion(),))
    faster = replace(moving, motions=(replace(motion(), velocity=2 * motion().velocity),))
    cases = [
        CYLINDER, replace(CYLINDER, seed=1), replace(CYLINDER, objective="moving_mass"),
        replace(CYLINDER, effort=Effort(population=9)), replace(CYLINDER, inner=moving),
        replace(CYLINDER, inner=faster),
    ]  # fmt: skip
    assert len(set(map(fingerprint, cases))) == len(cases)
    longer = replace(CYLINDER, effort=Effort(999))
    assert fingerprint(longer) == fingerprint(CYLINDER)


def test_a_file_is_locked_until_it_is_closed_and_nothing_else_is_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither twice nor after an error: the number may be that of another file by then."""
    path = tmp_path / "at.json"
    opened: list[int] = []
    closed: list[int] = []

    def noted(call: Callable[..., int]) -> Callable[..., int]:
        return lambda *given: opened.append(call(*given)) or opened[-1]

    def close(number: int) -> None:
        closed.append(number)
        os.close(number)

    own = vars(os) | {"open": noted(os.open), "dup": noted(os.dup), "close": close}
    monkeypatch.setattr(checkpoint, "os", SimpleNamespace(**own))
    file = Checkpoint(path, CYLINDER)
    for states in (STATES, STATES[:1]):
        file.save(states)
        with pytest.raises(FileError, match="by another process"):
            Checkpoint(path, CYLINDER)
    content = path.read_text()
    broken = replace(STATES[0], history=(0.8, float("nan")))
    with pytest.raises(ValueError, match="JSON"):
        file.save((broken,))
    assert path.read_text() == content

    def refuse(*_: object) -> None:
        raise FileError("at.json", "is used")

    monkeypatch.setattr(checkpoint, "keep_others_off", refuse)
    for write in (lambda: file.save(()), lambda: Checkpoint(path, CYLINDER)):
        with pytest.raises(FileError, match="is used"):
            write()
    assert path.read_text() == content
    file.close()
    file.close()
    assert sorted(closed) == sorted(opened)
    monkeypatch.undo()
    with Checkpoint(path, CYLINDER) as again:
        assert again.states == STATES[:1]


def is_open(path: Path) -> bool:
    """Whether this process has a file open."""
    wanted = path.stat()
    for number in range(3, 512):
        with suppress(OSError):  # nothing has this number
            found = os.fstat(number)
            if (found.st_dev, found.st_ino) == (wanted.st_dev, wanted.st_ino):
                return True
    return False


def test_where_there_are_no_locks_no_file_is_open_while_it_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows refuses it; how a file is asked for may change its number there."""
    path = tmp_path / "at.json"
    replaced: list[list[bool]] = []

    def replace_file(source: Path, target: Path, real=os.replace) -> None:
        replaced.append([is_open(each) for each in (source, target)])
        real(source, target)

    monkeypatch.setattr(atomic, "_lock", lambda number: None)
    monkeypatch.setattr(os, "replace", replace_file)
    monkeypatch.setattr(os.path, "samestat", pytest.fail)
    with Checkpoint(path, CYLINDER) as file:
        file.save(STATES)
        assert not is_open(path)
    assert replaced == [[False, False]] * 2
    with Checkpoint(path, CYLINDER) as again:
        assert again.states == STATES
