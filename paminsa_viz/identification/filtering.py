"""One zero-phase filter for everything: positions, torques, and the columns of Coulomb friction.

A Butterworth filter runs forward and backward (`scipy.signal.sosfiltfilt`), so that nothing is
delayed and the amplitude at the cut-off is half. What a filter does to the torques it does to the
columns too, because positions are filtered before they are differentiated and the sign of the
speed, which has high frequencies of its own, after. Above the cut-off nothing is left, so that a
tenth of the samples of a 1 kHz log carry all of it ("parallel decimation", Gautier and Khalil).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.log import InvalidLog, Log
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import nearest_solution

ORDER = 4
"""Order of the Butterworth filter; forward and backward it is twice that."""

OVERSAMPLING = 10.0
"""Samples that are kept, per period of the cut-off."""

SETTLING = 3.0
"""Periods of the cut-off that are left out at both ends of a segment."""

LOWEST_RATE = 4.0
"""Lowest sampling rate over the cut-off."""

_FIRST = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
_SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
_REACH = 3
"""Samples on both sides that the sixth-order differences take."""


@dataclass(frozen=True, eq=False)
class Signals:
    """Filtered and thinned-out signals of a log, m samples.

    Attributes:
        t: (m,) [s].
        segment: (m,) number of the segment that each sample is of.
        pose, velocity, acceleration: (m, 4) of the platform.
        position, speed, growth: (m, 4) of the actuators: positions, their first and second rates.
        coulomb: (m, 4) filtered sign of the speeds, tanh(speed / transition speed).
        torque: (m, 4) measured, filtered [N m, N].
        torque_rate: (m, 4) its rate [N m/s, N/s].
        step: Time between samples [s].
        cut_off: Where the filter halves [Hz].
    """

    t: Array
    segment: NDArray[np.int64]
    pose: Array
    velocity: Array
    acceleration: Array
    position: Array
    speed: Array
    growth: Array
    coulomb: Array
    torque: Array
    torque_rate: Array
    step: float
    cut_off: float


def filter_log(
    log: Log,
    geometry: Geometry,
    pose: Array,
    pieces: list[slice],
    *,
    cut_off: float,
    transition_speed: float,
    thinning: int | None = None,
) -> Signals:
    """Filter a log, differentiate it, and keep what its band needs.

    Args:
        log: The log.
        geometry: Lengths of the mechanism.
        pose: (n, 4) unfiltered poses of `log_poses`; they tell the assembly modes apart.
        pieces: The parts without gaps.
        cut_off: Where the filter halves [Hz].
        transition_speed: Speed scale of the Coulomb step [rad/s, m/s].
        thinning: Keep every so manyth sample; by default as `thinning_for` says.

    Raises:
        InvalidInput: If the cut-off is not above 0, or too high for the sampling rate.
        InvalidLog: If no piece is long enough for the filter to settle.
    """
    if not (np.isfinite(cut_off) and 0 < cut_off <= log.rate / LOWEST_RATE):
        most = log.rate / LOWEST_RATE
        raise InvalidInput("cut_off", f"above 0 and at most {most:g} Hz is needed, not {cut_off!r}")
    from scipy.signal import butter, sosfiltfilt  # takes a while to load

    every = thinning_for(log.rate, cut_off) if thinning is None else thinning
    sections = butter(ORDER, cut_off, fs=log.rate, output="sos")
    settle = round(SETTLING / cut_off * log.rate)
    kept = [p for p in pieces if p.stop - p.start > 2 * settle + 4 * _REACH * every]
    if not kept:
        least = (2 * settle + 4 * _REACH * every) / log.rate
        raise InvalidLog(f"a piece without gaps of at least {least:.3g} s is needed")
    step = every / log.rate
    parts = []
    for number, piece in enumerate(kept):
        length = piece.stop - piece.start
        raw = np.concatenate([log.position[piece], log.torque[piece]], axis=1)
        smooth = sosfiltfilt(sections, raw, axis=0, padlen=min(settle, length - 1))
        sign = np.tanh(_difference(smooth[:, :4], _FIRST) * (log.rate / transition_speed))
        sign = sosfiltfilt(sections, sign, axis=0, padlen=min(settle, length - 1 - 2 * _REACH))
        inside = slice(settle, length - settle, every)
        q, torque = smooth[inside, :4], smooth[inside, 4:]
        p = nearest_solution(geometry, q, pose[piece][inside])
        middle = slice(_REACH, -_REACH)
        signs = sign[settle - _REACH : length - settle - _REACH : every]
        parts.append(
            (
                log.t[piece][inside][middle],
                np.full(len(q) - 2 * _REACH, number),
                p[middle],
                _difference(p, _FIRST) / step,
                _difference(p, _SECOND) / step**2,
                q[middle],
                _difference(q, _FIRST) / step,
                _difference(q, _SECOND) / step**2,
                signs[middle],
                torque[middle],
                _difference(torque, _FIRST) / step,
            )
        )
    arrays = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Signals(*arrays, step=step, cut_off=cut_off)


def thinning_for(rate: float, cut_off: float) -> int:
    """Return how many samples there are for one that is kept."""
    return max(1, int(rate / (OVERSAMPLING * cut_off)))


def _difference(values: Array, weights: Array) -> Array:
    """Return central differences (n - 6, ...) of rows in steps of 1."""
    size = len(values) - 2 * _REACH
    return np.asarray(sum(w * values[place : place + size] for place, w in enumerate(weights) if w))
