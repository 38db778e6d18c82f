"""The least margin and whose it is, and the twist that no actuator feels, by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from paminsa_viz.model import (
    APPENDIX_4,
    Limit,
    check_reach,
    escape_twist,
    inverse_jacobian,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.measures import least_margin, leg_margins, serial_margin
from paminsa_viz.model.resizing import radius_ratio
from paminsa_viz.model.robot import AXIS_X, AXIS_Y
from paminsa_viz.model.singularity import NEAR_LOCUS
from tests.support.cases import Case, cases
from tests.support.samples import enlarged


@given(case=cases())
def test_the_least_margin_is_that_of_the_leg_and_limit_it_names(case: Case) -> None:
    rng = np.random.default_rng(case.seed)
    g, m = case.geometry, mechanism(case.geometry)
    size = g.base_radius * rng.uniform(0.1, 3.0)
    x, y, z = rng.uniform(-size, size, (3, 40))
    theta = rng.uniform(-np.pi, np.pi, 40)
    legs = [
        leg_margins(m, np.cos(angle), np.sin(angle), x, y, np.cos(theta), np.sin(theta), z)
        for angle in AXIS_ANGLES
    ]
    every = np.array([margin for leg in legs for margin in leg])
    found = least_margin(m, x, y, np.cos(theta), np.sin(theta), z)
    np.testing.assert_allclose(found.margin, every.min(axis=0), atol=1e-12)
    which = np.asarray(found.which)
    assert set(np.unique(which)) <= set(range(12))
    at = every[which.astype(int), np.arange(40)]
    np.testing.assert_allclose(at, every.min(axis=0), atol=1e-12)
    # without the ends of the guides
    serial = serial_margin(m, x, y, np.cos(theta), np.sin(theta), z)[0]
    kept = [i for i in range(12) if i % 4 != 2]
    np.testing.assert_allclose(serial, every[kept].min(axis=0), atol=1e-12)


def test_every_leg_and_limit_is_named_by_its_own_number() -> None:
    rng = np.random.default_rng(0)
    m = mechanism(APPENDIX_4.geometry)
    theta = rng.uniform(-3, 3, 4000)
    x, y = rng.uniform(-0.6, 0.6, (2, 4000))
    z = rng.uniform(-1.2, 0.1, 4000)
    found = least_margin(m, x, y, np.cos(theta), np.sin(theta), z)
    seen = {int(which) for which in np.unique(np.asarray(found.which))}
    status = check_reach(APPENDIX_4.geometry, np.stack([x, y, theta, z], axis=1))
    broken = np.asarray(found.margin) < 0
    kinds = np.array([Limit.STRETCHED, Limit.FOLDED, Limit.GUIDE, Limit.AXIS])
    which = np.asarray(found.which).astype(int)
    np.testing.assert_array_equal(status.leg[broken], which[broken] // 4)
    np.testing.assert_array_equal(status.status[broken], kinds[which[broken] % 4])
    assert {one // 4 for one in seen} == {0, 1, 2}


def test_of_margins_that_are_as_small_the_first_is_named() -> None:
    """Legs 1 and 2 are mirror images in x = 0; what is no number at first stays."""
    m = mechanism(APPENDIX_4.geometry)
    far = m._replace(stroke=9.0, clearance=-9.0)  # neither guide nor axis is near
    for robot, y, z, which in (
        (m, 0.05, -0.95, 0.0), (far, -0.05, -0.03, 1.0),
        (m._replace(clearance=-9.0), 0.1, -0.4, 2.0), (m._replace(stroke=9.0), -0.125, -0.5, 3.0),
    ):  # fmt: skip
        one, two = (
            leg_margins(robot, AXIS_X[leg], AXIS_Y[leg], 0.0, y, 1.0, 0.0, z) for leg in (0, 1)
        )
        assert one == two
        found = least_margin(robot, 0.0, y, 1.0, 0.0, z)
        assert (found.margin, found.which) == (min(one), which)
    assert least_margin(m, np.nan, 0.0, 1.0, 0.0, -0.5).which == 0.0


@given(case=cases())
def test_no_actuator_feels_the_escape_twist(case: Case) -> None:
    """On the circle of positions and at the singular heading; away from both there is none."""
    g, rng = case.geometry, np.random.default_rng(case.seed)
    angle, theta = rng.uniform(0, 2 * np.pi, 20), rng.uniform(-2.5, 2.5, 20)
    radius = singular_radius(g, theta)
    pose = np.stack([radius * np.cos(angle), radius * np.sin(angle), theta, 0 * theta], axis=1)
    turn = singular_rotation(g)
    if np.isfinite(turn):
        pose[::2, :2] *= rng.uniform(0.1, 0.9, (10, 1))
        pose[::2, 2] = turn * rng.choice([-1.0, 1.0], 10)
    rows, twist = inverse_jacobian(g, pose), escape_twist(g, pose)
    assert (twist[:, 2] == 1.0).all()
    assert (twist[:, 3] == 0.0).all()
    felt = np.einsum("nij,nj->ni", rows, twist)
    assert np.abs(felt).max() < 1e-10 * np.abs(rows).max() * np.abs(twist).max()
    limit = NEAR_LOCUS * radius_ratio(g)
    for off, there in ((0.5 * limit, True), (2.0 * limit, False)):
        moved = pose[1::2].copy()
        moved[:, :2] *= 1.0 + off / radius[1::2, None]
        near = np.abs(g.platform_radius * (turn - np.abs(moved[:, 2]))) <= 2.0 * limit
        known = np.isfinite(escape_twist(g, moved)).all(axis=1)
        assert (known | near == there | near).all()
    assert np.isnan(escape_twist(g, [0.0, 0.0, 0.3 * (turn if np.isfinite(turn) else 1), 0])).all()


def test_a_turn_counts_as_the_path_of_the_joints_on_the_platform() -> None:
    """Of which one of a micrometer is near, of a robot of other size in proportion."""
    for times in (1.0, 0.01, 10.0):
        g = enlarged(APPENDIX_4, times).geometry
        turn, size = singular_rotation(g), times * 1e-6 / g.platform_radius
        for share, there in ((0.95, True), (1.05, False)):
            for sign in (-1.0, 1.0):
                heading = sign * (turn - share * size)
                found = escape_twist(g, [0.01 * times, 0.02 * times, heading, -0.5 * times])
                assert np.isfinite(found).all() == there
    with pytest.raises(ValueError, match="pose"):
        escape_twist(g, [0.0, 0.0, 0.0])
