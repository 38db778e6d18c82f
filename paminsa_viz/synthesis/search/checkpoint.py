"""Checkpoints of a search: where it is, as a file that it goes on from."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict, replace
from typing import Any

import msgspec
import numpy as np

from paminsa_viz.errors import FileError
from paminsa_viz.files.atomic import (
    check_writable,
    file_errors,
    keep_others_off,
    open_atomically,
)
from paminsa_viz.files.plain_data import parse_json
from paminsa_viz.interrupts import indivisible
from paminsa_viz.studies.metrics import samples_hash
from paminsa_viz.synthesis.search.case import Effort, Regime, SynthesisCase
from paminsa_viz.synthesis.search.outer import RegimeState

FORMAT = 1

LARGEST_FILE = 50_000_000
"""Of a larger checkpoint no more is read [bytes]; one of the default effort has some 20 kB."""

LEAST_POPULATION = 5
"""Least number of trials that differential evolution goes on from."""

ROUNDING = 1e-9
"""By how much a number of the best trial may be off its range, as a share of it."""


def fingerprint(case: SynthesisCase) -> str:
    """Return a hash of all that a search follows from but how long it may look."""
    alike = replace(case, effort=replace(case.effort, generations=Effort().generations))
    motions = () if case.inner is None else case.inner.motions
    facts = [repr(alike), *map(samples_hash, motions)]
    return hashlib.sha256("\n".join(facts).encode()).hexdigest()[:32]


class Checkpoint:
    """The file of a search, which no other process writes until it is closed.

    It is there as soon as it is opened, and at any moment a whole one.

    Attributes:
        states: Where the search was when the file was opened; nothing in a new one.
    """

    def __init__(self, path: str | os.PathLike[str], case: SynthesisCase) -> None:
        """Open the checkpoint of a case, or begin one where there is none.

        Raises:
            FileError: If the file cannot be read or written, is no checkpoint, one of another
                case, or is used by another process.
        """
        self._path, self._case = path, case
        self._lock: int | None = None
        check_writable(path)
        with indivisible():  # a stop leaves no empty file
            try:
                with file_errors(path, "written"):
                    self._lock, content = _locked(path)
                self.states = _read(content, os.fspath(path), case) if content else ()
                if not content:
                    self._begin()
            except BaseException:
                self.close()
                raise

    def __enter__(self) -> Checkpoint:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let other processes use the file."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def save(self, states: tuple[RegimeState, ...]) -> None:
        """Write where the search is, completely or not at all.

        Raises:
            FileError: If the file cannot be written.
        """
        data = {
            "format": FORMAT,
            "case": fingerprint(self._case),
            "states": [asdict(state) | {"regime": state.regime.name} for state in states],
        }
        lock = None
        try:
            with open_atomically(self._path) as file:
                json.dump(data, file, allow_nan=False)
                # The file that replaces the old one is locked before it is in place.
                lock = os.dup(file.fileno())
                if not keep_others_off(lock, self._path):
                    os.close(lock)  # Windows replaces no file that is open, and has no such locks
                    lock = None
        except BaseException:
            if lock is not None:
                os.close(lock)
            raise
        self.close()
        self._lock = lock

    def _begin(self) -> None:
        try:
            self.save(())
        except FileError:
            os.unlink(self._path)  # it is empty
            raise


def _locked(path: str | os.PathLike[str]) -> tuple[int | None, bytes]:
    """Lock a file, which is made where there is none.

    Returns:
        Its descriptor, None where there are no locks and it is closed again, and its content.
    """
    while True:
        number = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
        kept = False
        try:
            locked = keep_others_off(number, path)
            if not locked or os.path.samestat(os.fstat(number), os.stat(path)):
                with open(number, "rb", closefd=False) as file:
                    content = file.read(LARGEST_FILE)
                kept = locked
                return (number if locked else None), content
        except FileNotFoundError:
            pass  # meanwhile another process has put a new file in its place
        finally:
            if not kept:
                os.close(number)


def _read(content: bytes, name: str, case: SynthesisCase) -> tuple[RegimeState, ...]:
    """Return the states in a checkpoint.

    Raises:
        FileError: If it is none, is damaged, or one of another case.
    """
    try:
        data = parse_json(content)
    except ValueError as error:
        raise FileError(name, "is no checkpoint of a search") from error
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise FileError(name, "is no checkpoint of a search")
    if data.get("case") != fingerprint(case):
        raise FileError(
            name, "is a checkpoint of another case; remove it to start over, or name another file"
        )
    try:
        states = tuple(_state(item, case) for item in data["states"])
        if len({state.regime for state in states}) < len(states):
            raise ValueError("a regime twice")
    except (KeyError, TypeError, ValueError, msgspec.ValidationError) as error:
        raise FileError(name, "is no checkpoint of a search, or is damaged") from error
    return states


def _state(item: dict[str, Any], case: SynthesisCase) -> RegimeState:
    """Return what is written of a state, if a search can go on from it."""
    regime = Regime[item["regime"]]
    state = msgspec.convert(item | {"regime": regime.value}, RegimeState)
    low, high = case.bounds.T
    slack = ROUNDING * (high - low)
    rows, best = np.array(state.population), np.array(state.best)
    possible = (
        state.trials > 0
        and rows.shape == (max(len(rows), LEAST_POPULATION), len(low))
        and np.all((rows >= 0) & (rows <= 1))
        and best.shape == low.shape
        and np.all((best >= low - slack) & (best <= high + slack))
        and 0 < len(state.history) <= state.generation
        and np.isfinite(state.history).all()
    )
    if not possible:
        raise ValueError("numbers that no search has")
    return state
