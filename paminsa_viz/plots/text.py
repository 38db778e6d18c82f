"""Text that matplotlib is to write: measured, broken into lines, and limited to what it can write.

The font is DejaVu Sans, which comes with matplotlib.
"""

from __future__ import annotations

from bisect import bisect_right
from functools import lru_cache
from typing import Literal

from matplotlib import font_manager
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.textpath import text_to_path

Weight = Literal["normal", "bold"]


@lru_cache(maxsize=5000)  # captions differ by a few words
def text_width(text: str, size: float, weight: Weight = "normal") -> float:
    """Return how wide a text of some size is, in the unit of the size."""
    font = FontProperties(family="DejaVu Sans", size=size, weight=weight)
    return text_to_path.get_text_width_height_descent(text, font, False)[0]


def printable(text: str) -> str:
    """Return a text on one line, with characters that the font lacks replaced by ``?``."""
    known = _characters()
    line = " ".join(word for row in text.splitlines() for word in row.split(" ") if word)
    return "".join(c if ord(c) in known else "?" for c in line)


def wrapped(text: str, size: float, width: float, weight: Weight = "normal") -> list[str]:
    """Break a text into lines no wider than ``width``, in the unit of ``size``.

    A word that is wider is cut.
    """
    lines: list[str] = []
    for word in printable(text).split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, size, weight) <= width:
            lines[-1] = longer
            continue
        while len(word) > 1 and text_width(word, size, weight) > width:
            fitting = range(1, len(word))
            count = bisect_right(fitting, width, key=lambda n: text_width(word[:n], size, weight))
            lines.append(word[: max(1, count)])
            word = word[max(1, count) :]
        if word:
            lines.append(word)
    return lines


def close_fonts() -> None:
    """Close the files of fonts, which matplotlib keeps open for each thread that has drawn.

    Fonts in use stay open, and are opened again where they are needed next.
    """
    kept = getattr(font_manager, "_get_font", None)  # there is no public way
    if kept is not None:
        kept.cache_clear()


@lru_cache(maxsize=1)
def _characters() -> frozenset[int]:
    return frozenset(get_font(findfont(FontProperties(family="DejaVu Sans"))).get_charmap())
