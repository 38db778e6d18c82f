"""Errors of reading and writing; each is one line and carries its parts for a page to show."""

from __future__ import annotations

from paminsa_viz.errors import PaminsaError
from paminsa_viz.errors import printable as printable

SHOWN_CHARACTERS = 60
"""Longest piece of a file's own text that a message repeats."""


def shown(value: object) -> str:
    """Return a value found in a file as short, single-line, printable text.

    What a file holds may be hostile: long, nested, or full of control characters.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, int) and value.bit_length() > 200:
        return "a number of very many digits"
    text = repr(value) if isinstance(value, (str, int, float)) else f"{value}"
    text, end = printable(text), "...'" if isinstance(value, str) else "..."
    return text if len(text) <= SHOWN_CHARACTERS else text[: SHOWN_CHARACTERS - len(end)] + end


class FileError(PaminsaError):
    """A file that cannot be read or written, and why.

    Attributes:
        source: Name of the file.
        problem: What is wrong and what is expected, in words.
    """

    def __init__(self, source: str, problem: str, place: str = "") -> None:
        self.source = source
        self.problem = problem
        super().__init__(f"{printable(source)}{place}: {problem}")


class DesignFileError(FileError):
    """A design file that is refused.

    Attributes:
        source: Name of the file.
        problem: What is wrong and what is allowed, in words.
        line: Line in the file, counted from 1, or None where it is not known.
        key: Dotted key such as ``"links.b3_kg"``, or an empty string.
        value: What the file gives for it, or None.
    """

    def __init__(
        self,
        source: str,
        problem: str,
        *,
        line: int | None = None,
        key: str = "",
        value: object = None,
    ) -> None:
        self.line = line
        self.key = key
        self.value = value
        place = "" if line is None else f", line {line}"
        if key:
            table, _, name = key.rpartition(".")
            place += f", [{printable(table[:SHOWN_CHARACTERS])}]" if table else ","
            place += f" {printable(name[:SHOWN_CHARACTERS])}"
            place += "" if value is None else f" = {shown(value)}"
        super().__init__(source, problem, place)


class TableFileError(FileError):
    """A table that is refused.

    Attributes:
        source: Name of the file.
        problem: What is wrong and what is allowed, in words.
        row: Row as a spreadsheet counts it (the header is row 1), or None.
        column: Name of the column, or an empty string.
        value: The cell's text, or None.
    """

    def __init__(
        self,
        source: str,
        problem: str,
        *,
        row: int | None = None,
        column: str = "",
        value: str | None = None,
    ) -> None:
        self.row = row
        self.column = column
        self.value = value
        place = "" if row is None else f", row {row}"
        place += f", column {printable(column[:SHOWN_CHARACTERS])}" if column else ""
        super().__init__(source, problem, place)
