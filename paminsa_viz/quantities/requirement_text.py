"""Requirements as text: ``condition <= 10``, ``|tau_1| <= 15 N m``, ``error_x <= 100 um``.

The grammar is ``[low <=] quantity [<= high] [unit] [for theta A..B deg, z A..B mm]``, with ``>=``
as well, ``|quantity|`` for a bound on the magnitude, and the units in which a quantity is shown.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import NoReturn

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.registry import QUANTITIES
from paminsa_viz.quantities.requirements import (
    Range,
    Requirement,
    Requirements,
    Workspace,
)
from paminsa_viz.units import MM, DisplayUnit, display_unit, format_value, number

LONGEST = 300
"""Longest text [characters]."""

EXAMPLE = "condition <= 10"

RequirementText = Callable[[Requirement], str]
"""A requirement as text: a label with symbols, or what `parse_requirement` reads."""

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
_SIGN = r"(?:<=|>=|≤|≥|<|>)"
_FORM = re.compile(
    rf"(?:(?P<first>{_NUMBER})\s*(?P<first_unit>[^<>=≤≥|]*?)\s*(?P<first_sign>{_SIGN})\s*)?"
    rf"(?P<name>\|\s*[\w-]+\s*\||[\w-]+)"
    rf"(?:\s*(?P<sign>{_SIGN})\s*(?P<bound>{_NUMBER})\s*(?P<unit>[^<>=≤≥|]*?))?",
    re.IGNORECASE,
)
_RANGE = re.compile(
    rf"(?P<name>theta|θ|z)\s*=?\s*(?P<low>{_NUMBER})\s*(?:\.\.|to)\s*(?P<high>{_NUMBER})"
    r"\s*(?P<unit>[^,\d]*)",
    re.IGNORECASE,
)


@kinds_checked
def parse_requirement(text: str) -> Requirement:
    """Return the requirement that a text describes.

    Numbers are in the unit in which the quantity is shown, which may follow them; ranges of theta
    are in degrees, of z in millimeters.

    Raises:
        InvalidInput: If the text is no requirement; says what is wrong and shows one.
    """
    if len(text) > LONGEST:
        _refuse("requirement", f"at most {LONGEST} characters are possible")
    body, word, rest = _partition(text)
    found = _FORM.fullmatch(body.strip())
    if found is None or not (found["first"] or found["bound"]):
        _refuse(text, f"a quantity and a bound are needed, as in {EXAMPLE!r}")
    name = found["name"]
    magnitude = name.startswith("|")
    entry = _quantity(name.strip("| \t"))
    low = high = None
    for value, unit, sign, before in (
        (found["first"], found["first_unit"], found["first_sign"], True),
        (found["bound"], found["unit"], found["sign"], False),
    ):
        if value is None:
            continue
        bound = _number(text, value, unit, entry)
        largest = (sign[0] in "<≤") != before
        if (high if largest else low) is not None:
            _refuse(text, "both signs bound the same side")
        low, high = (low, bound) if largest else (bound, high)
    if magnitude:
        if low is not None or high is None or high < 0.0:
            _refuse(text, f"a magnitude has one bound, not below 0, as in '|{entry.key}| <= 1'")
        low = -high
    ranges = _ranges(text, rest) if word else {}
    return Requirement(entry.key, low, high, ranges.get("theta"), ranges.get("z"))


def requirement_text(requirement: Requirement) -> str:
    """Return a requirement as ASCII text that `parse_requirement` reads back."""
    unit = requirement.entry.display
    suffix = f" {ascii_unit(unit)}" if unit.text else ""

    def shown(value: float) -> str:
        return f"{unit.from_si(value):.10g}"

    text = _bounds_text(requirement, requirement.entry.key, shown, lambda v: shown(v) + suffix)
    return text + _ranges_text(requirement, "theta", "deg", ascii_only=True)


def requirement_label(requirement: Requirement) -> str:
    """Return a requirement for people, with symbols: ``|τ₁| ≤ 15 N·m``, ``κ ≤ 10``."""
    unit = requirement.entry.display

    def shown(value: float) -> str:
        return number(value * unit.factor)

    text = _bounds_text(requirement, requirement.entry.symbol, shown, unit.format)
    text = text.replace("<=", "≤").replace(">=", "≥")
    return text + ranges_label(requirement)


def ranges_label(requirement: Requirement) -> str:
    """Return the ranges of its own that a requirement has, for people: `` for θ 0..30°``."""
    return _ranges_text(requirement, "θ", "°", ascii_only=False)


def _bounds_text(
    requirement: Requirement,
    name: str,
    shown: Callable[[float], str],
    with_unit: Callable[[float], str],
) -> str:
    low, high = requirement.low, requirement.high
    if high is None:
        return f"{name} >= {with_unit(math.nan if low is None else low)}"
    if low is None:
        return f"{name} <= {with_unit(high)}"
    if low == -high:
        return f"|{name}| <= {with_unit(high)}"
    return f"{shown(low)} <= {name} <= {with_unit(high)}"


def ascii_unit(unit: DisplayUnit) -> str:
    """Return the text of a unit with ASCII characters alone: ``um``, ``deg``, ``N m``."""
    for place, plain in _ASCII.items():
        if unit.text == place:
            return plain
    text = unit.text.translate(_PLAIN).replace("°", "deg")
    return re.sub(r"(?<=[a-z])(?=-?\d)", "^", text)


_ASCII = {"″": "arcsec", "µm": "um"}
_PLAIN = str.maketrans("·²³⁴⁻", " 234-")


def _ranges_text(requirement: Requirement, theta: str, degrees: str, *, ascii_only: bool) -> str:
    parts = []
    for name, limits, unit, label in (
        (theta, requirement.theta, display_unit("rad"), degrees),
        ("z", requirement.z, display_unit("m"), "mm"),
    ):
        if limits is not None:
            ends = [
                f"{unit.from_si(end):.10g}" if ascii_only else number(end * unit.factor)
                for end in limits
            ]
            space = "" if label == "°" else " "
            parts.append(f"{name} {ends[0]}..{ends[1]}{space}{label}")
    return f" for {', '.join(parts)}" if parts else ""


def _partition(text: str) -> tuple[str, str, str]:
    parts = re.split(r"\s+for\s+", text, maxsplit=1, flags=re.IGNORECASE)
    return (parts[0], "for", parts[1]) if len(parts) > 1 else (text, "", "")


def _quantity(name: str) -> Quantity:
    key = name.lower().replace("-", "_")
    if key in QUANTITIES:
        return QUANTITIES[key]
    for entry in QUANTITIES.values():
        if name.replace(" ", "") == entry.symbol.replace(" ", ""):
            return entry
    hint = name_hint(key, QUANTITIES)
    raise InvalidInput("requirement", f"there is no quantity {name[:40]!r}; {hint}")


def _number(text: str, value: str, unit: str | None, entry: Quantity) -> float:
    own = entry.display
    given = _plain(unit or "")
    if re.match(r",\d", given):
        _refuse(text, f"decimals follow a point, not a comma: {value}{given.replace(',', '.', 1)}")
    if given and given not in (_plain(ascii_unit(own)), _plain(own.text)):
        needed = ascii_unit(own) or "no unit"
        _refuse(text, f"{entry.key} is given in {needed}, not in {(unit or '')[:20]!r}")
    found = own.to_si(float(value))
    if not math.isfinite(found):
        _refuse(text, f"a finite number is needed, not {value[:20]}")
    return found


def _plain(unit: str) -> str:
    plain = unit.strip().replace("μ", "µ").replace("°", "deg").replace("″", "arcsec")
    return re.sub(r"[\s·*^]", "", plain.translate(_PLAIN))


def _ranges(text: str, rest: str) -> dict[str, Range]:
    found: dict[str, Range] = {}
    for part in rest.split(","):
        match = _RANGE.fullmatch(part.strip())
        if match is None:
            _refuse(text, f"{part.strip()[:40]!r} is no range; 'theta -30..30' or 'z -900..-500'")
        name = "z" if match["name"].lower() == "z" else "theta"
        unit, allowed = (
            (display_unit("m"), ("", "mm")) if name == "z" else (display_unit("rad"), ("", "deg"))
        )
        if _plain(match["unit"]) not in allowed:
            _refuse(text, f"a range of {name} is in {allowed[1]}")
        ends = unit.to_si(float(match["low"])), unit.to_si(float(match["high"]))
        if name in found or not all(map(math.isfinite, ends)) or ends[0] > ends[1]:
            _refuse(text, f"one range of {name}, least and largest, is possible")
        found[name] = ends
    return found


def _refuse(text: str, problem: str) -> NoReturn:
    raise InvalidInput(f"requirement {text[:60]!r}", problem)


def shape_text(workspace: Workspace) -> str:
    """Return the shape and sizes of a workspace for people: ``cylinder ⌀ 300 × 400 mm``."""
    x, y, z = (number(MM * extent) for extent in workspace.size)
    return f"{workspace.shape.section.text(x, y, z)} mm"


def headings_text(requirements: Requirements, digits: int = 4) -> str:
    """Return the headings that are required: ``θ −30° to 30°``, or ``θ 0°`` for one alone."""
    return f"θ {' to '.join(heading_ends(requirements, digits))}"


def heading_ends(requirements: Requirements, digits: int = 4) -> list[str]:
    """Return the ends of the range of headings, or the only one."""
    return list(dict.fromkeys(format_value(end, "rad", digits) for end in requirements.theta))


def workspace_text(workspace: Workspace) -> str:
    """Return a workspace for people: shape, sizes and center."""
    places = zip("xyz", workspace.center, strict=True)
    center = [
        f"{name} {'free' if place is None else format_value(place, 'm')}" for name, place in places
    ]
    return f"{shape_text(workspace)} about {', '.join(center)}"


def worst_text(value: float, bound: Requirement | None) -> str:
    """Return a worst value, rounded toward the end of a bound that it is nearest to, or beyond.

    So it never reads as better than it is. Without a bound it is the least distance to a limit.
    """
    if bound is None:
        return format_value(value, "m", up=False)
    low = -math.inf if bound.low is None else bound.low
    high = math.inf if bound.high is None else bound.high
    return format_value(value, bound.entry.unit, up=high - value < value - low)
