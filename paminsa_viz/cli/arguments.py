"""Reading the words of a command line into a typed value, with one-line errors."""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Sequence
from contextlib import redirect_stderr
from typing import Any, TypeVar

import tyro

from paminsa_viz.errors import PaminsaError

PROGRAM = "paminsa-viz"

Options = TypeVar("Options")


class UsageError(PaminsaError):
    """Invalid arguments."""


def print_error(error: Exception) -> None:
    """Print an error as one line on stderr."""
    print(f"{PROGRAM}: {' '.join(str(error).split())}", file=sys.stderr)


def parse(kind: type[Options], words: Sequence[str], command: str, description: str) -> Options:
    """Return an instance of ``kind``, a dataclass or a union of subcommands, from words.

    Args:
        kind: What to make.
        words: The words after the command's name.
        command: The command's name, empty for the program itself.
        description: What its ``--help`` says first.

    Raises:
        UsageError: If the words do not fit.
        SystemExit: After ``--help``.
    """
    program = f"{PROGRAM} {command}".rstrip()
    complaint = io.StringIO()
    target: Any = kind
    if not {"-h", "--help"}.isdisjoint(words):
        print(f"{description}\n")  # tyro would run its lines together
    try:
        with redirect_stderr(complaint):
            return tyro.cli(
                target,
                args=list(words),
                prog=program,
                description=" ",
                config=(tyro.conf.OmitArgPrefixes, tyro.conf.UseAppendAction),
            )
    except SystemExit as stop:
        if not stop.code:
            raise
        raise UsageError(f"{one_line(complaint.getvalue())}; see {program} --help") from None


def one_line(complaint: str) -> str:
    """Return the first statement of tyro's complaint, and its suggestion, as one line.

    A complaint is a title and statements with rules between them, in a drawn frame or, on a screen
    without line drawing, below a dashed rule.
    """
    statements: list[list[str]] = [[]]
    for framed in re.sub(r"\x1b\[[\d;]*m", "", complaint).splitlines():
        line = framed.strip("│").rstrip()
        if re.match(r"[╭╰]|\s*[─-]{4}", line):
            statements.append([])
        elif line.strip() and not line.startswith(" " * 8):  # there is a flag's help text
            statements[-1].append(line.strip())
    texts = [" ".join(lines).rstrip(".") for lines in statements if lines]
    if "╭" not in complaint:
        del texts[:1]  # the title
    texts[:1] = [_without_types(text) for text in texts[:1]]
    kept = texts[:1] + [text for text in texts[1:] if text.startswith("Perhaps")]
    return "; ".join(kept) or "the arguments do not fit"


_TYPES = {
    r"no type matching (?:\{None\}\|)?\{?(.+?)\}? could be instantiated from \[(.*?)\]\. Got.*": (
        r"\1 is needed, not \2"
    ),
    r"invalid literal for int\(\) with base 10: (.*)": r"a whole number is needed, not \1",
    r"could not convert string to float: (.*)": r"a number is needed, not \1",
}
"""Errors of tyro and Python about a value of another type, and the text shown instead."""


def _without_types(text: str) -> str:
    """Return a statement in words of the command line instead of the language's."""
    for pattern, needed in _TYPES.items():
        text = re.sub(pattern, needed, text)
    return text
