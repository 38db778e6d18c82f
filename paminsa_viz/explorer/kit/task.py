"""Tasks in the background: what is started by a button, and what follows what is shown.

A `Task` or a `Follower` is all that a feature says of a job: its place in the state, the job of a
state, and what finds the result. Buttons, progress, threads, and whether a result still holds
follow from it.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, fields, replace
from functools import partial
from typing import Any, Generic, NamedTuple, TypeVar

from paminsa_viz.explorer.core import threads
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.session import IDLE_DELAY, Session
from paminsa_viz.explorer.core.tab_store import task_name
from paminsa_viz.explorer.kit.changes import BODIES, changed_names, sentence
from paminsa_viz.explorer.kit.entries import Button, Given, ProgressBar, Worker, given
from paminsa_viz.explorer.kit.text import status
from paminsa_viz.explorer.state.outcome import Outcome, TaskState, solve
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput, PaminsaError
from paminsa_viz.progress import Progress

log = logging.getLogger(__name__)

Job = TypeVar("Job")
Result = TypeVar("Result")


STOP_HINT = "Ends it without a result; an earlier one stays"
"""Tooltip of a button that stops a task."""


@dataclass(frozen=True)
class Task(Generic[Job, Result]):
    """What is started by a button, runs on a thread, and leaves an outcome in the state.

    Attributes:
        place: Where the state holds it.
        job: The job of a state, with all that its result depends on; may raise `PaminsaError`.
        find: Finds the result of a job; called on the thread.
        receive: Takes an outcome over, where that is more than to keep it; the task has ended.
        kept: Where the outcome is, if not at the place itself.
        own: Whether a job at the place is one of this task, where several share the place.
        again: The job that would find an outcome anew; `job` of the state if None.
        undo: Whether what an outcome changes can be undone.
        bodies: Whether the result depends on the size of the drawn bodies.
    """

    place: Place[Any]
    job: Callable[[State], Job]
    find: Callable[[Job, Progress], Result]
    _: KW_ONLY
    receive: Callable[[State, Outcome[Job, Result]], State] | None = None
    kept: Callable[[State], Outcome[Job, Result] | None] | None = None
    own: Callable[[Job], bool] = lambda job: True
    again: Callable[[State, Outcome[Job, Result]], Job] | None = None
    undo: bool = False
    bodies: bool = False

    def start(self, state: State) -> State:
        """Start the job of a state; what runs at the place is not wanted any more.

        Raises:
            PaminsaError: If there is none.
        """
        started = self.place.write(state, self._at(state).started(self.job(state)))
        name = task_name(self.place.path, self._at(started).kind)
        # It is offered no more, or a press would start it once more from its beginning.
        return replace(started, ended=tuple(one for one in state.ended if one != name))

    def stop(self, state: State) -> State:
        """End the run, without an outcome."""
        return self.place.write(state, self._at(state).ended())

    def forget(self, state: State) -> State:
        """End the run, and forget the last outcome."""
        return self.place.write(state, replace(self._at(state).ended(), outcome=None))

    def runs(self, state: State) -> bool:
        """Whether a job of the task runs."""
        job = self._at(state).running
        return job is not None and self.own(job)

    def outcome(self, state: State) -> Outcome[Job, Result] | None:
        """Return what came of the last job, or None."""
        return self._at(state).outcome if self.kept is None else self.kept(state)

    def result(self, state: State) -> Result | None:
        """Return what the last job found, or None."""
        outcome = self.outcome(state)
        return None if outcome is None else outcome.result

    def required(self, state: State, what: str, problem: str) -> tuple[Job, Result]:
        """Return the last job and what it found.

        Raises:
            InvalidInput: If there is nothing.
        """
        outcome = self.outcome(state)
        if outcome is None or outcome.result is None:
            raise InvalidInput(what, problem)
        return outcome.job, outcome.result

    def changes(self, state: State) -> tuple[str, ...]:
        """Return what the last outcome depends on that has changed since, in words."""
        outcome = self.outcome(state)
        if outcome is None:
            return ()
        try:
            now = self.job(state) if self.again is None else self.again(state, outcome)
        except InvalidInput as error:  # there is no such job by now
            return (error.argument,)
        except PaminsaError:
            return ("what it was made of",)
        names = changed_names(outcome.job, now)
        return tuple(name for name in names if self.bodies or name != BODIES)

    def now(self, state: State) -> Job | None:
        """Return the job of a state, or None if there is none."""
        try:
            return self.job(state)
        except PaminsaError:
            return None

    def is_stale(self, state: State) -> bool:
        """Whether there is an outcome that is not of the state by now."""
        return bool(self.changes(state))

    def stale_text(self, state: State) -> str:
        """Return what has changed since the last outcome, as a sentence; empty if it holds."""
        return sentence(self.changes(state))

    def text(self, state: State, testid: str, running: str, failed: str) -> str:
        """Return that the task runs, or why there is nothing.

        It is empty as long as nothing was started, and where a result is to be shown.

        Args:
            state: The state.
            testid: Name for tests.
            running: Said while it runs.
            failed: Title above the reason.
        """
        outcome = self.outcome(state)
        if self.runs(state):
            return status(testid, "plain", running)
        if outcome is None or outcome.result is not None:
            return ""
        return status(testid, "bad", failed, outcome.problem, self.stale_text(state))

    def buttons(self, start: Button) -> tuple[Button, ProgressBar, Button]:
        """Return its button and, while it runs, its progress and a button that stops it."""
        key = start.key

        def can_start(state: State) -> bool:
            return not self.runs(state) and (start.visible is None or start.visible(state))

        return (
            replace(start, visible=can_start),
            ProgressBar(
                f"{key}.progress", visible=self.runs, read=lambda state: self._at(state).done
            ),
            Button(
                f"{key}.stop", "Stop", color="gray", visible=self.runs, undo=False,
                effect=self.stop, hint=STOP_HINT,
            ),
        )  # fmt: skip

    @property
    def worker(self) -> Worker:
        """The entry that runs its jobs; of tasks that share a place, one has to be on the page."""
        return Worker(self.place.path, make=partial(TaskRunner, task=self))

    def report(self, state: State, ticket: int, done: float, **known: Any) -> State:
        """Take over what part of a run is done and what is known, if it is still wanted.

        Of what is known, that counts which the place has room for.
        """
        own = self._at(state)
        if not own.runs(ticket):
            return state
        room = {item.name for item in fields(own)}
        kept = {name: value for name, value in known.items() if name in room}
        return self.place.write(state, replace(own, done=done, **kept))

    def deliver(self, state: State, ticket: int, outcome: Outcome[Job, Result]) -> State:
        """Take over the outcome of a run; that of an older one is dropped."""
        own = self._at(state)
        if not own.runs(ticket):
            return state
        if self.receive is not None:
            return self.receive(self.place.write(state, own.ended()), outcome)
        return self.place.write(state, replace(own.ended(), outcome=outcome))

    def _at(self, state: State) -> TaskState[Job, Result]:
        return self.place.read(state)


@dataclass(frozen=True)
class Follower(Generic[Job, Result]):
    """What follows what is shown: whenever it is another job, that one is run.

    Nothing is run for a preview, which shows one robot after the other; see `NOT_OF_PREVIEW`.

    Attributes:
        place: Where the state holds the last outcome.
        wanted: The job of a frame, or None for none.
        find: Finds the result of a job; called on a thread.
        receive: Takes an outcome over, where that is more than to keep it.
        idle: Whether a job that has just changed waits until nothing is dragged.
    """

    place: Place[Outcome[Job, Result] | None]
    wanted: Callable[[Frame], Job | None]
    find: Callable[[Job, Progress], Result]
    _: KW_ONLY
    receive: Callable[[State, Outcome[Job, Result]], State] | None = None
    idle: Given[bool] = False

    @property
    def worker(self) -> Worker:
        """The entry that runs its jobs."""
        return Worker(self.place.path, make=partial(FollowerRunner, follower=self))

    def deliver(self, state: State, outcome: Outcome[Job, Result]) -> State:
        """Take over an outcome."""
        if self.receive is not None:
            return self.receive(state, outcome)
        return self.place.write(state, outcome)


NOT_OF_PREVIEW = "Not computed of the robots that a search shows while it runs."
"""What the text of a follower's result says in a preview."""


