"""Measuring and wrapping words for matplotlib, in mm, before anything is drawn."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from typing import TypeVar

from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.textpath import text_to_path

_POINT = 25.4 / 72  # mm

Item = TypeVar("Item")


def in_rows(
    items: Iterable[Item], widths: Iterable[float], gap: float, width: float
) -> list[list[Item]]:
    """Break items of some widths, with gaps between them, into rows no wider than ``width``."""
    rows: list[list[Item]] = []
    used = 0.0
    for item, wide in zip(items, widths, strict=True):
        if rows and used + gap + wide <= width:
            rows[-1].append(item)
            used += gap + wide
        else:
            rows.append([item])
            used = wide
    return rows


class TextMetrics:
    """DejaVu Sans, which comes with matplotlib, at one size.

    Attributes:
        size: Size [points].
        line: Distance of two lines of text [mm].
    """

    def __init__(self, size: float, weight: str = "normal") -> None:
        self.size = size
        self.line = 1.25 * size * _POINT
        self._font = FontProperties(family="DejaVu Sans", size=size, weight=weight)

    def width(self, words: str) -> float:
        """Return how wide words are [mm]."""
        return text_to_path.get_text_width_height_descent(words, self._font, False)[0] * _POINT

    def plain(self, words: str) -> str:
        """Return words on one line, with what the font cannot write replaced by ``?``."""
        font = get_font(findfont(self._font))
        line = " ".join(word for row in words.splitlines() for word in row.split(" ") if word)
        return "".join(c if font.get_char_index(ord(c)) else "?" for c in line)

    def wrapped(self, words: str, width: float) -> list[str]:
        """Break words into lines no wider than ``width`` [mm]; a longer word is cut."""
        pieces = [piece for w in self.plain(words).split(" ") for piece in self._cut(w, width)]
        rows = in_rows(pieces, map(self.width, pieces), self.width(" "), width)
        return [" ".join(row) for row in rows]

    def _cut(self, word: str, width: float) -> list[str]:
        """Cut a word into pieces of at most ``width`` [mm]."""
        pieces: list[str] = []
        while len(word) > 1 and self.width(word) > width:
            fits = bisect_right(range(1, len(word)), width, key=lambda n: self.width(word[:n]))
            pieces.append(word[: max(1, fits)])
            word = word[max(1, fits) :]
        return [*pieces, word] if word else pieces
