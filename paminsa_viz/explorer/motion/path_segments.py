"""The path of a motion, cut where it begins and ends to fail."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.trajectory import TrajectoryAnalysis

MOST_POINTS: Final = 241
"""About how many points of a path are drawn."""


class Cut(NamedTuple):
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


def cut(analysis: TrajectoryAnalysis) -> Cut:
    """Return the path of an analyzed motion: points evenly spread, and the ends of what fails."""
    n = analysis.trajectory.size
    edges = np.flatnonzero(np.diff(analysis.check.good))[:MOST_POINTS]
    even = np.linspace(0, n - 1, min(n, MOST_POINTS)).round().astype(np.intp)
    samples = np.unique(np.concatenate([even, edges, edges + 1]))
    good = analysis.check.good[samples]
    place = analysis.trajectory.pose[samples][:, [0, 1, 3]]
    bad = [slice(max(run.start - 1, 0), run.stop + 1) for run in _runs(~good)]
    return Cut(samples, place, _runs(good), bad)


def _runs(flags: NDArray[np.bool_]) -> list[slice]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return [slice(int(first), int(stop)) for first, stop in edges.reshape(-1, 2)]
