"""The paper's optimal redistribution (Eq. 8): M_p2 = 0 takes gravity off M1..M3 everywhere."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    KneeBranch,
    lift_constant,
    lumped_matrix,
    mass_vector,
    solve_field,
    static_breakdown,
    static_imbalance,
    static_torques,
    xy_grid,
)
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.quantities import QUANTITIES
from tests import oracle
from tests.support.cases import BOTH, Case, assert_within, cases
from tests.support.samples import with_knee

pytestmark = pytest.mark.slow


ADDED = st.sampled_from(["joints.j7", "links.b7"])
"""Masses on the far side of the leg axis: they have a negative share in M_p2."""


def balanced(design: Design, path: str) -> Design:
    """The design with one mass chosen so that M_p2 = 0.

    Such a mass is never negative: without it M_p2 is positive, for all other shares are, but that
    of B3 at k < 2, which is left out then.
    """
    if design.geometry.magnification < 2:
        design = design.vary({"links.b3": 0.0})
    design = design.vary({path: 0.0, ("joints.j7" if path == "links.b7" else "links.b7"): 0.0})
    share = lumped_matrix(design.geometry, design.gravity)[1, MASS_PATHS.index(path)]
    missing = static_imbalance(design)
    assert share < 0 < missing
    return design.vary({path: -missing / share})


@given(case=cases(), path=ADDED)
def test_a_balanced_robot_holds_itself_everywhere(case: Case, path: str) -> None:
    design = balanced(case.design, path)
    weight = design.gravity * mass_vector(design)[:14].sum()
    assert abs(static_imbalance(design)) < 1e-14 * weight
    pose = case.poses(32)
    torque = static_torques(design, pose)
    size = np.abs(static_torques(case.design, pose)).max() + weight
    assert_within(torque[:, :3], np.zeros((32, 3)), 1e-13 * size)
    assert_within(torque[:, 3], np.full(32, lift_constant(design)), 1e-13 * size)
    expected = oracle.static_torques(design, pose[:8])
    assert_within(expected[:, :3], np.zeros((8, 3)), 1e-11 * size)
    # every body pulls, and all of them together do not
    parts = static_breakdown(design, pose)
    assert np.abs(parts.per_leg[:, :3]).max() > 1e-3 * weight * case.geometry.crank_length * 0.1
    assert_within(parts.total[:, :3], np.zeros((32, 3)), 1e-11 * size)


@BOTH
def test_the_counterweight_of_appendix_4(knee: KneeBranch) -> None:
    """m_7 that balances: 0.28 kg + 3 * 9.10041/9.81 kg = 3.063 kg, since its share is -g/k."""
    design = APPENDIX_4.vary({"joints.j7": 0.28 + 3 * 9.10041 / 9.81})
    assert abs(static_imbalance(design)) < 1e-14
    assert design.joints.j7 == pytest.approx(3.063, abs=1e-12)
    axis = np.linspace(-0.4, 0.4, 41)
    field = solve_field(with_knee(design.geometry, knee), xy_grid(axis, axis, np.pi / 3, -0.5))
    before = QUANTITIES["max_torque"].over(field, APPENDIX_4)
    after = QUANTITIES["max_torque"].over(field, design)
    assert np.nanmedian(before) > 1.0
    assert np.nanmax(after / before) < 1e-14


def test_a_balanced_robot_is_quiet_on_the_singular_circle() -> None:
    """Zero times an unbounded map has no value there, and is no reason to warn."""
    design = APPENDIX_4.vary(
        {
            "geometry.base_radius": 0.5,
            "geometry.platform_radius": 0.25,
            **{f"joints.{j}": 0.0 for j in ("j4", "j7", "j9")},
            **{f"links.{b}": 0.0 for b in ("b3", "b4", "b7", "b8")},
        }
    )
    assert static_imbalance(design) == 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        torque = static_torques(design, [[0.25, 0.0, 0.0, -0.5], [0.1, 0.0, 0.0, -0.5]])
    assert np.isnan(torque[0, :3]).all()
    np.testing.assert_array_equal(torque[1, :3], 0.0)
    assert np.isfinite(torque[:, 3]).all()
