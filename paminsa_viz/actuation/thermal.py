"""Temperature of windings over a duty cycle that goes on forever.

A winding is one thermal mass: with the time constant t_th its rise over that at the rated torque
follows t_th h' = (tau/rated)^2 - h. The heat is linear between samples, the solution exact; the
cycle starts at the temperature that it ends with.
"""

from __future__ import annotations

import numpy as np

from paminsa_viz.actuation.drive_table import DriveTable
from paminsa_viz.actuation.duty import ActuatorLoad, DutyMotion
from paminsa_viz.model.arrays import Array

EVEN = 1e-9
"""Relative difference of time steps that counts as even."""

DRIVES_AT_A_TIME = 64
"""Drives whose temperatures are worked out together, to bound the memory."""


def thermal_share(load: ActuatorLoad, table: DriveTable) -> Array:
    """Return the largest temperature rise over that at the rated torque, (n,).

    All drives need a time constant and a rated torque. A cycle that is short against the time
    constant gives the square of RMS over rated torque, any other one more.
    """
    shares = np.empty(len(table))
    for start in range(0, len(table), DRIVES_AT_A_TIME):
        rows = slice(start, start + DRIVES_AT_A_TIME)
        shares[rows] = _shares(load, table[rows])
    return shares


def _shares(load: ActuatorLoad, table: DriveTable) -> Array:
    factors, time = table.factors(), table.thermal_time[:, None]
    starts, parts = [], []
    # one cycle as affine maps of the temperature at its start: h -> decay h + gain
    decay, gain = np.ones(len(table)), np.zeros(len(table))
    for passage in load.passages:
        heat = (factors @ passage.signals / table.rated_torque[:, None]) ** 2
        rise = _rise(passage, heat, time)
        one = np.exp(-passage.t[-1] / time[:, 0])
        held = np.where(table.holds, 0.0, passage.held * factors[:, 2] / table.rated_torque) ** 2
        cooled = np.exp(-passage.dwell / time[:, 0])
        step_decay, step_gain = one * cooled, rise[:, -1] * cooled + held * (1 - cooled)
        many = step_decay ** (passage.repeats - 1)
        settled = step_gain / (1 - step_decay)
        starts.append((decay, gain, many, settled))
        parts.append((passage, rise, held))
        whole = many * step_decay
        decay, gain = decay * whole, gain * whole + settled * (1 - whole)
    base = gain / (1 - decay)
    hottest = np.zeros(len(table))
    for (before, offset, many, settled), (passage, rise, held) in zip(starts, parts, strict=True):
        # Repetitions approach one temperature from one side: the first or the last is hottest.
        first = before * base + offset
        last = many * first + settled * (1 - many)
        fade = np.exp(-passage.t / time)
        for start in (first, last):
            path = fade * start[:, None] + rise
            cooled = np.exp(-passage.dwell / time[:, 0])
            end = path[:, -1] * cooled + held * (1 - cooled)
            hottest = np.maximum(hottest, np.maximum(path.max(axis=1), end))
    return hottest


def _rise(passage: DutyMotion, heat: Array, time: Array) -> Array:
    """Return the temperature from zero at the start, under heat (n, m) linear between samples."""
    steps = np.diff(passage.t)
    fade, here, there = _weights(steps / time)
    rise = np.zeros_like(heat)
    rise[:, 1:] = here * heat[:, :-1] + there * heat[:, 1:]
    if np.ptp(steps) <= EVEN * steps.mean():
        from scipy.signal import lfilter  # late: it takes half a second to load

        for value in np.unique(time):
            rows = time[:, 0] == value
            decay = float(np.exp(-steps.mean() / value))
            rise[rows] = lfilter([1.0], [1.0, -decay], rise[rows], axis=1)
        return rise
    # steps of their own each: two maps h -> fade h + gain in a row are one, over 1, 2, 4, .. steps
    reach = 1
    while reach <= len(steps):
        rise[:, 1 + reach :] += fade[:, reach:] * rise[:, 1:-reach]
        fade[:, reach:] = fade[:, reach:] * fade[:, :-reach]
        reach *= 2
    return rise


def _weights(share: Array) -> tuple[Array, Array, Array]:
    """Return exp(-s) and the weights of the heat at both ends of a step of s time constants."""
    fade = np.exp(-share)
    mean = -np.expm1(-share) / share
    # near zero the exact form loses digits; its series does not
    there = np.where(share > 1e-4, 1 - mean, share / 2 - share**2 / 6)
    return fade, 1 - fade - there, there
