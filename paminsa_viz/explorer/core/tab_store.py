"""What a tab keeps across a reload: its document, and how it is shown.

The document is written as for a share code; how it is shown, part by part, as plain data. A part
that cannot be read, or is not possible any more, keeps its default.
"""

from __future__ import annotations

import json
import logging
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from operator import attrgetter
from typing import Annotated, Any

import msgspec

from paminsa_viz.explorer.core import actions, persistence
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.links import follow_link
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import Settings
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Appearance, Camera, WorkspaceView
from paminsa_viz.files.plain_data import parse_json
from paminsa_viz.model import PaminsaError

log = logging.getLogger(__name__)


SAVE_PERIOD = 2.0
"""How long a change may stay unsaved while a search runs or a motion is played [s]."""

MOST_WORKSPACES = 10
"""Most workspaces whose views are believed."""

MOST_ENDED = 20
"""Most ended tasks that are believed."""


def _parts(part: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dataclasses in a part of the state, with their places."""
    for item in fields(part):
        value, place = getattr(part, item.name), f"{path}{item.name}"
        if is_dataclass(value):
            yield place, value
            yield from _parts(value, f"{place}.")


TASKS = tuple(place for place, part in _parts(initial_state()) if isinstance(part, TaskState))
"""Places of all tasks of the state."""


def task_name(place: str, kind: str) -> str:
    """Return what a task is kept by: its place, and its kind where there are several."""
    return f"{place} {kind}".rstrip()


def unkept_tasks(state: State) -> Iterator[str]:
    """Yield the names of the tasks that a reload ends, or whose results it loses."""
    for place in TASKS:
        for kind in attrgetter(place)(state).unkept:
            yield task_name(place, kind)


LONGEST_OFFER = 20_000
"""Longest kept state that a tab keeps beside its own [characters]."""

VIEW: dict[str, Any] = {
    "layers": frozenset[str],
    "floor_opacity": Annotated[float, msgspec.Meta(ge=0, le=1)],
    "condition_limit": Annotated[float, msgspec.Meta(ge=1, le=sys.float_info.max)],
    "table_at_rest": bool,
    "appearance": Appearance,
    "offered": Annotated[str, msgspec.Meta(max_length=LONGEST_OFFER)],
    "workspace": str,
    "answer": str,
    "camera": Camera | None,
    "workspaces": Annotated[tuple[WorkspaceView, ...], msgspec.Meta(max_length=MOST_WORKSPACES)],
    "ended": Annotated[tuple[str, ...], msgspec.Meta(max_length=MOST_ENDED)],
    **{place: type(part) for place, part in _parts(initial_state()) if isinstance(part, Settings)},
}
"""Parts of the state that say how it is shown or what is set, and their types."""


FORMER_PLACES = {
    "balancing": "balance",
    "clearance_view": "clearance.settings",
    "driving": "drives",
    "identifying": "identification",
    "requiring": "requirements",
    "simulating": "simulation",
    "springing": "springs",
    "synthesizing": "synthesis",
    "tolerating": "tolerances",
}
"""What places of the state were called by versions that tabs may still be kept from."""


def _present(place: str) -> str:
    """Return what a place of the state is called now."""
    start, dot, rest = place.partition(".")
    return f"{FORMER_PLACES.get(start, start)}{dot}{rest}"


def dump(state: State) -> str:
    """Write what a tab keeps of a state."""
    view = {}
    ended = tuple(dict.fromkeys((*state.ended, *unkept_tasks(state))))[:MOST_ENDED]
    state = replace(state, ended=ended)
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
    kept = parse_json(text).get("view", {})
    view = {_present(name): part for name, part in kept.items()} if isinstance(kept, dict) else {}
    for name, kind in VIEW.items():
        try:
            value = msgspec.convert(view[name], kind)
        except (msgspec.ValidationError, LookupError, TypeError):
            continue
        if not isinstance(value, Settings) or value.possible:
            part, _, attribute = name.rpartition(".")
            state = state.updated(part, **{attribute: value})
    ended = tuple(map(_present, state.ended))
    known = replace(state, layers=state.layers & frozenset(LAYERS), ended=ended)
    if known.document.reference is None and known.map_view.difference:
        return known.updated("map_view", difference=False)
    return known


def restored(state: State, saved: str) -> State:
    """Return a state with what a tab has kept, or as it is if that cannot be read."""
    try:
        return restore(state, saved)
    except PaminsaError as error:
        log.info("a tab's saved state was not taken: %s", error)
        return state


def take(state: State, saved: str, opening: State) -> State:
    """Return a state with what a tab has kept, which may come late.

    What a person has set meanwhile is not written over: then what was kept is only offered.

    Args:
        state: The state of the page.
        saved: What the tab has kept.
        opening: The state that the page opened with.
    """
    found = restored(state, saved)
    if _work(state) in (_work(opening), _work(found)):
        return found
    return replace(state, offered=saved[:LONGEST_OFFER])


OF_THE_PAGE = ("docks", "offered", "ended", "workspace", "workspaces", "answer", "camera")
"""What the page itself changes of what is kept."""


def _work(state: State) -> object:
    """Return what a person does of that which is kept: not what the page does by itself."""
    kept = json.loads(dump(state))
    view = {name: part for name, part in kept["view"].items() if name not in OF_THE_PAGE}
    view["layers"] = sorted(set(view["layers"]) - {"fine"})
    return kept | {"view": view}


def open_offered(state: State) -> State:
    """Open what the tab has kept and the page has offered."""
    return replace(restored(state, state.offered), offered="")


def drop_offered(state: State) -> State:
    """Go on without what the tab has kept."""
    return replace(state, offered="")


class TabStore:
    """Keeps a tab's state in its own store, and what it shows in the address: when the page is
    idle, and every `SAVE_PERIOD` when it is not, as long as a search runs, a motion is played, or
    something is dragged."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._kept, self._saved = "", -math.inf

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Save what has changed."""
        del frame  # while a search runs it may be of a robot that is not the document's
        if not self._session.restored.is_set():
            return  # or what the tab has kept would be written over before it was taken
        now = time.monotonic()
        if dragging and now - self._saved < SAVE_PERIOD:
            return
        self._saved = now
        text = dump(self._session.state)
        if text != self._kept:
            self._kept = text
            self._session.bridge.save(text)
        follow_link(self._session)
