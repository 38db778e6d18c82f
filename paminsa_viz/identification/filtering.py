"""Zero-phase filters of positions, torques, and the columns that are fitted.

A Butterworth filter runs forward and backward (`scipy.signal.sosfiltfilt`), so that nothing is
delayed and the amplitude at the cut-off is half. Positions pass it before they are differentiated.
Then torques and columns pass it: the columns are not linear in the positions, and the sign of a
speed has high frequencies of its own, so that only a filter behind both leaves the equation
between them as it is (the parallel filter of Gautier and Khalil). What the filter of the positions
takes from the motion is missing in the columns but not in the torques, and no interval shows that
error. So a low cut-off holds for torques and columns only; that of the positions stays at
`POSITION_CUT_OFF`. Above it nothing is left, so that a tenth of the samples of a 1 kHz log carry
all of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.log import InvalidLog, Log
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import nearest_solution
from paminsa_viz.model.reach import Limit, reach_status
from paminsa_viz.units import rounded_to_side

ORDER = 4
"""Order of the Butterworth filter; forward and backward it is twice that."""

OVERSAMPLING = 10.0
"""Samples that are kept, per period of the cut-off of the positions."""

ANTI_ALIAS = (3.0, 0.35)
"""Cut-off of what comes before leaving out samples: over the cut-off, and at most over the rate."""

SETTLING = 2.0
"""Periods of its cut-off that each of the two passes takes at both ends of a piece."""

FORGOTTEN = 2.0**-60
"""What is left of a sample where the filter has forgotten it: nothing in double precision."""

COLUMNS_AT_ONCE = 8
"""Columns that are filtered at once."""

LOWEST_RATE = 4.0
"""Lowest sampling rate over the cut-off."""

POSITION_CUT_OFF = 10.0
"""Lowest cut-off of the positions; at lower rates a quarter of the rate [Hz]."""

_FIRST = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
_SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
_REACH = 3
"""Samples on both sides that the sixth-order differences take."""


class MotionSamples(NamedTuple):
    """The motion that columns are computed from, M samples, the ends of pieces among them.

    Attributes:
        segment: (M,) number of the piece.
        kept: (M,) whether the filter has settled.
        pose, velocity, acceleration: (M, 4) of the platform.
        position, speed, growth: (M, 4) of the actuators: positions, their first and second rates.
        sign: (M, 4) of the speeds: tanh(speed / transition speed).
    """

    segment: NDArray[np.int64]
    kept: NDArray[np.bool_]
    pose: Array
    velocity: Array
    acceleration: Array
    position: Array
    speed: Array
    growth: Array
    sign: Array


@dataclass(frozen=True, eq=False)
class Signals:
    """Filtered and thinned-out signals of a log, m samples where the filter has settled.

    Attributes:
        t: (m,) [s].
        segment: (m,) number of the segment that each sample is of.
        torque: (m, 4) measured, filtered [N m, N].
        torque_rate: (m, 4) its rate [N m/s, N/s].
        samples: The motion, for columns, which then pass `smooth`.
        step: Time between samples [s].
        cut_off: Where the filter halves [Hz].
    """

    t: Array
    segment: NDArray[np.int64]
    torque: Array
    torque_rate: Array
    samples: MotionSamples
    step: float
    cut_off: float
    _sections: Array

    @property
    def pose(self) -> Array:
        """The platform's poses at ``t``, (m, 4)."""
        return self.samples.pose[self.samples.kept]

    @property
    def velocity(self) -> Array:
        """The platform's velocities at ``t``, (m, 4)."""
        return self.samples.velocity[self.samples.kept]

    @property
    def acceleration(self) -> Array:
        """The platform's accelerations at ``t``, (m, 4)."""
        return self.samples.acceleration[self.samples.kept]

    def smooth(self, columns: Array) -> Array:
        """Filter columns as the torques were, (M, ...) in, (m, ...) out."""
        return smoothed(columns, self.samples, self._sections)


