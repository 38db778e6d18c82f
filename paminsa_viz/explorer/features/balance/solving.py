"""Solves the tasks of the balance; pure functions, run on any thread."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.balancing import (
    MOTION_GOALS,
    AddedMass,
    Imbalance,
    MassChange,
    Optimum,
    StaticPeak,
    Term,
    Tornado,
    TrajectoryPeak,
    balance,
    optimize,
    pareto_front,
    tornado,
)
from paminsa_viz.balancing.changes import with_weights
from paminsa_viz.balancing.effects import UNITS, Effect, effects, sizes_in_motion
from paminsa_viz.clearance import PairGroup, clearance
from paminsa_viz.explorer.core.maps import COARSE
from paminsa_viz.explorer.state.balance import (
    Balanced,
    BalanceJob,
    BalanceKind,
    BalanceSettings,
    Goal,
    MassFront,
    WeightClearance,
    changes_of,
)
from paminsa_viz.kept import kept
from paminsa_viz.model import (
    Design,
    Geometry,
    Grid,
    InvalidInput,
    Limit,
    PaminsaError,
    xy_grid,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots.map_values import half_width
from paminsa_viz.progress import Progress
from paminsa_viz.trajectory import SolvedTrajectory, Trajectory, analyze, solve_trajectory

FRONT_POINTS = 12
MIDDLE, MIDDLE_CELLS = 0.75, 21
"""What part of the clear square around the robot's axis is looked at where lengths change, and with
how many poses along its sides."""

MOST_POSES = 240
"""About how many poses of the motion are checked for counterweights that hit."""


def run(job: BalanceJob, progress: Progress) -> Balanced | MassFront | Tornado:
    """Solve a task.

    Raises:
        PaminsaError: If it has no solution.
    """
    if job.task is BalanceKind.FRONT:
        return _front(job, progress)
    if job.task is BalanceKind.SENSITIVITY:
        return _tornado(job, progress)
    found = balance(job.design) if job.task is BalanceKind.PAPER else _best(job)
    after = tidied(found.after)
    return Balanced(after, found, effects_of(job, after), weights_of(job, after))


def _best(job: BalanceJob) -> Optimum:
    settings = job.settings
    changes = changes_of(settings, job.design)
    if settings.goal.static:
        criterion = AddedMass() if settings.goal is Goal.ADDED else MassChange()
        return balance(job.design, changes, criterion, exact=settings.exact)
    limits = _limits(settings)
    if settings.exact:
        limits.append((Imbalance(), 0.0))
    if settings.goal is not Goal.BOTH:
        term = MOTION_GOALS[settings.goal.name.lower()](motion(job))
        return optimize(job.design, changes, term, limits=limits)
    solved = motion(job)
    dynamic_torque = float(np.abs(solved.torques(job.design)[:, :3]).max())
    # Each counts by what it is now, so that the share is one of like with like.
    parts = (
        (settings.motion_weight, TrajectoryPeak(solved), dynamic_torque),
        (
            1 - settings.motion_weight, StaticPeak(job.plane(COARSE)),
            static_torque(job, job.design),
        ),
    )  # fmt: skip
    goals = [(share / (now or 1.0), term) for share, term, now in parts]
    return optimize(job.design, changes, goals, limits=limits)


def _limits(settings: BalanceSettings) -> list[tuple[Term, float]]:
    return [(AddedMass(), settings.max_added)] if settings.max_added > 0 else []


def _front(job: BalanceJob, progress: Progress) -> MassFront:
    found = pareto_front(
        job.design, changes_of(job.settings, job.design), TrajectoryPeak(motion(job)),
        StaticPeak(job.plane(COARSE)), points=FRONT_POINTS, limits=_limits(job.settings),
        progress=progress,
    )  # fmt: skip
    return MassFront(found, tuple(tidied(p.design) for p in found.points))


def _tornado(job: BalanceJob, progress: Progress) -> Tornado:
    settings, design = job.settings, job.design
    try:
        trajectory = motion(job).trajectory
    except PaminsaError:  # what it matters to the motion then has no value
        trajectory = None
    return tornado(design, middle(job), trajectory, change=settings.variation, progress=progress)


def middle(job: BalanceJob) -> Grid:
    """Return poses around the robot's axis that stay clear of limits when lengths change a little.

    Raises:
        InvalidInput: If there is no room around the axis at this theta and z.
    """
    clear = job.plane(COARSE).status == Limit.OK
    half = COARSE // 2
    sizes = range(half, 0, -1)
    most = next((n for n in sizes if clear[half - n : half + n, half - n : half + n].all()), 0)
    if most == 0:
        raise InvalidInput("pose", "at this theta and z no pose around the middle is clear")
    reach = MIDDLE * most / half * half_width(job.design.geometry)
    centers = np.linspace(-reach, reach, MIDDLE_CELLS)
    return xy_grid(centers, centers, job.theta, job.z)


def tidied(design: Design) -> Design:
    """Return the design without counterweights that weigh nothing, those at one place as one."""
    weights = [weight for weight in design.counterweights if weight.mass > 0]
    return replace(design, counterweights=with_weights((), weights))


def effects_of(job: BalanceJob, after: Design) -> tuple[Effect, ...]:
    """Return what the step from the job's design to another one does."""
    sizes = (actuator_sizes(job, design) for design in (job.design, after))
    return effects(job.design, after, dict(zip(UNITS, zip(*sizes, strict=True), strict=True)))


