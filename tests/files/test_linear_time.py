"""No reader takes more than a second of processor time, whatever a file repeats."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest

from paminsa_viz.files.columns import POSES, TRAJECTORY, TableKind
from paminsa_viz.files.design_file import LARGEST_FILE, LONGEST_LINE, find_line, read_design
from paminsa_viz.files.errors import FileError
from paminsa_viz.files.resumable_csv import ResumableCsv
from paminsa_viz.files.table_reader import LONGEST_ROW, TableReader

pytestmark = pytest.mark.slow


REPEATED = ["(", "[", '"', "=", ".", ",", "#", " ", "\t", "\n", "a", "1", "_"]
MEGABYTE = 1_000_000


@contextmanager
def within_a_second() -> Iterator[None]:
    start = time.process_time()
    yield
    assert time.process_time() - start < 1.0


def contents(character: str, size: int) -> list[str]:
    """One character over and over: alone, one a line, in long lines behind the start of a key."""
    line = f"x{character}=" + character * (LONGEST_LINE - 10) + "\n"
    return [character * size, (f"{character}\n" * size)[:size], (line * (size // 900))[:size]]


@pytest.mark.parametrize("character", REPEATED)
def test_design_files(character: str) -> None:
    for content in contents(character, MEGABYTE):
        with within_a_second(), pytest.raises(FileError):
            read_design(content, "a.toml")
    for content in contents(character, LARGEST_FILE - 100):
        text = f"schema_version = 1\nx = 1\n{content}"
        with within_a_second(), pytest.raises(FileError):
            read_design(text[:LARGEST_FILE], "a.toml")
        with within_a_second():
            find_line(content, "links.b3_kg")


@pytest.mark.parametrize("kind", [POSES, TRAJECTORY], ids=lambda kind: kind.name)
@pytest.mark.parametrize("character", REPEATED)
def test_tables(character: str, kind: TableKind) -> None:
    good = ",".join(kind.needed) + "\n"
    for content in contents(character, MEGABYTE):
        cell = content[: LONGEST_ROW - 1000]
        for text in (content, good + content, f"x[{cell}],y\n"):
            with within_a_second(), suppress(FileError):
                for _ in TableReader(io.StringIO(text, newline=""), kind, "a.csv").blocks():
                    pass


@pytest.mark.parametrize("character", REPEATED)
def test_resumable_tables(character: str, tmp_path) -> None:
    path, head = tmp_path / "a.csv", {"format": "x 1", "study": "y"}
    start = "# format: x 1\n# study: y\n"
    for content in contents(character, MEGABYTE):
        for text in (content, start + content, f"{start}row,value\n{content}"):
            path.write_text(text)
            with (
                within_a_second(),
                suppress(FileError),
                ResumableCsv(path, head, ("row", "value"), identity="study") as table,
            ):
                list(table.read())
