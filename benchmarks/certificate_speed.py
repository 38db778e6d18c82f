"""Speed and tightness of proofs: bounds over boxes, and the largest proven workspace.

Run: ``python -m benchmarks.certificate_speed``.
"""

from __future__ import annotations

import itertools
import time

import numpy as np

from benchmarks.measure import heading, number, processor_time, table
from paminsa_viz.model import APPENDIX_4, measure_singularity, static_torques
from paminsa_viz.model.arrays import Array
from paminsa_viz.synthesis.proof.certificate import prove
from paminsa_viz.synthesis.proof.enclosures import condition_bounds, static_bounds
from paminsa_viz.synthesis.proof.largest import largest_workspace
from paminsa_viz.synthesis.proof.regions import Growth
from tests.synthesis.robots import NEEDED, TURN, cylinder

BOXES = 8192
TOLERANCES = (0.016, 0.005, 0.001)
"""Of the largest workspaces [m]."""


def poses() -> Array:
    """Return poses of the cylinder r 150 x 400 mm, theta to 30 degrees, (n, 4)."""
    rng = np.random.default_rng(0)
    angle, radius = rng.uniform(0, 2 * np.pi, BOXES), 0.15 * np.sqrt(rng.random(BOXES))
    return np.column_stack(
        [
            radius * np.cos(angle),
            radius * np.sin(angle),
            rng.uniform(-TURN, TURN, BOXES),
            rng.uniform(-0.8, -0.4, BOXES),
        ]
    )


def tightness() -> None:
    """Compare bounds over boxes with the largest values at their corners."""
    middle = poses()
    rows = []
    for width in (0.001, 0.002, 0.004, 0.008, 0.016):
        half = np.full((BOXES, 4), width) * [1.0, 1.0, 2.0, 1.0]
        condition = np.zeros(BOXES)
        torque = np.zeros(BOXES)
        for corner in itertools.product((-1.0, 1.0), repeat=4):
            at = middle + half * corner
            found = measure_singularity(APPENDIX_4.geometry, at).condition
            condition = np.fmax(condition, found)
            torque = np.fmax(torque, np.abs(static_torques(APPENDIX_4, at)[:, :3]).max(axis=1))
        most = condition_bounds(APPENDIX_4, middle, half)
        low, high = static_bounds(APPENDIX_4, middle, half)
        largest = np.maximum(-low[:, :3], high[:, :3]).max(axis=1)
        rows.append(
            (
                f"± {1e3 * width:g} mm, ± {2e3 * width:g} mrad",
                _excess(most, condition),
                _excess(largest, torque),
            )
        )
    heading("How much bounds over a box exceed the largest value at its corners (median)")
    table(("box", "condition number", "largest torque"), rows)


def _excess(bound: Array, value: Array) -> str:
    """Write the median excess; where half of the boxes have no bound, that."""
    excess = np.nan_to_num(bound / value - 1, nan=np.inf)
    median = float(np.median(excess))
    return f"{100 * median:.2g} %" if np.isfinite(median) else "no bound"


def speed() -> None:
    """Compare bounds over boxes with values at poses."""
    middle = poses()
    half = np.full((BOXES, 4), 0.004)
    times = {
        "condition number": (
            processor_time(lambda: measure_singularity(APPENDIX_4.geometry, middle)),
            processor_time(lambda: condition_bounds(APPENDIX_4, middle, half)),
        ),
        "torques and F_4": (
            processor_time(lambda: static_torques(APPENDIX_4, middle)),
            processor_time(lambda: static_bounds(APPENDIX_4, middle, half)),
        ),
    }
    heading(f"A box against a pose, on arrays of {BOXES}")
    table(
        ("quantity", "pose [µs]", "box [µs]", "ratio"),
        [
            (name, number(1e6 * pose / BOXES), number(1e6 * box / BOXES), number(box / pose))
            for name, (pose, box) in times.items()
        ],
    )


def workspaces() -> None:
    """Prove a cylinder and find the largest ones."""
    workspace = cylinder(0.3, 0.4)
    start = time.process_time()
    proof = prove(APPENDIX_4, NEEDED, workspace, time_limit=600)
    used = time.process_time() - start
    rows = [("d 300 x 400 mm", "proof", "", f"{proof.boxes:,}", number(used))]
    for growth, tolerance in itertools.product(
        (Growth.HORIZONTAL, Growth.ALL, Growth.VERTICAL), TOLERANCES
    ):
        start = time.process_time()
        found = largest_workspace(
            APPENDIX_4, NEEDED, workspace, growth=growth, tolerance=tolerance, time_limit=600
        )
        used = time.process_time() - start
        assert found.workspace is not None
        d, _, h = (1e3 * extent for extent in found.workspace.size)
        rows.append(
            (
                f"d {d:.1f} x {h:.1f} mm",
                f"largest, {growth.name.lower()}",
                f"{1e3 * found.gap:.2f}",
                f"{found.boxes:,}",
                number(used),
            )
        )
    heading("Appendix 4: cylinder about (0, 0, -600) mm, theta ± 30°, κ ≤ 10, 15 N·m, 450 N")
    table(("cylinder", "task", "gap [mm]", "boxes", "processor time [s]"), rows)


def main() -> None:
    """Run everything."""
    tightness()
    speed()
    workspaces()


if __name__ == "__main__":
    main()
