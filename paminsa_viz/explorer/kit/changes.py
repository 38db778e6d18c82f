"""What a result depends on that has changed since, in words: two jobs compared field by field."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from paminsa_viz.explorer.state.settings import Setting
from paminsa_viz.model import Design
from paminsa_viz.model.grids import COORDINATES

BODIES = "size of the bodies"
"""The one number of a geometry that only drawn bodies and their clearances depend on."""

DESIGN_PARTS = {
    "geometry": "lengths",
    "joints": "masses",
    "links": "masses",
    "inertias": "inertias",
    "platform": "masses",
    "payload": "payload",
    "friction": "friction",
    "load": "load",
    "gravity": "gravity",
    "counterweights": "counterweights",
    "drives": "drives",
    "accuracy": "errors of the drives",
    "leg1": "deviations of the legs",
    "leg2": "deviations of the legs",
    "leg3": "deviations of the legs",
    "elastic": "sections and stiffnesses",
}
"""What people call the parts of a design; others are called by their names."""

NAMES = {
    "trajectory": "motion",
    "duties": "motion",
    "analysis": "motion",
    "theta": "θ",
    "condition_limit": "κ that counts",
    "log": "logs",
    "other": "logs",
    "loaded": "logs",
    "measured": "measured poses",
    "bounds": "requirements",
    "against": "second objective",
    "body_scale": BODIES,
}
"""What people call the fields of jobs, where it is not their own name."""


def changed_names(before: Any, now: Any) -> tuple[str, ...]:
    """Return what differs between two jobs, each once; nothing if they are equal."""
    return tuple(dict.fromkeys(_differences(before, now))) if before != now else ()


def _differences(before: Any, now: Any) -> Iterator[str]:
    for item in fields(before):
        old, new = getattr(before, item.name), getattr(now, item.name)
        if not item.compare or old == new:
            continue
        setting: Setting | None = item.metadata.get("setting")
        if setting is not None and setting.label:
            yield f"“{setting.label.partition(' [')[0]}”"
        elif isinstance(before, Design) and item.name == "geometry":
            inner = set(_differences(old, new))
            yield from ([DESIGN_PARTS["geometry"]] if inner - {BODIES} else [])
            yield from inner & {BODIES}
        elif isinstance(before, Design):
            yield DESIGN_PARTS.get(item.name, item.name)
        elif item.name == "pose" and isinstance(new, tuple) and isinstance(old, tuple):
            yield from _coordinates(old, new)
        elif is_dataclass(old) and type(old) is type(new) and item.name not in NAMES:
            yield from _differences(old, new)
        else:
            yield NAMES.get(item.name, item.name.replace("_", " "))


def _coordinates(old: Sequence[float], new: Sequence[float]) -> Iterator[str]:
    for name, before, now in zip(COORDINATES, old, new, strict=True):
        if before != now:
            yield "θ" if name == "theta" else name


def sentence(names: Sequence[str]) -> str:
    """Return what says that a result is of something else by now; empty without names."""
    if not names:
        return ""
    *first, last = names
    listed = f"{', '.join(first)} and {last}" if first else last
    return f"Changed since: {listed}."
