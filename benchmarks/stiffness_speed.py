"""Speed of maps of stiffness and of the first natural frequency, and what a slider costs.

Run: ``python -m benchmarks.stiffness_speed``.
"""

from __future__ import annotations

import numpy as np

from benchmarks.measure import best, heading, number, processor_time, table
from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.leg_matrices import structure
from paminsa_viz.elastostatics.stiffness import field_stiffness, platform_stiffness
from paminsa_viz.elastostatics.vibration import first_frequencies, robot_modes
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.grids import solve_field, xy_grid
from paminsa_viz.quantities import QUANTITIES

CELLS = 72


def main() -> None:
    """Run everything."""
    axis = np.linspace(-0.15, 0.15, CELLS)
    grid = xy_grid(axis, axis, 0.4, -0.5)
    poses = grid.poses()
    field = solve_field(APPENDIX_4.geometry, grid)
    field_stiffness(field, APPENDIX_4)
    thick = [APPENDIX_4.vary({"elastic.b4_outer": 0.04 + 1e-4 * i}) for i in range(2)]
    few = poses.reshape(-1, 4)[:: CELLS * CELLS // 200]
    every = poses.size // 4
    runs = {
        f"whole 6x6, map {CELLS}x{CELLS}, force method": (
            lambda: platform_stiffness(APPENDIX_4, poses), every
        ),
        "the same with shear (Timoshenko)": (
            lambda: platform_stiffness(APPENDIX_4, poses, shear=True), every
        ),
        "a diameter moved: three quantities of the map": (
            lambda: [
                QUANTITIES[key].over(field, design)
                for design in thick
                for key in ("stiffness_x", "stiffness_horizontal", "stiffness_tilt")
            ],
            2 * every,
        ),
        f"first natural frequency, map {CELLS}x{CELLS}": (
            lambda: first_frequencies(APPENDIX_4, poses), every
        ),
        "the same with elastic drives alone": (lambda: drive_modes(APPENDIX_4, poses), every),
        "six modes in all coordinates (151)": (
            lambda: [robot_modes(APPENDIX_4, pose) for pose in few[:20]], 20
        ),
        "whole 6x6, assembled structure (151 freedoms)": (
            lambda: structure(APPENDIX_4, few).platform_stiffness(), len(few)
        ),
    }  # fmt: skip
    rows = []
    for name, (run, count) in runs.items():
        wall, core = best(run), processor_time(run)
        rows.append([name, number(1e3 * wall * every / count), number(1e3 * core * every / count),
                     number(1e6 * wall / count)])  # fmt: skip
    heading(f"Stiffness of {every} poses")
    table(["what", "ms a map", "ms of processor", "µs a pose"], rows)


if __name__ == "__main__":
    main()
