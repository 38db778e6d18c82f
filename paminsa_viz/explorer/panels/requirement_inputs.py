"""Inputs of one requirement: quantity, bound, and its own headings and heights."""

from __future__ import annotations

from functools import partial
from typing import Any

from paminsa_viz.explorer.inputs import Checkbox, Dropdown, Input, Number, Pair
from paminsa_viz.explorer.panels.requirements_text import names
from paminsa_viz.explorer.requirements import actions
from paminsa_viz.explorer.requirements.actions import Side, selected, side_of
from paminsa_viz.explorer.settings import MILLIMETERS
from paminsa_viz.explorer.state import State
from paminsa_viz.quantities import families
from paminsa_viz.quantities.requirements import Range
from paminsa_viz.units import display_unit

DEGREES = display_unit("rad")


def has_selected(state: State) -> bool:
    return selected(state) is not None


def _side(state: State) -> Side:
    one = selected(state)
    return Side.MOST if one is None else side_of(one)


def _family(state: State) -> str:
    one = selected(state)
    return next(iter(families())) if one is None else one.entry.family


def _quantity(state: State) -> str:
    one = selected(state)
    return families()[_family(state)][0].key if one is None else one.quantity


def _unit(state: State, name: str) -> str:
    one = selected(state)
    unit = "" if one is None else one.entry.display.text
    return f"{name} [{unit}]" if unit else name


def _bound(state: State) -> float:
    """Return the number of the selected requirement as it is shown."""
    one = selected(state)
    if one is None:
        return 0.0
    value = one.low if side_of(one) is Side.LEAST else one.high
    return one.entry.display.from_si(0.0 if value is None else value)


def _set_bound(state: State, value: float) -> State:
    one = selected(state)
    return state if one is None else actions.set_bound(state, one.entry.display.to_si(value))


def _ends(state: State) -> Range:
    one = selected(state)
    if one is None or one.low is None or one.high is None:
        return 0.0, 0.0
    unit = one.entry.display
    return unit.from_si(one.low), unit.from_si(one.high)


def _set_ends(state: State, ends: Range) -> State:
    one = selected(state)
    if one is None:
        return state
    low, high = map(one.entry.display.to_si, ends)
    return actions.edit(state, low=low, high=high)


def _own(name: str, label: str, unit_label: str, unit: Any, step: float) -> tuple[Input, Input]:
    """Return the switch and the ends of a range that the selected requirement has of its own."""

    def has(state: State) -> bool:
        one = selected(state)
        return one is not None and getattr(one, name) is not None

    def read(state: State) -> Range:
        one = selected(state)
        found = None if one is None else getattr(one, name)
        return (0.0, 0.0) if found is None else found

    return (
        Checkbox(
            f"requirements.own_{name}", label, read=has,
            hint="Otherwise it holds over all that is required",
            apply=lambda state, on: actions.set_own_range(state, name, on),
        ),
        Pair(
            f"requirements.{name}", unit_label, visible=has, units=(unit, unit), step=step,
            read=read, hint="From, to",
            apply=lambda state, ends: actions.edit(state, **{name: ends}),
        ),
    )  # fmt: skip


EDIT = (
    Dropdown(
        "requirements.selected", "Requirement",
        options=lambda state: names(state) or {"–": 0},
        read=lambda state: state.requiring.selected if has_selected(state) else 0,
        apply=actions.select, undo=False,
    ),
    Dropdown(
        "requirements.family", "Family", options={family: family for family in families()},
        read=_family, apply=actions.choose_family,
    ),
    Dropdown(
        "requirements.quantity", "Quantity",
        options=lambda state: {q.label: q.key for q in families()[_family(state)]},
        read=_quantity, apply=actions.choose_quantity,
    ),
    Dropdown(
        "requirements.side", "Bound", options={side.value: side for side in Side},
        read=_side, apply=actions.choose_side,
    ),
    Number(
        "requirements.value", partial(_unit, name="Value"), step=0.1,
        visible=lambda state: _side(state) is not Side.BETWEEN, read=_bound, apply=_set_bound,
    ),
    Pair(
        "requirements.ends", partial(_unit, name="From, to"), step=0.1,
        visible=lambda state: _side(state) is Side.BETWEEN, read=_ends, apply=_set_ends,
    ),
    *_own("theta", "Own θ range", "θ [°]", DEGREES, 1.0),
    *_own("z", "Own z range", "z [mm]", MILLIMETERS, 1.0),
)  # fmt: skip
