"""Least clearance between the robot's bodies along a motion, and its series."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.clearance import ALL_PAIRS, PairGroup, clearance, group_clearance
from paminsa_viz.palette import ACTUATOR_COLORS, INK, MUTED, OK, REFERENCE
from paminsa_viz.plots.series import SeriesPanel, SeriesSources, Trace, Values
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.units import format_value

SAMPLES = 241
"""Samples of a motion that are looked at, in equal distance; then all next to the least."""

_COLORS = (INK, REFERENCE, *ACTUATOR_COLORS, OK)
"""Of the groups of pairs."""


@dataclass(frozen=True, eq=False)
class MotionClearance:
    """Least clearance along a motion.

    Attributes:
        samples: (k,) which samples of the motion were looked at.
        least: (k,) least distance of two bodies there [m]; NaN where the robot cannot be.
        groups: Groups of pairs that were checked and have pairs.
        by_group: (k, groups) least distance of each group [m].
        distance: The least of all; NaN where there is none [m].
        t: When that is [s].
        names: The two bodies.
    """

    samples: NDArray[np.intp]
    least: Values
    groups: tuple[PairGroup, ...]
    by_group: Values
    distance: float = np.nan
    t: float = np.nan
    names: tuple[str, str] = ("", "")


def motion_clearance(
    analysis: TrajectoryAnalysis, pairs: Iterable[PairGroup] = ALL_PAIRS
) -> MotionClearance:
    """Return the least clearance of a design along its motion.

    Args:
        analysis: The design on the motion.
        pairs: Groups of pairs that are checked.
    """
    motion, chosen = analysis.trajectory, tuple(g for g in PairGroup if g in frozenset(pairs))
    count = min(motion.size, SAMPLES)
    samples = np.linspace(0, motion.size - 1, count).round().astype(np.intp)
    pose = np.where(analysis.check.ok[:, None], motion.pose, np.nan)
    first = clearance(analysis.design, pose[samples], chosen).least
    if np.isfinite(first).any():
        low = int(np.nanargmin(first))
        near = samples[[max(low - 1, 0), min(low + 1, count - 1)]]
        samples = np.union1d(samples, np.arange(near[0], near[1] + 1))
    found = clearance(analysis.design, pose[samples], chosen)
    by_group = group_clearance(analysis.design, pose[samples], chosen)
    known = [i for i in range(len(chosen)) if np.isfinite(by_group[:, i]).any()]
    groups = tuple(chosen[i] for i in known)
    if not np.isfinite(found.least).any():
        return MotionClearance(samples, found.least, groups, by_group[:, known])
    low = int(np.nanargmin(found.least))
    return MotionClearance(
        samples, found.least, groups, by_group[:, known],
        float(found.least[low]), float(motion.t[samples[low]]), found.pairs[found.pair[low]],
    )  # fmt: skip


def unknown_clearance(analysis: TrajectoryAnalysis) -> MotionClearance:
    """Return what stands for a clearance that is not computed yet: no values."""
    none = np.array([0, analysis.trajectory.size - 1], dtype=np.intp)
    return MotionClearance(none, np.full(2, np.nan), (), np.zeros((2, 0)))


def clearance_panels(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the least clearance of all bodies, and that of each group of pairs."""
    analysis = sources.analysis
    found = sources.clearance
    if not isinstance(found, MotionClearance):
        found = motion_clearance(analysis)
    time = analysis.trajectory.t

    def spread(values: Values) -> Values:
        known = np.isfinite(values)
        if not known.any():
            return np.full(time.size, np.nan)
        between = np.interp(time, time[found.samples], values)
        between[~analysis.check.ok] = np.nan
        return between

    peak = (found.t, found.distance) if np.isfinite(found.distance) else None
    notes = ()
    if peak is not None:
        text = f"{format_value(found.distance, 'm', 3)} at {format_value(found.t, 's', 3)}"
        notes = ((f"{text}: {found.names[0]} and {found.names[1]}", MUTED),)
    least = Trace("least", spread(found.least), INK, width=1.3, peak=peak)
    yield SeriesPanel("Least clearance", "all", "d", "m", INK, (least,), notes)
    traces = tuple(
        Trace(group.value, spread(found.by_group[:, i]), _COLORS[list(PairGroup).index(group)])
        for i, group in enumerate(found.groups)
    )
    none = Trace("no pairs", np.full(time.size, np.nan), INK)
    yield SeriesPanel("Clearance by pairs", "pairs", "d", "m", INK, traces or (none,))
