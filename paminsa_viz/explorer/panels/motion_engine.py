"""An engine's torques beside the formulae's: when it is asked, and what the page says of it."""

from __future__ import annotations

import time
from html import escape

from paminsa_viz.engines.comparison import Comparison
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.engine_check import Answer, ask_engine
from paminsa_viz.explorer.motion.results import MotionResults
from paminsa_viz.explorer.panels.motion_numbers import verdict
from paminsa_viz.explorer.session import IDLE_DELAY, Session
from paminsa_viz.palette import BAD, INK, MUTED
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import number

MARK = (
    '<span style="display:inline-block;width:6px;height:6px;border:1px solid '
    f'{INK};border-radius:50%;margin-right:4px;vertical-align:1px"></span>'
)
"""A mark as the charts have them, for a legend."""


class EngineChecker:
    """Asks the engine as soon as a design and motion have not changed for a while."""

    def __init__(self, session: Session) -> None:
        self._job: BackgroundJob[TrajectoryAnalysis, Answer] = BackgroundJob(
            session, "plots.engine_answer", lambda analysis, _: ask_engine(analysis),
            motions.receive_engine_answer,
            failed=lambda analysis, problem: Answer(analysis, None, problem), undo=False,
        )  # fmt: skip
        self._seen: TrajectoryAnalysis | None = None
        self._since = 0.0

    def draw(self, found: MotionResults | None, dragging: bool) -> None:
        """Ask about what is shown, unless it still changes or the answer is known.

        Args:
            found: The motion that an engine's torques are wanted for, or None.
            dragging: Whether the state changes; perhaps something else, or the motion plays.
        """
        now = time.monotonic()
        wanted = None if found is None else found.analysis
        if wanted is not self._seen:
            self._seen, self._since = wanted, now
        if found is None or found.answer is not None:
            return
        if not dragging or now - self._since >= IDLE_DELAY:
            self._job.request(wanted)


def verdict_html(answer: Answer | None, found: MotionResults) -> str:
    """Return what the line below the charts says of the engine."""
    if answer is None:
        return f'<span style="color:{MUTED}">engine: computing …</span>'
    torques = answer.found
    if torques is None:
        return f'<b style="color:{BAD}">no engine’s torques</b>: {escape(answer.problem)}'
    own, tolerance = torques.comparison(found.analysis), torques.tolerance
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
