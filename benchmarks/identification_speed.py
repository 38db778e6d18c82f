"""Speed of identifying a log: 20 s at 1 kHz, with intervals, causes and masses.

Run: ``python -m benchmarks.identification_speed``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.identification import (
    IdentificationSettings,
    find_causes,
    identify,
    make_log,
    nearest_masses,
    validate,
)
from paminsa_viz.identification.log import Log
from paminsa_viz.model import APPENDIX_4, Friction, inverse_dynamics, inverse_kinematics
from paminsa_viz.model.reach import home_pose

SECONDS, RATE = 20.0, 1000.0


def recorded(noise: float = 0.02) -> Log:
    """Make a log of five sines in each coordinate, with friction and noise."""
    design = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
    rng = np.random.default_rng(0)
    t = np.arange(round(SECONDS * RATE)) / RATE
    w = 2 * np.pi * 0.1 * rng.integers(1, 14, size=(5, 4, 1))
    phase = rng.uniform(0, 2 * np.pi, size=(5, 4, 1))
    size = np.array([0.02, 0.02, 0.12, 0.03])[:, None]
    motion = [
        (size * w**order * np.sin(w * t + phase + order * np.pi / 2)).sum(axis=0).T
        for order in range(3)
    ]
    motion[0] = motion[0] + np.array(home_pose(design.geometry))
    torque = inverse_dynamics(design, *motion).torque
    torque += noise * torque.std(axis=0) * rng.standard_normal(torque.shape)
    return make_log(t, inverse_kinematics(design.geometry, motion[0]).actuators, torque)


def main() -> None:
    """Run everything."""
    log = recorded()
    plain = IdentificationSettings(robustness=False)
    found = identify(APPENDIX_4, log)
    runs = {
        "check of the rows": lambda: make_log(log.t, log.position, log.torque),
        "estimates with intervals": lambda: identify(APPENDIX_4, log, plain),
        "the same, and with two more cut-offs": lambda: identify(APPENDIX_4, log),
        "the same, and each leg's own masses": lambda: identify(
            APPENDIX_4, log, IdentificationSettings(legs=True)
        ),
        "causes": lambda: find_causes(found),
        "nearest masses": lambda: nearest_masses(found),
        "validation with a second log": lambda: validate(found, log),
    }
    heading(f"Identification: {SECONDS:g} s at {RATE:g} Hz")
    table(["what", "ms"], [[name, number(1e3 * best(run))] for name, run in runs.items()])


if __name__ == "__main__":
    main()
