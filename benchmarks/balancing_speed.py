"""Speed of balancing: the paper's balance, optima with their certificates, fronts.

Run: ``python -m benchmarks.balancing_speed``.
"""

from __future__ import annotations

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.balancing import (
    AddedMass,
    Changes,
    MassRange,
    SpringPlace,
    StaticPeak,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
    along,
    at_joint,
    balance,
    beyond,
    fit_springs,
    length_tolerance,
    mass_tolerance,
    on_guide,
    optimize,
    pareto_front,
    tornado,
)
from paminsa_viz.model import APPENDIX_4, Grid, backend, solve_field
from paminsa_viz.trajectory import PRESET, Trajectory, solve_trajectory

DESIGN = APPENDIX_4


def workspace() -> Grid:
    """Return 21 x 21 x 7 x 5 poses."""
    axis = np.linspace(-0.1, 0.1, 21)
    return Grid.over(
        (0.0, 0.0, 0.0, -0.5),
        theta=np.linspace(-0.5, 0.5, 7),
        z=np.linspace(-0.6, -0.4, 5),
        y=axis,
        x=axis,
    )


def changes() -> Changes:
    """Return eight masses that may change by half, and four rails for counterweights."""
    paths = [f"joints.j{i}" for i in (3, 4, 7, 9)] + [f"links.b{i}" for i in (3, 4, 7, 8)]
    masses = [MassRange(p, 0.5 * DESIGN.value(p), 1.5 * DESIGN.value(p)) for p in paths]
    rails = (
        beyond("b8", 8, 0.2, 4.0),
        beyond("b3", 7, 0.2, 4.0),
        along(DESIGN.geometry, "b3", 2.0),
        along(DESIGN.geometry, "b7", 2.0),
    )
    return Changes(tuple(masses), rails)


def motion() -> Trajectory:
    """Return a motion of all four coordinates at 1000 samples a second."""
    return PRESET["paper-like"].build(DESIGN.geometry).sample()


def optima() -> None:
    """Time optima, with the gap that their certificates leave."""
    field, path = solve_field(DESIGN.geometry, workspace()), motion()
    solved = solve_trajectory(DESIGN.geometry, path)
    peak, static = TrajectoryPeak(solved), StaticPeak(field)
    runs = {
        "paper's balance, least added mass": lambda: balance(DESIGN),
        "the same with eight masses and four rails": lambda: balance(DESIGN, changes()),
        "peak static torque": lambda: optimize(DESIGN, changes(), static),
        "peak torque on a trajectory": lambda: optimize(DESIGN, changes(), peak),
        "RMS torque on a trajectory": lambda: optimize(DESIGN, changes(), TrajectoryRms(solved)),
        "driving energy on a trajectory": lambda: optimize(
            DESIGN, changes(), TrajectoryEnergy(solved)
        ),
        "peak + RMS + 0.1 mass, static peak below 1 N·m": lambda: optimize(
            DESIGN, changes(),
            [(1.0, peak), (1.0, TrajectoryRms(solved)), (0.1, AddedMass())],
            limits=[(static, 1.0)],
        ),
    }  # fmt: skip
    rows = []
    for name, run in runs.items():
        found = run()
        size = max(abs(found.objective), *(abs(v.before) for v in found.values))
        rows.append([name, number(1e3 * best(run)), str(found.rounds), f"{found.gap / size:.1e}"])
    heading(f"Optimal masses; {path.size} samples, {workspace().size} poses")
    table(["what", "ms", "linear programs", "relative gap"], rows)

    places = [
        SpringPlace(on_guide(0.0, 0.3), at_joint(9), 1e4, 0.0, 0.5),
        SpringPlace(on_guide(-0.2, 0.3), at_joint(7), 1e4, 0.0, 0.5),
    ]
    poses = workspace().poses()
    others = {
        "front of 12 points, dynamic against static peak": lambda: pareto_front(
            DESIGN, changes(), peak, static
        ),
        "two springs, least peak": lambda: fit_springs(DESIGN, places, poses),
        "two springs, least RMS": lambda: fit_springs(DESIGN, places, poses, measure="rms"),
        "tornado of all masses and lengths": lambda: tornado(DESIGN, workspace(), path),
        "spread from masses": lambda: mass_tolerance(DESIGN, 0.01, poses),
        "spread from lengths, 200 samples": lambda: length_tolerance(DESIGN, 0.01, poses),
    }
    heading("What goes with it")
    table(["what", "ms"], [[name, number(1e3 * best(run))] for name, run in others.items()])


def main() -> None:
    """Run everything."""
    backend.compile_now()
    optima()


if __name__ == "__main__":
    main()
