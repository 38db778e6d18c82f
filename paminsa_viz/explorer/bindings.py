"""Builds a panel's entries on the page and keeps them and the state in step.

Callbacks of the page only dispatch; the value is read when the worker gets to it, since callbacks
may overtake each other and the input's own value does not.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from functools import partial, singledispatchmethod
from typing import Any

from paminsa_viz.explorer.entries import (
    Button,
    ButtonGroup,
    Checkbox,
    Custom,
    Dropdown,
    Effect,
    Entry,
    Folder,
    Html,
    Input,
    Number,
    Pair,
    Progress,
    Run,
    Slider,
    Tabs,
    TextBox,
    Upload,
    text_of,
)
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import PaminsaError

TYPING_TIMEOUT = 1.0
"""How long an impossible value may stand before it is refused [s]: typing 0.5 passes through 0."""

EMPTY = ("–",)
"""What stands in a hidden row of buttons: viser refuses a row without any."""

Draw = Callable[[Frame, bool], None]


class Panel:
    """Entries on the page, as a view of the session; built in the current container.

    Attributes:
        handles: viser's handles of the entries by their keys.
        views: The views of `Custom` entries by their keys.
    """

    def __init__(self, session: Session, entries: Sequence[Entry]) -> None:
        self._session, self._gui = session, session.client.gui
        self.handles: dict[str, Any] = {}
        self.views: dict[str, Any] = {}
        self._draws: list[Draw] = []
        self._build_all(entries)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the state."""
        for draw in self._draws:
            draw(frame, dragging)

    def _build_all(self, entries: Sequence[Entry]) -> None:
        for entry in entries:
            self._build(entry)

    @singledispatchmethod
    def _build(self, entry: Any) -> None:
        raise TypeError(f"{type(entry).__name__} is not an entry")

    @_build.register
    def _input(self, entry: Input) -> None:
        state = self._session.state
        handle = _add_input(self._gui, entry, state, _properties(entry, state))
        binding = Binding(self._session, entry, handle)
        ends = SliderRange(entry, handle, state) if isinstance(entry, Slider) else None

        def draw(frame: Frame, dragging: bool) -> None:
            if entry.idle and dragging:
                return
            written = binding.draw(frame.state)
            if ends is not None:
                ends.draw(frame.state, written)

        self._draws.append(draw)
        if isinstance(entry, Dropdown) and callable(entry.options):
            self._follow(handle, "options", lambda state: tuple(entry.choices(state)), first=True)
        if isinstance(entry, Pair):
            if callable(entry.step):
                self._follow(handle, "step", entry.step)
            if entry.precision is not None:
                self._follow(handle, "precision", entry.precision)
        self._register(entry, handle)

    @_build.register
    def _button(self, entry: Button) -> None:
        state = self._session.state
        icon: Any = entry.icon(state) if callable(entry.icon) else entry.icon
        color: Any = entry.color
        handle = self._gui.add_button(
            text_of(entry.label, state), icon=icon, color=color, **_properties(entry, state)
        )
        handle.on_click(lambda _: perform(self._session, entry.key, entry.effect, undo=entry.undo))
        if callable(entry.icon):
            self._follow(handle, "icon", entry.icon)
        self._register(entry, handle)

    @_build.register
    def _button_group(self, entry: ButtonGroup) -> None:
        session, state = self._session, self._session.state
        options = tuple(entry.effects(state))
        properties = _properties(entry, state)
        properties["visible"] &= bool(options)
        handle = self._gui.add_button_group(
            text_of(entry.label, state), options or EMPTY, **properties
        )

        def click(event: Any) -> None:
            effect = entry.effects(session.state).get(event.target.value)
            if effect is not None:
                perform(session, entry.key, effect)

        handle.on_click(click)
        if callable(entry.choices):
            shown = entry.visible or (lambda _: True)

            def draw(frame: Frame, dragging: bool) -> None:
                del dragging
                options = tuple(entry.effects(frame.state))
                if options:
                    handle.options = options
                handle.visible = bool(options) and shown(frame.state)

            self._draws.append(draw)
            self._register(entry, handle, skip="visible")
        else:
            self._register(entry, handle)

    @_build.register
    def _upload(self, entry: Upload) -> None:
        state = self._session.state
        color: Any = entry.color
        handle = self._gui.add_upload_button(
            text_of(entry.label, state), icon=entry.icon, color=color, mime_type=entry.mime_type,
            **_properties(entry, state),
        )  # fmt: skip

        def receive(event: Any) -> None:
            file = event.target.value
            self._session.submit(partial(entry.receive, self._session, file.name, file.content))

        handle.on_upload(receive)
        self._register(entry, handle)

    @_build.register
    def _html(self, entry: Html) -> None:
        handle = self._gui.add_html("", **_place(entry, self._session.state))
        seen: list[object] = []

        def draw(frame: Frame, dragging: bool) -> None:
            if entry.idle and dragging:
                return
            if entry.depends is not None:
                now = entry.depends(frame)
                if seen and seen[0] is now:
                    return
                seen[:] = [now]
            handle.content = entry.content(frame)

        self._draws.append(draw)
        self._register(entry, handle)

    @_build.register
    def _progress(self, entry: Progress) -> None:
        handle = self._gui.add_progress_bar(
            0.0, animated=True, **_place(entry, self._session.state)
        )
        self._follow(handle, "value", lambda state: 100 * entry.read(state))
        self._register(entry, handle)

    @_build.register
    def _folder(self, entry: Folder) -> None:
        state = self._session.state
        folder = self._gui.add_folder(
            text_of(entry.label, state) or None, expand_by_default=entry.open,
            **_place(entry, state),
        )  # fmt: skip
        self._register(entry, folder)
        with folder:
            self._build_all(entry.entries)

    @_build.register
    def _tabs(self, entry: Tabs) -> None:
        group = self._gui.add_tab_group(**_place(entry, self._session.state))
        self._register(entry, group)
        for name, entries in entry.tabs.items():
            with group.add_tab(name):
                self._build_all(entries)

    @_build.register
    def _custom(self, entry: Custom) -> None:
        view = self.views[entry.key] = entry.make(self._session)
        self._draws.append(view.draw)

    def _register(self, entry: Entry, handle: Any, skip: str = "") -> None:
        """Keep the handle, and let it follow what all entries share."""
        assert entry.key not in self.handles, f"two entries are named {entry.key}"
        self.handles[entry.key] = handle
        for name, value in (
            ("label", entry.label), ("visible", entry.visible), ("disabled", entry.disabled),
        ):  # fmt: skip
            if callable(value) and name != skip:
                self._follow(handle, name, value)
        if callable(entry.hint):
            self._follow(handle, "hint", entry.hint, idle=True)

    def _follow(
        self,
        handle: Any,
        name: str,
        value: Callable[[State], Any],
        *,
        idle: bool = False,
        first: bool = False,
    ) -> None:
        """Let a property of a handle follow the state.

        Args:
            handle, name: What follows.
            value: What it is.
            idle: Whether only when nothing is dragged.
            first: Whether before all that was built so far.
        """
        last: list[Any] = [getattr(handle, name)]

        def draw(frame: Frame, dragging: bool) -> None:
            if idle and dragging:
                return
            now = value(frame.state)
            if last[0] != now:  # viser sends a dropdown's options and an icon again and again
                last[0] = now
                setattr(handle, name, now)

        self._draws.insert(-1 if first else len(self._draws), draw)


