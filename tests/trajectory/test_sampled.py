"""Sampled trajectories: what lies between samples, and what is made of someone else's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import Trajectory, from_samples, point_to_point, via_points
from paminsa_viz.trajectory.imported import _last_digit
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
    for found, wanted in zip(made.at(T), (ROWS, ROWS[::-1], -ROWS), strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-12)
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


def test_a_motion_lasts_from_its_first_sample_to_its_last() -> None:
    made = Trajectory(T + 5.0, ROWS, ROWS, ROWS)
    assert made.duration == pytest.approx(1.0)
    again = made.resampled(10.0)
    assert (again.t[0], again.t[-1], again.size) == (5.0, 6.0, 11)


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
        ("velocity", {"velocity": np.where(np.arange(12) == 7, np.nan, 0.0).reshape(3, 4)}),
        ("load", {"load": np.zeros((3, 4))}),
        ("load", {"load": np.where(np.arange(18) == 7, np.nan, 0.0).reshape(3, 6)}),
        ("pose", {"pose": np.where(np.arange(12) == 7, -1.01e12, 0.0).reshape(3, 4)}),
        # a step of less than four units in the last place of the largest time, whatever its sign
        ("t", {"t": [0.0, 2.0**20, 2.0**20 + 3 * 2.0**-32]}),
        ("t", {"t": [-(2.0**20) - 3 * 2.0**-32, -(2.0**20), 0.0]}),
    ],
)
def test_errors_name_the_argument(argument: str, change: dict) -> None:
    parts = {"t": T, "pose": ROWS, "velocity": ROWS, "acceleration": ROWS} | change
    with pytest.raises(InvalidInput) as caught:
        Trajectory(**parts)
    assert caught.value.argument == argument


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


@pytest.mark.parametrize("rate", [6.0, -6.0])
def test_times_start_at_zero_and_turns_are_unwrapped(rate: float) -> None:
    turning = EXACT.pose.copy()
    turning[:, 2] = rate * EXACT.t
    wrapped = turning.copy()
    wrapped[:, 2] = np.mod(turning[:, 2] + np.pi, 2 * np.pi) - np.pi
    made = from_samples(EXACT.t + 3.5, wrapped)
    assert made.t[0] == 0.0
    np.testing.assert_allclose(made.t, EXACT.t, atol=1e-12)
    np.testing.assert_allclose(made.pose[:, 2], turning[:, 2], atol=1e-12)
    assert "shifted by -3.5 s" in made.notes[0]
    assert "full turn" in made.notes[1]
    high = EXACT.pose + np.array([0.0, 0.0, 0.0, 5.0])
    assert not any("full turn" in note for note in from_samples(EXACT.t, high).notes)


def test_coarse_digits_are_noted() -> None:
    notes = from_samples(EXACT.t, np.round(EXACT.pose, 4)).notes
    assert any("steps of 0.0001" in note for note in notes)
    assert not any("steps of" in note for note in from_samples(EXACT.t, EXACT.pose).notes)


@pytest.mark.parametrize("column", range(4))
@pytest.mark.parametrize(("digits", "step", "noted"), [(4, 0.044, True), (4, 0.0455, False)])
def test_digits_are_noted_with_what_second_differences_make_of_them(
    column: int, digits: int, step: float, noted: bool
) -> None:
    """Each of the three numbers may be off by half a digit: (1/2 + 1 + 1/2) digits over step^2."""
    t = step * np.arange(40)
    pose = np.outer(np.sin(3 * t), [0.1, 0.2, 0.3, 0.05])
    pose[:, 3] -= 0.5
    pose[:, column] = np.round(pose[:, column], digits)
    t[-1] += 10 * step  # one long step does not matter
    notes = [note for note in from_samples(t, pose).notes if "steps of" in note]
    assert len(notes) == noted
    if noted:
        name, unit = ("x", "y", "theta", "z")[column], "rad" if column == 2 else "m"
        noise = 2 * 10.0**-digits / step**2
        assert notes[0].startswith(f"{name} is written in steps of 0.0001 {unit};")
        assert f"wrong by {noise:.2g} {unit}/s²" in notes[0]
    assert not any("steps of" in note for note in from_samples(t[:2], pose[:2]).notes)
    few = from_samples(t[1:4], pose[1:4]).notes
    assert any("steps of" in note for note in few) == noted


@pytest.mark.parametrize("column", range(4))
@pytest.mark.parametrize("kind", ["velocity", "acceleration"])
def test_rates_that_are_not_those_of_the_samples_are_noted_from_a_twentieth_on(
    kind: str, column: int
) -> None:
    """A steady rate that is larger by q is off by q / (1 + q) of the largest value."""
    t = np.linspace(0.0, 1.0, 30)
    slope = np.array([0.1, -0.2, 0.4, 0.3])
    flat, ramp = np.tile(slope, (30, 1)), np.outer(t, slope)
    for q, share in ((0.0520, 0.0), (0.0530, 5.0), (0.25, 20.0), (-0.2, 20.0)):
        scale = np.ones(4)
        scale[column] += q
        rates = (flat * scale, 0 * flat) if kind == "velocity" else (ramp, flat * scale)
        pose = ramp if kind == "velocity" else 0.5 * t[:, None] * ramp
        notes = from_samples(t, pose, *rates).notes
        if not share:
            assert notes == ()
            continue
        (note,) = notes
        assert note.startswith(f"The {kind} of {('x', 'y', 'theta', 'z')[column]} is not the rate")
        assert f"typically off by {share:.0f} % of its largest value" in note


@pytest.mark.parametrize(
    ("velocity", "acceleration", "word"),
    [(180 / np.pi, 1.0, "velocity of theta"), (1.0, 180 / np.pi, "acceleration of theta")],
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
    for pose in (level, level - [0.3, 0.0, 0.0, 0.0]):  # also where all of x are rounded up
        assert not any("steps of" in note for note in from_samples(EXACT.t, pose).notes)


def test_digits_are_those_that_are_met_to_a_1e_12th() -> None:
    for off, step in ((0.95e-12, 0.1), (1.05e-12, 0.0)):
        for side in (off, -off):
            assert _last_digit(np.array([0.3, 0.1 + side, -0.4])) == step
    assert [_last_digit(np.array([0.3, at])) for at in (0.123456789, 0.1234567891)] == [1e-9, 0.0]


@pytest.mark.parametrize(("size", "noted"), [(0.95e-9, False), (1.05e-9, True)])
def test_rates_below_a_1e_9th_are_not_compared(size: float, noted: bool) -> None:
    t = np.linspace(0.0, 1.0, 30)
    rate = np.tile([size, 0.0, 0.0, 0.0], (30, 1))
    notes = from_samples(t, 0.5 * t[:, None] * rate, rate).notes
    assert any("typically off by 50 % of" in note for note in notes) == noted


def test_bad_samples_are_rejected() -> None:
    with pytest.raises(InvalidInput, match="together with the velocity"):
        from_samples(EXACT.t, EXACT.pose, None, EXACT.acceleration)
    with pytest.raises(InvalidInput, match="increase"):
        from_samples(EXACT.t[::-1], EXACT.pose)
    with pytest.raises(InvalidInput, match="pose"):
        from_samples(EXACT.t, EXACT.pose[:-1])


SIZES = st.floats(-330, 308).map(lambda power: 10.0**power)


@given(
    steps=st.lists(SIZES, min_size=1, max_size=8),
    start=st.just(0.0) | SIZES | SIZES.map(float.__neg__),
    size=st.just(1.0) | SIZES,
    rates=st.integers(0, 2),
    rest=st.booleans(),
)
@example(steps=[1e-310, 1e-310], start=0.0, size=1.0, rates=0, rest=False)
@example(steps=[1e16, 0.1], start=-1e16, size=1.0, rates=1, rest=False)
@example(steps=[1e308, 1e308], start=-1e308, size=1.0, rates=0, rest=True)
@example(steps=[1.0, 1.0], start=0.0, size=1e308, rates=0, rest=False)
def test_numbers_of_any_size_make_a_finite_motion_or_are_refused(
    steps, start, size, rates, rest
) -> None:
    with np.errstate(over="ignore"):
        times = np.cumsum([start, *steps])
    pose = size * np.sin(np.arange(times.size))[:, None] * [0.1, 0.2, 0.3, 0.4]
    try:
        made = from_samples(times, pose, *[pose] * rates, rest=rest)
    except InvalidInput:
        return
    between = made.at(np.linspace(0.0, made.duration, 50))
    assert all(np.isfinite(values).all() for values in (*between, *made.at(made.t)))


def test_rates_are_off_in_parts_of_the_largest_of_given_and_own() -> None:
    """x = sin t: cos t times 1/2 is off by |cos t| / 2 of 1, cos t times 2 by as much of 2."""
    t = np.linspace(0.0, 6.0, 601)
    pose = np.outer(np.sin(t), [0.1, 0.0, 0.0, 0.0])
    rate = np.outer(np.cos(t), [0.1, 0.0, 0.0, 0.0])
    typical = 50.0 * np.median(np.abs(np.cos(0.5 * (t[1:] + t[:-1]))))
    for factor in (0.5, 2.0):
        notes = from_samples(t, pose, factor * rate).notes
        assert any(f"typically off by {typical:.0f} % of" in note for note in notes)


@pytest.mark.parametrize("given", [1, 2], ids=["poses", "velocities"])
def test_rates_that_are_too_large_at_one_place_alone_blame_units(given: int) -> None:
    """Not what was made of the samples, which a person has not given."""
    t = np.linspace(0.0, 10.0, 2001)
    t[1000:] -= t[1000] - t[999] - 1e-9
    pose = np.zeros((2001, 4))
    pose[1000:, 1] = 100.0 if given == 1 else 0.0
    speeds = np.zeros((2001, 4))
    speeds[1000:, 1] = 1e4
    with pytest.raises(InvalidInput, match="check the units of t and pose") as caught:
        from_samples(t, pose, *[speeds] * (given - 1))
    assert caught.value.argument == "pose"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_rates_of_a_spline_that_are_too_large_to_either_side_blame_units(sign: float) -> None:
    """A speed without an acceleration, and an acceleration at small speeds."""
    t = np.array([0.0, 0.1, 0.2])
    for times, x in ((t[[0, 2]], [0.0, 3e11]), (t, 1e12 * t**2)):
        pose = np.outer(sign * np.array(x), [1.0, 0.0, 0.0, 0.0])
        with pytest.raises(InvalidInput, match="check the units of t and pose"):
            from_samples(times, pose)
