"""What further logs of the same robot say: whether its numbers predict them, and a payload.

A payload m on the platform adds m g/3 to b_1, m/6 to b_6 and b_7 (see `base_parameters`). The first
is known best, but is no other than an offset of F_4: where F_4 drifts between the logs, only what
moves tells the payload. With a payload that is known, the ratio is a common gain of all torques.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.columns import fit_model
from paminsa_viz.identification.filtering import Signals
from paminsa_viz.identification.identify import filtered, identify, prepare
from paminsa_viz.identification.log import Log
from paminsa_viz.identification.results import Identification
from paminsa_viz.model.arrays import Array


@dataclass(frozen=True, eq=False)
class Validation:
    """How the numbers of one log predict another one.

    Attributes:
        log: The other log.
        signals: Its filtered signals.
        predicted: (m, 4) what is predicted at ``signals.t`` [N m, N].
        residual: (4,) RMS of measured less predicted [N m, N].
        own: (4,) RMS of what is left when the other log is identified by itself [N m, N].
    """

    log: Log
    signals: Signals
    predicted: Array
    residual: Array
    own: Array

    @property
    def ratio(self) -> Array:
        """RMS residual over that of the log's own fit, (4,); 1 where nothing is lost."""
        return self.residual / self.own


def validate(identification: Identification, log: Log) -> Validation:
    """Return how well the numbers of an identification predict another log.

    Args:
        identification: Of the first log.
        log: Of the same robot on another motion, from a start near the same pose.

    Raises:
        InvalidLog: If the other log cannot be used.
    """
    design, start = identification.design, identification.start
    settings = replace(identification.settings, robustness=False)
    own = identify(log, design, settings, start=start)
    signals = filtered(prepare(log, design, start), design, settings)
    x = identification.solution.x
    model = fit_model(design, signals, settings)
    predicted = model.columns @ x + model.known
    residual = np.sqrt(((signals.torque - predicted) ** 2).mean(axis=0))
    return Validation(log, signals, predicted, residual, own.noise)


@dataclass(frozen=True)
class PayloadEstimate:
    """A payload from two logs.

    Attributes:
        mass: With F_4 trusted [kg].
        half_width: Half of its 95 % interval [kg].
        free_mass: With an unknown drift of F_4 between the logs [kg].
        free_half_width: Half of its 95 % interval [kg].
        drift: That drift [N].
        drift_half_width: Half of its 95 % interval [N].
        known: The payload that was given, or None [kg].
    """

    mass: float
    half_width: float
    free_mass: float
    free_half_width: float
    drift: float
    drift_half_width: float
    known: float | None = None

    @property
    def gain(self) -> tuple[float, float] | None:
        """The common gain of the torques and half of its interval; None without a known mass."""
        if self.known is None:
            return None
        return self.mass / self.known, self.half_width / self.known


def payload_between(
    without: Identification, loaded: Identification, known: float | None = None
) -> PayloadEstimate:
    """Return the payload that one log has more than another.

    The intervals take the two logs as independent.

    Args:
        without: Of the log without it.
        loaded: Of the log with it.
        known: The payload, if it was weighed [kg]; the common gain follows.

    Raises:
        InvalidInput: If the known payload is not above 0, or a log does not tell the weight.
    """
    if known is not None and not (np.isfinite(known) and known > 0):
        raise InvalidInput("payload", f"a finite mass above 0 is needed, not {known!r}")
    design = without.design
    weight, error = _difference(without, loaded, "b_1")
    if not np.isfinite(error):
        raise InvalidInput("payload", "the logs do not tell the weight: M4 has to move")
    mass, half = 3 * weight / design.gravity, 3 * error / design.gravity
    moving = [_difference(without, loaded, symbol) for symbol in ("b_6", "b_7")]
    weights = np.array([1 / width**2 if np.isfinite(width) else 0.0 for _, width in moving])
    if weights.any():
        values = np.array([value for value, _ in moving])
        free = 6 * float(weights @ values / weights.sum())
        free_half = 6 / float(np.sqrt(weights.sum()))
    else:
        free, free_half = np.nan, np.inf
    lever = 3 * design.geometry.magnification  # F_4 = 3 k b_1 at rest
    drift = lever * (weight - free * design.gravity / 3)
    drift_half = lever * float(np.hypot(error, free_half * design.gravity / 3))
    return PayloadEstimate(mass, half, free, free_half, drift, drift_half, known)


def _difference(first: Identification, second: Identification, symbol: str) -> tuple[float, float]:
    """Return by how much a number grows from one log to the other, and its half width."""
    a, b = first.estimate(symbol), second.estimate(symbol)
    return b.value - a.value, float(np.hypot(a.half_width, b.half_width))
