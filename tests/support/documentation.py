"""The pages of the documentation as text, for tests of the numbers that they state."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def page(name: str) -> str:
    """Return a page with all its lines in one."""
    return " ".join((DOCS / f"{name}.md").read_text(encoding="utf-8").split())


def missing(name: str, sentences: Iterable[str]) -> list[str]:
    """Return the sentences, made of a program's own numbers, that a page does not have."""
    text = page(name)
    return [sentence for sentence in sentences if sentence not in text]
