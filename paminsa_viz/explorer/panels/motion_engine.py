"""An engine's torques beside the formulae's: when it is asked, and what the page says of it."""

from __future__ import annotations

import threading
import time
from functools import partial
from html import escape

from paminsa_viz.engines.comparison import Comparison
from paminsa_viz.explorer.motion.checking import Answer, ask_engine, taken
from paminsa_viz.explorer.motion.store import MotionResults
from paminsa_viz.explorer.panels.motion_numbers import verdict
from paminsa_viz.explorer.session import REST, Session
from paminsa_viz.palette import BAD, INK, MUTED
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import number

MARK = (
    '<span style="display:inline-block;width:6px;height:6px;border:1px solid '
    f'{INK};border-radius:50%;margin-right:4px;vertical-align:1px"></span>'
)
"""A mark as the charts have them, for a legend."""


class EngineChecker:
    """Asks the engine on a thread of its own, as soon as a design and motion have held for a while.

    One question runs at a time, and of those that wait only the newest; its answer comes back as a
    request.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._lock = threading.Lock()
        self._seen: TrajectoryAnalysis | None = None
        self._since = 0.0
        self._asked: TrajectoryAnalysis | None = None
        self._next: TrajectoryAnalysis | None = None
        self._busy = False

    def draw(self, found: MotionResults | None, moving: bool) -> None:
        """Ask about what is shown, unless the hand still changes it or it is known.

        Args:
            found: The motion that an engine's torques are wanted for, or None.
            moving: Whether the hand moves; it may move something else, or the motion may play.
        """
        now = time.monotonic()
        wanted = None if found is None else found.present
        if wanted is not self._seen:
            self._seen, self._since = wanted, now
        if found is None or found.answer is not None or wanted is self._asked:
            return
        if not moving or now - self._since >= REST:
            self._ask(found.present)

    def _ask(self, analysis: TrajectoryAnalysis) -> None:
        with self._lock:
            self._asked = self._next = analysis
            if self._busy:
                return
            self._busy = True
        threading.Thread(target=self._work, name="paminsa-engine", daemon=True).start()

    def _work(self) -> None:
        while True:
            with self._lock:
                analysis, self._next = self._next, None
                if analysis is None or self._session.closed:
                    self._busy = False
                    return
            answer = ask_engine(analysis)
            if self._next is None:
                intent = partial(taken, answer=answer)
                self._session.dispatch("plots.engine_answer", intent, step=False)


def verdict_html(answer: Answer | None, found: MotionResults) -> str:
    """Return what the line below the charts says of the engine."""
    if answer is None:
        return f'<span style="color:{MUTED}">engine: computing …</span>'
    torques = answer.found
    if torques is None:
        return f'<b style="color:{BAD}">no engine’s torques</b>: {escape(answer.problem)}'
    own, tolerance = torques.comparison(found.present), torques.tolerance
    said = (
        f"{escape(torques.engine.name)}, {len(own.computed)} samples: "
        f"{verdict(own.agrees(tolerance))}, off by {_share(own)} of the largest torque"
    )
    if found.sources.published is not None:
        published = torques.comparison(found.sources.published)
        passed = published.agrees(tolerance)
        said += f" · as published {verdict(passed)}, {_share(published)}"
        said += "" if passed else ": <b>the misprints</b>"
    return said


def _share(comparison: Comparison) -> str:
    return number(float(comparison.relative.max()), 2)
