"""Inputs of the settings of a feature, made from the fields of their dataclass, and of layers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from enum import Enum
from typing import Any

from paminsa_viz.explorer.core.actions import set_layers
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, Input, Number, TextBox, attribute
from paminsa_viz.explorer.state.settings import Setting
from paminsa_viz.explorer.state.state import State
from paminsa_viz.quantities import QUANTITIES, families


def layer_switch(key: str, layer: str, label: str, hint: str, *, undo: bool = True) -> Checkbox:
    """Return the switch of a layer of the scene."""
    return Checkbox(
        key, label, hint=hint, undo=undo,
        read=lambda state: layer in state.layers,
        apply=lambda state, visible: set_layers(state, **{layer: visible}),
    )  # fmt: skip


def quantity_inputs(
    key: str,
    labels: tuple[str, str],
    read: Callable[[State], str],
    choose: Callable[[State, str], State],
    hint: str,
) -> tuple[Dropdown, Dropdown]:
    """Return the choice of a quantity: its family, then itself; `choose` takes its key."""

    def family(state: State) -> str:
        return QUANTITIES[read(state)].family

    def choose_family(state: State, chosen: str) -> State:
        """Choose the first quantity of a family, unless one of it is chosen."""
        return state if chosen == family(state) else choose(state, families()[chosen][0].key)

    return (
        Dropdown(
            f"{key}.family", labels[0], options={name: name for name in families()},
            hint="Which quantities are offered below", read=family, apply=choose_family,
        ),
        Dropdown(
            f"{key}.quantity", labels[1], hint=hint, read=read, apply=choose,
            options=lambda state: {q.label: q.key for q in families()[family(state)]},
        ),
    )  # fmt: skip


class SettingInputs:
    """Makes the inputs of the settings that stand at a place in the state."""

    def __init__(
        self, prefix: str, path: str, kind: type, change: Callable[..., State] | None = None
    ) -> None:
        """Prepare for one feature.

        Args:
            prefix: What the keys of the inputs begin with.
            path: Place of the settings, such as ``"springs.settings"``.
            kind: Their dataclass.
            change: Makes the state with another value, where more changes with it.
        """
        self._prefix, self._path, self._change = prefix, path, change
        self._fields = {item.name: item for item in fields(kind)}

    def __call__(self, name: str, **properties: Any) -> Input:
        """Return the input of a field: as its default is a switch, a choice, a text or a number."""
        default: Any = self._fields[name].default
        one: Setting = self._fields[name].metadata["setting"]
        key = f"{self._prefix}.{name}"
        properties = {
            "hint": one.hint, **attribute(f"{self._path}.{name}", self._change), **properties,
        }  # fmt: skip
        options = properties.pop("options", one.options)
        if options is None and isinstance(default, Enum):
            options = {member.value: member for member in type(default)}
        if options is not None:
            return Dropdown(key, one.label, options=options, **properties)
        if isinstance(default, bool):
            return Checkbox(key, one.label, **properties)
        if isinstance(default, str):
            return TextBox(key, one.label, **properties)
        if isinstance(default, int):
            apply = properties["apply"]
            properties["apply"] = lambda state, value: apply(state, round(value))
        properties = {"step": one.step, **properties}
        return Number(key, one.label, range=one.range, unit=one.unit, **properties)
