"""What a tab keeps across a reload: its document, and how it is shown.

The document is written as for a share code; how it is shown, part by part, as plain data. A part
that cannot be read, or is not possible any more, keeps its default.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from operator import attrgetter
from typing import Any

import msgspec

from paminsa_viz.explorer import actions, persistence
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.docks import LARGEST_DOCK
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion.description import PlotView
from paminsa_viz.explorer.scene.layers import LAYERS
from paminsa_viz.explorer.settings import Settings
from paminsa_viz.explorer.state import Appearance, Docks, MapView, State, initial_state
from paminsa_viz.explorer.synthesis.jobs import SynthesisSettings
from paminsa_viz.files.plain_data import parse_json
from paminsa_viz.plots.ranges import LARGEST_END
from paminsa_viz.quantities import QUANTITIES


def _settings(part: Any, path: str = "") -> Iterator[tuple[str, type[Settings]]]:
    """Yield the places and types of all settings in a part of the state."""
    for item in fields(part):
        value, place = getattr(part, item.name), f"{path}{item.name}"
        if isinstance(value, Settings):
            yield place, type(value)
        elif is_dataclass(value):
            yield from _settings(value, f"{place}.")


VIEW: dict[str, Any] = {
    "map_view": MapView,
    "layers": frozenset[str],
    "floor_opacity": float,
    "plots": PlotView,
    "condition_limit": float,
    "table_at_rest": bool,
    "appearance": Appearance,
    "docks": Docks,
    **dict(_settings(initial_state())),
}
"""Parts of the state that say how it is shown or what is set, and their types."""


def dump(state: State) -> str:
    """Write what a tab keeps of a state."""
    view = {}
    for name in VIEW:
        part = attrgetter(name)(state)
        view[name] = msgspec.to_builtins(part.saved if isinstance(part, Settings) else part)
    return json.dumps(json.loads(persistence.dump(state.document)) | {"view": view})


def restore(state: State, text: str) -> State:
    """Return a state with what a tab has kept.

    Raises:
        PaminsaError: If the document cannot be read.
    """
    state = actions.restore(state, persistence.load(text))
    view = parse_json(text).get("view", {})
    for name, kind in VIEW.items():
        try:
            value = msgspec.convert(view[name], kind)
        except (msgspec.ValidationError, LookupError, TypeError):
            continue
        if _possible(name, value):
            part, _, attribute = name.rpartition(".")
            state = state.updated(part, **{attribute: value})
    known = replace(state, layers=state.layers & frozenset(LAYERS))
    if known.document.reference is None and known.map_view.difference:
        return known.updated("map_view", difference=False)
    return known


def _possible(name: str, value: Any) -> bool:
    match name:
        case "map_view":
            ends = (value.low, value.high)
            return value.quantity in QUANTITIES and all(abs(end) <= LARGEST_END for end in ends)
        case "plots":
            return 0 <= value.actuator < 4 and 0 <= value.color < 4
        case "floor_opacity":
            return 0 <= value <= 1
        case "docks":
            widths = (value.left.width, value.right.width)
            return all(width is None or 0 < width <= LARGEST_DOCK for width in widths)
        case "condition_limit":
            return math.isfinite(value) and value >= 1
        case "balancing.settings":
            slots = (value.slot_b8, value.slot_b3)
            possible = all(0 <= s.max_lever <= 1 and 0 <= s.max_mass <= 100 for s in slots)
            return possible and 0 <= value.motion_weight <= 1
        case "synthesizing.settings":
            return value == SynthesisSettings() or _searchable(value)
    return True


def _searchable(value: SynthesisSettings) -> bool:
    # Late: a page that searches for nothing does without.
    from paminsa_viz.explorer.synthesis.cases import REGIMES
    from paminsa_viz.synthesis.search.objectives import OBJECTIVES

    known = {value.objective, value.against or value.objective} <= OBJECTIVES.keys()
    ends = [end for _, limits in value.ranges for end in limits]
    return known and value.regimes in REGIMES and all(map(math.isfinite, ends))


class TabStore:
    """Keeps a tab's state in its own store, whenever the page is idle."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._kept = ""

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Save what has changed."""
        # A search may show a robot that is not the document's.
        if dragging or frame.state.synthesizing.running is not None:
            return
        text = dump(frame.state)
        if text != self._kept:
            self._kept = text
            self._bridge.save(text)