def weights_of(job: BalanceJob, design: Design) -> WeightClearance | None:
    """Return whether counterweights hit anything, in the plane of the maps and on the motion."""
    if not design.counterweights:
        return None
    field = job.plane(COARSE)
    poses = [field.grid.poses()[field.status == Limit.OK]]
    if job.trajectory is not None:
        every = max(job.trajectory.size // MOST_POSES, 1)
        poses.append(job.trajectory.pose[::every])
    return weight_clearance(design, np.concatenate(poses))


def weight_clearance(design: Design, poses: Array) -> WeightClearance | None:
    """Return the least clearance of counterweights over poses (n, 4); None if there are none."""
    if not any(weight.mass > 0 for weight in design.counterweights) or not len(poses):
        return None
    found = clearance(design, poses, (PairGroup.COUNTERWEIGHTS,))
    known = np.isfinite(found.least)
    if not known.any():
        return None
    low = int(np.nanargmin(found.least))
    x, y, theta, z = (float(value) for value in poses[low])
    return WeightClearance(
        float(found.least[low]), found.pairs[found.pair[low]], (x, y, theta, z),
        float((found.least[known] < 0).mean()), int(known.sum()),
    )  # fmt: skip


def actuator_sizes(job: BalanceJob, design: Design) -> Array:
    """Return what `balancing.effects` compares of M1..M4, (4, 4); NaN where there is none."""
    sizes = np.full((len(UNITS), 4), np.nan)
    field = job.of_maps()
    if (used := field.status == Limit.OK).any():
        sizes[0] = np.abs(field.torques(design)[:, used]).max(axis=1)
    try:
        solved = motion(job)
    except PaminsaError:
        return sizes
    sizes[1:] = sizes_in_motion(analyze(design, solved.trajectory, keep=solved))
    return sizes


def static_torque(job: BalanceJob, design: Design) -> float:
    """Return the largest static torque of M1..M3 over the plane [N m], 0 where no pose counts."""
    field = job.plane(COARSE)
    torque = field.torques(design)[:3, field.status == Limit.OK]
    return float(np.abs(torque).max(initial=0.0))


def motion(job: BalanceJob) -> SolvedTrajectory:
    """Return the current motion, solved.

    Raises:
        ImpossibleTrajectory: If the robot cannot run it.
        PaminsaError: If there is none.
    """
    if job.trajectory is None:
        raise PaminsaError(job.problem or "there is no motion yet")
    design = job.design
    solved = _solved(design.geometry, job.trajectory, design.gravity)
    solved.check.require()
    return solved


@kept(2)
def _solved(geometry: Geometry, trajectory: Trajectory, gravity: float) -> SolvedTrajectory:
    return solve_trajectory(geometry, trajectory, gravity=gravity)
