"""Speed of the accuracy: maps of the errors from the drives beside a map of another quantity.

Run: ``python -m benchmarks.accuracy_speed``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.model import APPENDIX_4, Design, DriveAccuracy
from paminsa_viz.plots.map_values import workspace_field
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.quantities import QUANTITIES

CELLS = 72


def main() -> None:
    """Run everything."""
    geometry = APPENDIX_4.geometry
    field = workspace_field(geometry, 0.5, -0.5, CELLS)
    step = 0

    def another() -> Design:
        """Return a design whose errors and loads have not been worked out yet."""
        nonlocal step
        step += 1
        return replace(
            APPENDIX_4, accuracy=DriveAccuracy(1e-4 + 1e-9 * step), gravity=9.81 + 1e-6 * step
        )

    keys = ("max_torque", "acceleration", "linear_error_x", "error_horizontal", "error_theta")
    for key in keys:
        QUANTITIES[key].over(field, APPENDIX_4)  # what the geometry decides is solved once
    times = {key: best(lambda key=key: QUANTITIES[key].over(field, another())) for key in keys}
    rows = [
        [
            key,
            number(1e3 * time),
            number(1e6 * time / CELLS**2),
            number(time / times["acceleration"]),
        ]
        for key, time in times.items()
    ]
    heading(f"maps of {CELLS}x{CELLS} cells after a change of accuracy and gravity")
    table(["quantity", "ms", "µs a pose", "times acceleration"], rows)
    pose = np.array([0.05, 0.02, 0.3, -0.5])
    one = best(lambda: drive_errors(geometry, another().accuracy, pose))
    print(f"one pose, as the page does for each frame: {number(1e3 * one)} ms")


if __name__ == "__main__":
    main()
