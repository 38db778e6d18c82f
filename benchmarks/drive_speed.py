"""Speed of choosing drives: pairs of given ratio, exact ratio intervals, windings.

Run: ``python -m benchmarks.drive_speed``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.actuation.drive_table import DriveTable, drive_table
from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.ratios import ratio_intervals
from paminsa_viz.actuation.sizing import size_drives, thermal_share
from paminsa_viz.model import APPENDIX_4, Drive
from paminsa_viz.trajectory import PRESET

MOTORS = 1000


def motors(*, sloped: bool) -> DriveTable:
    """Draw motors of 0.05 to 5 N m, with a rectangular or a sloped envelope."""
    rng = np.random.default_rng(0)
    found = []
    for _ in range(MOTORS):
        rated = 10 ** rng.uniform(-1.3, 0.7)
        peak, top = 3 * rated, rng.uniform(300, 700)
        found.append(
            Drive(
                rotor_inertia=rated * 10 ** rng.uniform(-5.2, -4.0),
                gear_ratio=rng.uniform(20, 200), efficiency=rng.uniform(0.6, 0.95),
                viscous=1e-5 * rated, rated_torque=rated, peak_torque=peak,
                rated_speed=0.6 * top, top_speed=top,
                thermal_time_constant=rng.choice([300.0, 600.0, 900.0]),
                envelope=((0.0, peak), (0.6 * top, peak), (top, peak / 3)) if sloped else (),
            )
        )  # fmt: skip
    return drive_table(found)


def main() -> None:
    """Run everything."""
    plan = PRESET["waypoints"].build(APPENDIX_4.geometry).lasting(10.0)
    motion = plan.sample(1000)
    cycle = duty_cycle(APPENDIX_4, [Duty(motion)])
    for load in cycle.loads:
        size_drives(load, motors(sloped=False))  # the load's own sums
    loads = best(lambda: duty_cycle(APPENDIX_4, [Duty(plan.sample(1000))]))  # kept by motion
    rows = [["loads of the motion", "", number(1e3 * loads)]]
    for name, sloped in (("rectangular", False), ("sloped", True)):
        columns = motors(sloped=sloped)
        screws = replace(columns, ratio=columns.ratio * 2 * np.pi / 0.2)
        both = [(load, screws if load.name == "M4" else columns) for load in cycle.loads]
        runs = {
            "pairs of given ratio": lambda both=both: [size_drives(*one).use for one in both],
            "exact intervals of the ratio": lambda both=both: [
                ratio_intervals(*one) for one in both
            ],
        }
        rows += [[what, name, number(1e3 * best(run))] for what, run in runs.items()]
    few = motors(sloped=False)[:20]
    windings = best(lambda: thermal_share(cycle.loads[0], few))
    rows.append(["temperature of 20 windings", "", number(1e3 * windings)])
    heading(f"{MOTORS} motors and gears on 4 actuators; {motion.size} samples")
    table(["what", "envelope", "ms"], rows)


if __name__ == "__main__":
    main()
