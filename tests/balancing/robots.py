"""What the tests of balancing share: a workspace, a motion, changes, and random choices of them."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from paminsa_viz.balancing import Changes, MassRange, along, beyond
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Field,
    Grid,
    lumped_matrix,
    mass_vector,
    solve_field,
)
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.trajectory import PRESET, SolvedTrajectory, Trajectory, solve_trajectory
from tests import oracle

PATHS = tuple(f"joints.j{i}" for i in (3, 4, 7, 9)) + tuple(f"links.b{i}" for i in (3, 4, 7, 8))


def workspace(sign: float = 1.0) -> Grid:
    """Poses below (or with -1 above) the guides, away from the singularities."""
    return Grid.over(
        (0.0, 0.0, 0.0, -0.5 * sign),
        x=np.linspace(-0.1, 0.1, 9),
        y=np.linspace(-0.1, 0.1, 9),
        theta=np.linspace(-0.5, 0.5, 5),
        z=np.linspace(-0.6, -0.4, 3) * sign,
    )


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
    """Masses of the pantograph within a share of themselves, and counterweights on four rails."""
    d = APPENDIX_4
    masses = tuple(
        MassRange(p, (1 - share) * d.value(p), (1 + share) * d.value(p), inertia_follows=i % 2 == 0)
        for i, p in enumerate(PATHS)
    )
    rails = (
        beyond("b8", 8, 0.2, 4.0), beyond("b3", 7, 0.2, 4.0),
        along(d.geometry, "b3", 2.0), along(d.geometry, "b7", 2.0),
    )  # fmt: skip
    return Changes(masses, rails)


def random_choices(
    rng: np.random.Generator, what: Changes, count: int, *, ends: bool = True
) -> tuple[Any, Any]:
    """Lumped coefficients (18, count) and robot masses (count,) of random feasible designs.

    Worked out here from the numbers of Appendix 4 and from where a point of a bar is at two
    configurations, not from the program's own columns. Many choices lie at the ends of bounds,
    where optima are.
    """
    d = APPENDIX_4
    values = np.repeat(mass_vector(d)[:, None], count, axis=1)

    def draw(low: float, high: float) -> Any:
        share = rng.uniform(size=count)
        snap = rng.uniform(size=count) < 0.5
        return low + (high - low) * np.where(snap & ends, np.round(share), share)

    for mass in what.masses:
        index = MASS_PATHS.index(mass.path)
        chosen = draw(mass.low, mass.high)
        if mass.inertia_follows and mass.path.startswith("links."):
            name = mass.path.removeprefix("links.")
            for i, path in enumerate(MASS_PATHS):
                if path.startswith(f"inertias.{name}_"):
                    values[i] *= chosen / values[index]
        values[index] = chosen
    c = lumped_matrix(d.geometry, d.gravity) @ values
    kilos = [p.startswith(("joints.", "links.")) for p in MASS_PATHS]
    total = 3 * values[kilos].sum(axis=0) + d.platform.mass + d.payload.mass
    for rail in what.counterweights:
        weight, place = draw(rail.low, rail.high), draw(rail.nearest, rail.farthest)
        r5, r9, z5 = point_factors(d, rail.bar, rail.joint, place)
        c[0] += weight * d.gravity * z5
        c[1] += weight * d.gravity * r9
        for row, extra in (
            (3, r5**2 / 2),
            (4, z5**2 / 2),
            (5, r9**2 / 2),
            (6, r5 * r9),
            (7, z5 * r9),
        ):
            c[row] += weight * extra
        total += 3 * weight
    return c, total


def point_factors(design: Design, bar: str, joint: int, beyond: Any) -> tuple[Any, Any, Any]:
    """How a point of a bar follows joints 5 and 9, from its place in two random configurations."""
    other = {"b3": {4: 7, 7: 4}, "b4": {9: 5, 5: 9}, "b7": {8: 7, 7: 8}, "b8": {8: 9, 9: 8}}[bar]
    rows, right, rows_z, right_z = [], [], [], []
    for pose in ((0.03, 0.02, 0.2, -0.45), (-0.06, 0.05, -0.3, -0.6)):
        leg = oracle.leg(design, tuple(map(np.asarray, pose)), 2)
        axis = np.array([*np.array(leg.points[3], float)[:2], 0.0])
        p = {i: np.array(v, float) - axis for i, v in leg.points.items()}
        h = np.array(leg.heading, float)
        outward = (p[joint] - p[other[joint]]) / np.linalg.norm(p[joint] - p[other[joint]])
        place = p[joint][:, None] + outward[:, None] * np.atleast_1d(beyond)
        rows.append([p[5] @ h, p[9] @ h])
        right.append(h @ place)
        rows_z.append([p[5][2], p[9][2]])
        right_z.append(place[2])
    r5, r9 = np.linalg.solve(rows, right)
    z5, same = np.linalg.solve(rows_z, right_z)
    np.testing.assert_allclose(same, r9, rtol=0, atol=1e-11)
    return r5, r9, z5
