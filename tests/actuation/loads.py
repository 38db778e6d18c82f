"""Random loads and drives for the tests of sizing."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from paminsa_viz.actuation.drive_table import DriveTable, drive_table
from paminsa_viz.actuation.duty import ActuatorLoad, DutyMotion, load_signals
from paminsa_viz.model.drive import Drive


def random_load(
    rng: np.random.Generator, samples: int = 200, *, dwell: float = 0.0, bias: float = 0.0
) -> ActuatorLoad:
    """Draw a smooth motion and a torque that goes with it, now driving, now braking."""
    t = np.linspace(0.0, rng.uniform(0.5, 5.0), samples)
    shares, duration = t / t[-1], t[-1]
    speed, growth, torque = np.zeros(samples), np.zeros(samples), np.full(samples, bias)
    for k in range(1, 5):
        size, w = rng.normal(), np.pi * k / duration
        speed += size * np.sin(w * t)
        growth += size * w * np.cos(w * t)
        torque += rng.normal() * 3 * np.cos(np.pi * k * shares + rng.uniform(0, 6))
    torque += rng.normal() * growth
    speed[[0, -1]] = 0.0
    signals = load_signals(torque, growth, speed)
    passage = DutyMotion(t, signals, 1.0, dwell, float(torque[-1]))
    return ActuatorLoad("M1", (passage,), rng.uniform(0.01, 1.0))


def random_drives(
    rng: np.random.Generator, count: int, *, coulomb: float = 0.0, bent: bool = False
) -> DriveTable:
    """Draw motors of which some can drive a `random_load` with some ratios and some cannot."""
    drives = []
    for _ in range(count):
        rated = 10 ** rng.uniform(-1.7, 0.7)
        peak = rated * rng.uniform(1.5, 4.0)
        top = 10 ** rng.uniform(2.0, 3.0)
        knee, end = rng.uniform(0.2, 0.9) * top, rng.uniform(0.0, 0.9) * peak
        points = ((0.0, peak), (knee, peak), (top, end))
        if bent:
            points = ((0.0, peak), (0.4 * top, 0.5 * peak), (0.8 * top, 0.45 * peak), (top, 0.0))
        drives.append(
            Drive(
                rotor_inertia=rated * 10 ** rng.uniform(-5.5, -3.5),
                efficiency=rng.uniform(0.4, 1.0),
                viscous=rated * rng.choice([0.0, 10 ** rng.uniform(-5, -3)]),
                coulomb=coulomb * rated * rng.uniform(),
                rated_torque=rated, peak_torque=peak,
                rated_speed=top * rng.uniform(0.3, 1.0), top_speed=top,
                envelope=points if bent or rng.uniform() < 0.7 else (),
                brake=bool(rng.integers(2)),
                thermal_time_constant=None,
            )
        )  # fmt: skip
    return drive_table(drives)


def cases(
    rng: np.random.Generator, count: int, drives: int, *, coulomb: float = 0.0, bent: bool = False
) -> Iterator[tuple[ActuatorLoad, DriveTable, float]]:
    """Yield loads with drives, and with a limit on the ratio of inertias or none."""
    for _ in range(count):
        load = random_load(
            rng, 801, dwell=rng.choice([0.0, 1.0]), bias=rng.normal() * rng.choice([0.0, 2.0])
        )
        table = random_drives(rng, drives, coulomb=coulomb, bent=bent)
        yield load, table, float(rng.choice([np.inf, 30.0]))
