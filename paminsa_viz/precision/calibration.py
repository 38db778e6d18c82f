"""Calibration: the lengths of the legs from measured poses and actuator readings.

Forward kinematics with unequal legs predicts each measured pose; the 42 deviations are fitted by
nonlinear least squares. Angles count with a length, so that all columns and rows are in meters:
those of the platform with R_pl, as the path of its joints, those of leg axes and actuators with
R_b.

Not all 42 can be seen in the platform's pose. Of legs that are equal, the singular values of the
scaled Jacobian fall to nothing after 30 of them with six measured coordinates, after 28 with x, y,
theta and z. The combinations of lengths above that gap are fitted first. Real legs differ, and then
further combinations show in second order: those are fitted as well whose interval is within
`known_within`. What is left keeps its value in the design that the calibration starts from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import require_seed
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.precision.calibration_problem import (
    COUNT,
    GAP,
    CalibrationProblem,
    require_enough,
)
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array, with_deviations
from paminsa_viz.precision.measurements import (
    Measurements,
    PredictionErrors,
    coordinate_scales,
    differences,
    errors_of,
    length_scales,
    predict,
)
from paminsa_viz.progress import Progress, go_on

KNOWN = 1e-3
"""Half interval up to which a combination that shows in second order is fitted, at Appendix 4's
lengths [m]; see `known_within` for others."""

_ROUNDS = 5


def known_within(geometry: Geometry) -> float:
    """Return `KNOWN` in proportion to crank plus coupler, to one digit [m]."""
    return float(f"{KNOWN * length_ratio(geometry):.0e}")


@dataclass(frozen=True, eq=False)
class Combination:
    """A combination of lengths that the measurements show.

    Attributes:
        weights: (3, 14) its direction among the scaled lengths, of unit length.
        singular_value: Change of the scaled pose for a change of it, root mean square over the
            measured coordinates.
        value: What it was found to be [m].
        half_width: Half of its interval of confidence [m].
    """

    weights: Array
    singular_value: float
    value: float
    half_width: float


@dataclass(frozen=True, eq=False)
class Calibration:
    """Result of a calibration.

    Attributes:
        design: The design with the identified deviations.
        start: The design it started from.
        singular_values: (42,) of the scaled Jacobian with equal legs, over the measured rows.
        rank: How many of them show with equal legs.
        combinations: Those that were fitted, best known first.
        covariance: (42, 42) of the scaled lengths within the combinations [m^2].
        noise: Standard deviation of the scaled residuals [m].
        held: (n,) which of the measured poses were held back.
        residuals_before, residuals_after: (n, c) predicted minus measured coordinates with the
            lengths before and after [m, m, rad, m, rad, rad].
        before, after: Errors of the fitted poses with the lengths before and after.
        before_held, after_held: The same of the poses that were held back.
    """

    design: Design
    start: Design
    singular_values: Array
    rank: int
    combinations: tuple[Combination, ...]
    covariance: Array
    noise: float
    held: NDArray[np.bool_]
    residuals_before: Array
    residuals_after: Array
    before: PredictionErrors
    after: PredictionErrors
    before_held: PredictionErrors
    after_held: PredictionErrors

    @property
    def determined(self) -> NDArray[np.bool_]:
        """Which lengths lie within what was fitted, so that they have an interval, (3, 14)."""
        return within(np.array([item.weights.ravel() for item in self.combinations]))

    @property
    def standard_deviations(self) -> Array:
        """Of the lengths, (3, 14) [m, rad]; NaN where not `determined`."""
        sizes = np.sqrt(np.diag(self.covariance)).reshape(3, -1) / length_scales(self.start)
        return np.where(self.determined, sizes, np.nan)

    @property
    def improved(self) -> bool:
        """Whether held-back poses, or the fitted ones if there are none, are predicted better."""
        old, new = self.before_held, self.after_held
        if not new.poses:
            old, new = self.before, self.after
        scale = coordinate_scales(self.start)[: len(new.rms)]
        return bool(np.linalg.norm(new.rms * scale) < np.linalg.norm(old.rms * scale))


def within(basis: Array) -> NDArray[np.bool_]:
    """Return which lengths lie within the directions (m, 42) of a basis, (3, 14)."""
    return (1 - (basis**2).sum(axis=0) < 1e-6).reshape(3, -1)


@of_design
def calibrate(
    design: Design,
    measured: Measurements,
    *,
    validate: float = 0.0,
    seed: int = 0,
    progress: Progress = go_on,
) -> Calibration:
    """Identify the deviations of a design's legs.

    Args:
        design: What to start from, with its own deviations.
        measured: Poses and readings.
        validate: Share of the poses, drawn at random, that are held back to check the result.
        seed: Of that draw.
        progress: Told how many of the fits are done, as a part of the most there can be.

    Raises:
        InvalidMeasurement: If the design's legs cannot be assembled near a measured pose.
        InvalidInput: If there are too few poses, the share is not from 0 to 0.9, or the seed is
            not possible.
        Canceled: If ``progress`` ends it.
    """
    if not 0 <= validate <= 0.9:
        raise InvalidInput("validate", f"a share from 0 to 0.9 is needed, not {validate:g}")
    require_seed(seed)
    count, width = measured.poses.shape
    held = np.zeros(count, np.bool_)
    order = np.random.default_rng(seed).permutation(count)
    held[order[: round(validate * count)]] = True
    fitted, kept = measured.take(~held), measured.take(held)
    require_enough(len(fitted), width, len(kept))
    start = deviation_array(design)
    problem = CalibrationProblem(design, fitted, progress)
    predicted = predict(design, start, measured)
    problem.require_near(predicted, measured)
    origin = problem.scaled(start)
    values, rank, singular = _first_fit(problem, origin)
    values, basis, found, noise = _fit_known(problem, origin, values, rank)
    margin = problem.margin(len(found))
    combinations = tuple(
        Combination(
            direction.reshape(3, -1), float(size / np.sqrt(problem.rows)),
            float(direction @ values), float(margin * noise / size),
        )
        for direction, size in zip(basis.T, found, strict=True)
    )  # fmt: skip
    deviations = problem.unscaled(values)
    old = differences(predicted, measured)
    new = differences(predict(design, deviations, measured), measured)
    return Calibration(
        design=with_deviations(design, deviations),
        start=design,
        singular_values=singular / np.sqrt(problem.rows),
        rank=rank,
        combinations=combinations,
        covariance=(basis * (noise / found) ** 2) @ basis.T,
        noise=noise,
        held=held,
        residuals_before=old,
        residuals_after=new,
        before=errors_of(old[~held]),
        after=errors_of(new[~held]),
        before_held=errors_of(old[held]),
        after_held=errors_of(new[held]),
    )


def _first_fit(problem: CalibrationProblem, origin: Array) -> tuple[Array, int, Array]:
    """Fit what equal legs show; return the values, how many those are, and singular values."""
    _, singular, directions = np.linalg.svd(problem.equal_legs(), full_matrices=False)
    rank = int((singular > GAP * singular[0]).sum())
    return problem.fit(origin, directions[:rank].T, origin), rank, singular


def _fit_known(
    problem: CalibrationProblem, origin: Array, values: Array, rank: int
) -> tuple[Array, Array, Array, float]:
    """Fit what the legs found show in second order as well.

    Returns:
        The values (42,), the basis (42, m), its singular values (m,), and the noise.
    """
    noise, count = problem.noise(values, rank), rank
    most = known_within(problem.design.geometry)
    basis, found = np.zeros((COUNT, 0)), np.zeros(0)
    for index in range(_ROUNDS):
        problem.done = (1 + index) / (1 + _ROUNDS)
        _, singular, directions = np.linalg.svd(problem.jacobian(values), full_matrices=False)
        known = (problem.margin(count) * noise < most * singular) & (singular > GAP * singular[0])
        before, count = count, int(known.sum())
        basis, found = directions[:count].T, singular[:count]
        values = problem.fit(origin, basis, values)
        noise = problem.noise(values, count)
        if count == before:
            break
    return values, basis, found, noise


def describe(combination: Combination, most: int = 4) -> str:
    """Return the leading lengths of a combination: ``"0.71 l_94(1) - 0.70 l_87(1)"`` of leg 1."""
    weights = combination.weights.ravel()
    order = np.argsort(-np.abs(weights), kind="stable")[:most]
    text = ""
    for place in order:
        leg, length = divmod(int(place), len(LENGTHS))
        weight = float(weights[place])
        sign = ("- " if weight < 0 else "+ ") if text else ("-" if weight < 0 else "")
        text += f"{' ' if text else ''}{sign}{abs(weight):.2f} {LENGTHS[length].symbol}({leg + 1})"
    return text
