"""Clearance on the page: of the pose and along the motion, found in the background when idle."""

from __future__ import annotations

from paminsa_viz.blocks.clearance import size_advice
from paminsa_viz.clearance import NearestPoints, clearance_reason
from paminsa_viz.explorer.state.clearance import MotionJob, PoseJob
from paminsa_viz.explorer.state.state import State
from paminsa_viz.plots.series_builders import MotionClearance
from paminsa_viz.trajectory import TrajectoryAnalysis


def pose_job(state: State) -> PoseJob:
    """Return what is wanted at the last reachable pose, with the current masses."""
    return PoseJob(state.shown_design, state.last_reachable.pose, state.clearance.settings.pairs)


def motion_job(state: State, analysis: TrajectoryAnalysis) -> MotionJob:
    """Return what is wanted along the motion."""
    pairs = state.clearance.settings.pairs
    return MotionJob(analysis.design, analysis.trajectory, pairs, analysis)


def nearest(state: State) -> NearestPoints | None:
    """Return the nearest bodies of the last reachable pose, None if they are not known."""
    outcome = state.clearance.pose
    if outcome is None or outcome.job.pose != state.last_reachable.pose:
        return None
    return outcome.result if outcome.job == pose_job(state) else None


def along(state: State, analysis: TrajectoryAnalysis) -> MotionClearance | None:
    """Return the clearance along the motion, None if it is not known."""
    outcome = state.clearance.motion
    known = outcome is not None and outcome.job == motion_job(state, analysis)
    return outcome.result if outcome is not None and known else None


def headline(distance: float) -> tuple[str, str]:
    """Return level and words of a status for a clearance that is too little [m]."""
    return ("bad", "bodies overlap") if distance < 0 else ("warn", "bodies are close")


def reason(state: State) -> tuple[float, str]:
    """Return the least clearance of the pose [m], NaN if unknown, and why it is too little."""
    found = nearest(state)
    if found is None:
        return float("nan"), ""
    why = clearance_reason(found.distance, found.names, state.clearance.settings.required)
    advice = size_advice(state.last_reachable.geometry)
    return found.distance, f"{why}; {advice}" if why and advice else why
