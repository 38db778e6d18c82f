"""Texts that come from elsewhere as plain data, within what every reader can handle.

JSON and TOML know numbers of thousands of digits, lists in lists without end and halves of
characters. Code that goes on with such data fails anywhere: at the first `float`, in a comparison,
while an error is written. So it is refused here, before any reader looks at it.
"""

from __future__ import annotations

import json
import tomllib
from typing import Any

MOST_LEVELS = 30
"""Most tables and lists within each other; what the program writes has fewer than ten."""

LARGEST_INTEGER = 2**63 - 1
"""Largest whole number in size, as in TOML's own specification."""


class UnusableData(ValueError):
    """Data that no reader can handle.

    Attributes:
        path: Dotted keys and places in lists down to a value, empty for the whole.
        value: What is there.
        problem: What is wrong, in words.
    """

    def __init__(self, path: str, value: object, problem: str) -> None:
        self.path, self.value, self.problem = path, value, problem
        super().__init__(problem)


def parse_json(text: str | bytes) -> Any:
    """Return a text as JSON.

    Raises:
        ValueError: If it is none, or `UnusableData`.
    """
    try:
        return checked_data(json.loads(text))
    except RecursionError as error:
        raise UnusableData("", None, "is nested too deeply") from error


def parse_plain_toml(text: str) -> dict[str, Any]:
    """Return a text as TOML.

    Raises:
        ValueError: If it is none, or `UnusableData`.
    """
    try:
        return checked_data(tomllib.loads(text))
    except RecursionError as error:
        raise UnusableData("", None, "is nested too deeply") from error


def checked_data(data: Any) -> Any:
    """Return parsed data if it is within the limits.

    Raises:
        UnusableData: If it is not, at the first place of it.
    """
    pending: list[tuple[Any, str, int]] = [(data, "", 0)]
    while pending:
        value, path, level = pending.pop()
        if isinstance(value, (dict, list)):
            if level >= MOST_LEVELS:
                raise UnusableData("", None, "is nested too deeply")
            items = value.items() if isinstance(value, dict) else enumerate(value)
            inside = [(part, f"{path}.{name}".lstrip("."), level + 1) for name, part in items]
            pending += reversed(inside)
        elif type(value) is int and abs(value) > LARGEST_INTEGER:
            raise UnusableData(path, value, "a finite number of fewer digits is needed")
        elif isinstance(value, str) and not value.isprintable() and _halved(value):
            raise UnusableData(path, value, "half a character cannot be written")
    return data


def _halved(text: str) -> bool:
    """Whether a text holds half of a pair of surrogates, which UTF-8 cannot write."""
    return any("\ud800" <= char <= "\udfff" for char in text)
