"""Logs that come with the program: of a robot in MuJoCo, made by ``examples/record_logs.py``."""

from __future__ import annotations

import io
from collections.abc import Sequence
from enum import Enum
from importlib.resources import files
from pathlib import Path

from paminsa_viz.files.logs import parse_log, read_log
from paminsa_viz.identification.log import Log


class ExampleLog(Enum):
    """The logs, each 20 s at 250 Hz; values are the names of the files."""

    BEST = "example_log.csv"
    """On the motion of largest information."""
    OTHER = "example_log_other.csv"
    """On another motion."""
    PAYLOAD = "example_log_payload.csv"
    """On the first motion, with 2 kg on the platform."""


def example_log(kind: ExampleLog = ExampleLog.BEST, *, gains: Sequence[float] | None = None) -> Log:
    """Return a log that comes with the program; ``gains`` as of `read_log`, which it refuses."""
    text = files("paminsa_viz.files").joinpath(kind.value).read_text(encoding="utf-8")
    return parse_log(io.StringIO(text), kind.value, gains=gains)


EXAMPLES = {
    "example": ExampleLog.BEST,
    "example-other": ExampleLog.OTHER,
    "example-payload": ExampleLog.PAYLOAD,
}
"""The logs by the names that commands take."""


def given_log(name: str, *, gains: Sequence[float] | None = None, split: bool = False) -> Log:
    """Return the log of a file, or the one of `EXAMPLES` if there is no such file.

    Args:
        name: Path of the file, or a name.
        gains: As of `read_log`.
        split: As of `read_log`.

    Raises:
        TableFileError: If the file cannot be read or is refused.
    """
    if name in EXAMPLES and not Path(name).exists():
        return example_log(EXAMPLES[name], gains=gains)
    return read_log(name, gains=gains, split=split)
