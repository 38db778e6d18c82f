"""Logs: read from tables, refused with their row, never closed up at gaps."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.logs import parse_log
from paminsa_viz.identification import InvalidLog, identify, log_poses, make_log
from paminsa_viz.identification import log as limits
from paminsa_viz.identification.filtering import filter_log
from paminsa_viz.identification.log_poses import follow_pose
from paminsa_viz.model import APPENDIX_4, KneeBranch, forward_kinematics, inverse_kinematics
from tests.support.identification_logs import clean_signals, multi_sine, simulated

RATE = 200.0


@pytest.fixture
def signals() -> list[Any]:
    """Four seconds of times, positions and torques, which a test may spoil."""
    return [array.copy() for array in clean_signals(1, duration=4.0, rate=RATE)]


def read(text: str, **options: Any) -> Any:
    return parse_log(io.StringIO(text, newline=""), "robot.csv", **options)


@pytest.mark.parametrize(
    ("place", "value", "row", "words"),
    [
        ((0, 30), 0.5, 41, "t: times have to increase"),
        ((0, 30), 29 / RATE, 40, "t: .* is there twice"),
        ((1, (30, 1)), np.nan, 40, "theta2: no finite number"),
        ((2, (30, 3)), np.inf, 40, "force4: no finite number"),
        ((1, (30, 0)), 57.3, 40, "theta1: .*degrees"),
        ((1, (30, 3)), 350.0, 40, "Z: .*millimeters"),
        ((1, (30, 3)), 1.9, 40, "Z: a jump at .* m/s"),
        ((1, (30, 2)), 2.9, 40, "theta3: a jump at .* rad/s"),
    ],
    ids=["reversed", "repeated", "nan", "infinite", "degrees", "millimeters", "lift", "turn"],
)
def test_a_wrong_row_is_named(
    signals: list[Any], place: Any, value: float, row: int, words: str
) -> None:
    """A table whose first sample stands in row 10."""
    array, index = place
    signals[array][index] = value
    with pytest.raises(InvalidLog, match=f"^row {row}, {words}") as caught:
        make_log(*signals, first_row=10)
    assert caught.value.row == row


def test_angles_of_encoders_that_jump_by_a_full_turn_are_made_continuous(
    signals: list[Any],
) -> None:
    t, position, torque = signals
    shifted = position + np.array([3.1, 3.1, -3.1, 0.0])
    jumping = shifted.copy()
    jumping[:, :3] = np.angle(np.exp(1j * shifted[:, :3]))
    assert np.abs(np.diff(jumping[:, :3], axis=0)).max(axis=0).min() > 6.0
    off = (make_log(t, jumping, torque).position - shifted) / (2 * np.pi)
    np.testing.assert_allclose(off - np.round(off[0]), 0.0, atol=1e-12)


def test_a_log_lasts_as_long_as_its_samples_and_needs_four_columns(signals: list[Any]) -> None:
    t, position, torque = signals
    assert make_log(t, position, torque).duration == pytest.approx(len(t) / RATE)
    with pytest.raises(InvalidInput, match=r"position: shape \(799, 4\) where \(800, 4\) is"):
        make_log(t, position[1:], torque)
    with pytest.raises(InvalidInput, match=r"t: one axis of times .* is \(800, 1\)"):
        make_log(t[:, None], position, torque)
    with pytest.raises(InvalidInput, match=r"torque: shape \(799, 4\) where"):
        make_log(t, position, torque[1:])


def test_a_start_is_one_pose_of_finite_numbers(signals: list[Any]) -> None:
    log = make_log(*signals)
    pose = [0.0, 0.0, 0.0, -0.5]
    for start in ([np.nan, *pose[1:]], [*pose[:3], np.inf], [pose, pose]):
        with pytest.raises(InvalidInput, match=r"start: .* needed"):
            log_poses(APPENDIX_4.geometry, log, start)


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_of_two_jumps_in_a_row_the_one_further_beyond_its_limit_is_named(
    signals: list[Any], turn: float
) -> None:
    """A lift of 20 m/s is twice what is believed, 150 rad/s are less beyond, though more."""
    t, position, torque = signals
    position[50:, 3] += turn * 20.0 / RATE
    position[50:, 1] += turn * 150.0 / RATE
    with pytest.raises(InvalidLog, match=r"^row 51, Z: a jump at [12]\d(\.\d)? m/s; at most 10"):
        make_log(t, position, torque)


def test_a_jump_that_is_barely_too_large_does_not_read_as_if_it_were_real(
    signals: list[Any],
) -> None:
    t, position, torque = signals
    step = position[50, 3] - position[49, 3]
    position[50:, 3] += 10.004 / RATE - step
    with pytest.raises(InvalidLog, match=r"a jump at 10\.1 m/s; at most 10 is real"):
        make_log(t, position, torque)


def test_samples_know_their_rows_where_rows_are_left_out_or_resampled(signals: list[Any]) -> None:
    log = make_log(*signals, first_row=10)
    assert [log.row(index) for index in (0, 7)] == [10, 17]
    assert replace(log, rows=None).row(7) == 8
    t = signals[0].copy()
    t[1:-1] += np.random.default_rng(0).uniform(-0.2, 0.2, t.size - 2) / RATE
    uneven = make_log(t, *signals[1:], first_row=10)
    rows = np.array([uneven.row(index) for index in range(len(uneven.t))])
    assert np.abs(uneven.t - t[rows - 10]).max() < 1.4 / RATE  # never further than the next row


def test_what_just_keeps_a_limit_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """In powers of two, so that nothing is rounded: rows a second, gaps, speeds, ranges, rows."""
    monkeypatch.setattr(limits, "SLOWEST", 64.0)
    monkeypatch.setattr(limits, "FASTEST", (128.0, 8.0))
    t = np.arange(10.0) / 64.0
    position = np.full((10, 4), 0.25)
    torque = np.ones((10, 4))
    assert make_log(t, position, torque).rate == 64.0
    with pytest.raises(InvalidLog, match=r"there are 32 rows a second; at least 64 are needed"):
        make_log(2.0 * t, position, torque)
    for column, step, most in ((1, 2.0, "128 is real"), (3, 0.125, "8 is real")):
        moved = position.copy()
        moved[5:, column] += step  # at 64 rows a second: as fast as is believed
        make_log(t, moved, torque)
        moved[5:, column] += 0.125
        with pytest.raises(InvalidLog, match=f"at most {most}"):
            make_log(t, moved, torque)
    late = np.concatenate([t[:6], t[6:] + 0.5 / 64.0])  # one and a half steps
    monkeypatch.setattr(limits, "SLOWEST", 20.0)
    assert len(make_log(late, position, torque).starts) == 1
    with pytest.raises(InvalidLog, match="after the row before"):
        make_log(np.concatenate([t[:6], t[6:] + 0.625 / 64.0]), position, torque)
    for column, most in ((0, 2 * np.pi), (3, 20.0)):
        still = position.copy()
        still[:, column] = most
        for sign in (1.0, -1.0):
            make_log(t, sign * still, torque)
            with pytest.raises(InvalidLog, match="beyond"):
                make_log(t, sign * np.nextafter(still, 100.0), torque)


def test_times_of_a_clock_are_told_with_all_their_digits(signals: list[Any]) -> None:
    """Seconds since 1970, as recorders write them."""
    t = 1_764_450_000 + signals[0]
    t[500] = t[499]
    told = f"{t[499]:.3f}".rstrip("0").rstrip(".")
    with pytest.raises(InvalidLog, match=rf"times have to increase, and {told} s is there twice"):
        make_log(t, *signals[1:])
    t[500] = t[498]
    with pytest.raises(InvalidLog, match=f" s follows {told} s"):
        make_log(t, *signals[1:])


def test_a_gap_is_refused_or_splits_and_is_never_closed_up(signals: list[Any]) -> None:
    kept = np.r_[0:400, 402:800]
    with pytest.raises(InvalidLog, match="cut the log there") as caught:
        make_log(*(array[kept] for array in signals))
    assert caught.value.row == 401
    log = make_log(*(array[kept] for array in signals), split=True)
    assert log.starts == (0, 400)
    np.testing.assert_array_equal(log.t, signals[0][kept])
    assert any("split" in note for note in log.notes)


def test_pieces_begin_where_the_log_says_and_behind_rows_that_are_left_out() -> None:
    log = make_log(*clean_signals(1, duration=20.0, rate=RATE))
    position = log.position.copy()
    position[1500:1510, 3] = 5.0  # out of reach
    starts = (0, 1007, 2007, 3001, 3201, 3400)
    split = replace(log, starts=starts, split=True, position=position)
    _, pieces = log_poses(APPENDIX_4.geometry, split)
    assert [(piece.start, piece.stop) for piece in pieces] == [
        (0, 1007), (1007, 1500), (1510, 2007), (2007, 3001), (3001, 3201),
        (3400, 4000),  # but those of less than a second
    ]  # fmt: skip


def test_uneven_rows_are_resampled_and_that_is_stated(signals: list[Any]) -> None:
    t, _, torque = signals
    jitter = np.random.default_rng(0).uniform(-0.2, 0.2, t.size) / RATE
    jitter[[0, -1]] = 0.0
    pose = multi_sine(1)(t + jitter)[0]
    position = inverse_kinematics(APPENDIX_4.geometry, pose).actuators
    log = make_log(t + jitter, position, torque)
    assert any("resampled" in note for note in log.notes)
    np.testing.assert_allclose(np.diff(log.t), 1 / log.rate, rtol=1e-9)
    assert log.t[0] == t[0]
    assert t[-1] - 1.01 / log.rate < log.t[-1] <= t[-1] + 1e-6 / log.rate
    exact = inverse_kinematics(APPENDIX_4.geometry, multi_sine(1)(log.t)[0]).actuators
    np.testing.assert_allclose(log.position, exact, atol=1e-6)


@pytest.mark.parametrize("jittery", [0, 1])
def test_one_uneven_piece_is_enough_for_all_to_be_resampled(
    signals: list[Any], jittery: int
) -> None:
    kept = np.r_[0:300, 330:800]
    t, position, torque = (array[kept] for array in signals)
    part = slice(1, 299) if jittery == 0 else slice(301, -1)  # their ends stay
    t[part] += np.random.default_rng(0).uniform(-0.2, 0.2, t[part].size) / RATE
    log = make_log(t, position, torque, split=True)
    assert any("resampled" in note for note in log.notes)
    assert log.starts == (0, 300)
    for piece in log.segments:
        np.testing.assert_allclose(np.diff(log.t[piece]), 1 / log.rate, rtol=1e-9)


def test_a_jump_is_one_that_is_too_fast_but_across_a_gap(signals: list[Any]) -> None:
    """Where the robot may have gone anywhere; just before and just behind it is one."""
    kept = np.r_[0:400, 402:800]
    t, position, torque = (array[kept] for array in signals)
    for row, refused in ((399, True), (400, False), (401, True)):
        moved = position.copy()
        moved[row:, 3] += 1.0  # in less than a fiftieth of a second
        if refused:
            with pytest.raises(InvalidLog, match=f"^row {row + 1}, Z: a jump"):
                make_log(t, moved, torque, split=True)
        else:
            assert make_log(t, moved, torque, split=True).starts == (0, 400)


@pytest.mark.parametrize("late", [0.3, -0.3])
def test_one_row_too_late_or_too_early_is_uneven_by_as_much(
    signals: list[Any], late: float
) -> None:
    t, position, torque = signals
    t[100] += late / RATE
    (note,) = make_log(t, position, torque).notes
    assert float(note.partition("up to ")[2].split()[0]) == pytest.approx(
        1e3 * 0.3 / RATE, rel=1e-2
    )
    t[100] -= 0.98 * late / RATE
    assert make_log(t, position, torque).notes == ()


@pytest.mark.parametrize("longer", [0.0, 0.95e-6 / 39, -1e-9])
def test_rows_of_a_resampled_piece_end_with_its_last_whatever_is_rounded(longer: float) -> None:
    """Of steps that add up to a little more or less than the time between first and last row.

    To be the last, a row may be early by a millionth of a step.
    """
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(0.9, 1.1, 40))
    step = (t[-1] - t[0]) / 39 * (1 + longer)
    values = np.stack([t, t**2, 0 * t, -t], axis=1)  # which splines have exactly
    even, position, torque, rows = limits._resampled(t, values, 2.0 * values, np.arange(40), step)
    np.testing.assert_allclose(even, t[0] + step * np.arange(40))
    assert (rows[0], rows[-1]) == (0, 39)
    assert (np.abs(t[rows] - even) < 1.1).all()
    expected = np.stack([even, even**2, 0 * even, -even], axis=1)
    np.testing.assert_allclose(position, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(torque, 2.0 * expected, rtol=1e-9, atol=1e-9)
    earlier = (t[-1] - t[0]) / 39 * (1 + 1.05e-6 / 39)
    assert len(limits._resampled(t, values, values, np.arange(40), earlier)[0]) == 39


def test_a_piece_of_four_rows_is_the_shortest_that_is_resampled() -> None:
    for size in (3, 4):
        t = np.array([0.0, 0.9, 2.1, 3.0])[:size]
        given = t, np.tile(t[:, None], 4), np.ones((size, 4)), np.arange(size)
        found = limits._resampled(*given, 1.0)
        expected = np.arange(4.0) if size == 4 else t
        np.testing.assert_allclose(found[0], expected, atol=1e-12)
        np.testing.assert_allclose(found[1][:, 0], expected, atol=1e-12)


def test_segments_of_a_resampled_log_begin_behind_its_gaps(signals: list[Any]) -> None:
    """Three pieces of uneven rows: each begins where the step between samples is a gap."""
    kept = np.r_[0:300, 330:500, 520:800]
    t, position, torque = (array[kept] for array in signals)
    jitter = np.random.default_rng(0).uniform(-0.2, 0.2, t.size) / RATE
    log = make_log(t + jitter, position, torque, split=True)
    steps = np.diff(log.t) * RATE
    np.testing.assert_array_equal(np.flatnonzero(steps > 1.5) + 1, log.starts[1:])
    assert len(log.starts) == 3
    assert [round(steps[start - 1]) for start in log.starts[1:]] == pytest.approx([31, 21], abs=1)
    assert len(log.notes) == 2


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_poses_follow_the_assembly_that_starts_nearest(knee: KneeBranch) -> None:
    design = APPENDIX_4.with_knee(knee)
    t, position, _ = clean_signals(3, design, duration=10.0, rate=RATE)
    poses = multi_sine(3, design)(t)[0]
    np.testing.assert_allclose(
        log_poses(design.geometry, make_log(t, position, position))[0], poses, atol=1e-9
    )
    modes = forward_kinematics(design.geometry, position).pose
    other = np.abs(modes - poses[:, None]).sum(axis=-1).argmax(axis=1)
    mirror = modes[np.arange(len(t)), other]
    found = follow_pose(design.geometry, position, mirror[0])
    np.testing.assert_allclose(found[:, [0, 1, 3]], mirror[:, [0, 1, 3]], atol=1e-9)
    np.testing.assert_allclose(np.exp(1j * found[:, 2]), np.exp(1j * mirror[:, 2]), atol=1e-9)
    rng, seen = np.random.default_rng(0), set()
    for start in rng.uniform([-0.3, -0.3, -7.0, -1.0], [0.3, 0.3, 7.0, 0.0], (40, 4)):
        apart = np.exp(1j * (modes[0, :, 2] - start[2]))  # also full turns away
        off = np.array([*(modes[0, :, :2] - start[:2]).T, np.angle(apart)])
        off[2] *= design.geometry.platform_radius
        nearest = int(np.argmin((off**2).sum(axis=0)))
        begun = follow_pose(design.geometry, position[[0, 700]], start)
        np.testing.assert_allclose(begun[0], modes[0, nearest], atol=1e-9)
        seen.add(nearest)
    assert seen == {0, 1}


def test_rows_near_a_singularity_or_out_of_reach_are_refused_or_left_out() -> None:
    t = np.arange(2000) / RATE
    pose = np.zeros((t.size, 4))
    pose[:, 3] = -0.5
    pose[:, 0] = 0.244 * np.sin(2 * np.pi * t / 5.0)  # the singular circle is at 0.25 m
    position = inverse_kinematics(APPENDIX_4.geometry, pose).actuators
    with pytest.raises(InvalidLog, match=r"condition number is 1\d.*near a singularity") as caught:
        log_poses(APPENDIX_4.geometry, make_log(t, position, position))
    assert 100 < (caught.value.row or 0) < 250
    split = make_log(t, position, position, split=True)
    pieces = log_poses(APPENDIX_4.geometry, split)[1]
    assert len(pieces) > 2
    assert max(np.abs(pose[piece, 0]).max() for piece in pieces) < 0.24
    position[:, 3] += 2.0
    with pytest.raises(InvalidLog, match=r"row 1: out of reach"):
        log_poses(APPENDIX_4.geometry, make_log(t, position, position))


def test_times_in_milliseconds_are_refused(signals: list[Any]) -> None:
    with pytest.raises(InvalidLog, match=r"0\.2 rows a second.*t_ms"):
        make_log(1e3 * signals[0], signals[1], signals[2])


def test_a_robot_at_rest_is_refused() -> None:
    t = np.arange(4000) / RATE
    position = np.tile(
        inverse_kinematics(APPENDIX_4.geometry, [0, 0, 0, -0.5]).actuators, (4000, 1)
    )
    for design in (APPENDIX_4, replace(APPENDIX_4, gravity=0.9)):  # some gravity is enough
        with pytest.raises(InvalidLog, match="hardly moves"):
            identify(design, make_log(t, position, position))


def test_headings_have_no_jump_behind_a_row_where_the_legs_do_not_meet() -> None:
    geometry = APPENDIX_4.geometry
    theta = np.linspace(2.4, 4.0, 60)  # past a half turn
    poses = np.column_stack([np.zeros((60, 2)), theta, np.full(60, -0.55)])
    poses[:, :2] = 0.01
    position = inverse_kinematics(geometry, poses).actuators
    position[20, :3] = (0.0, 2.0, 4.5)
    assert np.isnan(forward_kinematics(geometry, position[20]).pose[..., 2]).all()
    found = follow_pose(geometry, position, poses[0])[:, 2]
    np.testing.assert_allclose(np.delete(found, 20), np.delete(theta, 20), atol=1e-9)


def test_torques_that_are_not_thinned_out_are_filtered_as_columns_are() -> None:
    log = simulated(1, APPENDIX_4, rate=200.0, duration=10.0)
    pose, pieces = log_poses(APPENDIX_4.geometry, log)
    signals = filter_log(
        log, APPENDIX_4.geometry, pose, pieces, cut_off=20.0, transition_speed=0.01, thinning=1
    )
    ends = 2 * 3  # of the differences, twice
    torque = np.concatenate([log.torque[piece][ends:-ends] for piece in pieces])
    np.testing.assert_allclose(signals.smooth(torque), signals.torque, rtol=1e-9, atol=1e-12)
    steady = np.repeat([[0.0, 1.0, -3.0]], len(torque), axis=0)  # has no frequency to filter
    np.testing.assert_allclose(signals.smooth(steady), steady[: len(signals.t)], atol=1e-12)
