"""Speed of the volume where requirements hold, next to the same poses one by one.

Run: ``python -m benchmarks.volume_speed``.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.model import APPENDIX_4, backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.conflict import smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
from paminsa_viz.synthesis.volume.surface import volume_surface

TEXTS = ("condition <= 10", "max_torque <= 15 N m", "f_4 <= 450 N")
TURN = math.radians(30.0)


def every_pose(volume: Volume) -> Array:
    """Return where all hold, from the quantities of every pose of the grid."""
    theta = np.linspace(-TURN, TURN, volume.headings)
    found = np.ones(volume.cause.shape, np.bool_)
    for i, x in enumerate(volume.x):
        grid = Grid.over((x, 0.0, 0.0, 0.0), theta=theta, y=volume.y, z=volume.z)
        field = solve_field(APPENDIX_4.geometry, grid)
        for bound in volume.requirements.bounds:
            with np.errstate(invalid="ignore"):
                margin = bound.margin(bound.entry.over(field, APPENDIX_4))
                found[i] &= (margin >= 0.0).all(axis=0)
    return found


def main() -> None:
    """Run everything."""
    backend.compile_now()
    requirements = Requirements(tuple(map(parse_requirement, TEXTS)), (-TURN, TURN))
    cylinder = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4))
    placed = Requirements(requirements.bounds, requirements.theta, cylinder)
    fine = solve_volume(APPENDIX_4, requirements)
    poses = fine.cause.size * fine.headings
    reached = int(fine.reachable.sum()) * fine.headings
    rows = []

    def row(what: str, seconds: float, whole: float) -> None:
        rows.append([what, number(1e3 * seconds), f"{whole / seconds:.3g}"])

    whole = best(lambda: every_pose(fine))
    row("every pose by its own", whole, whole)
    row("volume, fine", best(lambda: solve_volume(APPENDIX_4, requirements)), whole)
    coarse = best(lambda: solve_volume(APPENDIX_4, requirements, resolution=COARSE))
    row("volume, coarse", coarse, whole)
    row("check of a cylinder, coarse", best(lambda: check_requirements(APPENDIX_4, placed)), whole)
    row("surface of 20,000 faces", best(lambda: volume_surface(fine)), whole)
    row("smallest conflict", best(lambda: smallest_conflict(fine)), whole)
    heading(f"{len(TEXTS)} requirements over {FINE.headings} headings")
    print(f"{poses / 1e6:.1f} million poses on the grid, {reached / 1e6:.1f} of them in reach\n")
    table(["what", "ms", "times as fast as every pose"], rows)


if __name__ == "__main__":
    main()
