"""What a study measures of a design on a motion: its dynamic loads, or where it fails and why."""

from __future__ import annotations

import hashlib

import numpy as np

from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import Limit, status_words
from paminsa_viz.studies.metrics import Metric
from paminsa_viz.trajectory import Trajectory, analyze

MOTION_METRICS: tuple[Metric, ...] = (
    Metric("motion_peak_torque_Nm", "largest torque of M1 to M3 on the motion"),
    Metric("motion_rms_torque_Nm", "RMS torque of M1 to M3 over the motion's time"),
    Metric("motion_peak_force_N", "largest force of M4 on the motion"),
    Metric("motion_energy_J", "energy that M1 to M4 put in on the motion; braking gives none back"),
)
"""Everything that is measured on a motion, in the order of a table's columns."""

RUNS = str(status_words(Limit.OK))
"""Word for a motion that a design can run."""


def measure_motion(design: Design, trajectory: Trajectory) -> tuple[str, float, tuple[float, ...]]:
    """Return a word, a time [s] and the `MOTION_METRICS` [SI] of a design on a motion.

    The numbers are those of `analyze`, friction included. A design that cannot run the whole
    motion has none: they are NaN, the word is what it fails at, such as ``guide:leg2`` or
    ``singular``, and the time is when. Otherwise the word is `RUNS` and the time NaN.
    """
    analysis = analyze(design, trajectory)
    first = analysis.check.first
    if first is not None:
        word = str(status_words(first.limit, first.leg))
        return word, first.t, (np.nan,) * len(MOTION_METRICS)
    rotary, lift = analysis.summary[:3], analysis.summary[3]
    found = (
        max(abs(motor.peak) for motor in rotary),
        float(np.sqrt(np.mean([motor.rms**2 for motor in rotary]))),
        abs(lift.peak),
        sum(motor.driven for motor in analysis.summary),
    )
    return RUNS, np.nan, found


def samples_hash(trajectory: Trajectory) -> str:
    """Return what tells a motion's samples from any others, whatever the motion is called."""
    found = hashlib.sha256()
    for array in (trajectory.t, trajectory.pose, trajectory.velocity, trajectory.acceleration):
        found.update(array.astype("<f8").tobytes())
    return found.hexdigest()[:32]
