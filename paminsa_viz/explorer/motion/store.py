"""What a session has worked out along its motion, kept so that little is worked out again."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.explorer.motion.checking import Answer
from paminsa_viz.explorer.motion.planning import planned
from paminsa_viz.explorer.state import State
from paminsa_viz.model import Design, Misprint
from paminsa_viz.trajectory import (
    Simulation,
    SolvedTrajectory,
    Trajectory,
    TrajectoryAnalysis,
    analyze,
)


@dataclass(frozen=True, eq=False)
class Analyzed:
    """A motion and all that is plotted of it.

    Attributes:
        present: The present design on the motion.
        reference: The pinned design on the same motion, or None.
        printed: The present design by the formulae as printed, or None if they are not shown.
        simulation: The last simulation, or None.
        answer: What came of asking an engine about the present design on this motion; None as long
            as it was not asked, or only about another.
    """

    present: TrajectoryAnalysis
    reference: TrajectoryAnalysis | None
    printed: TrajectoryAnalysis | None
    simulation: Simulation | None
    answer: Answer | None = None


class MotionStore:
    """Analyses the motion of one session; used by its worker alone."""

    def __init__(self) -> None:
        self._solved: dict[str, SolvedTrajectory] = {}
        self._last: dict[str, tuple[tuple[object, ...], TrajectoryAnalysis]] = {}

    def present(self, state: State) -> TrajectoryAnalysis | None:
        """Return the present design on the present motion, or None without a motion."""
        document = state.document
        found = planned(document.motion, document.design)
        if found.trajectory is None:
            return None
        return self._analysis("present", document.design, found.trajectory)

    def all(self, state: State) -> Analyzed | None:
        """Return everything that is plotted, or None without a motion."""
        present = self.present(state)
        if present is None:
            return None
        document, motion = state.document, present.trajectory
        reference = printed = None
        if document.reference is not None:
            reference = self._analysis("reference", document.reference, motion)
        if state.plots.printed:
            printed = self._analysis("printed", document.design, motion, Misprint.ALL)
        outcome = state.simulating.outcome
        answer = state.engine_answer
        if answer is not None and not answer.serves(present):
            answer = None
        simulation = outcome.simulation if outcome else None
        return Analyzed(present, reference, printed, simulation, answer)

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
