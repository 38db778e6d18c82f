"""Motions through type-2 singularities, where a usual law needs torques without bound.

A turn through theta = 73.4°, where every position is singular, and a line through the singular
circle. The time law meets t_s^T F = 0 at the crossing; balanced, the robot can go as slowly as it
likes, and it can be held on the far side of the circle.
"""

import numpy as np

from paminsa_viz.balancing import balance
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.trajectory import (
    CrossingRefused,
    MotionLimits,
    analyze,
    payload_drift,
    straight_path,
    time_optimal,
    unplanned_torque,
)

designs = {"Appendix 4": APPENDIX_4, "balanced": balance(APPENDIX_4).after}
paths = {
    "turn": straight_path([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5]),
    "line": straight_path([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5]),
}
for name, path in paths.items():
    for robot, design in designs.items():
        try:
            found = time_optimal(design, path, MotionLimits(torque=10.0))
        except CrossingRefused as refusal:
            print(f"{name}, {robot}: {refusal}")
            continue
        (crossing,) = found.crossings
        peak = np.abs(analyze(design, found.plan.sample()).torque[:, :3]).max()
        naive = unplanned_torque(crossing, found.plan.duration)
        drift = np.array(payload_drift(design, found, 0.1)[0].shift)
        print(f"{name}, {robot}: {found.plan.duration:.3f} s, through at {crossing.t:.3f} s")
        print(f"  peak {peak:.2f} N·m; the quintic law at 1 kHz: {naive:.0f} N·m")
        print(f"  limit torques {np.round(crossing.torque[:3], 3)} N·m")
        print(f"  drift by 0.1 kg: {1e6 * np.hypot(*drift[:2]):.2f} µm, {1e6 * drift[2]:.2f} µrad")
