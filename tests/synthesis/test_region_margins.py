"""Margins over a whole region: no pose has a smaller one, and some pose has it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, Design, Geometry, check_reach, singular_radius
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.quantities.requirements import Requirement, WorkspaceShape
from paminsa_viz.synthesis.proof.evidence import Evidence, Method, Verdict
from paminsa_viz.synthesis.proof.regions import (
    PoseRegion,
    RegionMargins,
    freedom,
    from_unit,
    lowest,
    region_margins,
)
from tests.synthesis.certificate_robots import random_poses, robots

LENGTHS = st.floats(0.0, 0.3)
PLACES = st.floats(-0.4, 0.4)


@st.composite
def regions(draw: st.DrawFn) -> PoseRegion:
    shape = draw(st.sampled_from(WorkspaceShape))
    a, b, c = draw(LENGTHS), draw(LENGTHS), draw(LENGTHS)
    start, width = draw(st.floats(-4.0, 4.0)), draw(st.floats(0.0, 7.0))
    center = (draw(PLACES), draw(PLACES), draw(st.floats(-1.0, 0.5)))
    half = (a, a if shape is WorkspaceShape.CYLINDER else b, c)
    return PoseRegion(shape, center, half, (start, start + width))


def edge_poses(region: PoseRegion, n: int, seed: int) -> Any:
    """Random poses with more of them on the faces, edges and corners."""
    rng = np.random.default_rng(seed)
    unit = np.clip(rng.uniform(-2.0, 2.0, (n, 4)), -1, 1)
    if region.shape is WorkspaceShape.CYLINDER:
        angle = rng.uniform(0, 2 * np.pi, n)
        unit[:, :2] = np.column_stack([np.cos(angle), np.sin(angle)]) * rng.choice(
            [1, 0.5, 0], (n, 1)
        )
    return from_unit(region, unit)


@given(design=robots(), region=regions(), seed=st.integers(0, 999))
def test_no_pose_has_a_smaller_margin(design: Design, region: PoseRegion, seed: int) -> None:
    margins = region_margins(design.geometry, region)
    poses = edge_poses(region, 3000, seed)
    assert (check_reach(design.geometry, poses).margins >= margins.reach - 1e-15).all()
    _, singular = freedom(design.geometry, poses)
    assert singular.min() >= min(margins.circle, margins.turn)


@pytest.mark.slow
@settings(max_examples=8)
@given(region=regions(), swap=st.booleans())
def test_some_pose_has_the_least_and_the_largest_distance(region: PoseRegion, swap: bool) -> None:
    g = Geometry(crank_length=0.9, coupler_length=1.1)
    if swap:
        g = Geometry(crank_length=0.9, coupler_length=1.1, base_radius=0.1, platform_radius=0.35)
    low, high = region.leg_distances(g)
    for leg in range(3):

        def distance(poses: Any, leg: int = leg) -> Any:
            # X_1 from the margin of joint 5 to its leg axis
            return check_reach(g, poses).margins[:, leg, 3]

        assert abs(lowest(distance, region)[1] - low[leg]) < 2e-4
        assert abs(-lowest(lambda p, d=distance: -d(p), region)[1] - high[leg]) < 2e-4


@pytest.mark.parametrize("leg", range(3))
@pytest.mark.parametrize(
    "side", [(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 0), (0, 1), (-1, 0), (0, -1)]
)
@pytest.mark.parametrize("gap", [0.05, -0.03])
def test_least_distance_toward_each_corner_and_side(
    leg: int, side: tuple[int, int], gap: float
) -> None:
    # As theta turns fully, P runs on a circle about the leg axis. A box outside of it, or one
    # within, has its nearest corner or side at a known distance from the circle.
    g = APPENDIX_4.geometry
    toward = np.array(side, float)
    unit = toward / np.hypot(*toward)
    nearest = g.base_radius * LEG_AXES[leg] + (g.platform_radius + gap) * unit
    half = np.array([0.004, 0.007])  # no square, whose far corner is in the same direction
    x, y = nearest + half * toward * np.sign(gap)
    region = PoseRegion(WorkspaceShape.BOX, (x, y, -0.6), (*half, 0.1), (0.0, 2 * np.pi))
    low, _ = region.leg_distances(g)
    expected = abs(gap)
    if gap < 0 and 0 in side:  # the ends of a side are nearer to a circle around it
        across = half[side.index(0)]
        expected = g.platform_radius - np.hypot(g.platform_radius + gap, across)
    assert low[leg] == pytest.approx(expected, abs=1e-12)


@given(region=regions())
def test_random_poses_are_in_the_region(region: PoseRegion) -> None:
    poses = random_poses(region, 500, np.random.default_rng(3))
    away = np.abs(poses[:, [0, 1, 3]] - region.center)
    assert (away <= np.array(region.half) + 1e-12).all()
    if region.shape is WorkspaceShape.CYLINDER:
        assert (np.hypot(away[:, 0], away[:, 1]) <= region.half[0] + 1e-12).all()
    assert (poses[:, 2] >= region.theta[0] - 1e-12).all()
    assert (poses[:, 2] <= region.theta[1] + 1e-12).all()


def test_the_singular_circle_bounds_a_centered_disc_exactly() -> None:
    g = APPENDIX_4.geometry
    for theta in (0.0, 0.4, 1.0):
        radius = float(singular_radius(g, theta))
        for factor, holds in ((0.999999, True), (1.000001, False)):
            half = (radius * factor, radius * factor, 0.0)
            region = PoseRegion(WorkspaceShape.CYLINDER, (0, 0, -0.5), half, (theta, theta))
            assert (region_margins(g, region).circle > 0) is holds


def test_a_turn_past_the_singular_rotation_is_found() -> None:
    # R_pl/R_b = 0.1/0.35: cos theta is that at 73.4 degrees
    g = APPENDIX_4.geometry
    for degrees, holds in ((73.3, True), (73.5, False), (300.0, False)):
        region = PoseRegion(
            WorkspaceShape.BOX, (0, 0, -0.6), (0.01, 0.01, 0.01), (0.0, np.radians(degrees))
        )
        assert (region_margins(g, region).turn > 0) is holds


def test_a_region_holds_above_every_limit_and_within_the_singularities() -> None:
    reach = np.array([[0.5, 0.4, 0.3, 0.2], [0.6, 0.11, 0.3, 0.4], [0.5, 0.4, 0.1, 0.2]])
    found = RegionMargins(reach, 0.2, 0.3)
    assert found.least_reach == 0.1
    assert found.holds()
    for place in np.ndindex(reach.shape):
        for value in (0.0, -0.5):
            short = reach.copy()
            short[place] = value
            assert not RegionMargins(short, 0.2, 0.3).holds()
    for circle, turn in ((0.0, 0.3), (0.2, 0.0), (-0.1, 0.3), (0.2, -0.1)):
        assert not RegionMargins(reach, circle, turn).holds()


def test_what_is_known_of_a_requirement_has_the_bound_that_its_margin_stands_for() -> None:
    upper, lower = Requirement("condition", high=5.0), Requirement("clearance", low=0.002)
    pose = np.array([0.1, 0.2, 0.3, -0.5])
    found = Evidence.of(upper, Method.CLOSED_FORM, Verdict.PROVEN, 0.5, pose, 7)
    assert (found.key, found.bound, found.boxes) == (upper, 4.5, 7)
    assert found.pose == tuple(pose)
    found = Evidence.of(lower, Method.CLOSED_FORM, Verdict.REFUTED, -0.005)
    assert (found.bound, found.pose) == (pytest.approx(-0.003), None)
    both = Evidence.of(
        Requirement("f_4", low=1.0, high=2.0), Method.CLOSED_FORM, Verdict.PROVEN, 0.1
    )
    assert np.isnan(both.bound)
    zero = Evidence.of(Requirement("f_4", high=0.0), Method.SAMPLED, Verdict.SAMPLED, 0.5)
    assert zero.bound == -0.5
    plain = Evidence("singularity", Method.CLOSED_FORM, Verdict.PROVEN, 0.3)
    assert (plain.key, plain.bound) == ("singularity", 0.3)
