"""Clearance of the pose and along the motion, found whenever what is shown has changed."""

from __future__ import annotations

from paminsa_viz.clearance import NearestPoints, PairGroup, nearest_points
from paminsa_viz.explorer.core.clearance import motion_job, pose_job
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.kit.task import Follower
from paminsa_viz.explorer.state.clearance import MotionJob, PoseJob
from paminsa_viz.explorer.state.state import State
from paminsa_viz.plots.series_builders import MotionClearance, motion_clearance


def set_pairs(state: State, group: PairGroup, checked: bool) -> State:
    """Check a group of pairs, or no longer."""
    before = state.clearance.settings.pairs
    pairs = before | {group} if checked else before - {group}
    return state.updated("clearance.settings", pairs=frozenset(pairs))


def find_nearest(job: PoseJob, _: object) -> NearestPoints | None:
    """Find the nearest bodies."""
    return nearest_points(job.design, job.pose, job.pairs)


def find_along(job: MotionJob, _: object) -> MotionClearance:
    """Find the clearance along a motion."""
    return motion_clearance(job.analysis, job.pairs)


def _motion_job(frame: Frame) -> MotionJob | None:
    return None if frame.analysis is None else motion_job(frame.state, frame.analysis)


OF_POSE = Follower(
    Place(lambda state: state.clearance.pose), lambda frame: pose_job(frame.state), find_nearest,
    idle=True,
)  # fmt: skip

ALONG_MOTION = Follower(
    Place(lambda state: state.clearance.motion), _motion_job, find_along, idle=True
)