class Binding:
    """An input, its way into the state and its way back.

    A value that is typed and not possible changes nothing at first. Only if it still stands after
    `TYPING_TIMEOUT` is the person told, and the input set back.
    """

    def __init__(self, session: Session, entry: Input, handle: Any) -> None:
        self._session, self._entry, self._handle = session, entry, handle
        # What the input held when it was last read or written here. If it holds something else,
        # the page has just set it, and the callback that says so is on its way.
        self._known: Any = handle.value
        self._refused = False
        self._timer: threading.Timer | None = None
        handle.on_update(self._on_update)

    def draw(self, state: State) -> bool:
        """Show the state's value, unless the person has set a newer one that was not read yet.

        Returns:
            Whether the input was written.
        """
        if self._refused or not same(self._handle.value, self._known):
            return False
        value = self._entry.shown(state)
        if same(self._known, value):
            return False
        self._handle.value = value
        self._known = value  # and not what the page may have set in this very moment
        return True

    def _on_update(self, event: Any) -> None:
        if event.client is None:  # set by this program
            self._known = self._handle.value
            return
        self._session.dispatch(self._entry.key, self._set, step=self._entry.undo)

    def _set(self, state: State) -> State:
        if self._timer is not None:
            self._timer.cancel()
        self._refused = False
        try:
            return self._apply(state)
        except PaminsaError:
            if not self._entry.typed:
                raise
            self._refused = True
            self._timer = threading.Timer(TYPING_TIMEOUT, self._insist)
            self._timer.daemon = True
            self._timer.start()
            return state

    def _insist(self) -> None:
        if self._refused:
            self._session.dispatch(self._entry.key, self._refuse)

    def _refuse(self, state: State) -> State:
        self._refused = False
        return self._apply(state)  # raises again, and now the session notifies

    def _apply(self, state: State) -> State:
        value = self._known = self._handle.value
        return self._entry.apply(state, self._entry.parse(state, value))


