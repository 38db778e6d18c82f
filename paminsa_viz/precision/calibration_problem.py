"""The least-squares problem of a calibration, and the poses to measure, which show most of it."""

from __future__ import annotations

import numpy as np

from paminsa_viz.checks import require_count, require_seed
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import check_reach, home_pose, workspace_height, workspace_radius
from paminsa_viz.model.singularity import measure_singularity, singular_rotation
from paminsa_viz.precision.leg_lengths import LENGTHS, nominal_lengths
from paminsa_viz.precision.measurements import (
    InvalidMeasurement,
    Measurements,
    coordinate_scales,
    differences,
    length_scales,
    predict,
)
from paminsa_viz.precision.unequal_legs import UnequalPose, nominal_pose, sensitivities
from paminsa_viz.progress import Progress, go_on, keep_on

COUNT = 3 * len(LENGTHS)
"""Number of lengths."""

CONFIDENCE = 0.95
"""Coverage of the intervals."""

GAP = 1e-8
"""Singular value, over the largest, below which equal legs do not show a combination."""

FARTHEST = 0.3
"""Farthest that a measured pose may be from the predicted one, over R_b."""

_ADVICE = "check units, zeros and axes"

_MISFIT = 10.0
"""Residual of a pose that trial lengths cannot be assembled in [m]."""


def require_enough(poses: int, coordinates: int, held: int = 0) -> None:
    """Check that so many poses are enough to fit all lengths.

    Args:
        poses: How many are fitted.
        coordinates: Measured coordinates of each.
        held: How many are held back besides.

    Raises:
        InvalidInput: If they are not.
    """
    least = COUNT // coordinates + 1
    if poses < least:
        back = f" besides the {held} that are held back" if held else ""
        problem = f"at least {least} poses are needed{back}, there are {poses}"
        raise InvalidInput("measured", f"{problem}: {coordinates} coordinates each, for {COUNT} "
                           "lengths")  # fmt: skip


class CalibrationProblem:
    """Residuals of scaled deviations (42,) and their Jacobian.

    Attributes:
        done: What part of the work is done, 0 to 1; told to `progress` at each trial.
    """

    def __init__(self, design: Design, measured: Measurements, progress: Progress = go_on) -> None:
        self.design, self.measured = design, measured
        self.done = 0.0
        self._progress = progress
        self.width = measured.poses.shape[1]
        self.rows = measured.poses.size
        self._column = length_scales(design)
        self._row = coordinate_scales(design)[: self.width]
        self._solved: tuple[bytes, UnequalPose] | None = None

    def scaled(self, deviations: Array) -> Array:
        """Return deviations (3, 14) as scaled values (42,) [m]."""
        return (deviations * self._column).ravel()

    def unscaled(self, values: Array) -> Array:
        """Return scaled values (42,) as deviations (3, 14) [m, rad]."""
        return values.reshape(3, -1) / self._column

    def margin(self, fitted: int) -> float:
        """Return half the width of an interval over its standard error, with what was fitted."""
        from scipy.special import stdtrit  # takes a while to load

        return float(stdtrit(self.rows - fitted, 0.5 + CONFIDENCE / 2))

    def require_near(self, found: UnequalPose, measured: Measurements) -> None:
        """Check that predicted poses are near the measured ones.

        Raises:
            InvalidMeasurement: If a pose is far away, or has no prediction.
        """
        if not found.ok.all():
            index = int(np.argmin(found.ok))
            reason = found.reason(index)
            raise InvalidMeasurement(index, f"the design has no such pose: {reason}; {_ADVICE}")
        miss = np.abs(differences(found, measured) * self._row).max(axis=1)
        if miss.max() > FARTHEST * self.design.geometry.base_radius:
            index = int(np.argmax(miss))
            problem = f"is {miss[index]:.3g} m away from what the design predicts; {_ADVICE}"
            raise InvalidMeasurement(index, problem)

    def _at(self, values: Array) -> UnequalPose:
        key = values.tobytes()
        if self._solved is None or self._solved[0] != key:
            keep_on(self._progress, self.done)
            self._solved = key, predict(self.design, self.unscaled(values), self.measured)
        return self._solved[1]

    def residuals(self, values: Array) -> Array:
        """Return the scaled errors (rows,) [m]."""
        error = differences(self._at(values), self.measured) * self._row
        return np.where(np.isfinite(error), error, _MISFIT).ravel()

    def jacobian(self, values: Array) -> Array:
        """Return the derivatives of the residuals, (rows, 42)."""
        lengths = nominal_lengths(self.design.geometry) + self.unscaled(values)
        return self._matrix(lengths, self._at(values))

    def equal_legs(self) -> Array:
        """Return the Jacobian of the nominal robot at the measured poses."""
        geometry = self.design.geometry
        found = nominal_pose(geometry, self.measured.poses[:, :4])
        return self._matrix(nominal_lengths(geometry), found)

    def _matrix(self, lengths: Array, found: UnequalPose) -> Array:
        slopes = sensitivities(self.design.geometry, lengths, found).lengths[:, : self.width]
        slopes = slopes * self._row[:, None, None] / self._column
        return np.nan_to_num(slopes.reshape(self.rows, COUNT))

    def fit(self, origin: Array, basis: Array, guess: Array) -> Array:
        """Return the best values within a basis (42, m) about an origin, near a guess."""
        from scipy.optimize import least_squares  # takes a while to load

        found = least_squares(
            lambda step: self.residuals(origin + basis @ step),
            basis.T @ (guess - origin),
            jac=lambda step: self.jacobian(origin + basis @ step) @ basis,  # type: ignore[arg-type]
            method="lm", x_scale="jac", xtol=1e-12, ftol=1e-10, gtol=1e-15, max_nfev=60,
        )  # fmt: skip
        return origin + basis @ found.x

    def noise(self, values: Array, fitted: int) -> float:
        """Return the standard deviation of the residuals, with what was fitted taken off."""
        square = float((self.residuals(values) ** 2).sum()) / (self.rows - fitted)
        return float(np.sqrt(max(square, np.finfo(float).eps ** 2)))