class TaskRun(NamedTuple):
    """A run of a job; two of the same job are told apart by their tickets."""

    ticket: int
    job: Any


class _Unwanted(Exception):
    """Nobody waits for the result of a run any more."""


class Background:
    """Runs the newest run that is requested, on a thread.

    One runs at a time, and of those that wait only the newest.

    Attributes:
        wanted: The run that was requested last, or None.
    """

    def __init__(
        self,
        name: str,
        find: Callable[[Any, Progress], Any],
        deliver: Callable[[TaskRun, Outcome], None],
        report: Callable[..., bool],
        closed: Callable[[], bool],
    ) -> None:
        """Prepare for jobs of one kind.

        Args:
            name: What it is of, for the log.
            find: Finds the result of a job.
            deliver: Called with a run that is still wanted and its outcome.
            report: Called with a run that is still wanted, what part of it is done, and what is
                known; returns whether to stop with what it has.
            closed: Whether nothing is wanted any more.
        """
        self._name, self._find, self._closed = name, find, closed
        self._deliver, self._report = deliver, report
        self._lock = threading.Lock()
        self.wanted: TaskRun | None = None
        self._waiting: TaskRun | None = None
        self._busy = False

    def request(self, run: TaskRun | None) -> None:
        """Run a job, unless it is the run requested last; with None, cancel what runs."""
        with self._lock:
            if run is self.wanted or (run and self.wanted and run.ticket == self.wanted.ticket):
                return
            self.wanted = self._waiting = run
            if run is None or self._busy:
                return
            self._busy = True
        threads.start(self._work)

    def _work(self) -> None:
        while True:
            with self._lock:
                run, self._waiting = self._waiting, None
                if run is None or self._closed():
                    self._busy = False
                    return
            try:
                outcome = solve(self._find, run.job, partial(self._progress, run))
            except _Unwanted:
                continue
            except Exception:
                log.exception("a job in the background failed: %s", self._name)
                error = PaminsaError("it failed; details are in the program’s log")
                outcome = Outcome(run.job, error=error)
            if self.wanted is run:
                self._deliver(run, outcome)

    def _progress(self, run: TaskRun, done: float, /, **known: Any) -> bool:
        if self._closed() or self.wanted is not run:
            raise _Unwanted  # or it would still work out what it has found so far
        return self._report(run, done, **known)


