"""Texts as no program would write them: mutated, nested without end, with impossible numbers."""

from __future__ import annotations

import random
import re

from hypothesis import strategies as st

TOKENS = (
    "1e999", "-1e999", "nan", "NaN", "inf", "Infinity", "-Infinity", "1e308", "-0.0", "1e-400",
    "9" * 20, "9" * 400, "-" + "9" * 400, "9" * 5000, str(2**63), "0x10", "1_000", "true", "null",
    '""', '"\\u0000"', '"\\ud800"', '"\x1b[31m"', "[]", "{}", "", "\x00", "\x1b[2J", "\u202e",
    "[" * 60 + "]" * 60, "[" * 5000, "{" * 5000, '{"a":' * 900 + "1" + "}" * 900,
    "[" * 900 + "]" * 900, "a." * 400 + "a = 1", "1979-05-27T07:32:00Z", "\n", ",", ";", "\t",
)  # fmt: skip
"""What is put in the place of a number or a word, or between others."""


def mutant(text: str, seed: int, most: int = 4) -> str:
    """Return a text with some of its numbers and words replaced, and parts cut out or doubled."""
    draw = random.Random(seed)
    for _ in range(draw.randint(1, most)):
        found = list(re.finditer(r"-?[\d.]+(?:e[+-]?\d+)?|\w+", text)) or [None]
        place = draw.choice(found)
        start, end = place.span() if place else (0, 0)
        kind = draw.randrange(6)
        if kind < 3:
            text = text[:start] + draw.choice(TOKENS) + text[end:]
        elif kind == 3:
            text = text[:start] + draw.choice(TOKENS) + text[start:]
        elif kind == 4:
            text = text[:start] + text[start + draw.randint(1, 40) :]
        else:
            text = text[:end] + text[start : end + draw.randint(0, 200)] + text[end:]
    return text


def mutants(text: str) -> st.SearchStrategy[str]:
    """Draw mutants of a text."""
    return st.integers(0, 2**32).map(lambda seed: mutant(text, seed))
