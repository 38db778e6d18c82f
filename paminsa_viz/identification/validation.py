"""A second log validates an identification; a third with a payload weighs it, or shows the gain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.columns import FitModel, fit_model
from paminsa_viz.identification.estimate import (
    FitSolution,
    block_numbers,
    half_widths,
    jackknife,
    normal_blocks,
    solve,
)
from paminsa_viz.identification.filtering import Signals
from paminsa_viz.identification.identify import filtered, require_motion, shifted
from paminsa_viz.identification.log import Log
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.identification.results import Identification
from paminsa_viz.model.arrays import Array

MOST_RATIO = 1.1
"""Largest residual on another motion, over that of its own fit, that still validates."""

EXACT = 1e-4
"""The same over the root mean square of the measured torques, however small that of its own fit:
a log without noise leaves what filters and a soft Coulomb friction do."""


@dataclass(frozen=True, eq=False)
class Validation:
    """How well an identification predicts another log of the same robot.

    Attributes:
        log: The other log.
        signals: Its filtered signals.
        predicted: (m, 4) torques of the identification [N m, N].
        residual: (4,) root mean square of measured less predicted [N m, N].
        own: (4,) what is left when the same model is fitted to this log [N m, N].
    """

    log: Log
    signals: Signals
    predicted: Array
    residual: Array
    own: Array

    @property
    def measured(self) -> Array:
        """Filtered measured torques, (m, 4) [N m, N]."""
        return self.signals.torque

    @property
    def ratio(self) -> Array:
        """Residual over that of its own fit, (4,); 1 is perfect."""
        return self.residual / self.own

    @property
    def holds(self) -> bool:
        """Whether each ratio is at most `MOST_RATIO`, or the residual at most `EXACT`."""
        exact = EXACT * np.sqrt((self.measured**2).mean(axis=0))
        return bool((self.residual <= np.maximum(MOST_RATIO * self.own, exact)).all())


@dataclass(frozen=True)
class PayloadEstimate:
    """What a log with another payload says of it, if all else is as before.

    Attributes:
        mass, half_width: How much heavier the payload is than in the first log, and half of the
            95 % interval [kg].
        inertia, inertia_half_width: The same of its inertia about the vertical [kg m^2].
        free_mass, free_half_width: The mass if F_4's offset may have drifted between the logs.
        drift: That drift [N].
        drift_half_width: Half of its 95 % interval [N].
        known: The payload's true mass [kg], or None.
    """

    mass: float
    half_width: float
    inertia: float
    inertia_half_width: float
    free_mass: float
    free_half_width: float
    drift: float
    drift_half_width: float
    known: float | None = None

    @property
    def gain(self) -> tuple[float, float] | None:
        """Common gain of the torques, measured over true, and half of its interval.

        None without a known payload. All masses and frictions of the first log are too large by it.
        """
        if self.known is None:
            return None
        return self.mass / self.known, self.half_width / self.known


@kinds_checked
def validate(
    identification: Identification, log: Log, *, start: ArrayLike | None = None
) -> Validation:
    """Predict another log of the same robot, with the same payload, from an identification.

    Args:
        identification: What the first log says.
        log: The other log.
        start: Pose (4,) near its start, to choose the assembly; by default the first log's.

    Raises:
        InvalidLog: If the log cannot be used.
    """
    signals, model = _modeled(identification, log, start)
    length = identification.settings.block_length
    numbers = block_numbers(signals.t, signals.segment, length, log.name)
    own = solve(normal_blocks(model.columns, model.torque, numbers))
    predicted = model.columns @ identification.solution.x + model.known
    residual = np.sqrt(((signals.torque - predicted) ** 2).mean(axis=0))
    return Validation(log, signals, predicted, residual, own.noise)


@kinds_checked
def weigh_payload(
    identification: Identification,
    log: Log,
    *,
    known: float | None = None,
    start: ArrayLike | None = None,
) -> PayloadEstimate:
    """Return the payload of a log from an identification without it, with intervals.

    Args:
        identification: What the first log says.
        log: A log of the same robot with another payload on the platform's axis.
        known: The true mass that was put on [kg]: then the common gain follows.
        start: Pose (4,) near its start, to choose the assembly; by default the first log's.

    Raises:
        InvalidLog: If the log cannot be used.
        InvalidInput: If the known mass is not above 0.
    """
    if known is not None and not (np.isfinite(known) and known > 0):
        raise InvalidInput("payload", f"a finite mass above 0 kg is needed, not {known!r}")
    signals, model = _modeled(identification, log, start)
    design = identification.design
    radius = design.geometry.platform_radius
    x = model.columns @ np.linalg.pinv(model.report)[:, :11]
    payload = np.zeros((11, 2))
    payload[[0, 5, 6, 10], 0] = design.gravity / 3, 1 / 6, 1 / 6, -(radius**2)
    payload[10, 1] = 1.0
    offset = np.zeros((*signals.torque.shape, 1))
    offset[:, 3] = 1.0
    length = identification.settings.block_length
    numbers = block_numbers(signals.t, signals.segment, length, log.name)
    fits = []
    for columns in (x @ payload, np.concatenate([x @ payload, offset], axis=-1)):
        fits.append(_step(columns, model, identification.solution, numbers))
    (plain, error), (free, free_error) = fits
    return PayloadEstimate(
        float(plain[0]), float(error[0]), float(plain[1]), float(error[1]),
        float(free[0]), float(free_error[0]), float(free[2]), float(free_error[2]), known,
    )  # fmt: skip


def _modeled(
    identification: Identification, log: Log, start: ArrayLike | None
) -> tuple[Signals, FitModel]:
    """Return another log's signals and columns, with the delay of the first taken off."""
    start = identification.start if start is None else start
    design, settings = identification.design, identification.settings
    signals = filtered(log, design, settings, log_poses(design.geometry, log, start))
    require_motion(signals, log.name)
    if identification.lag:
        signals = shifted(signals, identification.lag)
    return signals, fit_model(design, signals, settings)


def _step(
    columns: Array, model: FitModel, first: FitSolution, numbers: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Fit columns to what the first log's estimates leave, (n,), with half widths, (n,).

    Variances are those of leaving out blocks of this log, and of the first one.
    """
    n = columns.shape[-1]
    blocks = normal_blocks([columns, model.columns], model.torque, numbers)
    left = model.torque - model.columns @ first.x
    noise = solve(normal_blocks(columns, left, numbers)).noise
    matrix, right = blocks.weighted(noise**-2)
    matrix, right = matrix[:, :n], right[:, :n]

    def fitted(matrix: Array, right: Array, x: Array) -> Array:
        force = right - np.einsum("...ac,...c->...a", matrix[..., n:], x)
        return np.asarray(np.linalg.solve(matrix[..., :n], force[..., None])[..., 0])

    whole, force = matrix.sum(axis=0), right.sum(axis=0)
    value = fitted(whole, force, first.x)
    here = jackknife(fitted(whole - matrix, force - right, first.x))
    there = jackknife(fitted(whole[None], force[None], first.without))
    quantile = half_widths(min(len(matrix), first.blocks))
    return value, quantile * np.sqrt(here**2 + there**2)