class TaskRunner:
    """A view that runs what a task has started; what comes of it is an action of the session."""

    def __init__(self, session: Session, task: Task[Any, Any]) -> None:
        """Prepare for the jobs of a task."""
        self._session, self._task = session, task
        self.background = Background(
            task.place.path, task.find, self._deliver, self._report, lambda: session.closed
        )

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Run what was started, and cancel what was stopped."""
        own = self._task.place.read(frame.state)
        self.background.request(None if own.running is None else TaskRun(own.ticket, own.running))

    def _deliver(self, run: TaskRun, outcome: Outcome) -> None:
        action = partial(self._task.deliver, ticket=run.ticket, outcome=outcome)
        self._session.dispatch(f"{self._task.place.path}.result", action, step=self._task.undo)

    def _report(self, run: TaskRun, done: float, **known: Any) -> bool:
        own = self._task.place.read(self._session.state)  # a view may be late to say so
        if not own.runs(run.ticket):
            raise _Unwanted
        action = partial(self._task.report, ticket=run.ticket, done=done, **known)
        source = f"{self._task.place.path}.progress"
        self._session.dispatch(source, action, step=False, overtakes=True)
        return own.stopping


class FollowerRunner:
    """A view that runs the job of what is shown, unless it can wait or its outcome is known."""

    def __init__(self, session: Session, follower: Follower[Any, Any]) -> None:
        """Prepare for the jobs of a follower."""
        self._session, self._follower = session, follower
        self._ticket = 0
        self._seen: Any = None
        self._since = 0.0
        self.background = Background(
            follower.place.path, follower.find, self._deliver, lambda run, done, **known: False,
            lambda: session.closed,
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Request the job that is wanted."""
        follower, state = self._follower, frame.state
        job = None if frame.is_preview else follower.wanted(frame)
        known, now = follower.place.read(state), time.monotonic()
        if job != self._seen:
            self._seen, self._since = job, now
        last = self.background.wanted
        requested = last is not None and last.job == job
        changing = dragging and not requested and now - self._since < IDLE_DELAY
        waits = changing and given(follower.idle, state)
        if job is None or waits or (known is not None and known.job == job):
            self.background.request(None)
        elif not requested:
            self._ticket += 1
            self.background.request(TaskRun(self._ticket, job))

    def _deliver(self, run: TaskRun, outcome: Outcome) -> None:
        action = partial(self._follower.deliver, outcome=outcome)
        self._session.dispatch(f"{self._follower.place.path}.result", action, step=False)
