"""Inputs of one requirement: quantity, side, and its own headings and heights."""

from __future__ import annotations

from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.features.requirements.actions import Side, selected, side_of
from paminsa_viz.explorer.features.requirements.texts import names
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, Input, Pair
from paminsa_viz.explorer.kit.setting_inputs import quantity_inputs
from paminsa_viz.explorer.state.settings import MILLIMETERS
from paminsa_viz.explorer.state.state import State
from paminsa_viz.quantities import families
from paminsa_viz.quantities.requirements import Range, Requirement
from paminsa_viz.units import DisplayUnit, display_unit

DEGREES = display_unit("rad")


NOTHING = Requirement(next(iter(families().values()))[0].key, high=0.0)
"""What hidden inputs show."""


def has_selected(state: State) -> bool:
    return selected(state) is not None


def _edited(state: State) -> Requirement:
    return selected(state) or NOTHING


def _side(state: State) -> Side:
    return side_of(_edited(state))


def _own(name: str, label: str, unit_label: str, unit: DisplayUnit) -> tuple[Input, Input]:
    """Return the switch and the ends of a range that the selected requirement has of its own."""

    def has(state: State) -> bool:
        return getattr(_edited(state), name) is not None

    def read(state: State) -> Range:
        return getattr(_edited(state), name) or (0.0, 0.0)

    return (
        Checkbox(
            f"requirements.own_{name}", label, read=has,
            hint="Otherwise it holds over all that is required",
            apply=lambda state, on: actions.set_own_range(state, name, on),
        ),
        Pair(
            f"requirements.{name}", unit_label, visible=has, units=(unit, unit), step=1.0,
            ordered=True, read=read, hint="From, to",
            apply=lambda state, ends: actions.edit(state, **{name: ends}),
        ),
    )  # fmt: skip


EDIT = (
    Dropdown(
        "requirements.selected", "Requirement",
        options=lambda state: names(state) or {"–": 0},
        read=lambda state: state.requirements.selected if has_selected(state) else 0,
        apply=actions.select, undo=False, hint="Which one of the list is edited here",
    ),
    *quantity_inputs(
        "requirements", ("Family", "Quantity"), lambda state: _edited(state).quantity,
        actions.choose_quantity, "What is bounded",
    ),
    Dropdown(
        "requirements.side", "Bound", options={side.value: side for side in Side},
        read=_side, apply=actions.choose_side,
        hint="On which side the quantity is bounded; the number is typed in the list",
    ),
    *_own("theta", "Own θ range", "θ [°]", DEGREES),
    *_own("z", "Own z range", "z [mm]", MILLIMETERS),
)  # fmt: skip