def smoothed(values: Array, samples: MotionSamples, sections: Array) -> Array:
    """Filter values (M, ...) piece by piece; return them where the filter has settled, (m, ...)."""
    from scipy.signal import sosfiltfilt  # takes a while to load

    longest = math.ceil(math.log(FORGOTTEN) / math.log(math.sqrt(sections[:, 5].max())))
    flat = values.reshape(len(values), -1)
    used = np.flatnonzero(np.any(flat != 0.0, axis=0))
    whole = np.zeros((int(samples.kept.sum()), flat.shape[1]))
    begin = 0
    for place in pieces_of(samples.segment):
        kept = samples.kept[place]
        rows = slice(begin, begin + int(kept.sum()))
        begin = rows.stop
        padding = min(longest, len(place) - 1)
        for start in range(0, len(used), COLUMNS_AT_ONCE):  # the filter holds some copies of them
            some = used[start : start + COLUMNS_AT_ONCE]
            found = sosfiltfilt(sections, flat.T[some][:, place], padlen=padding)
            whole[rows, some] = found[:, kept].T
    return whole.reshape(-1, *values.shape[1:])


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
        cut_off: Where the filter halves [Hz]; positions as `position_cut_off` says.
        transition_speed: Speed scale of the Coulomb step [rad/s, m/s].
        thinning: Keep every so manyth sample; by default as `thinning_for` says.

    Raises:
        InvalidInput: If the cut-off is not above 0, or too high for the sampling rate.
        InvalidLog: If no piece is long enough for the filter to settle, or the filtered motion is
            out of reach.
    """
    if not (np.isfinite(cut_off) and 0 < cut_off <= log.rate / LOWEST_RATE):
        most = rounded_to_side(log.rate / LOWEST_RATE, 6, up=False)
        problem = f"above 0 and at most {most:g} Hz is needed with {log.rate:.6g} rows a second"
        raise InvalidInput("cut_off", f"{problem}, not {cut_off!r}")
    from scipy.signal import butter, sosfiltfilt  # takes a while to load

    every = thinning_for(log.rate, cut_off) if thinning is None else thinning
    rate = log.rate / every
    fast = position_cut_off(log.rate, cut_off)
    sections: Any = butter(ORDER, fast, fs=log.rate, output="sos")
    slow: Any = butter(ORDER, cut_off, fs=rate, output="sos")
    first = butter(
        ORDER, min(ANTI_ALIAS[0] * cut_off, ANTI_ALIAS[1] * rate), fs=log.rate, output="sos"
    )
    settle = round((SETTLING / fast + SETTLING / cut_off) * rate)
    least = (2 * settle + 4 * _REACH) * every
    kept = [piece for piece in pieces if piece.stop - piece.start > least]
    if not kept:
        shortest = rounded_to_side(least / log.rate, 3, up=True)
        longest = max((log.t[piece][-1] - log.t[piece][0] for piece in pieces), default=0.0)
        problem = f"a piece without gaps of at least {shortest:.3g} s is needed"
        longest = rounded_to_side(float(longest), 3, up=False)
        raise InvalidLog(f"{problem}; the longest is {longest:.3g} s", log=log.name)
    padding = round(SETTLING / cut_off * log.rate)
    parts, torques, times = [], [], []
    for number, piece in enumerate(kept):
        q = sosfiltfilt(
            sections, log.position[piece], axis=0, padlen=round(SETTLING / fast * log.rate)
        )
        sign = np.tanh(_difference(q, _FIRST) * (log.rate / transition_speed))
        torque = log.torque[piece]
        if every > 1:
            sign = sosfiltfilt(first, sign, axis=0, padlen=padding)
            torque = sosfiltfilt(first, torque, axis=0, padlen=padding)
        thin = slice(_REACH, len(q) - _REACH, every)
        q, sign, torque = q[thin], sign[::every], torque[thin]
        p = nearest_solution(geometry, q, pose[piece][thin])
        middle = slice(_REACH, -_REACH)
        count = len(q) - 2 * _REACH
        settled = np.zeros(count, np.bool_)
        settled[settle : count - settle] = True
        parts.append(
            (
                np.full(count, number), settled, p[middle],
                _difference(p, _FIRST) * rate, _difference(p, _SECOND) * rate**2,
                q[middle],
                _difference(q, _FIRST) * rate, _difference(q, _SECOND) * rate**2,
                sign[middle],
            )
        )  # fmt: skip
        torques.append(torque[middle])
        times.append(log.t[piece][thin][middle])
    samples = MotionSamples(*(np.concatenate(part) for part in zip(*parts, strict=True)))
    t = np.concatenate(times)
    status, _ = reach_status(geometry, samples.pose)
    if (status != Limit.OK).any():
        at = t[np.flatnonzero(status != Limit.OK)[0]]
        problem = f"at {at:.6g} s the filtered motion is out of reach; leave this part out"
        raise InvalidLog(problem, log=log.name)
    torque = np.concatenate(torques)
    both = np.concatenate([torque, _rates(torque, samples.segment) * rate], axis=1)
    smooth = smoothed(both, samples, slow)
    return Signals(
        t[samples.kept], samples.segment[samples.kept], smooth[:, :4], smooth[:, 4:],
        samples, 1 / rate, cut_off, slow,
    )  # fmt: skip


def position_cut_off(rate: float, cut_off: float) -> float:
    """Return where the filter of the positions halves [Hz], for the rate and the cut-off [Hz]."""
    return max(cut_off, min(POSITION_CUT_OFF, rate / LOWEST_RATE))


def thinning_for(rate: float, cut_off: float) -> int:
    """Return how many samples there are for one that is kept."""
    return max(1, int(rate / (OVERSAMPLING * position_cut_off(rate, cut_off))))


def pieces_of(segment: NDArray[np.int64]) -> list[NDArray[np.intp]]:
    """Return the places of the samples of each piece, for their numbers (n,)."""
    return np.split(np.arange(len(segment)), np.flatnonzero(np.diff(segment)) + 1)


def _rates(values: Array, segment: NDArray[np.int64]) -> Array:
    """Return sixth-order differences of rows in steps of 1, piece by piece; zero at the ends."""
    found = np.zeros_like(values)
    for place in pieces_of(segment):
        found[place[_REACH:-_REACH]] = _difference(values[place], _FIRST)
    return found


def _difference(values: Array, weights: Array) -> Array:
    """Return central differences (n - 6, ...) of rows in steps of 1."""
    size = len(values) - 2 * _REACH
    return np.asarray(sum(w * values[place : place + size] for place, w in enumerate(weights) if w))
