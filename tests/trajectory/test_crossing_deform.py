"""Paths that are changed along the escape twist so that they can be run."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing import balance
from paminsa_viz.model import APPENDIX_4, InvalidInput, escape_twist, inverse_dynamics, mass_matrix
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.trajectory import (
    CrossingRefused,
    MotionLimits,
    analyze,
    plan_deformed,
    straight_path,
    time_optimal,
)
from paminsa_viz.trajectory.paths import StraightPath, spline_path
from paminsa_viz.trajectory.time_optimal import DeformedPlan

pytestmark = pytest.mark.slow

BALANCED = balance(APPENDIX_4).after
TEN = MotionLimits(torque=10.0)
GRID = np.linspace(0.0, 1.0, 4001)


def _weak_path() -> StraightPath:
    """A straight path at right angles (by M) to the escape twist, where it crosses the circle."""
    radius = float(singular_radius(BALANCED.geometry, 0.3))
    pose = np.array([radius * np.cos(0.2), radius * np.sin(0.2), 0.3, -0.5])
    effort = escape_twist(BALANCED.geometry, pose) @ mass_matrix(BALANCED, pose)
    along = np.array([np.cos(0.2), np.sin(0.2), 0.0, 0.0])
    along[2] = -effort @ along / effort[2]
    return straight_path(pose - 0.08 * along, pose + 0.05 * along)


@pytest.fixture(scope="module")
def deformed() -> DeformedPlan:
    with pytest.raises(CrossingRefused) as refusal:
        time_optimal(BALANCED, _weak_path(), TEN)
    assert refusal.value.cause == "weak"
    return plan_deformed(BALANCED, _weak_path(), TEN)


def test_a_path_without_influence_can_be_run_after_a_small_change(deformed: DeformedPlan) -> None:
    found = deformed.found
    (crossing,) = found.crossings
    assert abs(crossing.condition.a) > 1e-3
    assert abs(crossing.residual) < 1e-9
    state = found.plan.at(crossing.t + np.array([-1e-7, 1e-7]))  # the torque turns within 1 ms
    torque = inverse_dynamics(BALANCED, *state).torque
    assert np.abs(torque - crossing.torque).max() < 2e-2
    analysis = analyze(BALANCED, found.plan.sample(1000.0))
    assert analysis.check.possible
    assert np.abs(analysis.torque[:, :3]).max() < 10.1


def test_the_deviation_is_that_of_the_path(deformed: DeformedPlan) -> None:
    path = _weak_path()
    off = deformed.found.path(GRID) - path(GRID)
    size = np.hypot(off[:, 0], off[:, 1]) + BALANCED.geometry.platform_radius * np.abs(off[:, 2])
    assert size.max() == pytest.approx(deformed.deviation, rel=1e-3)
    s = deformed.found.crossings[0].crossing.s
    for at in (0.0, s, 1.0):
        where = np.array([at])
        assert np.abs(deformed.found.path(where) - path(where)).max() < 1e-12
    twist = escape_twist(BALANCED.geometry, path(np.array([s])))[0]
    assert np.abs(off - off[:, 2:3] * twist).max() < 1e-12


def test_derivatives_of_a_changed_path_are_its_own(deformed: DeformedPlan) -> None:
    path, step = deformed.found.path, 1e-6
    s = np.linspace(0.01, 0.99, 400)
    for order in range(3):
        rate = (path(s + step, order) - path(s - step, order)) / (2.0 * step)
        assert np.abs(rate - path(s, order + 1)).max() < 1e-4 * np.abs(path(s, order + 1)).max()


def test_what_needs_no_change_is_not_changed_and_what_cannot_be_held_is_refused() -> None:
    turn = straight_path([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5])
    assert plan_deformed(BALANCED, turn, TEN).deviation == 0.0
    with pytest.raises(CrossingRefused) as refusal:
        plan_deformed(APPENDIX_4, straight_path([0.1, 0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5]), TEN)
    assert refusal.value.cause == "hold"
    with pytest.raises(InvalidInput, match="most"):
        plan_deformed(BALANCED, turn, TEN, most=0.0)


def test_a_path_without_a_crossing_is_refused_for_what_it_needs() -> None:
    """Its middle needs more than its ends, and there is no crossing to change it at."""
    path = spline_path([[0.0, 0.0, 0.0, -0.5], [0.12, 0.05, 0.3, -0.5], [0.01, 0.0, 0.01, -0.5]])
    with pytest.raises(CrossingRefused, match=r"at least \S+ times as large$") as refusal:
        plan_deformed(APPENDIX_4, path, MotionLimits(torque=1.0))
    assert (refusal.value.cause, refusal.value.to_raise) == ("infeasible", "torque")
