"""The least-squares problem of a calibration: residuals, their Jacobian, fits within a basis."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.precision.leg_lengths import LENGTHS, nominal_lengths
from paminsa_viz.precision.measurements import (
    InvalidMeasurement,
    Measurements,
    coordinate_scales,
    differences,
    length_scales,
    predict,
)
from paminsa_viz.precision.unequal_legs import Closure, UnequalPose, nominal_pose, sensitivities

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


class CalibrationProblem:
    """Residuals of scaled deviations (42,) and their Jacobian."""

    def __init__(self, design: Design, measured: Measurements) -> None:
        self.design, self.measured = design, measured
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
            reason = Closure(int(found.closure[index])).reason
            raise InvalidMeasurement(index, f"the design has no such pose: {reason}; {_ADVICE}")
        miss = np.abs(differences(found, measured) * self._row).max(axis=-1)
        if miss.max() > FARTHEST * self.design.geometry.base_radius:
            index = int(np.argmax(miss))
            problem = f"is {miss[index]:.3g} m away from what the design predicts; {_ADVICE}"
            raise InvalidMeasurement(index, problem)

    def _at(self, values: Array) -> UnequalPose:
        key = values.tobytes()
        if self._solved is None or self._solved[0] != key:
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
