"""What the tests of balancing share: a workspace, a motion, changes, and random designs of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from paminsa_viz.balancing import (
    LIFT,
    AddedMass,
    Changes,
    MassRange,
    StaticLift,
    StaticPeak,
    StaticRms,
    Term,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
    along,
    beyond,
    whole_mass,
)
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    Field,
    Grid,
    solve_field,
    static_torques,
)
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.trajectory import PRESET, SolvedTrajectory, Trajectory, analyze, solve_trajectory

PATHS = tuple(f"joints.j{i}" for i in (3, 4, 7, 9)) + tuple(f"links.b{i}" for i in (3, 4, 7, 8))


def workspace(sign: float = 1.0) -> Grid:
    """Poses below (or with -1 above) the guides, away from the singularities."""
    side = np.linspace(-0.1, 0.1, 9)
    z = np.linspace(-0.6, -0.4, 3) * sign
    return Grid.over((0, 0, 0, -0.5 * sign), x=side, y=side, theta=np.linspace(-0.5, 0.5, 5), z=z)


@cache
def field() -> Field:
    """The workspace of Appendix 4's robot."""
    return solve_field(APPENDIX_4.geometry, workspace())


@cache
def trajectory() -> Trajectory:
    """A motion of all four coordinates."""
    return PRESET["paper-like"].build(APPENDIX_4.geometry).sample(150)


@cache
def solved() -> SolvedTrajectory:
    """The motion, solved for Appendix 4's robot."""
    return solve_trajectory(APPENDIX_4.geometry, trajectory())


def changes(share: float = 0.5) -> Changes:
    """Masses of the pantograph within a share of themselves, and counterweights in four ranges."""
    d = APPENDIX_4
    masses = tuple(
        MassRange(p, (1 - share) * d.value(p), (1 + share) * d.value(p), inertia_follows=i % 2 == 0)
        for i, p in enumerate(PATHS)
    )
    ranges = (
        beyond("b8", 8, 0.2, 4.0), beyond("b3", 7, 0.2, 4.0),
        along(d.geometry, "b3", 2.0), along(d.geometry, "b7", 2.0),
    )  # fmt: skip
    return Changes(masses, ranges)


def terms() -> list[Term]:
    """Return one term of every kind."""
    return [
        StaticPeak(field()), StaticRms(field()), StaticLift(field()),
        TrajectoryPeak(solved()), TrajectoryRms(solved()),
        TrajectoryPeak(solved(), LIFT), TrajectoryRms(solved(), LIFT),
        TrajectoryEnergy(solved()), AddedMass(),
    ]  # fmt: skip


def measured(design: Design) -> dict[str, float]:
    """Every term of a design, from the functions that analyze designs."""
    held = static_torques(design, workspace().poses()).reshape(-1, 4)
    summary = analyze(design, trajectory(), keep=solved()).summary
    return {
        "peak static torque": float(np.abs(held[:, :3]).max()),
        "RMS static torque": float(np.sqrt(np.mean(held[:, :3] ** 2))),
        "peak static force of M4": float(np.abs(held[:, 3]).max()),
        "peak torque of M1-M3 on the trajectory": max(abs(s.peak) for s in summary[:3]),
        "RMS torque of M1-M3 on the trajectory": float(
            np.sqrt(np.mean([s.rms**2 for s in summary[:3]]))
        ),
        "peak force of M4 on the trajectory": abs(summary[3].peak),
        "RMS force of M4 on the trajectory": summary[3].rms,
        "driving energy on the trajectory": sum(s.driven for s in summary),
        "added mass": whole_mass(design) - whole_mass(APPENDIX_4),
    }


@cache
def random_measures(count: int = 400) -> dict[str, np.ndarray]:
    """Every term of random designs within `changes`, many at the ends of bounds, by label."""
    rng = np.random.default_rng(0)

    def draw(low: float, high: float) -> float:
        share = rng.uniform()
        return low + (high - low) * (round(share) if rng.uniform() < 0.5 else share)

    found = []
    for _ in range(count):
        numbers: dict[str, float | None] = {}
        for mass in changes().masses:
            chosen = numbers[mass.path] = draw(mass.low, mass.high)
            name = mass.path.removeprefix("links.")
            for path in MASS_PATHS:
                if mass.inertia_follows and path.startswith(f"inertias.{name}_"):
                    ratio = chosen / APPENDIX_4.value(mass.path)
                    numbers[path] = ratio * APPENDIX_4.value(path)
        weights = tuple(
            Counterweight(r.bar, r.joint, draw(r.nearest, r.farthest), draw(r.low, r.high))
            for r in changes().counterweights
        )
        found.append(measured(replace(APPENDIX_4.vary(numbers), counterweights=weights)))
    return {label: np.array([each[label] for each in found]) for label in found[0]}
