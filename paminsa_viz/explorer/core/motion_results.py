"""Results along a session's motion, kept so that little is computed again, and its path."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.core.clearance import along
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.state.simulation import Answer, serves
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Design, Misprint
from paminsa_viz.plots.series import EngineTorques, SeriesSources, runs
from paminsa_viz.plots.series_builders import unknown_clearance
from paminsa_viz.trajectory import Simulation, Trajectory, TrajectoryAnalysis, analyze

MOST_POINTS = 241
"""About how many points of a path are drawn."""


@dataclass(frozen=True, eq=False)
class MotionResults:
    """A motion and all that is plotted of it.

    Attributes:
        sources: What the curves are made of. An engine's torques that are wanted and not known yet
            are NaN there.
        answer: What came of asking an engine about the current design on this motion; None as long
            as it was not asked, or only about another.
    """

    sources: SeriesSources
    answer: Answer | None = None

    @property
    def analysis(self) -> TrajectoryAnalysis:
        """The current design on the motion."""
        return self.sources.analysis


class MotionStore:
    """Analyses the motion of one session; used by its worker alone."""

    def __init__(self) -> None:
        self._last: dict[str, TrajectoryAnalysis] = {}
        self._collect = lru_cache(maxsize=1)(_collect)
        self._unknown = lru_cache(maxsize=1)(unknown_clearance)

    def analysis(self, state: State) -> TrajectoryAnalysis | None:
        """Return the current design on the current motion, or None without a motion."""
        document = state.document
        found = planned(document.motion, document.design)
        if found.trajectory is None:
            return None
        return self._analysis("current", document.design, found.trajectory)

    def all(self, state: State) -> MotionResults | None:
        """Return everything that is plotted, or None without a motion; the same while it holds."""
        current = self.analysis(state)
        if current is None:
            return None
        document, motion = state.document, current.trajectory
        reference = published = None
        if document.reference is not None:
            reference = self._analysis("reference", document.reference, motion)
        if state.plots.published:
            published = self._analysis("published", document.design, motion, Misprint.ALL)
        simulation, answer = state.simulation.result, state.engine_answer
        if answer is not None and not serves(answer, current, state.plots.checker):
            answer = None
        near = None
        if state.plots.plot == "clearance":
            near = along(state, current) or self._unknown(current)
        return self._collect(
            current, reference, published, simulation, answer, state.plots.needs_engine, near
        )

    def _analysis(
        self, role: str, design: Design, trajectory: Trajectory, misprints: Misprint = Misprint.NONE
    ) -> TrajectoryAnalysis:
        last = self._last.get(role)
        if last is None or last.trajectory is not trajectory or last.design != design:
            keep = None if last is None else last.solved
            last = analyze(design, trajectory, misprints=misprints, keep=keep)
            self._last[role] = last
        return last


def _collect(
    current: TrajectoryAnalysis,
    reference: TrajectoryAnalysis | None,
    published: TrajectoryAnalysis | None,
    simulation: Simulation | None,
    answer: Answer | None,
    engine_wanted: bool,
    clearance: object | None,
) -> MotionResults:
    engine = None
    if engine_wanted:
        found = answer.result if answer else None
        unknown = np.full(current.torque.shape, np.nan)
        engine = found.engine if found else EngineTorques("engine", unknown)
    return MotionResults(
        SeriesSources(current, reference, published, simulation, engine, clearance), answer
    )


def in_piece(t: NDArray[np.float64], piece: tuple[float, float] | None) -> NDArray[np.bool_]:
    """Return which times (n,) [s] are in a piece of time, all if there is none."""
    return np.full(t.shape, True) if piece is None else (t >= piece[0]) & (t <= piece[1])


class PathSegments(NamedTuple):
    """A path of k points.

    Attributes:
        samples: (k,) which samples of the motion they are.
        place: (k, 3) x, y, z of the platform [m].
        good: Runs of points where the robot can be.
        bad: Runs where it cannot, each from the point before it to the point after it.
    """

    samples: NDArray[np.intp]
    place: NDArray[np.float64]
    good: list[slice]
    bad: list[slice]


def split_path(analysis: TrajectoryAnalysis) -> PathSegments:
    """Return the path of an analyzed motion: points evenly spread, and the ends of what fails."""
    n = analysis.trajectory.size
    edges = np.flatnonzero(np.diff(analysis.check.ok))[:MOST_POINTS]
    even = np.linspace(0, n - 1, min(n, MOST_POINTS)).round().astype(np.intp)
    samples = np.unique(np.concatenate([even, edges, edges + 1]))
    good = analysis.check.ok[samples]
    place = analysis.trajectory.pose[samples][:, [0, 1, 3]]
    bad = [slice(max(run.start - 1, 0), run.stop + 1) for run in runs(np.where(good, np.nan, 0.0))]
    return PathSegments(samples, place, runs(np.where(good, 0.0, np.nan)), bad)
