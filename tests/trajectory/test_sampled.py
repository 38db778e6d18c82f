"""Sampled trajectories: what is accepted, and what lies between samples."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import Trajectory, point_to_point, via_points
from tests.trajectory.plans import A, B, C

T = np.array([0.0, 0.3, 1.0])
ROWS = np.arange(12.0).reshape(3, 4) / 10


def test_between_samples_a_quintic_comes_back_exactly() -> None:
    for plan in (point_to_point(A, B, 1.5), via_points([A, C, B], 2.0)):
        t = np.linspace(0, plan.duration, 41)
        breaks = plan.curve.breaks * plan.duration
        at = np.union1d(breaks, np.linspace(0, plan.duration, 5))
        samples = Trajectory(at, *plan.at(at))
        for found, exact in zip(samples.at(t), plan.at(t), strict=True):
            np.testing.assert_allclose(found, exact, atol=1e-11)


def test_any_samples_are_met_and_joined_smoothly() -> None:
    made = Trajectory(T, ROWS, ROWS[::-1], -ROWS)
    for found, given in zip(made.at(T), (ROWS, ROWS[::-1], -ROWS), strict=True):
        np.testing.assert_allclose(found, given, atol=1e-12)
    t, h = np.array([0.1, 0.5, 0.9]), 1e-6
    state, before, after = made.at(t), made.at(t - h), made.at(t + h)
    np.testing.assert_allclose((after.pose - before.pose) / (2 * h), state.velocity, atol=1e-7)
    rate = (after.velocity - before.velocity) / (2 * h)
    np.testing.assert_allclose(rate, state.acceleration, atol=1e-6)
    left, right = made.at(0.3 - 1e-9), made.at(0.3 + 1e-9)
    np.testing.assert_allclose(left.acceleration, right.acceleration, atol=1e-6)


def test_before_and_after_it_is_the_end_state() -> None:
    made = Trajectory(T, ROWS, ROWS, ROWS)
    np.testing.assert_allclose(made.at([-1.0, 2.0]).pose, ROWS[[0, 2]])
    assert made.at(0.5).pose.shape == (4,)
    assert made.at(np.zeros((2, 3))).velocity.shape == (2, 3, 4)


def test_resampling_keeps_the_motion() -> None:
    made = point_to_point(A, B, 2.0).sample(50).resampled(333)
    exact = point_to_point(A, B, 2.0).at(made.t)
    assert made.size == 667
    np.testing.assert_allclose(made.acceleration, exact.acceleration, atol=1e-10)


def test_arrays_are_read_only_copies() -> None:
    pose = ROWS.copy()
    made = Trajectory(T, pose, ROWS, ROWS)
    pose[:] = 9.0
    np.testing.assert_array_equal(made.pose, ROWS)
    with pytest.raises(ValueError, match="read-only"):
        made.pose[0, 0] = 1.0


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("t", {"t": [0.0]}),
        ("t", {"t": [0.0, 1.0, 1.0]}),
        ("t", {"t": [0.0, 1.0, np.nan]}),
        ("t", {"t": ["a", "b", "c"]}),
        ("pose", {"pose": ROWS[:2]}),
        ("velocity", {"velocity": ROWS[:, :3]}),
        ("acceleration", {"acceleration": np.full((3, 4), np.inf)}),
    ],
)
def test_errors_name_the_argument(argument: str, change: dict) -> None:
    parts = {"t": T, "pose": ROWS, "velocity": ROWS, "acceleration": ROWS} | change
    with pytest.raises(InvalidInput) as caught:
        Trajectory(**parts)
    assert caught.value.argument == argument
