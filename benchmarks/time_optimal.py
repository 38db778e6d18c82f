"""The time-optimal law against the motion's own one, stretched: durations of the presets.

Run: ``python -m benchmarks.time_optimal``. The table of `docs/motions.md` is its output. Durations
do not depend on the machine.
"""

from __future__ import annotations

from dataclasses import replace

from benchmarks.measure import heading, number, table
from paminsa_viz.model import APPENDIX_4, Design, Drive, backend
from paminsa_viz.trajectory import PRESETS, MotionLimits, shortest_motion

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
    "those, 6 N m, 400 N": (APPENDIX_4, LIMITS),
    "servo drives alone": (DRIVEN, MotionLimits()),
}


def main() -> None:
    """Print one table."""
    backend.compile_now()
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


if __name__ == "__main__":
    main()
