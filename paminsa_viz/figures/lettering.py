"""Measuring and wrapping words for matplotlib, in mm, before anything is drawn."""

from __future__ import annotations

from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.textpath import text_to_path

_POINT = 25.4 / 72  # mm


class Lettering:
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
        """Return words on one line, with what the font can not write replaced by ``?``."""
        font = get_font(findfont(self._font))
        line = " ".join(word for row in words.splitlines() for word in row.split(" ") if word)
        return "".join(c if font.get_char_index(ord(c)) else "?" for c in line)

    def wrapped(self, words: str, width: float) -> list[str]:
        """Break words into lines no wider than ``width`` [mm]; a longer word is cut."""
        rows: list[str] = []
        row = ""
        for word in self.plain(words).split(" "):
            longer = f"{row} {word}" if row else word
            if self.width(longer) <= width:
                row = longer
                continue
            if row:
                rows.append(row)
            while self.width(word) > width and len(word) > 1:
                cut = len(word) - 1
                while cut > 1 and self.width(word[:cut]) > width:
                    cut -= 1
                rows.append(word[:cut])
                word = word[cut:]
            row = word
        return [*rows, row] if row else rows
