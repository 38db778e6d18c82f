"""Checkpoints of a search: where it is, as a file that it goes on from."""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import asdict, replace
from typing import Any

from paminsa_viz.files.atomic import as_file_error, open_atomically
from paminsa_viz.files.errors import FileError
from paminsa_viz.studies.metrics import samples_hash
from paminsa_viz.synthesis.search.case import Effort, Regime, SynthesisCase
from paminsa_viz.synthesis.search.outer import RegimeState

FORMAT = 1

LARGEST_FILE = 50_000_000
"""Largest checkpoint [bytes]; one of the default effort has some 20 kB."""


def fingerprint(case: SynthesisCase) -> str:
    """Return a hash of all that a search follows from but how long it may look."""
    alike = replace(case, effort=replace(case.effort, generations=Effort().generations))
    motions = () if case.inner is None else case.inner.motions
    facts = [repr(alike), *map(samples_hash, motions)]
    return hashlib.sha256("\n".join(facts).encode()).hexdigest()[:32]


def save_checkpoint(
    path: str | os.PathLike[str], case: SynthesisCase, states: tuple[RegimeState, ...]
) -> None:
    """Write where the search of a case is, completely or not at all.

    Raises:
        FileError: If the file cannot be written.
    """
    data = {
        "format": FORMAT,
        "case": fingerprint(case),
        "states": [asdict(state) | {"regime": state.regime.name} for state in states],
    }
    with open_atomically(path) as file:
        json.dump(data, file, allow_nan=False)


def load_checkpoint(path: str | os.PathLike[str], case: SynthesisCase) -> tuple[RegimeState, ...]:
    """Read where the search of a case was; nothing if there is no such file.

    Raises:
        FileError: If the file cannot be read, is no checkpoint, or one of another case.
    """
    name = os.fspath(path)
    if not os.path.exists(path):
        return ()
    try:
        with open(path, encoding="utf-8") as file:
            data = json.loads(file.read(LARGEST_FILE))
    except OSError as error:
        raise as_file_error(name, error, "read") from error
    except ValueError as error:
        raise FileError(name, "is no checkpoint of a search") from error
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise FileError(name, "is no checkpoint of a search")
    if data.get("case") != fingerprint(case):
        raise FileError(
            name, "is a checkpoint of another case; remove it to start over, or name another file"
        )
    try:
        return tuple(_state(item, len(case.ranges)) for item in data["states"])
    except (KeyError, TypeError, ValueError) as error:
        raise FileError(name, "is no checkpoint of a search, or is damaged") from error


def _state(item: dict[str, Any], count: int) -> RegimeState:
    return RegimeState(
        Regime[item["regime"]], int(item["generation"]), int(item["trials"]),
        tuple(_row(row, count) for row in item["population"]), _row(item["best"], count),
        _row(item["history"], len(item["history"])), bool(item["done"]),
    )  # fmt: skip


def _row(values: list[Any], count: int) -> tuple[float, ...]:
    row = tuple(map(float, values))
    if len(row) != count or not all(map(math.isfinite, row)):
        raise ValueError("a row of another length, or no numbers")
    return row
