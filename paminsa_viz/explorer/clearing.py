"""Clearance on the page: of the pose and along the motion, found in the background when idle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from paminsa_viz.clearance import ALL_PAIRS, NearestPoints, PairGroup
from paminsa_viz.model import Design
from paminsa_viz.trajectory import TrajectoryAnalysis

if TYPE_CHECKING:
    from paminsa_viz.explorer.frame import Frame
    from paminsa_viz.explorer.motion.results import MotionStore
    from paminsa_viz.explorer.session import Session
    from paminsa_viz.explorer.state import State
    from paminsa_viz.plots.clearance_series import MotionClearance

REQUIRED = (0.0, 0.1)
"""Least and largest clearance that can be asked for [m]."""


@dataclass(frozen=True)
class ClearanceSettings:
    """What is checked.

    Attributes:
        pairs: Groups of pairs of bodies.
        required: Least distance of two bodies that is no reason for a warning [m].
    """

    pairs: frozenset[PairGroup] = ALL_PAIRS
    required: float = 0.005


@dataclass(frozen=True)
class PoseJob:
    """The nearest bodies of a design at a pose."""

    design: Design
    pose: tuple[float, ...]
    pairs: frozenset[PairGroup]


@dataclass(frozen=True, eq=False)
class MotionJob:
    """The least clearance of a design along its motion."""

    analysis: TrajectoryAnalysis
    pairs: frozenset[PairGroup]

    def serves(self, analysis: TrajectoryAnalysis, pairs: frozenset[PairGroup]) -> bool:
        """Whether its result is that of a design on a motion."""
        own = self.analysis
        same = own.trajectory is analysis.trajectory and own.design == analysis.design
        return same and self.pairs == pairs


@dataclass(frozen=True, eq=False)
class PoseOutcome:
    """The nearest bodies; None where there are none."""

    job: PoseJob
    nearest: NearestPoints | None


@dataclass(frozen=True, eq=False)
class MotionOutcome:
    """The clearance along a motion; None if it could not be found."""

    job: MotionJob
    found: MotionClearance | None


@dataclass(frozen=True)
class Clearing:
    """What is known of clearances.

    Attributes:
        pose, motion: The last results; they may be of another pose or motion.
    """

    pose: PoseOutcome | None = None
    motion: MotionOutcome | None = None


def pose_job(state: State) -> PoseJob:
    """Return what is wanted at the last reachable pose, with the current masses."""
    from dataclasses import replace

    document, last = state.document, state.last_reachable
    design = document.design
    if last.geometry != design.geometry:
        design = replace(design, geometry=last.geometry)
    return PoseJob(design, last.pose, state.clearance_view.pairs)


def nearest(state: State) -> NearestPoints | None:
    """Return the nearest bodies of the last reachable pose, None if they are not known."""
    outcome = state.clearing.pose
    if outcome is None or outcome.job.pose != state.last_reachable.pose:
        return None
    return outcome.nearest if outcome.job == pose_job(state) else None


def along(state: State, analysis: TrajectoryAnalysis) -> MotionClearance | None:
    """Return the clearance along the motion, None if it is not known."""
    outcome = state.clearing.motion
    served = outcome is not None and outcome.job.serves(analysis, state.clearance_view.pairs)
    return outcome.found if outcome is not None and served else None


def reason(state: State) -> tuple[float, str]:
    """Return the least clearance of the pose [m], NaN if unknown, and why it is too little."""
    from paminsa_viz.clearance import clearance_reason

    found = nearest(state)
    if found is None:
        return float("nan"), ""
    required = state.clearance_view.required
    return found.distance, clearance_reason(found.distance, found.names, required)


def set_pairs(state: State, group: PairGroup, checked: bool) -> State:
    """Check a group of pairs, or no longer."""
    before = state.clearance_view.pairs
    pairs = before | {group} if checked else before - {group}
    return state.updated("clearance_view", pairs=frozenset(pairs))


class ClearanceChecker:
    """A view that finds clearances in the background, once nothing is dragged."""

    def __init__(self, session: Session, motions: MotionStore) -> None:
        from paminsa_viz.explorer.background import BackgroundJob

        self._motions = motions
        job: Any = partial(BackgroundJob, session, progress=None, undo=False)
        self._pose = job(
            "clearance.pose", lambda wanted, _: find_nearest(wanted),
            lambda state, outcome: state.updated("clearing", pose=outcome),
            failed=lambda wanted, _: PoseOutcome(wanted, None),
        )  # fmt: skip
        self._motion = job(
            "clearance.motion", lambda wanted, _: find_along(wanted),
            lambda state, outcome: state.updated("clearing", motion=outcome),
            failed=lambda wanted, _: MotionOutcome(wanted, None),
        )  # fmt: skip
        self._wanted: PoseJob | None = None
        self._along: MotionJob | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Ask for what is not known."""
        state = frame.state
        if dragging:
            return
        wanted = pose_job(state)
        known = state.clearing.pose
        if wanted != self._wanted and (known is None or known.job != wanted):
            self._wanted = wanted
            self._pose.request(wanted)
        analysis = self._motions.analysis(state)
        pairs = state.clearance_view.pairs
        if analysis is None or (self._along and self._along.serves(analysis, pairs)):
            return
        self._along = MotionJob(analysis, pairs)
        self._motion.request(self._along)


def find_nearest(job: PoseJob) -> PoseOutcome:
    """Find the nearest bodies."""
    from paminsa_viz.clearance import nearest_points

    return PoseOutcome(job, nearest_points(job.design, job.pose, job.pairs))


def find_along(job: MotionJob) -> MotionOutcome:
    """Find the clearance along a motion."""
    from paminsa_viz.plots.clearance_series import motion_clearance

    return MotionOutcome(job, motion_clearance(job.analysis, job.pairs))
