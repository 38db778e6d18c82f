"""Errors of robots drawn at random within their tolerances, by exact kinematics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import wrap
from paminsa_viz.precision.leg_lengths import LENGTHS, design_lengths
from paminsa_viz.precision.manufacture import clearance_widths, tolerance_widths
from paminsa_viz.precision.unequal_legs import Closure, solve_actuators, solve_pose

MOST_SAMPLES = 1_000_000
"""Most robots times poses: their errors take 48 MB."""

BLOCK = 4096
"""Robots times poses solved at a time."""


@dataclass(frozen=True, eq=False)
class MonteCarlo:
    """Errors of n robots at poses (...).

    Attributes:
        pose: (..., 4) poses that the drives were set for [m, m, rad, m].
        seed: Of the random numbers.
        errors: (n, ..., 6) errors of `unequal_legs.COORDINATES` [m, m, rad, m, rad, rad]; NaN where
            a robot has no solution.
        closure: (n, ...) values of `Closure`.
        canceled: Whether it was ended early, with fewer robots than asked for.
    """

    pose: Array
    seed: int
    errors: Array
    closure: NDArray[np.uint8]
    canceled: bool

    @property
    def solved(self) -> Array:
        """Share of the robots that have a solution, (...)."""
        return np.asarray((self.closure == Closure.OK).mean(axis=0))

    @property
    def rms(self) -> Array:
        """Root mean square errors, (..., 6); NaN where a robot has no solution."""
        return np.sqrt((self.errors**2).mean(axis=0))

    def quantile(self, share: float) -> Array:
        """Return the sizes of errors that a share of the robots does not exceed, (..., 6).

        A robot without a solution counts as an infinite error.
        """
        sizes = np.where(np.isnan(self.errors), np.inf, np.abs(self.errors))
        return np.quantile(sizes, share, axis=0, method="inverted_cdf")


def monte_carlo(
    design: Design,
    pose: ArrayLike,
    *,
    robots: int = 1000,
    seed: int = 0,
    block: int = BLOCK,
    progress: Callable[[int, int], bool | None] | None = None,
) -> MonteCarlo:
    """Draw robots with lengths uniform within tolerances and clearances, and solve their poses.

    The drives are where the design's own lengths ask them to be. Robot i is the same whatever the
    number of robots or the block.

    Args:
        design: The robot, its deviations and tolerances.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].
        robots: How many.
        seed: Of the random numbers.
        block: Robots times poses solved at a time.
        progress: Called with the number of robots done and of all; true ends it with those done.

    Raises:
        InvalidInput: If there are too many or no robots, or a pose cannot be taken.
    """
    pose = as_vectors(pose, "pose")
    flat = pose.reshape(-1, 4)
    if robots < 1 or robots * len(flat) > MOST_SAMPLES:
        most = MOST_SAMPLES // max(len(flat), 1)
        raise InvalidInput("robots", f"1 to {most} are possible with {len(flat)} poses")
    if seed < 0:
        raise InvalidInput("seed", f"a whole number of at least 0 is needed, not {seed}")
    geometry, center = design.geometry, design_lengths(design)
    start = solve_actuators(geometry, center, flat)
    if not start.ok.all():
        reason = Closure(int(start.closure[~start.ok][0])).reason
        raise InvalidInput("pose", f"a pose cannot be taken: {reason}")
    tolerance, clearance = tolerance_widths(design.tolerances), clearance_widths(design.tolerances)
    random = np.random.default_rng(seed)
    errors = np.empty((robots, len(flat), 6))
    closure = np.empty((robots, len(flat)), np.uint8)
    wanted = start.coordinates
    at_once, done, canceled = max(1, block // len(flat)), 0, False
    while done < robots and not canceled:
        some = slice(done, min(done + at_once, robots))
        drawn = random.uniform(-1.0, 1.0, (some.stop - done, 2, 3, len(LENGTHS)))
        lengths = center + drawn[:, 0] * tolerance + drawn[:, 1] * clearance
        found = solve_pose(geometry, lengths[:, None], start.actuators, flat)
        change = found.coordinates - wanted
        change[..., 2] = wrap(change[..., 2])
        errors[some], closure[some] = change, found.closure
        done = some.stop
        canceled = bool(progress is not None and progress(done, robots))
    shape = pose.shape[:-1]
    return MonteCarlo(
        pose, seed,
        errors[:done].reshape(done, *shape, 6), closure[:done].reshape(done, *shape),
        canceled and done < robots,
    )  # fmt: skip
