"""Trajectories from someone else's samples: rates from splines, and what the notes say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import from_samples, point_to_point, via_points
from tests.trajectory.plans import A, B, C

EXACT = point_to_point(A, B, 1.2).sample(400)


def test_rates_of_smooth_samples_are_recovered() -> None:
    made = from_samples(EXACT.t, EXACT.pose)
    np.testing.assert_allclose(made.velocity, EXACT.velocity, atol=1e-9)
    np.testing.assert_allclose(made.acceleration, EXACT.acceleration, atol=1e-7)
    assert made.notes == ("Velocity and acceleration are those of a spline of degree 5.",)
    half = from_samples(EXACT.t, EXACT.pose, EXACT.velocity)
    np.testing.assert_allclose(half.acceleration, EXACT.acceleration, atol=1e-9)
    whole = from_samples(EXACT.t, EXACT.pose, EXACT.velocity, EXACT.acceleration)
    np.testing.assert_array_equal(whole.acceleration, EXACT.acceleration)
    assert whole.notes == ()


def test_few_waypoints_at_rest_make_the_planners_motion() -> None:
    times = np.array([0.0, 0.7, 2.0])
    made = from_samples(times, [A, C, B], rest=True)
    plan = via_points([A, C, B], times=times)
    for found, exact in zip(made.at(np.linspace(0, 2, 30)), plan.at(np.linspace(0, 2, 30)),
                            strict=True):  # fmt: skip
        np.testing.assert_allclose(found, exact, atol=1e-9)


@pytest.mark.parametrize("count", range(2, 8))
def test_any_number_of_samples(count: int) -> None:
    """A polynomial of the degree that the samples can carry comes back."""
    degree = {2: 1, 3: 2, 4: 3, 5: 3}.get(count, 5)
    t = np.linspace(0, 1, count) ** 1.3
    pose = (t**degree)[:, None] * [1.0, 2.0, 0.1, -1.0]
    made = from_samples(t, pose)
    rate = degree * (t ** max(degree - 1, 0))[:, None] * [1.0, 2.0, 0.1, -1.0]
    np.testing.assert_allclose(made.velocity, rate, atol=1e-9)


def test_times_start_at_zero_and_turns_are_unwrapped() -> None:
    turning = EXACT.pose.copy()
    turning[:, 2] = 6.0 * EXACT.t
    wrapped = turning.copy()
    wrapped[:, 2] = np.mod(turning[:, 2] + np.pi, 2 * np.pi) - np.pi
    made = from_samples(EXACT.t + 3.5, wrapped)
    assert made.t[0] == 0.0
    np.testing.assert_allclose(made.t, EXACT.t, atol=1e-12)
    np.testing.assert_allclose(made.pose[:, 2], turning[:, 2], atol=1e-12)
    assert "shifted by -3.5 s" in made.notes[0]
    assert "full turn" in made.notes[1]


def test_coarse_digits_are_noted() -> None:
    notes = from_samples(EXACT.t, np.round(EXACT.pose, 4)).notes
    assert any("steps of 0.0001" in note for note in notes)
    assert not any("steps of" in note for note in from_samples(EXACT.t, EXACT.pose).notes)


@pytest.mark.parametrize(
    ("velocity", "acceleration", "word"),
    [
        (180 / np.pi, 1.0, "velocity of theta"),
        (1.0, 180 / np.pi, "acceleration of theta"),
    ],
)
def test_rates_in_another_unit_are_noted(velocity, acceleration, word) -> None:
    scale = np.array([1.0, 1.0, velocity, 1.0])
    growth = np.array([1.0, 1.0, acceleration, 1.0])
    made = from_samples(
        EXACT.t, EXACT.pose, EXACT.velocity * scale, EXACT.acceleration * growth * scale
    )
    assert word in made.notes[0]


def test_constant_coordinate_gives_no_note_on_digits() -> None:
    level = EXACT.pose * [1.0, 0.0, 1.0, 1.0]
    assert not any("steps of" in note for note in from_samples(EXACT.t, level).notes)


EXTREMES = st.sampled_from([5e-324, 1e-310, 1e-9, 1e-3, 0.1, 1.0, 1e8, 1e12, 1e16, 1e160, 1e308])
SIGNED = st.builds(float.__mul__, EXTREMES, st.sampled_from([-1.0, 1.0]))


@given(
    times=st.lists(SIGNED, min_size=2, max_size=9, unique=True).map(sorted),
    scale=EXTREMES,
    given_rates=st.integers(0, 2),
    rest=st.booleans(),
)
def test_extreme_numbers_are_rejected_or_stay_finite(times, scale, given_rates, rest) -> None:
    """Warnings are errors here, so that an overflow fails the test."""
    rows = np.sin(np.arange(4.0 * len(times)).reshape(-1, 4)) * scale
    rates = [rows] * given_rates
    try:
        made = from_samples(times, rows, *rates, rest=rest)
    except InvalidInput:
        return
    middle = made.at((made.t[1:] + made.t[:-1]) / 2)
    assert all(np.isfinite(values).all() for values in (*middle, made.velocity))


def test_bad_samples_are_rejected() -> None:
    with pytest.raises(InvalidInput, match="together with the velocity"):
        from_samples(EXACT.t, EXACT.pose, None, EXACT.acceleration)
    with pytest.raises(InvalidInput, match="increase"):
        from_samples(EXACT.t[::-1], EXACT.pose)
    with pytest.raises(InvalidInput, match="pose"):
        from_samples(EXACT.t, EXACT.pose[:-1])
