"""What the documentation states, for tests: numbers on its pages, defaults in descriptions."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[2] / "docs"


def page(name: str) -> str:
    """Return a page with all its lines in one."""
    return " ".join((DOCS / f"{name}.md").read_text(encoding="utf-8").split())


def missing(name: str, sentences: Iterable[str]) -> list[str]:
    """Return the sentences, made of a program's own numbers, that a page does not have."""
    text = page(name)
    return [sentence for sentence in sentences if sentence not in text]


def defaults_of(function: Callable[..., Any], names: Iterable[str]) -> dict[str, Any]:
    """Return the defaults of some arguments by their names."""
    found = inspect.signature(function).parameters
    return {name: found[name].default for name in names}