MARGIN = 0.05
"""Least distance of a pose from the limits of reach, over R_b."""

WORST_CONDITION = 10.0
"""Largest condition number of a pose."""

MOST_POSES = 1000
_CANDIDATES = 800
_DRAWN = 8192
_ROUNDS = 20


@of_design
def measuring_poses(
    design: Design,
    poses: int,
    *,
    coordinates: int = 6,
    seed: int = 0,
    progress: Progress = go_on,
) -> Array:
    """Choose poses of which the calibration's intervals are small, (n, 4) [m, m, rad, m].

    Random poses on home's side of the guides, away from limits and singularities, of which
    one after the other is taken that adds most to the determinant of the information about what
    can be seen at all.

    Args:
        design: The robot.
        poses: How many, at most `MOST_POSES`.
        coordinates: Measured coordinates of a pose, 6, or 4 without the tilt.
        seed: Of the random numbers.
        progress: Told what part of the poses is chosen.

    Raises:
        InvalidInput: If a number is not possible, or the workspace is too small.
        Canceled: If ``progress`` ends it.
    """
    require_count(poses, "poses", MOST_POSES)
    if coordinates not in (4, 6):
        raise InvalidInput("coordinates", f"4 or 6 are possible, not {coordinates}")
    require_seed(seed)
    found = _candidates(design, max(_CANDIDATES, 2 * poses), seed)
    geometry = design.geometry
    slopes = sensitivities(geometry, nominal_lengths(geometry), nominal_pose(geometry, found))
    rows = slopes.lengths[:, :coordinates] * coordinate_scales(design)[:coordinates, None, None]
    rows = (rows / length_scales(design)).reshape(len(found), coordinates, COUNT)
    _, singular, directions = np.linalg.svd(rows.reshape(-1, COUNT), full_matrices=False)
    seen = directions[singular > GAP * singular[0]]
    rows = rows @ seen.T / (singular[: len(seen)] / np.sqrt(len(found)))
    inverse = np.eye(len(seen)) * 1e6  # of the information: hardly any at first
    free = np.ones(len(found), np.bool_)
    chosen = []
    for index in range(poses):
        keep_on(progress, index / poses)
        spread = rows @ inverse @ np.swapaxes(rows, -1, -2) + np.eye(coordinates)
        gain = np.where(free, np.linalg.slogdet(spread)[1], -np.inf)
        best = int(np.argmax(gain))
        free[best] = False
        chosen.append(best)
        shown = rows[best] @ inverse
        inverse = inverse - shown.T @ np.linalg.solve(spread[best], shown)
    return found[chosen]


def _candidates(design: Design, count: int, seed: int) -> Array:
    """Draw reachable poses, uniform in x, y, theta and z, clear of limits and singularities."""
    geometry = design.geometry
    random = np.random.default_rng(seed)
    across, up = workspace_radius(geometry), workspace_height(geometry)
    turn = float(np.nan_to_num(singular_rotation(geometry), nan=np.pi))
    home = np.array(home_pose(geometry))
    side = np.sign(measure_singularity(geometry, home).determinant)
    found = np.empty((0, 4))
    for _ in range(_ROUNDS):
        drawn = random.uniform(-1.0, 1.0, (_DRAWN, 4)) * [across, across, turn, up]
        drawn[:, 3] = -geometry.knee.sign * np.abs(drawn[:, 3]) - geometry.platform_joint_height
        measured = measure_singularity(geometry, drawn)
        clear = check_reach(geometry, drawn).margins.min(axis=(-1, -2))
        good = (clear > MARGIN * geometry.base_radius) & (measured.condition < WORST_CONDITION)
        found = np.concatenate([found, drawn[good & (np.sign(measured.determinant) == side)]])
        if len(found) >= count:
            return found[:count]
    raise InvalidInput("poses", f"only {len(found)} of {count} poses found; check the lengths")
