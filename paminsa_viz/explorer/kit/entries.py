"""What a panel holds, as plain tables: buttons, texts, folders, and `inputs`.

`paminsa_viz.explorer.kit.bindings` builds the entries on the page, keeps them up to date, and
dispatches what a person does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, TypeAlias, TypeVar

from paminsa_viz.explorer.core.actions import Action
from paminsa_viz.explorer.core.docks import ANSWER_TAB
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session, View
from paminsa_viz.explorer.state.state import State
from paminsa_viz.units import tied_html

T = TypeVar("T")

Given: TypeAlias = T | Callable[[State], T]
"""A constant, or what follows from the state."""

Condition = Callable[[State], bool]


def given(value: Any, state: State) -> Any:
    """Return what is constant, or follows from the state."""
    return value(state) if callable(value) else value


@dataclass(frozen=True)
class Run:
    """What a button does when it does not change the state, such as an export.

    Attributes:
        call: Called with the session, on a thread of its own; `Session.submit` hands work to the
            session's worker.
        at_once: Whether it is called as the click arrives, before all that comes later. It may
            then do no more than to hand over work.
    """

    call: Callable[[Session], None]
    at_once: bool = False


@dataclass(frozen=True)
class Then:
    """An action with what a person sees of it that is not beside its button.

    Attributes:
        action: The action.
        says: What is said once it has been carried out, if anything.
        opens: Name of the tab where it is seen, see `Session.open_tab`.
    """

    action: Action
    says: Given[str] = ""
    opens: str = ""

    def __call__(self, state: State) -> State:
        """Return the state after the action."""
        return self.action(state)


Effect = Action | Run | Then


@dataclass(frozen=True)
class Entry:
    """What all entries share.

    Attributes:
        key: Its name.
        label: Text next to it.
        hint: Tooltip.
        visible, disabled: When it is; always and never if None.
        order: Place in the container, where it is not that of the table.
    """

    key: str
    label: Given[str] = ""
    _: KW_ONLY
    hint: Given[str] = ""
    visible: Condition | None = None
    disabled: Condition | None = None
    order: float | None = None


@dataclass(frozen=True)
class Button(Entry):
    """A button.

    Attributes:
        effect: What it does.
        icon: Name of its icon.
        color: Its color, if it is not the page's.
        undo: Whether it can be undone.
        keys: Hotkey and modifier of its command in the palette, in viser's words; its hint, then a
            constant, is shown with them.
    """

    _: KW_ONLY
    effect: Effect
    icon: Given[Any] = None
    color: str | None = None
    undo: bool = True
    keys: tuple[str, str] | None = None

    @property
    def tooltip(self) -> Given[str]:
        """The hint, and the keys that do the same."""
        if self.keys is None:
            return self.hint
        hotkey, modifier = self.keys
        return f"{self.hint} ({modifier.replace('cmd/ctrl', 'ctrl').title()}+{hotkey})"


@dataclass(frozen=True)
class ButtonGroup(Entry):
    """Buttons in a row.

    Attributes:
        choices: What each does, by its text; none of them hides the row.
    """

    _: KW_ONLY
    choices: Given[Mapping[str, Effect]]


@dataclass(frozen=True)
class Upload(Entry):
    """A button that opens a file.

    Attributes:
        receive: Called with the file's name and content, on the thread of the upload: a long table
            would hold the session's worker up.
        mime_type: Which files are offered.
    """

    _: KW_ONLY
    receive: Callable[[Session, str, bytes], None]
    mime_type: str
    icon: Any = None
    color: str | None = None


@dataclass(frozen=True)
class Html(Entry):
    """A text, rendered from what is shown.

    Attributes:
        content: Its HTML, if it is not always the same.
        idle: Whether it follows only when nothing is dragged, and now and then while a motion is
            played.
    """

    _: KW_ONLY
    content: str | Callable[[Frame], str]
    idle: bool = False

    def shown(self, frame: Frame) -> str:
        """Return its HTML for a frame, in which no line ends between a number and its unit."""
        return tied_html(self.content(frame) if callable(self.content) else self.content)


@dataclass(frozen=True)
class ProgressBar(Entry):
    """A bar.

    Attributes:
        read: What part is done, 0 to 1.
    """

    _: KW_ONLY
    read: Callable[[State], float]


@dataclass(frozen=True)
class Folder(Entry):
    """A folder of entries; without a label, they are only grouped.

    Attributes:
        entries: What it holds.
        open: Whether it is open at first.
    """

    _: KW_ONLY
    entries: Sequence[Entry]
    open: bool = True


@dataclass(frozen=True)
class Tabs(Entry):
    """Tabs of entries.

    Attributes:
        tabs: What they hold, by name.
    """

    _: KW_ONLY
    tabs: Mapping[str, Sequence[Entry]]


@dataclass(frozen=True)
class Answer(Entry):
    """What came of a job, or of what is shown: it is seen in the tab *Answer* of the left dock.

    The tab opens by itself when another answer comes. Where the entry stands in its table there is
    a button that shows it again: below what asks for the answer, and first in the section where
    nothing does, since it only follows what is shown.

    Attributes:
        entries: What it holds: verdict, table, chart, and what can be done with it.
        found: What it is of, None as long as there is nothing; another one is another answer.
        always: Whether there is one all the same, which follows what is shown.
    """

    _: KW_ONLY
    entries: Sequence[Entry]
    found: Callable[[State], object] = lambda state: None
    always: Given[bool] = False

    def exists(self, state: State) -> bool:
        """Whether there is something to show."""
        return given(self.always, state) or self.found(state) is not None

    def show(self, state: State) -> State:
        """Return the state with this as the answer that is shown."""
        return state.updated("", answer=self.key)

    @property
    def opens(self) -> Then:
        """What shows it."""
        return Then(self.show, opens=ANSWER_TAB)

    @property
    def button(self) -> ButtonGroup:
        """The button that shows it."""
        return ButtonGroup(
            f"{self.key}.show", "Answer", choices={str(self.label): self.opens},
            visible=self.exists, hint="Shows it in the tab Answer of the dock on the left",
        )  # fmt: skip


@dataclass(frozen=True)
class Custom(Entry):
    """Something that draws itself.

    Attributes:
        make: Builds it in the current container of the page.
    """

    _: KW_ONLY
    make: Callable[[Session], View]


@dataclass(frozen=True)
class Worker(Entry):
    """What runs the jobs of a task or a follower, see `paminsa_viz.explorer.kit.task`.

    It follows the state whether or not its tab is open.

    Attributes:
        make: Builds it; it puts nothing on the page.
    """

    _: KW_ONLY
    make: Callable[[Session], View]


@dataclass(frozen=True)
class Message(Entry):
    """Something that the page says; its key is the kind of the message.

    Attributes:
        receive: Called with what comes with it, which may be anything.
    """

    _: KW_ONLY
    receive: Callable[[Session, Any], None]
