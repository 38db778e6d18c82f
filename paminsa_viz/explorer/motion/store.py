"""What a session has worked out along its motion, kept so that little is worked out again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.explorer.motion.checking import Answer
from paminsa_viz.explorer.motion.planning import planned
from paminsa_viz.explorer.state import State
from paminsa_viz.model import Design, Misprint
from paminsa_viz.plots.series import EngineTorques, SeriesSources
from paminsa_viz.trajectory import (
    SolvedTrajectory,
    Trajectory,
    TrajectoryAnalysis,
    analyze,
)


@dataclass(frozen=True, eq=False)
class MotionResults:
    """A motion and all that is plotted of it.

    Attributes:
        sources: What the curves are made of. An engine's torques that are wanted and not known yet
            are NaN there.
        answer: What came of asking an engine about the present design on this motion; None as long
            as it was not asked, or only about another.
    """

    sources: SeriesSources
    answer: Answer | None = None

    @property
    def present(self) -> TrajectoryAnalysis:
        """The present design on the motion."""
        return self.sources.analysis


class MotionStore:
    """Analyses the motion of one session; used by its worker alone."""

    def __init__(self) -> None:
        self._solved: dict[str, SolvedTrajectory] = {}
        self._last: dict[str, tuple[tuple[object, ...], TrajectoryAnalysis]] = {}
        self._results: tuple[tuple[object, ...], MotionResults] | None = None

    def present(self, state: State) -> TrajectoryAnalysis | None:
        """Return the present design on the present motion, or None without a motion."""
        document = state.document
        found = planned(document.motion, document.design)
        if found.trajectory is None:
            return None
        return self._analysis("present", document.design, found.trajectory)

    def all(self, state: State) -> MotionResults | None:
        """Return everything that is plotted, or None without a motion; the same while it holds."""
        present = self.present(state)
        if present is None:
            return None
        document, motion = state.document, present.trajectory
        reference = published = None
        if document.reference is not None:
            reference = self._analysis("reference", document.reference, motion)
        if state.plots.published:
            published = self._analysis("published", document.design, motion, Misprint.ALL)
        outcome, answer = state.simulating.outcome, state.engine_answer
        simulation = outcome.simulation if outcome else None
        if answer is not None and not answer.serves(present):
            answer = None
        engine_wanted = state.plots.needs_engine
        key = (present, reference, published, simulation, answer, engine_wanted)
        if self._results is None or self._results[0] != key:
            engine = None
            if engine_wanted:
                found = answer.found if answer else None
                unknown = np.full(present.torque.shape, np.nan)
                engine = found.engine if found else EngineTorques("engine", unknown)
            sources = SeriesSources(present, reference, published, simulation, engine)
            self._results = key, MotionResults(sources, answer)
        return self._results[1]

    def _analysis(
        self,
        role: str,
        design: Design,
        trajectory: Trajectory,
        misprints: Misprint = Misprint.NONE,
    ) -> TrajectoryAnalysis:
        key = (design, trajectory, misprints)
        known = self._last.get(role)
        if known is not None and known[0] == key:
            return known[1]
        found = analyze(design, trajectory, misprints=misprints, keep=self._solved.get(role))
        self._solved[role] = found.solved
        self._last[role] = (key, found)
        return found
