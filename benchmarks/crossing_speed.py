"""Speed of planning motions through singularities.

Run: ``python -m benchmarks.crossing_speed``. The machine should be idle.
"""

from __future__ import annotations

from benchmarks.measure import best, heading, number, table
from paminsa_viz.balancing import balance
from paminsa_viz.model import APPENDIX_4, backend
from paminsa_viz.trajectory import (
    MotionLimits,
    crossing_condition,
    crossings,
    spline_path,
    straight_path,
    time_optimal,
)

BALANCED = balance(APPENDIX_4).after
PATHS = {
    "turn through 73.4°": straight_path([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5]),
    "line through the circle": straight_path([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5]),
    "turn there and back": spline_path(
        [[0.03, 0.02, 0.9, -0.5], [0.03, 0.02, 1.5, -0.5], [0.05, 0.0, 1.5, -0.45],
         [0.05, 0.0, 0.9, -0.45]]
    ),
}  # fmt: skip
LIMITS = MotionLimits(torque=20.0)


def main() -> None:
    """Print one table."""
    backend.compile_now()
    geometry = BALANCED.geometry
    rows = []
    for name, path in PATHS.items():
        at = crossings(geometry, path)[0].s
        times = (
            best(lambda path=path: crossings(geometry, path)),
            best(lambda path=path, at=at: crossing_condition(BALANCED, path, at)),
            best(lambda path=path: time_optimal(BALANCED, path, LIMITS), least=10),
        )
        rows.append([name, *(number(1e3 * time) for time in times)])
    heading("Motions of the balanced robot through singularities")
    columns = ["path", "find crossings [ms]", "condition [ms], target 1", "plan [ms], target 1000"]
    table(columns, rows)


if __name__ == "__main__":
    main()
