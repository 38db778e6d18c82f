"""The time-optimal law: against the motion's own one, and how much longer than with finer pieces.

Run: ``python -m benchmarks.time_optimal``. The table of `docs/motions.md` is the first of its
output, figures of `docs/crossing.md` are in the second. Durations do not depend on the machine.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measure import heading, number, table
from paminsa_viz.model import APPENDIX_4, Design, Drive, backend
from paminsa_viz.trajectory import PRESETS, MotionLimits, crossing_program, shortest_motion
from tests.trajectory.crossings import (
    FINER,
    any_path,
    duration,
    influences,
    lines_across,
    random_crossing,
)

RATES = MotionLimits(speed=1.0, turn_speed=6.0, acceleration=10.0, turn_acceleration=60.0)
LIMITS = replace(RATES, torque=6.0, force=400.0)
SERVO = Drive(
    "servo", 4e-6, 1e-6, 80.0, 0.8, viscous=2e-6, coulomb=2e-3, peak_torque=0.2, top_speed=400.0,
    envelope=((0.0, 0.2), (150.0, 0.2), (500.0, 0.01)),
)  # fmt: skip
SCREW = replace(
    SERVO, gear_ratio=1.0, transmission="screw", lead=0.01, peak_torque=0.9, top_speed=600.0,
    envelope=((0.0, 0.9), (300.0, 0.9), (600.0, 0.5)),
)  # fmt: skip
DRIVEN = replace(APPENDIX_4, drives=(SERVO, SERVO, SERVO, SCREW))
CASES: dict[str, tuple[Design, MotionLimits]] = {
    "1 m/s, 6 rad/s, 10 m/s², 60 rad/s²": (APPENDIX_4, RATES),
    "those, 6 N·m, 400 N": (APPENDIX_4, LIMITS),
    "servo drives alone": (DRIVEN, MotionLimits()),
}


PATHS = 40
"""Paths of each kind that cross singularities."""


def main() -> None:
    """Print both tables."""
    backend.compile_now()
    presets()
    crossed()


def presets() -> None:
    """Print durations of the presets."""
    rows = []
    for preset in PRESETS[1:]:  # the first one and the quintic move have one path and law
        cells = []
        for design, limits in CASES.values():
            found = shortest_motion(preset.build(design.geometry), limits, design)
            best = found.plan.duration
            cells.append(
                f"{number(best)} / {number(found.stretched)}, {best / found.stretched:.2f}"
            )
        rows.append([preset.label, *cells])
    heading("Time-optimal law / the motion's own one, stretched [s], and their ratio")
    table(["motion", *CASES], rows)


def crossed() -> None:
    """Print how much longer motions through singularities are than with finer pieces."""
    rows = []
    for label, make in (("lines across the circle", lines_across), ("any paths", any_path)):
        found = []
        for seed in range(PATHS):
            design, path, limits, planned = random_crossing(make, seed)
            finer = duration(design, path, limits, *FINER)
            found.append((min(influences(design, path)), planned.plan.duration / finer - 1.0))
        cosine, excess = np.array(found).T
        steep = cosine < crossing_program.STEEP
        for kind, chosen in (("a ≈ 0", steep), ("other", ~steep)):
            values = 100.0 * excess[chosen]
            if len(values):
                rows.append([f"{label}, {kind}", str(len(values)),
                             number(float(np.median(values))), number(values.max())])  # fmt: skip
    heading(
        f"How much longer than with {FINER[0]} pieces, halved {FINER[1]} times at crossings [%]"
    )
    table(["paths", "number", "median", "at most"], rows)


if __name__ == "__main__":
    main()
