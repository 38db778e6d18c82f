"""Builds a panel's entries on the page and keeps them and the state in step.

Callbacks of the page only dispatch. What a person does is taken as it arrives, on the server's
event loop: callbacks on threads may overtake each other, and the worker may write over an input.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from paminsa_viz.explorer.browser.bridge import newest_value
from paminsa_viz.explorer.core.actions import Action
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session, View
from paminsa_viz.explorer.kit.entries import (
    Answer,
    Button,
    ButtonGroup,
    Custom,
    Effect,
    Entry,
    Folder,
    Given,
    Html,
    Message,
    ProgressBar,
    Run,
    Tabs,
    Then,
    Upload,
    Worker,
    given,
)
from paminsa_viz.explorer.kit.inputs import Dropdown, Input, Number, OneNumber, Pair, Slider
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PaminsaError
from paminsa_viz.units import number, tied_html

TYPING_TIMEOUT = 1.0
"""How long an impossible value may remain before it is refused [s]: typing 0.5 passes through 0."""

PLAYED_PERIOD = 0.5
"""How often what waits for an idle page follows a motion that is played [s]."""

EMPTY = ("–",)
"""Text in a hidden row of buttons: viser refuses a row without any."""

Draw = Callable[[Frame, bool], None]


class Panel:
    """Entries on the page, as a view of the session; built in the current container.

    Attributes:
        handles: viser's handles of the entries by their keys.
    """

    def __init__(self, session: Session, entries: Sequence[Entry], tab: str = "") -> None:
        """Build the entries.

        Args:
            session: The session.
            entries: What is built.
            tab: Path of the tab it is in. While something is dragged and the tab is not open, only
                its jobs follow the state.
        """
        self._session, self._gui = session, session.client.gui
        self.handles: dict[str, Any] = {}
        self._tab = tab
        self._jobs: list[View] = []
        self._draws: list[Draw] = []
        self._waits = False
        self._due = -math.inf
        self._build_all(entries)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the state."""
        for job in self._jobs:
            job.draw(frame, dragging)
        if dragging and not self._session.shows(self._tab):
            return
        self._waits = dragging and not self._is_due(frame.state)
        started = time.monotonic()
        for draw in self._draws:
            draw(frame, dragging)
        if not self._waits:
            now = time.monotonic()
            self._due = now + max(PLAYED_PERIOD, 9 * (now - started))  # a tenth of it at most

    def _is_due(self, state: State) -> bool:
        """Whether what waits for an idle page is drawn all the same: a motion may be played for
        ever, and its numbers would stay those of another pose or design."""
        return state.playback.playing and time.monotonic() >= self._due

    def _build_all(self, entries: Sequence[Entry]) -> None:
        for entry in entries:
            self._build(entry)

    def _build(self, entry: Entry) -> None:
        if isinstance(entry, Custom):
            view = entry.make(self._session)
            self._draws.append(lambda frame, _: view.draw(frame, self._waits))
            return
        if isinstance(entry, Answer):
            entry = entry.button
        if isinstance(entry, Worker):
            self._jobs.append(entry.make(self._session))
            return
        if isinstance(entry, Message):
            self._session.bridge.on(entry.key, partial(entry.receive, self._session))
            return
        if isinstance(entry, ButtonGroup) and callable(entry.choices):
            entry = replace(entry, visible=partial(_has_choices, entry))
        assert entry.key not in self.handles, f"two entries are named {entry.key}"
        handle = self.handles[entry.key] = self._add(entry)
        for name in ("label", "visible", "disabled"):
            self._follow(handle, name, getattr(entry, name))
        if isinstance(entry, (Button, Upload)):
            self._hint_button(handle, entry.tooltip if isinstance(entry, Button) else entry.hint)
        else:
            self._follow(handle, "hint", entry.hint, idle=True)
        if isinstance(entry, Folder):
            with handle:
                self._build_all(entry.entries)
        elif isinstance(entry, Tabs):
            for name, entries in entry.tabs.items():
                with handle.add_tab(name):
                    self._build_all(entries)

    def _add(self, entry: Entry) -> Any:
        """Make an entry's handle, with what only entries of its kind have."""
        gui, session, state = self._gui, self._session, self._session.state
        label = given(entry.label, state)
        place = {"visible": entry.visible is None or entry.visible(state), "order": entry.order}
        properties = place | {
            "disabled": entry.disabled is not None and entry.disabled(state),
            "hint": given(entry.hint, state) or None,
        }
        match entry:
            case Input():
                return self._bind(entry, entry.add(gui, state, label, **properties))
            case Button():
                properties |= {"icon": given(entry.icon, state), "color": entry.color}
                handle = gui.add_button(label, **properties)

                async def press(event: Any) -> None:
                    del event
                    perform(session, entry.key, entry.effect, undo=entry.undo)

                handle.on_click(press)
                self._follow(handle, "icon", entry.icon)
            case ButtonGroup():
                return self._add_group(entry, label, properties)
            case Upload():
                properties |= {"icon": entry.icon, "color": entry.color}
                handle = gui.add_upload_button(label, mime_type=entry.mime_type, **properties)

                def receive(event: Any) -> None:
                    file = event.target.value
                    session.guard(partial(entry.receive, session, file.name, file.content))

                handle.on_upload(receive)
            case Html():
                content = entry.content
                handle = gui.add_html("" if callable(content) else tied_html(content), **place)
                if callable(content):
                    self._follow_frame(handle, "content", entry.shown, entry.idle)
            case ProgressBar():
                handle = gui.add_progress_bar(0.0, animated=True, **place)
                self._follow(handle, "value", lambda state: 100 * entry.read(state))
            case Folder():
                handle = gui.add_folder(label or None, expand_by_default=entry.open, **place)
            case Tabs():
                handle = gui.add_tab_group(**place)
            case _:
                raise TypeError(f"{type(entry).__name__} is not an entry")
        return handle

    def _bind(self, entry: Input, handle: Any) -> Any:
        if isinstance(entry, Dropdown) and callable(options := entry.options):
            self._follow(handle, "options", lambda state: tuple(options(state)))
        binding = (
            SliderBinding(self._session, entry, handle)
            if isinstance(entry, Slider)
            else Binding(self._session, entry, handle)
        )

        def draw(frame: Frame, dragging: bool) -> None:
            if not (entry.idle and self._waits):
                binding.draw(frame.state, dragging)

        self._draws.append(draw)
        if isinstance(entry, OneNumber):
            self._follow(handle, "precision", entry.places)
        if isinstance(entry, Number):
            self._follow(handle, "step", entry.step)
        if isinstance(entry, Pair):
            self._follow(handle, "step", entry.step)
            self._follow(handle, "precision", entry.precision)
        return handle

    def _add_group(self, entry: ButtonGroup, label: str, properties: dict[str, Any]) -> Any:
        session = self._session
        options = tuple(given(entry.choices, session.state))
        handle = self._gui.add_button_group(label, options or EMPTY, **properties)

        async def press(event: Any) -> None:
            effect = given(entry.choices, session.state).get(event.target.value)
            if effect is not None:
                perform(session, entry.key, effect)

        handle.on_click(press)
        if callable(choices := entry.choices):
            self._follow(handle, "options", lambda state: tuple(choices(state)) or handle.options)
        return handle

    def _hint_button(self, handle: Any, hint: Given[str]) -> None:
        said = ""

        def draw(state: State) -> None:
            nonlocal said
            if (now := given(hint, state)) != said:
                said = now
                self._session.bridge.hint(handle, now)

        draw(self._session.state)
        if callable(hint):
            self._draws.append(lambda frame, _: draw(frame.state))

    def _follow(self, handle: Any, name: str, value: Any, *, idle: bool = False) -> None:
        """Let a property of a handle follow the state, if ``value`` does."""
        if callable(value):
            self._follow_frame(handle, name, lambda frame: value(frame.state), idle)

    def _follow_frame(
        self, handle: Any, name: str, value: Callable[[Frame], Any], idle: bool
    ) -> None:
        def draw(frame: Frame, dragging: bool) -> None:
            del dragging
            if idle and self._waits:
                return
            now = value(frame)
            if getattr(handle, name) != now:  # viser sends options and an icon again and again
                setattr(handle, name, now)

        self._draws.append(draw)


