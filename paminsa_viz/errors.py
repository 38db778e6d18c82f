"""Errors of the package; each carries the data that a page or command line needs to explain it."""

from __future__ import annotations

import difflib
import unicodedata
from collections.abc import Iterable

LONGEST_VALUE = 60
"""Longest piece of a value that a message repeats [characters]."""


class PaminsaError(ValueError):
    """Root of every error that this package raises on bad input.

    Its text holds no control characters, whatever names of others it repeats: a terminal would
    follow them.
    """

    def __init__(self, *parts: object) -> None:
        super().__init__(*(_uncontrolled(p) if isinstance(p, str) else p for p in parts))

    def __reduce__(self) -> tuple[object, ...]:
        # Python would call the class with the text alone, which fails where it takes more: a pool
        # of processes that gets such an error from a worker waits forever.
        return _without_init, (type(self), *self.args), vars(self)


def _without_init(kind: type[PaminsaError], *parts: object) -> PaminsaError:
    return kind.__new__(kind, *parts)


def printable(text: str) -> str:
    """Return ``text`` on one line, with every character that is not printable replaced by ``?``."""
    if text.isprintable():  # as nearly all are, also long ones
        return text
    return "".join(char if char.isprintable() else "?" for char in text)


LONGEST_MESSAGE = 1500
"""Longest message on one line [characters]: with its program's name it fits on a small screen."""


def one_line(error: object) -> str:
    """Return what an error says as one printable line; of a long one the beginning and the end."""
    text = printable(" ".join(str(error).split()))
    if len(text) <= LONGEST_MESSAGE:
        return text
    half = LONGEST_MESSAGE // 2
    return f"{text[:half]} ... {text[-half:]}"


def _uncontrolled(text: str) -> str:
    """Return a text with its lines and blanks as they are, and all else as in `printable`."""
    if text.isprintable():
        return text
    blank = (char == "\n" or unicodedata.category(char) == "Zs" for char in text)
    return "".join(c if keep else printable(c) for c, keep in zip(text, blank, strict=True))


class InvalidDesign(PaminsaError):
    """A design value that no machine can have.

    Attributes:
        field: Dotted path of the value, for example ``"geometry.base_radius"``.
        value: What was given.
        allowed: What is allowed, in words.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        text = f"{value!r:.{LONGEST_VALUE}}"
        super().__init__(f"{field} = {text} is not possible: {allowed}")


class InvalidInput(PaminsaError):
    """An argument whose shape or values a function cannot use.

    Attributes:
        argument: Name of the argument.
        problem: What is wrong with it and what is expected, in words.
    """

    def __init__(self, argument: str, problem: str) -> None:
        self.argument = argument
        self.problem = problem
        super().__init__(f"{argument}: {problem}")


class UnreachablePose(PaminsaError):
    """A pose that the mechanism cannot take.

    Attributes:
        pose: The pose (x, y, theta, z) [m, m, rad, m].
        leg: Paper's number of the leg that stands in the way (1, 2, 3), or 0 if no single leg does.
        limit: Name of the limit.
        excess: By how much the limit is exceeded [m].
    """

    def __init__(
        self, pose: tuple[float, ...], leg: int, limit: str, excess: float, explanation: str
    ) -> None:
        self.pose = pose
        self.leg = leg
        self.limit = limit
        self.excess = excess
        super().__init__(explanation)


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
        place += f", column {printable(column[:LONGEST_VALUE])}" if column else ""
        super().__init__(source, problem, place)


LONGEST_LIST = 600
"""Longest list of names in a message [characters]: it fits on a small screen."""


def name_hint(
    name: str, known: Iterable[str], cutoff: float = 0.6, there: str = "there are"
) -> str:
    """Return advice for an unknown name: the nearest of those that are known, or which there are.

    Args:
        name: The unknown name.
        known: All there are; where they are too many to be listed, the nearest ones are.
        cutoff: How alike the nearest has to be to be the one that was meant, 0 to 1.
        there: Words before a list.
    """
    names = list(known)
    near = difflib.get_close_matches(name[:100], names, 1, cutoff)
    if near:
        return f"did you mean {near[0]}?"
    listed = ", ".join(names) or "none"
    if len(listed) <= LONGEST_LIST:
        return f"{there} {listed}"
    nearest = difflib.get_close_matches(name[:100], names, len(names), 0.0)
    while len(listed := ", ".join(nearest)) > LONGEST_LIST:
        nearest.pop()
    return f"{there} {listed} and {len(names) - len(nearest)} more"
