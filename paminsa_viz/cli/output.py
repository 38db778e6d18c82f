"""What commands print: tables for people, JSON for programs, errors in one line."""

from __future__ import annotations

import codecs
import json
import logging
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from paminsa_viz.blocks.data import plain
from paminsa_viz.blocks.kinds import Block, Note, Table
from paminsa_viz.cli.letters import as_written
from paminsa_viz.errors import one_line
from paminsa_viz.files.atomic import open_atomically
from paminsa_viz.files.design_file import save_design
from paminsa_viz.interrupts import on_interrupt
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.units import NONE, TIE, tied
from paminsa_viz.version import COMMAND, MADE_BY

if TYPE_CHECKING:
    from paminsa_viz.quantities.requirements import Requirements


def print_error(error: Exception) -> None:
    """Print an error as one line on stderr."""
    print(f"{COMMAND}: {one_line(error)}", file=sys.stderr)


def print_failure(error: Exception, *, as_json: bool) -> int:
    """Print why there is no result, for programs on the output as well; returns the exit code."""
    print_error(error)
    if as_json:
        print_json({"ok": False, "problems": [str(error)]})
    return 1


def print_written(paths: Iterable[object]) -> None:
    """Print which files are written."""
    for path in paths:
        print(f"{path}: written")


def print_left_out(design: Design) -> None:
    """Print what files and results leave out of a design, if it has it."""
    if note := equal_legs_note(design.deviations):
        print(note)


def write_report(request: ReportRequest, path: Path) -> None:
    """Write a design report, with its progress on the error stream.

    Raises:
        FileError: If it cannot be written.
    """
    from paminsa_viz.report.page import report_html  # figures take a second to load

    # Opened first, so that a place which cannot be written to is known before the work.
    with open_atomically(path) as file:
        file.write(report_html(request, _print_step))


def save_changed(
    design: Design, path: Path, requirements: Requirements | None, *, comment: str = ""
) -> Path:
    """Write a design that a command has changed, and return its path.

    It has the file's name: it is no longer the design that its own name says. What the robot is
    needed for goes along, None for nothing.

    Raises:
        FileError: If it cannot be written.
    """
    named = replace(design, name=path.stem[:100])
    return save_design(named, path, comment=comment, requirements=requirements)


def print_began(what: str) -> None:
    """Say what has begun, in one piece: a stop may print its line at any moment."""
    with suppress(OSError):  # work goes on though nobody reads how far it is
        sys.stderr.write(f"{what} ...\n")


@contextmanager
def status_line(text: str) -> Iterator[Callable[[str], None]]:
    """Show what is being done, to people: not to files and other programs.

    Args:
        text: What comes first; the function that this gives shows another one.
    """
    from rich.console import Console  # takes a while to load

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda text: None
        return
    status = console.status(text)
    with on_interrupt(status.stop), status:  # or a terminal is left without its cursor
        yield status.update


@contextmanager
def progress_line(text: str, limit: str = "") -> Iterator[Progress]:
    """Show what part of work is done, to people, see `status_line`.

    Args:
        text: What is done.
        limit: What the part is one of, if that is known.
    """
    with status_line(text) as update:

        def show(done: float, /, **_: Any) -> None:
            update(f"{text}: {done:.0%}{limit}")

        yield show


def announce_compilation() -> None:
    """Tell people, once, why the first run after installing takes longer, or why each does."""
    log = logging.getLogger("paminsa_viz.model.compiled")
    log.addHandler(_announcement)
    log.setLevel(logging.INFO)


class _Announcement(logging.Handler):
    """Tells of the first kernel that is not on disk, and whether it will be."""

    def emit(self, record: logging.LogRecord) -> None:
        logging.getLogger(record.name).removeHandler(self)
        if getattr(record, "kept", True):
            print_began("compiling, once after installing")
        else:
            print_began("compiling at each start: no folder keeps it; NUMBA_CACHE_DIR can name one")


_announcement = _Announcement()


def _print_step(done: float, /, *, step: str, **_: Any) -> None:
    print_began(step)


def print_json(facts: dict[str, Any], *, signed: bool = True) -> None:
    """Print facts as JSON, see `blocks.data`; a number that is not finite becomes null.

    Args:
        facts: What a command found; arrays, enumerations, paths and records may be in it.
        signed: Whether the program that found them is named first.
    """
    made_by = {"made_by": MADE_BY} if signed else {}
    # JSON is read as UTF-8: in another encoding all that is not ASCII is written as escapes.
    escaped = codecs.lookup(getattr(sys.stdout, "encoding", None) or "utf-8").name != "utf-8"
    text = json.dumps(plain(made_by | facts), indent=2, ensure_ascii=escaped, allow_nan=False)
    print(text)


def print_heading(design: Design, *facts: str) -> None:
    """Print which design the results below are of, and where or under what they hold."""
    print(ascii_numbers(", ".join((f'design "{design.name}"', *facts))))


def print_blocks(blocks: Iterable[Block]) -> None:
    """Print the notes and tables of a report for people, with a star before rows that stand out."""
    texts = [block for block in blocks if isinstance(block, (Note, Table))]
    for before, block in zip([None, *texts], texts, strict=False):
        if isinstance(before, Table) or (before is not None and isinstance(block, Table)):
            print()
        if isinstance(block, Note):
            _print_text(block.text)
        else:
            _print_report_table(block)


def _print_text(text: str) -> None:
    """Print a text; in a terminal no line ends in a word, or between a number and its unit."""
    if not sys.stdout.isatty():
        print(ascii_numbers(text))
        return
    width = shutil.get_terminal_size().columns
    words = ascii_numbers(tied(text))
    lines = textwrap.wrap(words, width, break_long_words=False, break_on_hyphens=False)
    print("\n".join(lines).replace(TIE, " "))


def _print_report_table(table: Table) -> None:
    if table.caption:
        _print_text(table.caption)
    lines = [("", *map(ascii_numbers, table.head))] if any(table.head) else []
    for row in table.rows:
        mark = "*" if row.kind == "marked" else ""
        missing = len(table.head) - len(row.cells)
        lines.append((mark, *map(ascii_numbers, row.cells), *[""] * missing))
    marked = any(line[0] for line in lines)
    _print_rows(lines if marked else [line[1:] for line in lines], words=table.words + marked)


PRINTED = {
    "−": "-", "±": "+-", "≤": "<=", "≥": ">=", "⌀": "d", "″": '"', NONE: "-",
    "“": '"', "”": '"', "’": "'",
}  # fmt: skip
"""Signs that a terminal may lack, and what is printed instead."""


def ascii_numbers(text: str) -> str:
    """Return a text whose numbers every terminal and program reads: ``-1.2e-13``, ``<= 3``."""
    exponents = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
    text = re.sub(r"·10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda found: f"e{found[1].translate(exponents)}", text)
    for sign, instead in PRINTED.items():
        text = text.replace(sign, instead)
    return re.sub("θ(?![\u0300-\u036f])", "theta", text)  # a word has no place for a dot above


def _print_rows(rows: Sequence[tuple[str, ...]], words: int) -> None:
    """Print rows with columns in line.

    Args:
        rows: Rows of as many cells each.
        words: How many columns from the left hold words; the others hold numbers, which are
            aligned to the right.
    """
    written = [tuple(map(as_written, row)) for row in rows]
    widths = [max(map(len, column)) for column in zip(*written, strict=True)]
    for row in written:
        cells = [
            cell.ljust(width) if place < words else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        print("  ".join(cells).rstrip())
