"""The room of counterweights: no pose needs more, and it is not much more than poses need."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    KneeBranch,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.leg_points import CounterweightClearance, counterweight_clearance
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.model.reach import Limit
from tests.support.cases import BOTH
from tests.support.samples import random_design, with_knee

ENDS = [(bar, end) for bar, ends in BAR_ENDS.items() for end in ends]


def met(
    design: Design, weight: Counterweight, rng: np.random.Generator, n: int
) -> CounterweightClearance | None:
    """Return the same of random poses, from the joints' positions; None if none is reached."""
    g, sign = design.geometry, design.geometry.knee.sign
    turn = singular_rotation(g)
    theta = rng.uniform(-turn, turn, n)
    away = singular_radius(g, theta) * np.sqrt(rng.uniform(size=n))
    angle = rng.uniform(0, 2 * np.pi, n)
    depth = rng.uniform(0, g.crank_length + g.coupler_length, n)
    height = -sign * depth - g.platform_joint_height
    pose = np.stack([away * np.cos(angle), away * np.sin(angle), theta, height], axis=-1)
    configuration = inverse_kinematics(g, pose)
    good = configuration.reach.status == Limit.OK
    if not good.any():
        return None
    near, far, axis, five = (
        configuration.points[joint][good] for joint in (weight.joint, weight.other, 3, 5)
    )
    along = (near - far) / np.linalg.norm(near - far, axis=-1, keepdims=True)
    point = near + weight.beyond * along
    toward = (five - axis)[..., :2]
    rho = np.linalg.norm(toward, axis=-1)
    r = ((point - axis)[..., :2] * toward).sum(axis=-1) / rho
    z = point[..., 2]
    # By the time it comes to the robot's axis it has come near: 5 mm in so many random poses.
    meets = np.linalg.norm(point[..., :2], axis=-1) <= 0.005
    meets |= (sign * (z - five[..., 2]) <= 0) & (r >= rho)
    deep = np.where(meets, depth[good][:, None], 0.0)
    return CounterweightClearance(r.max(), -r.min(), z.min(), z.max(), deep.max())


@given(
    st.integers(0, 10**6),
    st.sampled_from(ENDS),
    st.floats(-0.3, 0.3),
    st.sampled_from(list(KneeBranch)),
)
def test_no_random_pose_needs_more(seed, end, beyond, knee) -> None:
    rng = np.random.default_rng(seed)
    design, weight = random_design(rng), Counterweight(end[0], end[1], beyond, 1.0)
    found = met(with_knee(design, knee), weight, rng, 6_000)
    if found is None:
        return
    room = counterweight_clearance(with_knee(design.geometry, knee), weight)
    assert room is not None
    assert room.inward >= found.inward
    assert room.outward >= found.outward
    assert room.low <= found.low
    assert room.high >= found.high
    nearly = counterweight_clearance(with_knee(design.geometry, knee), weight, 0.005)
    assert nearly is not None
    assert nearly.clear_depth >= found.clear_depth


@BOTH
def test_the_robot_of_appendix_4_comes_close_to_it(knee) -> None:
    weight = Counterweight("b3", 7, 0.2, 1.0)
    found = met(with_knee(APPENDIX_4, knee), weight, np.random.default_rng(1), 50_000)
    room = counterweight_clearance(with_knee(APPENDIX_4.geometry, knee), weight)
    assert found is not None
    assert room is not None
    for name in ("inward", "outward", "low", "high", "clear_depth"):
        assert getattr(room, name) == pytest.approx(getattr(found, name), abs=0.04), name


@BOTH
def test_a_platform_as_large_as_the_base_has_a_room(knee) -> None:
    wide = replace(with_knee(APPENDIX_4, knee).geometry, platform_radius=0.36)
    room = counterweight_clearance(wide, Counterweight("b3", 7, 0.2, 1.0))
    assert room is not None
    assert np.isfinite([room.inward, room.outward, room.low, room.high]).all()


def test_a_disc_needs_its_radius_more() -> None:
    weight = Counterweight("b8", 8, 0.2, 1.0)
    point = counterweight_clearance(APPENDIX_4.geometry, weight)
    disc = counterweight_clearance(APPENDIX_4.geometry, weight, 0.05)
    assert point is not None
    assert disc is not None
    assert disc.inward == pytest.approx(point.inward + 0.05)
    assert disc.outward == pytest.approx(point.outward + 0.05)
    assert disc.high - disc.low == pytest.approx(point.high - point.low + 0.1)
    assert disc.clear_depth >= point.clear_depth


def test_a_robot_that_reaches_nothing_has_no_room() -> None:
    short = replace(APPENDIX_4.geometry, crank_length=0.01, coupler_length=0.9)
    weight = Counterweight("b8", 8, 0.2, 1.0)
    assert counterweight_clearance(replace(short, axis_clearance=0.7), weight) is None


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_the_knee_of_the_other_branch_needs_no_room(knee: KneeBranch) -> None:
    """Bars B4 and B7 lean the other way there, by decimeters; random poses come within some cm."""
    design, rng = with_knee(APPENDIX_4, knee), np.random.default_rng(3)
    for bar, joint in (("b4", 9), ("b7", 8)):
        weight = Counterweight(bar, joint, 0.15, 2.0)
        found = met(design, weight, rng, 40_000)
        room = counterweight_clearance(design.geometry, weight)
        assert found is not None
        assert room is not None
        assert found.inward < room.inward < found.inward + 0.1
        assert found.outward < room.outward < found.outward + 0.05
