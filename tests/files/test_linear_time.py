"""No reader takes more than some seconds of processor time, whatever half a megabyte repeats.

The slowest takes a quarter of a second; one whose time grew with the square of the length, minutes.
"""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from paminsa_viz.cli.verify import _mechanics
from paminsa_viz.errors import PaminsaError
from paminsa_viz.explorer.core.persistence import load, open_share_code
from paminsa_viz.files.columns import POSES, TRAJECTORY, TableKind
from paminsa_viz.files.design_file import LARGEST_FILE, LONGEST_LINE, read_design
from paminsa_viz.files.resumable_csv import ResumableCsv
from paminsa_viz.files.table_reader import LONGEST_ROW, TableReader
from paminsa_viz.files.toml_table import find_line
from paminsa_viz.files.trajectory_table import parse_trajectory

pytestmark = pytest.mark.slow

REPEATED = '([{"=.,#< \t\na1_-\\é\0'
LENGTH = 500_000
LIMIT = 2.0
"""Most processor time of a reader, also on a slow or busy machine [s]."""


@contextmanager
def within_limit(what: str) -> Iterator[None]:
    start = time.process_time()
    with suppress(PaminsaError):
        yield
    assert time.process_time() - start < LIMIT, what


def contents(character: str, size: int) -> list[str]:
    """One character over and over: alone, one a line, in long lines behind the start of a key."""
    line = f"x{character}=" + character * (LONGEST_LINE - 10) + "\n"
    return [character * size, (f"{character}\n" * size)[:size], (line * (size // 900))[:size]]


def read_table(kind: TableKind, text: str) -> None:
    for _ in TableReader(io.StringIO(text, newline=""), kind, "a.csv").blocks():
        pass


def read_tables(text: str) -> None:
    """Read a header, cells of a row, and a cell of the header."""
    with suppress(PaminsaError):
        read_table(POSES, text)  # no kind has such a header
    for kind in (POSES, TRAJECTORY):
        head = ",".join(kind.needed) + "\n"
        for part in (head + text, f"x[{text[: LONGEST_ROW - 1000]}],y\n"):
            with suppress(PaminsaError):
                read_table(kind, part)


def read_resumable(text: str) -> None:
    """Read it as a head, as columns and as rows."""
    for start in ("", "# format: x 1\n# study: y\n", "# format: x 1\n# study: y\nrow,value\n"):
        Path("a.csv").write_text(start + text)
        head = {"format": "x 1", "study": "y"}
        with (
            suppress(PaminsaError),
            ResumableCsv("a.csv", head, ("row", "value"), identity="study") as table,
        ):
            list(table.read())


def read_part(text: str) -> None:
    """Read as much as is taken of a design file, below a key."""
    text = f"schema_version = 1\nx = 1\n{text}"[:LARGEST_FILE]
    find_line(text, "links.b3_kg")
    read_design(text, "a.toml")


def read_model(text: str) -> None:
    Path("a.xml").write_text(f"<mujoco>{text}")
    _mechanics(Path("a.xml"))


READERS: dict[str, Callable[[str], object]] = {
    "design file": lambda text: read_design(text, "a.toml"),
    "part of a design file": read_part,
    "uploaded design": lambda text: read_design(text.encode(), "a.toml"),
    "table": read_tables,
    "trajectory": lambda text: parse_trajectory(io.StringIO(text, newline=""), "a.csv"),
    "resumable table": read_resumable,
    "share code": lambda text: open_share_code(f"PMZ1-{text}"),
    "saved session": load,
    "model": read_model,
}


@pytest.mark.parametrize("reader", READERS)
def test_time_is_in_proportion_to_the_length(reader, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for character in REPEATED:
        for content in contents(character, LENGTH):
            with within_limit(repr(character)):
                READERS[reader](content)
