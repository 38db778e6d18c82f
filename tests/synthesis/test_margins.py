"""Margins over headings against the same quantities over a grid, for every quantity there is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.volume.margins import (
    Columns,
    heading_margins,
    headings,
    solve_columns,
    time_per_position,
)

DESIGN = replace(
    APPENDIX_4,
    load=LoadCase(force_x=5.0, force_z=-8.0, moment_z=0.4),
    payload=replace(APPENDIX_4.payload, mass=2.0),
    counterweights=(Counterweight("b3", 7, 0.2, 1.0),),
)
X, Y, Z = np.array([-0.03, 0.08]), np.array([0.05]), np.array([-0.7, -0.45])
THETA = (-0.3, 0.4)


@pytest.mark.parametrize("key", QUANTITIES)
def test_least_margin_is_that_of_all_headings(key: str) -> None:
    theta = headings(THETA, 3)
    grid = Grid.over((0.0, Y[0], 0.0, 0.0), x=X, theta=theta, z=Z)
    field = solve_field(DESIGN.geometry, grid)
    values = QUANTITIES[key].over(field, DESIGN)
    assert np.isfinite(values).any()
    bound = Requirement(key, None, 0.0)
    found = heading_margins(
        DESIGN, Requirements((bound,), THETA), np.column_stack([X, Y.repeat(2)]), Z, 3
    )
    expected = np.where(np.isnan(values), -np.inf, -values).min(axis=1)
    np.testing.assert_allclose(found.least[0], expected, rtol=1e-9, atol=1e-12)
    ends = np.where(np.isnan(values), -np.inf, -values)[:, ::2].min(axis=1)
    np.testing.assert_allclose(found.coarse[0], ends, rtol=1e-9, atol=1e-12)


def test_columns_have_positions_of_their_own() -> None:
    positions = np.array([[0.0, 0.0], [0.1, -0.05], [0.02, 0.03]])
    columns = Columns.at(positions, np.array([-0.2, 0.1]), Z)
    assert columns.shape == (3, 2, 2)
    poses = columns.poses()
    np.testing.assert_array_equal(poses[1, 1, 0], [0.1, -0.05, 0.1, -0.7])
    field = solve_columns(DESIGN.geometry, columns)
    for pose, gamma in zip(poses.reshape(-1, 4), field.gamma.reshape(4, -1).T, strict=True):
        alone = solve_field(DESIGN.geometry, Grid.over(pose, x=pose[:1]))
        np.testing.assert_allclose(gamma, alone.gamma[:, 0], rtol=1e-12)


def test_robots_whose_reach_no_bars_exceed_are_solved_at_every_height() -> None:
    long = replace(
        APPENDIX_4.geometry, base_radius=9.0, crank_length=9.0, coupler_length=9.0, guide_stroke=9.0
    )
    design = replace(APPENDIX_4, geometry=long)
    requirements = Requirements((Requirement("condition", None, 0.0),), (0.0, 0.0))
    found = heading_margins(design, requirements, np.zeros((1, 2)), np.array([-3.0, -50.0]), 3)
    assert np.isfinite(found.least[0, 0, 0])
    assert found.least[0, 0, 1] == -np.inf
    assert time_per_position(design, requirements, 3, 10) > time_per_position(
        APPENDIX_4, requirements, 3, 10
    )
