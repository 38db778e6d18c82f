"""What is typed into the command palette as a whole: values to set, maps to show, pins.

``m7 3.063`` sets a number of the design, ``x 50 mm`` moves the robot, ``map stiffness z`` shows a
map, ``pin clearance`` and ``pin m7`` put a number into the strip or take it off. One command of
the palette says what the text would do, and does it. The name of a section, or its beginning, makes
the command that opens it the first one.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import viser

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.pins.tab import name_of, pin
from paminsa_viz.explorer.kit.bindings import perform
from paminsa_viz.explorer.kit.design_numbers import DIGITS, set_value
from paminsa_viz.explorer.kit.entries import Effect, Then
from paminsa_viz.explorer.state.pins import IMBALANCE
from paminsa_viz.model import PARAMETERS
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.units import TYPED_UNITS, DisplayUnit, display_unit, symbol_text

SHORTEST = 3
"""Letters from which on a name is known by its beginning."""

LONGEST = 100
"""Characters that are read of a text."""

HELP = "Set a value, show a map, or pin a number"
EXAMPLES = "m7 3.063; R_b 370 mm; theta 60; map stiffness z; pin clearance"

_VALUE = re.compile(
    r"(?P<name>\S.*?)\s*(?:=|\s)\s*(?P<number>[+\-\u2212]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?)"
    r"\s*(?P<unit>[^\d\s].*)?",
    re.IGNORECASE,
)
_AMBIGUOUS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_WORD = re.compile(r"\w+")
_GREEK = {"theta": "θ", "kappa": "κ", "tau": "τ"}


@dataclass(frozen=True)
class Typed:
    """What a text means.

    Attributes:
        label: What it would do, or why it does nothing.
        effect: Does it; None if it does nothing.
    """

    label: str
    effect: Effect | None = None


def _plain(name: str) -> str:
    """Return a symbol as it may be typed: the case of its first letter counts."""
    bare = re.sub(r"[^\w]|_", "", name)
    return bare[:1] + bare[1:].casefold()


@dataclass(frozen=True)
class _Target:
    """A number that can be set, with its unit and the parameter or coordinate that it is."""

    symbol: str
    unit: DisplayUnit
    path: str
    is_pose: bool = False

    def effect(self, value: float) -> Effect:
        """Return what sets it [SI]."""
        if self.is_pose:
            return partial(actions.move, **{self.path: value})
        return partial(
            set_value, value=value, path=self.path, name=self.symbol, unit=self.unit
        )  # fmt: skip


@cache
def _targets() -> dict[str, _Target]:
    found: dict[str, _Target] = {}
    for parameter in PARAMETERS:
        target = _Target(symbol_text(parameter.symbol), parameter.display, parameter.path)
        names = parameter.symbol.split("=") if "k l_" not in parameter.symbol else [
            parameter.symbol.partition("=")[0]
        ]  # fmt: skip
        found |= {_plain(name): target for name in names}
    symbols = dict(zip(COORDINATES, ("x", "y", "θ", "z"), strict=True))
    for name, symbol in symbols.items():
        unit = display_unit("rad" if name == "theta" else "m")
        found |= dict.fromkeys((name, symbol), _Target(symbol, unit, name, is_pose=True))
    return found


def _scale(typed: str | None, unit: DisplayUnit) -> float | None:
    """Return how many of a unit one of the unit typed is, None if it is of another kind."""

    def plain(text: str) -> str:
        bare = re.sub(r"[\s·*^]", "", text).translate(str.maketrans("²³", "23"))
        return "°" if bare in ("deg", "degrees") else bare

    if typed is None or plain(typed) == plain(unit.text):
        return 1.0
    kind = next((each for each in TYPED_UNITS if unit.text in each), {})
    return kind[plain(typed)] / kind[unit.text] if plain(typed) in kind else None


def _value(text: str) -> Typed | None:
    """Return what a symbol with a number means, or None if the text is none."""
    found = _VALUE.fullmatch(text)
    target = None if found is None else _targets().get(_plain(found["name"]))
    if found is None or target is None:
        return None
    if _AMBIGUOUS.fullmatch(found["number"]):
        return Typed(f"{found['number']} may be a thousand or a fraction: write it with a point")
    scale = _scale(found["unit"], target.unit)
    if scale is None:
        unit = f"in {target.unit.text}" if target.unit.text else "without a unit"
        return Typed(f"{target.symbol} is set {unit}, not in {found['unit'].strip()}")
    number = found["number"].replace("\u2212", "-").replace(",", ".")
    if not math.isfinite(float(number)):
        return Typed(f"{target.symbol} needs a finite number")
    value = target.unit.to_si(float(number) * scale)
    return Typed(
        f"Set {target.symbol} to {target.unit.format(value, DIGITS)}", target.effect(value)
    )


def _quantity(text: str) -> str | None:
    """Return the key of the quantity that words name, or None if there is none."""
    words = [_GREEK.get(word, word) for word in _WORD.findall(text.casefold())]
    if not words:
        return None

    def misses(label: str) -> int:
        """Return how many words a label has besides those that are typed, -1 if one is missing."""
        there = _WORD.findall(label.casefold())
        missing = any(not any(each.startswith(word) for each in there) for word in words)
        return -1 if missing else len(there) - len(words)

    for texts in ("label", "title"):
        scores = {key: misses(getattr(one, texts)) for key, one in QUANTITIES.items()}
        found = [key for key, score in scores.items() if score >= 0]
        if found:
            return min(found, key=scores.__getitem__)
    return None


def _map(name: str) -> Typed | None:
    """Return what shows the map of a quantity, or None if there is none of that name."""
    key = _quantity(name)
    if key is None:
        return None
    effect = Then(partial(choose_quantity, quantity=key), opens="Single map")
    return Typed(f"Show the map: {QUANTITIES[key].label}", effect)


def _pin(name: str) -> Typed | None:
    """Return what pins a number of the design or a quantity, or None if there is none."""
    target = _targets().get(_plain(name))
    if target is not None:
        # The strip has the pose in any case.
        effect = None if target.is_pose else partial(pin, key=target.path)
        return effect and Typed(f"Pin {target.symbol}, or take it off", effect)
    key = IMBALANCE if _plain(name) == _plain(IMBALANCE) else _quantity(name)
    if key is None:
        return None
    return Typed(f"Pin {name_of(key)[0]}, or take it off", partial(pin, key=key))


_DO: dict[str, Callable[[str], Typed | None]] = {"map": _map, "pin": _pin}
"""What the first word of a text says to do with what the others name."""


def meaning(text: str) -> Typed | None:
    """Return what a text in the palette means as a whole, or None if it is a search."""
    plain = text.strip()
    if not _WORD.search(plain) or len(plain) > LONGEST:
        return None
    first, _, name = plain.partition(" ")
    does = _DO.get(first.casefold())
    return (does and name and does(name)) or _value(plain)


def named(text: str, names: Iterable[str]) -> str | None:
    """Return the name that a text is, or the only one that it begins, or None."""
    plain = text.strip().casefold()
    begun = [name for name in names if name.casefold().startswith(plain)]
    exact = [name for name in begun if len(name) == len(plain)]
    found = exact or begun
    return found[0] if len(plain) >= SHORTEST and len(found) == 1 else None


class TypedCommand:
    """The command of the palette that follows what is typed into it.

    Args:
        session: The tab of the browser.
        names: Other commands by their names: the one that is named becomes the first line.
    """

    def __init__(self, session: Session, names: Mapping[str, viser.CommandHandle]) -> None:
        self._session, self._text = session, ""
        self._handle = session.client.gui.add_command(HELP, description=EXAMPLES)
        self._handle.on_trigger(self._trigger)
        self._names = names
        self._words = {name: handle.description for name, handle in names.items()}
        self._named: str | None = None
        session.bridge.on("typed", self._hear)

    def _hear(self, data: Any) -> None:
        if not isinstance(data, str):
            return
        self._text = data
        found = meaning(data)
        # The palette finds the command by its description, which is therefore the very text.
        label, description = (HELP, EXAMPLES) if found is None else (found.label, data.strip())
        if self._handle.label != label or self._handle.description != description:
            self._handle.label, self._handle.description = label, description
        first = "" if found is None else label
        name = None if found is not None else named(data, self._names)
        if self._named not in (None, name):
            self._names[self._named].description = self._words[self._named]
        if name is not None:
            first = self._names[name].label
            self._names[name].description = data.strip()
        self._named = name
        self._session.bridge.call("answerTyped", data, first)

    async def _trigger(self, event: Any) -> None:
        # By the newest text: what the palette shows may be a key press behind.
        del event
        found = meaning(self._text)
        if found is None or found.effect is None:
            reason = f"Write such as {EXAMPLES}." if found is None else f"{found.label}."
            self._session.notify("Nothing was set", reason)
            return
        perform(self._session, "typed", found.effect)
