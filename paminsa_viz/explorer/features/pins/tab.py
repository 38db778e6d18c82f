"""Pins: what is pinned, its row in the strip, and the message that pins."""

from __future__ import annotations

import math
from functools import partial
from typing import Any, Final

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.pins.values import can_wait, find_values, wanted
from paminsa_viz.explorer.kit.entries import Entry, Message
from paminsa_viz.explorer.kit.robot_texts import margin_level, margin_share
from paminsa_viz.explorer.kit.task import Follower
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.pins import IMBALANCE, MOST_PINS, PinValue, can_be_pinned
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PARAMETER, InvalidInput
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.units import DisplayUnit, display_unit, number

DIGITS: Final = 3
"""Of the numbers in the strip."""

FOLLOWER: Final = Follower(
    Place(lambda state: state.pins.outcome), wanted, find_values, idle=can_wait
)
"""Finds what the pinned numbers are where the robot is."""


def pin(state: State, key: str) -> State:
    """Pin a number to the strip, or take it off.

    Raises:
        InvalidInput: If there are too many.
    """
    keys = state.pins.settings.keys
    if key in keys:
        return state.updated("pins.settings", keys=tuple(one for one in keys if one != key))
    if len(keys) >= MOST_PINS:
        raise InvalidInput("pins", f"at most {MOST_PINS} fit into the strip; take one off first")
    return state.updated("pins.settings", keys=(*keys, key))


def _receive(session: Session, data: Any) -> None:
    """Pin what was clicked, or take it off; ``data`` comes from the page."""
    if isinstance(data, str) and can_be_pinned(data):
        session.dispatch("pins", partial(pin, key=data), step=False)


def name_of(key: str) -> tuple[str, str, DisplayUnit]:
    """Return label, words and unit of a number that can be pinned."""
    if key == IMBALANCE:
        return "M_p2", "static imbalance", display_unit("N")
    if key in QUANTITIES:
        quantity = QUANTITIES[key]
        return quantity.label, quantity.title, quantity.display
    parameter = PARAMETER[key]
    return parameter.symbol.partition(" = ")[0], parameter.label, parameter.display


def pins_html(frame: Frame) -> str:
    """Return a row for each number that is pinned; nothing without any."""
    state = frame.state
    keys = state.pins.settings.keys
    if not keys:
        return ""
    outcome = state.pins.outcome
    values: dict[str, PinValue] = {}
    if outcome is not None and outcome.result is not None:
        values = dict(zip(outcome.job.keys, outcome.result, strict=False))
    stale = outcome is None or outcome.job != wanted(frame)
    compared = state.document.reference is not None
    rows = [_row(key, values.get(key)) for key in keys]
    return render("pins/pins.j2", rows=rows, stale=stale, compared=compared)


def _row(key: str, found: PinValue | None) -> dict[str, Any]:
    label, words, unit = name_of(key)
    row: dict[str, Any] = {"key": key, "label": label, "words": words, "unit": unit.text}
    if found is None:
        return row | {"value": "…", "reason": "", "reference": "", "change": "", "share": None}
    value, reference, change = map(
        unit.from_si, (found.value, found.reference, found.value - found.reference)
    )
    share = None if math.isnan(found.margin) else margin_share(found.margin, found.bound)
    return row | {
        "value": number(value, DIGITS), "reason": found.reason,
        "reference": number(reference, DIGITS),
        "change": number(change, DIGITS, sign=True), "share": share,
        "level": "" if share is None else margin_level(share),
        "margin": f"margin {unit.format(found.margin, DIGITS)}",
    }  # fmt: skip


PINS: Final[tuple[Entry, ...]] = (FOLLOWER.worker, Message("pin", receive=_receive))
"""What the strip needs besides its text."""
