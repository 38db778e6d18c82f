"""What commands print: tables for people, JSON for programs, errors in one line."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence

from paminsa_viz.cli import PROGRAM


def print_error(error: Exception) -> None:
    """Print an error as one line on stderr."""
    print(f"{PROGRAM}: {' '.join(str(error).split())}", file=sys.stderr)


def print_written(paths: Iterable[object]) -> None:
    """Print which files are written."""
    for path in paths:
        print(f"{path}: written")


def print_json(value: object) -> None:
    """Print a value as JSON; a number that is not finite becomes null."""
    print(json.dumps(_finite(value), indent=2, ensure_ascii=False, allow_nan=False))


def print_table(rows: Sequence[tuple[str, ...]], *, indent: int = 0, right: bool = False) -> None:
    """Print rows with columns in line.

    Args:
        rows: Rows of as many cells each.
        indent: Spaces before each row.
        right: Whether all columns but the first are aligned to the right: for numbers.
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = [
            cell.rjust(width) if right and place else cell.ljust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        print((" " * indent + "  ".join(cells)).rstrip())


def _finite(value: object) -> object:
    """Return a value with None in place of numbers that JSON does not have."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, float) and value - value != 0:
        return None
    return value
