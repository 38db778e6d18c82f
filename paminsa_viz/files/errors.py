"""Errors of reading and writing; each is one line and carries its parts for a page to show."""

from __future__ import annotations

from paminsa_viz.errors import LONGEST_VALUE, FileError, printable


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
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - len(end)] + end


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
            place += f", [{printable(table[:LONGEST_VALUE])}]" if table else ","
            place += f" {printable(name[:LONGEST_VALUE])}"
            place += "" if value is None else f" = {shown(value)}"
        super().__init__(source, problem, place)