class Binding:
    """An input that sets the state and follows it.

    A value that is typed and not possible changes nothing at first. Only if it is still there after
    `TYPING_TIMEOUT` is the person notified, and the input set back.
    """

    def __init__(self, session: Session, entry: Input, handle: Any) -> None:
        self._session, self._entry, self._handle = session, entry, handle
        self._received = self._taken = 0  # number of the newest value, and of the one applied last
        self._refused = False
        self._timer: threading.Timer | None = None
        self._newest = newest_value(handle)
        handle.on_update(self._receive)

    def draw(self, state: State, dragging: bool = True) -> bool:
        """Show the state's value, unless the person has set a newer one that was not read yet.

        Returns:
            Whether the input was written.
        """
        if self._refused or self._taken != self._received:
            return False
        value = self._entry.shown(state)
        if same(self._handle.value, value):
            return False
        self._handle.value = value
        return True

    async def _receive(self, event: Any) -> None:
        if event.client is not None:  # else this program has set it
            self._received += 1
            action = partial(self._set, self._received, self._newest())
            self._dispatch(action, overtakes=self._entry.typed)

    def _dispatch(self, action: Action, *, overtakes: bool = False) -> None:
        entry = self._entry
        self._session.dispatch(entry.key, action, step=entry.undo, overtakes=overtakes)

    def _set(self, number: int, value: Any, state: State) -> State:
        if self._timer is not None:
            self._timer.cancel()
        self._taken, self._refused = number, False
        try:
            return self._apply(value, state)
        except PaminsaError:
            if not self._entry.typed:
                raise
            self._refused = True
            if number == self._received and not same(self._handle.value, value):
                self._handle.value = value  # a frame drawn as it arrived has set it back
            insist = partial(self._dispatch, partial(self._refuse, number, value))
            self._timer = threading.Timer(TYPING_TIMEOUT, insist)
            self._timer.daemon = True
            self._timer.start()
            return state

    def _refuse(self, number: int, value: Any, state: State) -> State:
        if number != self._received:
            return state  # a newer value was typed meanwhile
        self._refused = False
        return self._apply(value, state)  # raises again, and now the session notifies

    def _apply(self, value: Any, state: State) -> State:
        parsed = self._entry.parse(state, value)
        if self._entry.is_shown(state, value):
            return state  # typed again: to and from the unit shown it may differ in the last digit
        return self._entry.apply(state, parsed)


