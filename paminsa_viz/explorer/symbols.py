"""How a design's numbers look to a person: symbols, units, and the step from SI to millimeters.

The model's symbols are the paper's, in plain text: ``m_B3``, ``I_XX^(B3)``, ``l_B4 = k l_B7``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from html import escape

from paminsa_viz.model import PARAMETER

_LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def plain(symbol: str) -> str:
    """Return a symbol for a label without markup.

    Figures are lowered, letters stay on the line, where Unicode has no lowered form for most of
    them: ``m_5`` gives ``m₅``, ``m_B3`` stays, ``I_XX^(B3)`` gives ``I_XX(B3)``.
    """
    text = re.sub(r"_(\d+)", lambda found: found[1].translate(_LOWERED), symbol)
    return text.replace("^(", "(").replace("k l_", "k·l_")


def html(symbol: str) -> str:
    """Return a symbol with italics, subscripts and superscripts, escaped for a page."""
    text = escape(symbol).replace("k l_", "k·l_")
    text = re.sub(r"\b([A-Za-z])(?=_|\b)", r"<i>\1</i>", text)
    text = re.sub(r"_([A-Za-z0-9]+)", r"<sub>\1</sub>", text)
    return re.sub(r"\^\(([^)]*)\)", r"<sup>(\1)</sup>", text)


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: ``"kg m^2"`` gives ``"kg·m²"``."""
    raised = re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_RAISED), unit)
    return re.sub(r"(?<=\w) (?=\w)|(?<=[²³]) ", "·", raised)


def number(value: float, digits: int = 6) -> str:
    """Write a number shortly, with a true minus sign: at most ``digits`` significant figures."""
    text = f"{value:.{digits}g}"
    if "e" in text:
        mantissa, _, exponent = text.partition("e")
        return f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}".replace("-", "−")
    return "0" if float(text) == 0 else text.replace("-", "−")


def change_text(before: float, after: float) -> str:
    """Write a change as a percentage of where it started."""
    if before == 0:
        return "new" if after else "0 %"
    percent = 100 * (after - before) / before
    if abs(percent) >= 1000:
        return f"×{number(after / before, 3)}"
    text = f"{percent:+.1f}" if abs(percent) < 100 else f"{percent:+.0f}"
    return f"{text.replace('-', '−')} %" if float(text) else "≈ 0 %"


@dataclass(frozen=True)
class DisplayUnit:
    """How one number of a design is shown.

    Attributes:
        symbol: The paper's symbol, for a label without markup.
        unit: Unit that a person sees.
        factor: From SI to that unit.
    """

    symbol: str
    unit: str
    factor: float

    def shown(self, value: float) -> float:
        """Return a value in SI as a person sees it."""
        return round(value * self.factor, 9)

    def inside(self, number: float) -> float:
        """Return a number that a person set in SI, without the dust of the division."""
        return number if self.factor == 1 else round(number / self.factor, 12)

    def text(self, value: float) -> str:
        """Return a value in SI with its unit, as a person reads it."""
        return f"{number(self.shown(value))} {self.unit}".rstrip()


@cache
def edge(path: str) -> DisplayUnit:
    """Return how the number at a dotted path is shown: lengths in mm, the rest in SI."""
    parameter = PARAMETER[path]
    symbol = plain(parameter.symbol)
    if parameter.unit == "m":
        return DisplayUnit(symbol, "mm", 1e3)
    return DisplayUnit(symbol, unit_text(parameter.unit), 1.0)


def fixed(value: float, decimals: int) -> str:
    """Write a number with a fixed count of decimals, a true minus sign and no negative zero."""
    text = f"{value:.{decimals}f}"
    if float(text) == 0:
        text = text.lstrip("-")
    return text.replace("-", "−")
