"""Whether worst errors of the drives are those of the whole box: random robots, points of boxes.

Run: ``python -m benchmarks.accuracy_error --boxes 1000``. Figures do not depend on the machine.
"""

from __future__ import annotations

import argparse

import numpy as np

from benchmarks.measure import heading, number, table
from paminsa_viz.model.arrays import Array
from tests.precision.boxes import edge_points, random_boxes, samples

NOTED = 3e-3
"""Share by which a box's edge is worse than its corners from which the box is counted."""


def main() -> None:
    """Compare stated errors with those at points."""
    parser = argparse.ArgumentParser(prog="accuracy_error", description=__doc__)
    parser.add_argument("--boxes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--points", type=int, default=301, help="of each edge, and inside")
    given = parser.parse_args()
    rng = np.random.default_rng(given.seed)
    worse: list[tuple[Array, ...]] = []
    while sum(len(item[0]) for item in worse) < given.boxes:
        for box in random_boxes(rng, 2):
            edges = box.worst(edge_points(box.half, given.points))
            inside = box.worst(samples(rng, box.half, given.points))
            worst = np.maximum(edges, inside)
            worse.append((worst / box.corners, worst / box.bounds, inside / edges))
    corners, bounds, inside = (
        np.concatenate(each)[: given.boxes] - 1.0 for each in zip(*worse, strict=True)
    )
    heading(f"{len(bounds)} boxes of random robots, 0.06 to 6 degrees to each side")
    rows = [
        [
            name,
            str(int((corners[:, i] > NOTED).sum())),
            number(round(100 * corners[:, i].max(), 4)),
            str(int((bounds[:, i] > 1e-9).sum())),
            number(round(-100 * bounds[:, i].min(), 4)),
            str(int((inside[:, i] > 1e-3).sum())),
        ]
        for i, name in enumerate(("x", "y", "theta", "in the plane"))
    ]
    columns = ["", f"boxes worse than their corners by {100 * NOTED:g} %", "at most [%]",
               "boxes worse than stated", "stated above the worst point, at most [%]",
               "boxes worse inside than on edges"]  # fmt: skip
    table(columns, rows)


if __name__ == "__main__":
    main()
