"""Numbers, units and symbols as text; every value inside the package is in SI.

The model writes symbols and units in plain text as the paper does: ``m_B3``, ``I_XX^(B3)``,
``l_B4 = k l_B7``, ``kg m^2``. Here they become Unicode or HTML, and lengths become millimeters and
angles degrees.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import lru_cache
from html import escape
from typing import NamedTuple

NONE = "–"
"""Text for a missing number."""

TIE = "\u00a0"
"""A space at which lines do not break."""

MM = 1e3
"""Millimeters in a meter."""

UM = 1e6
"""Micrometers in a meter."""

DEGREES = 180 / math.pi
"""Degrees in a radian."""

ARCSEC = 3600 * DEGREES
"""Arc seconds in a radian."""

COLUMN_UNITS: dict[str, dict[str, float]] = {
    "s": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "m": {"m": 1.0, "mm": 1e-3},
    "rad": {"rad": 1.0, "deg": math.pi / 180},
    "rad/s": {"rad_per_s": 1.0, "rpm": math.pi / 30},
    "kg": {"kg": 1.0, "g": 1e-3},
    "kg m^2": {"kg_m2": 1.0, "kg_cm2": 1e-4, "g_cm2": 1e-7},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"Nm": 1.0, "mNm": 1e-3, "Ncm": 1e-2},
    "N m s/rad": {"Nm_s_per_rad": 1.0, "mNm_per_rpm": 1e-3 * 30 / math.pi},
    "A": {"A": 1.0, "mA": 1e-3},
}
"""Endings of the columns of tables by SI unit, that of the unit itself first, with the factor to
it."""

TYPED_UNITS: tuple[dict[str, float], ...] = (
    {"µm": 1e-6, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0},
    {"°": math.pi / 180, "deg": math.pi / 180, "rad": 1.0},
    {"g": 1e-3, "kg": 1.0},
)
"""Units that may be typed where another of the same kind is shown, with the factor to the SI unit:
on the page in number boxes and in the command palette."""

SAME = 1e-9
"""Share of a number that counts as rounding where it is rounded to one side."""

_LARGE = 1e5
"""From here on numbers are written with a power of ten."""

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
# A difference has its Δ before the letter, and a square its ² after the index.
_SYMBOL = re.compile(
    r"(?<![^\WΔ])([A-Za-zα-ω])_([A-Za-zα-ω]{0,4}\d{0,2})(?![^\W²³])(?:\^\((\w+)\))?"
)
_WORD = re.compile(r"(?:a|[a-z]{2,})(?:[’'][a-z]+)?(?:[ ,;:]|$)")  # no l_B3, log.csv, x = 5
_APOSTROPHE = re.compile(r"(?<=\w)'(?=[st]\b)")
# What a space stands between; it comes first in a pattern, so that a search finds it at once.
_BEFORE_UNIT = (
    r"(?:(?<=[\d∞] )|(?<=\d</b> ))"  # 7.5 mm
    r"(?=(?:%|[kM]?N|[µmd]?m|m?s|[mµ]?rad|[kµ]?g|M?Pa|W|J|Hz|A|rpm)(?![a-z]))"
    r"|(?:(?<=\b[xyzθκ] )|(?<=⌀ ))(?=[−\d])"  # z −5, ⌀ 3
)
_TORN = re.compile(rf" (?:{_BEFORE_UNIT}|(?<=[×≤≥=±] )(?=[−\d])|(?<=\S )(?=[≤≥=±×] ))")  # κ ≤ 10
_TORN_HTML = re.compile(rf" (?:{_BEFORE_UNIT})(?![^<>]*>)")  # in no tag


def number(value: float, digits: int = 4, *, sign: bool = False, padded: bool = False) -> str:
    """Return a number with at most ``digits`` significant digits and a true minus sign.

    Those from 10⁵ on and small ones get a power of ten, 1.2·10⁻¹³; NaN is a dash, and what has no
    bound is ∞. With ``sign``, positive numbers get a plus sign. With ``padded``, which suits
    columns, zeros at the end stay.
    """
    if math.isnan(value):
        return NONE
    if math.isinf(value):
        return ("+∞" if sign else "∞") if value > 0 else "−∞"
    text = _plain(value, digits, ("+" if sign else "") + ("#" if padded else ""))
    mantissa, e, exponent = text.partition("e")
    mantissa = mantissa.removesuffix(".")
    if e:
        return f"{mantissa.replace('-', '−')}·{power_of_ten(int(exponent))}"
    return "0" if value == 0 else mantissa.replace("-", "−")


def _plain(value: float, digits: int, flags: str = "") -> str:
    """Return a number with at most ``digits`` digits, below 10⁵ without an exponent: 6910."""
    text = f"{value:{flags}.{digits}g}"
    return f"{float(text):{flags}.0f}" if text[-4:] in ("e+02", "e+03", "e+04") else text


def read_number(text: str) -> float | None:
    """Return the number that a cell of a table holds, also NaN and infinite; None if it holds none.

    Python's float() also takes 1_000 and the digits of other scripts; a table must not.
    """
    try:
        return float(text) if text.isascii() and "_" not in text else None
    except ValueError:
        return None


def fixed(value: float, decimals: int, *, sign: bool = False) -> str:
    """Return a number with a fixed count of decimals, a true minus sign and no negative zero.

    NaN is a dash, and what has no bound is ∞. With ``sign``, which suits changes, positive numbers
    get a plus sign.
    """
    if not math.isfinite(value):
        return number(value, sign=sign)
    text = f"{value:{'+' if sign else ''}.{decimals}f}"
    if float(text) == 0:
        text = text.lstrip("+-")
    return text.replace("-", "−")


def rounded_to_side(value: float, digits: int, *, up: bool) -> float:
    """Return a number of few significant digits that is no smaller, or no larger, than a value.

    It is what a bound would have to be: rounded to the nearest, half of all would not do. A
    difference of `SAME` of the value is none.
    """
    nearest = float(f"{value:.{digits}g}")
    lacks = value - nearest if up else nearest - value
    if not lacks > SAME * abs(value):
        return nearest
    step = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return float(f"{nearest + (step if up else -step):.{digits}g}")


def power_of_ten(exponent: int) -> str:
    """Return a power of ten, such as 10⁻³."""
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def counted(count: int, noun: str, plural: str = "") -> str:
    """Return a count with its noun, ``1 row`` or ``3,000 rows``.

    Counts of things have commas between thousands, measured numbers have none. A plural without s
    has to be given.
    """
    return f"{count:,} {noun if count == 1 else plural or f'{noun}s'}"


def percent(
    share: float, decimals: int = 0, *, digits: int | None = None, sign: bool = False
) -> str:
    """Return a share in percent: ``12.5 %``; a dash for NaN.

    Args:
        share: The share.
        decimals: How many there are; large numbers get a power of ten as those of `number` do.
        digits: Significant digits at most, in place of decimals.
        sign: Whether positive numbers of significant digits get a plus sign.
    """
    value = 100 * share
    if math.isnan(value):
        return NONE
    if digits is None and abs(value) < _LARGE:
        return f"{fixed(value, decimals)} %"
    return f"{number(value, digits or 3, sign=sign)} %"


def percent_change(before: float, after: float) -> str:
    """Return a change as a percentage of the value before."""
    if not (math.isfinite(before) and math.isfinite(after)):
        return NONE
    if before == 0:
        return "new" if after else "0 %"
    percent = 100 * (after - before) / before
    if abs(percent) >= 1000:
        return f"×{number(after / before, 3)}"
    decimals = 1 if round(abs(percent), 1) < 100 else 0
    return f"{fixed(percent, decimals, sign=True)} %" if round(percent, decimals) else "≈ 0 %"


def capitalized(text: str) -> str:
    """Return a text with a capital letter.

    A symbol or the name of a file or of a value that it begins with stays as it is written.
    """
    return text[0].upper() + text[1:] if _WORD.match(text) else text


def as_sentence(text: str) -> str:
    """Return what an error says as a sentence: with a capital letter and a period.

    Errors are plain text, for terminals too; where people read sentences they have ’ as all texts.
    """
    text = _APOSTROPHE.sub("’", capitalized(text))
    return text if not text or text[-1] in ".!?…" else f"{text}."


def symbol_text(symbol: str) -> str:
    """Return a symbol in Unicode, for labels without markup.

    Digits become subscripts; letters stay on the line, as Unicode has no subscript for most of
    them: ``m_5`` gives ``m₅``, ``m_B3`` stays, ``I_XX^(B3)`` gives ``I_XX(B3)``.
    """
    text = re.sub(r"_(\d+)", lambda found: found[1].translate(_SUBSCRIPTS), symbol)
    return _with_dots(text.replace("^(", "("))


def symbol_html(symbol: str) -> str:
    """Return a symbol as escaped HTML with italics, subscripts and superscripts."""
    text = escape(_with_dots(symbol))
    text = re.sub(r"\b([A-Za-z])(?=_|\b)", r"<i>\1</i>", text)
    text = re.sub(r"_([A-Za-z0-9]+)", r"<sub>\1</sub>", text)
    return re.sub(r"\^\(([^)]*)\)", r"<sup>(\1)</sup>", text)


def symbols_html(text: str) -> str:
    """Return a sentence as escaped HTML, with the symbols in it such as ``M_p2`` typeset."""

    def typeset(found: re.Match[str]) -> str:
        letter, below, above = found.groups()
        raised = f"<sup>({above})</sup>" if above else ""
        return f"<i>{letter}</i><sub>{below}</sub>{raised}" if below else found[0]

    if len(text) == 1 and text.isalpha():
        return f"<i>{escape(text)}</i>"
    return _SYMBOL.sub(typeset, escape(_with_dots(text)))


def tied(text: str) -> str:
    """Return a sentence in which no line ends between a number and its unit, sign or symbol."""
    return _TORN.sub(TIE, text)


def tied_html(html: str) -> str:
    """Return HTML in whose texts no line ends between a number and its unit or symbol.

    Lines may end at signs such as ≤: columns of tables are narrow. Tags stay as they are.
    """
    return _TORN_HTML.sub(TIE, html)


def _with_dots(text: str) -> str:
    """Return a text with a sign between the factors of ``k l_B7``."""
    return re.sub(r"\bk (?=l_)", "k·", text)


def symbols_math(text: str) -> str:
    """Return a text with the indices of its symbols as matplotlib writes them in math text."""

    def typeset(found: re.Match[str]) -> str:
        letter, below, above = found.groups()
        raised = f"^\\mathregular{{({above})}}" if above else ""
        return f"{letter}$_\\mathregular{{{below}}}{raised}$" if below else found[0]

    return _SYMBOL.sub(typeset, text.replace("$", r"\$"))


def unit_text(unit: str) -> str:
    """Return an SI unit in Unicode: ``kg m^2`` gives ``kg·m²``; ``1`` and ``""`` give ``""``."""
    if unit == "1":
        return ""
    raised = re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_SUPERSCRIPTS), unit)
    return re.sub(r"(?<=\w) (?=\w)|(?<=[²³]) ", "·", raised)


class DisplayUnit(NamedTuple):
    """The unit that an SI value is shown in.

    Attributes:
        factor: From SI to the displayed number.
        text: The unit, empty for pure numbers.
    """

    factor: float
    text: str

    def from_si(self, value: float) -> float:
        """Return an SI value as the displayed number, without the rounding error of the factor."""
        return float(value) if self.factor == 1 else round(value * self.factor, 9)

    def to_si(self, number: float) -> float:
        """Return a displayed number as an SI value, without the rounding error of the factor."""
        decimals = 12 if self.factor <= MM else 24
        return number if self.factor == 1 else round(number / self.factor, decimals)

    def format(
        self, value: float, digits: int = 4, *, ascii_only: bool = False, up: bool | None = None
    ) -> str:
        """Return an SI value with its unit: ``363.5 mm``, ``30°``; a dash for NaN.

        With ``ascii_only`` the number is one that every terminal and program reads: ``-1e-13``.
        A limit to follow is rounded up, or down (`rounded_to_side`); all else to the nearest.
        """
        shown = value * self.factor
        if up is not None:
            shown = rounded_to_side(shown, digits, up=up)
        text = _plain(shown, digits) if ascii_only else number(shown, digits)
        space = "" if self.text.startswith(("°", "″")) else " "
        return NONE if math.isnan(value) else f"{text}{space}{self.text}".rstrip()


_SCALED = {
    "m^2": DisplayUnit(MM**2, "mm²"),
    "m^4": DisplayUnit(MM**4, "mm⁴"),
    "Pa": DisplayUnit(1 / MM**2, "MPa"),
    "N/m": DisplayUnit(1 / MM, "N/mm"),
}
"""Units of elastic data."""


SHOWN_IN = {
    "m:um": DisplayUnit(UM, "µm"), "rad:arcsec": DisplayUnit(ARCSEC, "″"),
    "rad:mrad": DisplayUnit(1e3, "mrad"), "rad/s:rpm": DisplayUnit(30 / math.pi, "rpm"),
    "1:%": DisplayUnit(100.0, "%"),
}  # fmt: skip
"""SI units with another to show them in."""


def si_unit(unit: str) -> str:
    """Return an SI unit without the one it is shown in: ``"m:um"`` gives ``"m"``."""
    return unit.partition(":")[0]


@lru_cache
def display_unit(unit: str) -> DisplayUnit:
    """Return the unit that shows an SI unit: mm for m, mm² for m², degrees for rad, MPa for Pa.

    Angular rates are in degrees as well; speeds and accelerations stay in meters, as drives and
    limits are rated. An SI unit may name the one to show it in after a colon: ``"m:um"``,
    ``"rad:arcsec"`` and ``"rad:mrad"`` are small lengths and angles, ``"rad/s:rpm"`` is the speed
    of a motor, ``"1:%"`` is a share.
    """
    if ":" in unit:
        return SHOWN_IN[unit]
    if unit == "m":
        return DisplayUnit(MM, "mm")
    if unit in _SCALED:
        return _SCALED[unit]
    if unit == "rad" or re.fullmatch(r"rad/s(\^?[2²])?", unit):
        return DisplayUnit(DEGREES, unit_text(unit).replace("rad", "°"))
    return DisplayUnit(1.0, unit_text(unit))


def readable_unit(
    unit: str, largest: float, *, lowest: int = -300, bound: float = math.inf
) -> DisplayUnit:
    """Return the display unit of an SI unit, with a power of ten for very small or large values.

    Args:
        unit: SI unit.
        largest: Size of the largest value, in that unit.
        lowest: Lowest power of ten.
        bound: Displayed values from this on get a power of ten too.
    """
    plain = display_unit(unit)
    size = largest * plain.factor
    if not size or 1e-2 <= size < bound:
        return plain
    power = max(3 * math.floor(math.log10(size) / 3), lowest)
    return DisplayUnit(plain.factor * 10.0**-power, f"{power_of_ten(power)} {plain.text}".rstrip())


def format_value(value: float, unit: str, digits: int = 4, *, up: bool | None = None) -> str:
    """Return a value of an SI unit with its display unit; a dash for NaN.

    With ``up`` it is rounded to that side, as `DisplayUnit.format` says.
    """
    return display_unit(unit).format(value, digits, up=up)


def format_ascii(value: float, unit: str, digits: int = 4, *, up: bool | None = None) -> str:
    """Return the same with an ASCII number, for terminals, tables and messages."""
    return display_unit(unit).format(value, digits, ascii_only=True, up=up)


def format_pose(pose: Iterable[float], digits: int = 4, *, ascii_only: bool = False) -> str:
    """Return a pose [m, m, rad, m] for people: ``x 30 mm, y 0 mm, θ 60°, z −480 mm``.

    What is below 1e-9 is a rounding error. With ``ascii_only`` as `format_ascii` writes.
    """
    write = format_ascii if ascii_only else format_value
    x, y, theta, z = (round(float(value), 9) + 0.0 for value in pose)
    place = f"x {write(x, 'm', digits)}, y {write(y, 'm', digits)}"
    heading = "theta" if ascii_only else "θ"
    return f"{place}, {heading} {write(theta, 'rad', digits)}, z {write(z, 'm', digits)}"


def interval_text(value: float, half_width: float, *, ascii_only: bool = False) -> str:
    """Return a value and half of its interval, with two digits of the latter: 25.835 ± 0.050.

    The decimals of the value follow from the interval. Without a finite interval it is a dash.
    """
    if not (math.isfinite(value) and math.isfinite(half_width)):
        return "-" if ascii_only else NONE
    if half_width <= 0.0:
        return number(value) if not ascii_only else f"{value:.4g}"
    place = 1 - math.floor(math.log10(half_width))
    decimals = max(0, place)
    if decimals > 9 or max(abs(value), half_width) >= 1e9:
        first = math.floor(math.log10(abs(value) or half_width))
        digits = min(max(1, first + place + 1), 4)  # none beyond those of the interval
        if ascii_only:
            return f"{value:.{digits}g} +- {half_width:.2g}"
        return f"{number(value, digits)} ± {number(half_width, 2)}"
    if ascii_only:
        return f"{value:.{decimals}f} +- {half_width:.{decimals}f}"
    return f"{fixed(value, decimals)} ± {fixed(half_width, decimals)}"
