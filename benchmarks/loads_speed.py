"""Speed of joint forces and bar loads: a map, a motion, a pose, beside what they are built on.

Run: ``python -m benchmarks.loads_speed``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.measure import heading, number, processor_time, table
from paminsa_viz.elastostatics.bar_loads import (
    all_bar_loads,
    field_bar_loads,
    field_joint_forces,
    utilization,
)
from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.backend import use_numpy
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.grids import solve_field, xy_grid
from paminsa_viz.trajectory import PRESET, analyze

CELLS = 72


def main() -> None:
    """Run everything."""
    axis = np.linspace(-0.15, 0.15, CELLS)
    grid = xy_grid(axis, axis, 0.4, -0.5)
    poses, field = grid.poses(), solve_field(APPENDIX_4.geometry, grid)
    still = np.zeros_like(poses)
    rng = np.random.default_rng(0)
    matrices, right = (
        rng.normal(size=(3 * CELLS**2, 14, 14)),
        rng.normal(size=(3 * CELLS**2, 14, 1)),
    )
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(1000)
    analysis = analyze(APPENDIX_4, motion)
    one = poses[36, 36]
    at_one = joint_forces(APPENDIX_4, one)

    def inverse() -> object:
        with use_numpy():
            return inverse_dynamics(APPENDIX_4, poses, still, still)

    def whole_motion() -> None:
        found = motion_loads(analysis)
        assert found is not None
        found.peak, found.rms, found.equivalent, found.bar_peak, found.utilization  # noqa: B018

    def motion_joints() -> None:
        found = motion_loads(analysis)
        assert found is not None
        found.peak, found.rms, found.equivalent  # noqa: B018

    runs: dict[str, tuple[Callable[[], object], int]] = {
        f"inverse dynamics, {CELLS}x{CELLS} poses, NumPy": (inverse, CELLS**2),
        "as many 14x14 systems a leg, solved by LAPACK alone": (
            lambda: np.linalg.solve(matrices, right), CELLS**2
        ),
        f"joint forces, {CELLS}x{CELLS} poses": (
            lambda: joint_forces(APPENDIX_4, poses), CELLS**2
        ),
        f"map {CELLS}x{CELLS}: twelve quantities of joint forces": (
            lambda: field_joint_forces.__wrapped__(field, APPENDIX_4), CELLS**2
        ),
        f"map {CELLS}x{CELLS}: N, M, utilization of 21 bars": (
            lambda: field_bar_loads.__wrapped__(field, APPENDIX_4), CELLS**2
        ),
        f"motion, {motion.size} samples: peak, RMS, equivalent load": (motion_joints, motion.size),
        f"motion, {motion.size} samples: with N, V, M, utilization": (whole_motion, motion.size),
        "one pose: joint forces": (lambda: joint_forces(APPENDIX_4, one), 1),
        "one pose: N, V, M, utilization": (
            lambda: ([b.extremes() for b in all_bar_loads(at_one).values()], utilization(at_one)), 1
        ),
    }  # fmt: skip
    first = 0.0
    rows = []
    for name, (run, count) in runs.items():
        run()
        spent = processor_time(run)
        first = first or spent / count
        rows.append(
            (name, f"{number(1e3 * spent)} ms", f"{number(1e6 * spent / count)} µs",
             f"{number(spent / count / first)}")
        )  # fmt: skip
    heading("Joint forces and bar loads, processor time on one core")
    table(("what", "time", "a pose", "of inverse dynamics"), rows)


if __name__ == "__main__":
    main()