class SliderBinding(Binding):
    """A slider with its ends and step: they follow the state; ends grow to values beyond them.

    While a person drags the slider its ends stay, or the thumb would slip away; they shrink again
    when the page is idle, or a value comes from elsewhere.
    """

    def __init__(self, session: Session, entry: Slider, handle: Any) -> None:
        super().__init__(session, entry, handle)
        self._slider = entry
        self._base = given(entry.range, session.state)
        self._ends, self._marks = (handle.min, handle.max), handle._marks or ()
        self._show_marks()

    def draw(self, state: State, dragging: bool = True) -> bool:
        written = super().draw(state, dragging)
        base = given(self._slider.range, state)
        dragged = dragging and base == self._base and not written
        self._base = base
        step = given(self._slider.step, state)
        if step != self._handle.step:
            self._handle.step = step
        ends = self._slider.ends(state, self._ends if dragged else base)
        if ends != self._ends:
            self._ends = ends
            self._handle.min, self._handle.max = ends
            self._show_marks()
        return written

    def _show_marks(self) -> None:
        """Show the marks between the ends; without any the page writes the ends.

        It does so with six decimals: an end that has more is written here, or it would be a 0.
        """
        marks = tuple(mark for mark in self._marks if self._ends[0] <= mark.value <= self._ends[1])
        if not marks and self._marks and any(round(end, 6) != end for end in self._ends):
            first = self._marks[0]
            marks = tuple(replace(first, value=end, label=number(end)) for end in self._ends)
        marks = marks or None
        if marks != self._handle._marks:
            self._handle._marks = marks


def perform(session: Session, key: str, effect: Effect, *, undo: bool = True) -> None:
    """Do what a button or a command does, at once but for a `Run` that takes long."""
    if isinstance(effect, Run):
        if effect.at_once:
            effect.call(session)
        else:
            run = partial(session.guard, partial(effect.call, session))
            threading.Thread(target=run, name=f"paminsa-{key}", daemon=True).start()
    elif isinstance(effect, Then):
        follow_up = partial(_follow_up, session, effect)
        session.dispatch(key, effect.action, step=undo, then=follow_up)
    else:
        session.dispatch(key, effect, step=undo)


def _follow_up(session: Session, effect: Then) -> None:
    """Show what an action has done."""
    if effect.opens:
        session.open_tab(effect.opens)
    says = given(effect.says, session.state)
    if says:
        session.notify("Done", says, of_step=True)


def same(a: Any, b: Any) -> bool:
    """Whether two values of an input are the same but for rounding."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        if math.isnan(a) and math.isnan(b):
            return True
        return math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-15)
    return a == b


def _has_choices(entry: ButtonGroup, state: State) -> bool:
    """Whether a row of buttons that follow the state is seen."""
    return bool(given(entry.choices, state)) and (entry.visible is None or entry.visible(state))
