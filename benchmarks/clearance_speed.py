"""Speed of the clearance: maps beside a map of stiffness, groups of pairs, a pose, a new design.

Run: ``python -m benchmarks.clearance_speed``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.clearance import (
    clearance,
    group_clearance,
    kernels,
    nearest_points,
    shapes_of,
)
from paminsa_viz.clearance.shapes import build_shapes
from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.model import APPENDIX_4, Design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Counterweight, Payload
from paminsa_viz.plots.map_values import workspace_field

CELLS = 72


def map_poses(radius: float) -> Array:
    """Return the cells of a square map at home's height, (CELLS, CELLS, 4)."""
    x = np.linspace(-radius, radius, CELLS)
    poses = np.zeros((CELLS, CELLS, 4))
    poses[..., 0], poses[..., 1], poses[..., 3] = x[None, :], x[:, None], -0.55
    return poses


def main() -> None:
    """Run everything."""
    kernels.compiled()
    loaded = replace(
        APPENDIX_4,
        payload=Payload(mass=3.0),
        counterweights=(Counterweight("b8", 9, 0.15, 2.0), Counterweight("b4", 9, 0.1, 1.0)),
    )
    whole = workspace_field(APPENDIX_4.geometry, 0.0, -0.55, CELLS).grid.poses()
    maps: list[tuple[str, Design, Array]] = [
        ("whole workspace", APPENDIX_4, whole),
        ("within 50 mm", APPENDIX_4, map_poses(0.05)),
        ("within 260 mm, a quarter of it overlaps", APPENDIX_4, map_poses(0.26)),
        ("whole, payload and six counterweights", loaded, whole),
    ]
    reference = best(lambda: platform_stiffness(APPENDIX_4, whole))
    rows = []
    for name, design, poses in maps:
        time = best(lambda design=design, poses=poses: clearance(design, poses))
        rows.append(
            [name, number(1e3 * time), number(1e6 * time / CELLS**2), number(time / reference)]
        )
    time = best(lambda: group_clearance(APPENDIX_4, whole))
    rows.append(
        ["whole, all groups of pairs", number(1e3 * time), number(1e6 * time / CELLS**2),
         number(time / reference)]
    )  # fmt: skip
    heading(f"maps of {CELLS}x{CELLS} cells on one core")
    table(["map", "ms", "µs a pose", "times a map of stiffness"], rows)
    pose = np.array([0.05, 0.02, 0.3, -0.5])
    one = best(lambda: nearest_points(APPENDIX_4, pose))
    g = APPENDIX_4.geometry
    made = best(lambda: build_shapes(g, 3.0, loaded.counterweights))
    print(f"nearest points of one pose: {number(1e3 * one)} ms")
    print(f"shapes of a new design: {number(1e3 * made)} ms")
    shapes = shapes_of(APPENDIX_4)
    count = len(shapes.arrays.kind)
    print(f"{len(shapes.bodies)} bodies of {count} solids, {len(shapes.pairs)} pairs checked")


if __name__ == "__main__":
    main()