class SliderRange:
    """The ends of a slider: they follow the state, and grow to values beyond them.

    While a person drags the slider its ends stay, or the thumb would slip away; they shrink again
    when a value comes from elsewhere.
    """

    def __init__(self, entry: Slider, handle: Any, state: State) -> None:
        self._entry, self._handle = entry, handle
        self._base = entry.base_range(state)
        self._ends = (handle.min, handle.max)

    def draw(self, state: State, written: bool) -> None:
        """Follow the state.

        Args:
            state: The state.
            written: Whether the slider's value was just set by the program.
        """
        base = self._entry.base_range(state)
        by_hand = base == self._base and not written
        self._base = base
        ends = self._ends if by_hand else base
        if self._entry.fit is not None:
            ends = fitted(self._entry, ends, self._entry.shown(state))
        if ends != self._ends:
            self._ends = ends
            self._handle.min, self._handle.max = ends


def fitted(entry: Slider, ends: tuple[float, float], value: float) -> tuple[float, float]:
    """Return the ends of a slider that hold a value."""
    return ends if entry.fit is None else entry.fit(ends, value)


def perform(session: Session, key: str, effect: Effect, *, undo: bool = True) -> None:
    """Do what a button or a command does."""
    if isinstance(effect, Run):
        effect.call(session)
    else:
        session.dispatch(key, effect, step=undo)


def same(a: Any, b: Any) -> bool:
    """Whether two values of an input are the same but for rounding."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        if math.isnan(a) and math.isnan(b):
            return True
        return math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-9)
    return a == b


def _place(entry: Entry, state: State) -> dict[str, Any]:
    """Return the properties that every entry has on the page."""
    return {"visible": entry.visible is None or entry.visible(state), "order": entry.order}


def _properties(entry: Entry, state: State) -> dict[str, Any]:
    """Return the properties that inputs and buttons share on the page."""
    disabled = entry.disabled is not None and entry.disabled(state)
    hint = text_of(entry.hint, state) or None
    return _place(entry, state) | {"disabled": disabled, "hint": hint}


def _add_input(gui: Any, entry: Input, state: State, properties: dict[str, Any]) -> Any:
    label, value = text_of(entry.label, state), entry.shown(state)
    match entry:
        case Slider():
            low, high = fitted(entry, entry.base_range(state), value)
            return gui.add_slider(
                label, low, high, entry.step, value, marks=entry.marks, **properties
            )
        case Number():
            low, high = entry.range
            return gui.add_number(label, value, min=low, max=high, step=entry.step, **properties)
        case Pair():
            low, high = zip(*entry.range, strict=True)
            step = entry.step(state) if callable(entry.step) else entry.step
            return gui.add_vector2(
                label, value, step=step, min=None if None in low else low,
                max=None if None in high else high, **properties,
            )  # fmt: skip
        case Checkbox():
            return gui.add_checkbox(label, value, **properties)
        case Dropdown():
            options = tuple(entry.choices(state))
            return gui.add_dropdown(label, options, initial_value=value, **properties)
        case TextBox():
            return gui.add_text(label, value, **properties)
    raise TypeError(f"{type(entry).__name__} is not an input")
