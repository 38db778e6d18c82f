"""No reader takes more than a second of processor time, whatever a file repeats."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from paminsa_viz.files.design_file import LARGEST_FILE, LONGEST_LINE, find_line, read_design
from paminsa_viz.files.errors import FileError

REPEATED = ["(", "[", "{", '"', "'", "=", ".", ",", "#", " ", "\t", "\n", "a", "1", "_", "-", "\\"]
MEGABYTE = 1_000_000


@contextmanager
def within_a_second() -> Iterator[None]:
    start = time.process_time()
    yield
    assert time.process_time() - start < 1.0


def contents(character: str, size: int) -> list[str]:
    """One character over and over: alone, in long lines, in short ones, behind a good start."""
    line = character * (LONGEST_LINE - 10) + "\n"
    long = (line * (size // len(line) + 1))[:size]
    short = (f"{character}\n" * size)[:size]
    return [
        character * size,
        long,
        short,
        f"k = {character}\n{short}"[:size],
        f"x{character}=" + long,
    ]


@pytest.mark.parametrize("character", REPEATED)
def test_design_files(character: str) -> None:
    for content in contents(character, MEGABYTE):
        with within_a_second(), pytest.raises(FileError):
            read_design(content, "a.toml")
    for content in contents(character, LARGEST_FILE - 100):
        for text in (content, f"schema_version = 1\nx = 1\n{content}"):
            with within_a_second(), pytest.raises(FileError):
                read_design(text[:LARGEST_FILE], "a.toml")
            with within_a_second():
                find_line(content, "links.b3_kg")
