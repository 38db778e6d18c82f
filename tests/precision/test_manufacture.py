"""Errors by tolerances and clearances: bounds, their parts, random robots."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import size_of
from paminsa_viz.model import APPENDIX_4, solve_field, xy_grid
from paminsa_viz.model.accuracy import NO_TOLERANCES, Tolerances
from paminsa_viz.precision import manufacture
from paminsa_viz.precision.leg_lengths import INDEX, design_lengths, with_deviations
from paminsa_viz.precision.manufacture import (
    MonteCarlo,
    clearance_widths,
    design_sensitivities,
    field_tolerance_errors,
    longest_sum,
    manufactured_pose,
    monte_carlo,
    tolerance_errors,
    tolerance_widths,
)
from paminsa_viz.precision.unequal_legs import (
    Closure,
    Sensitivities,
    solve_actuators,
    solve_pose,
)
from paminsa_viz.quantities import QUANTITIES
from tests.support.cases import BY_HAND, Case, cases
from tests.support.measured import by_manufacture

SMALL = Tolerances(**dict.fromkeys(vars(Tolerances()), 1e-07))


@given(seed=st.integers(0, 999), n=st.integers(1, 7), batch=st.sampled_from([(), (30,), (6, 5)]))
def test_the_longest_sum_is_that_of_all_signs(seed: int, n: int, batch: tuple[int, ...]) -> None:
    """Many of the vectors lie along an axis, with zeros of either sign."""
    x, y = np.random.default_rng(seed).normal(size=(2, *batch, n)).round(seed % 2)
    signs = np.array(list(product((-1, 1), repeat=n)))
    wanted = np.hypot(x @ signs.T, y @ signs.T).max(axis=-1)
    assert np.allclose(longest_sum(x, y), wanted)


@pytest.mark.slow
@given(case=cases(), seed=st.integers(0, 99))
def test_worst_errors_bound_robots_at_their_corners_and_are_reached(case: Case, seed: int) -> None:
    design = replace(case.design, tolerances=SMALL)
    pose = case.poses(1)[0]
    found = tolerance_errors(design, pose)
    slopes = design_sensitivities(design, pose).lengths
    widths = tolerance_widths(SMALL) + clearance_widths(SMALL)
    lengths = design_lengths(design)
    start = manufactured_pose(design, pose)
    random = np.random.default_rng(seed).choice((-1.0, 1.0), (40, 3, 14))
    corners = np.concatenate([np.sign(slopes), random]) * widths
    moved = solve_pose(case.geometry, lengths + corners, start.actuators, pose)
    errors = moved.coordinates - start.coordinates
    size = np.abs(errors)
    assert (size <= found.worst * (1 + 1e-3) + 1e-12).all()
    assert np.allclose(np.diagonal(errors[:6]), found.worst, rtol=1e-3, atol=1e-12)
    assert (np.hypot(errors[:, 0], errors[:, 1]) <= found.horizontal * (1 + 1e-3)).all()
    assert (np.hypot(errors[:, 4], errors[:, 5]) <= found.tilt * (1 + 1e-3)).all()
    # and the largest distances are reached: in each direction by the corner that goes farthest
    generators = (slopes * widths).reshape(6, -1)
    angle = np.linspace(0.0, np.pi, 2001)
    toward = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for rows, largest in ((slice(0, 2), found.horizontal), (slice(4, 6), found.tilt)):
        farthest = np.abs(toward @ generators[rows]).sum(axis=1).max()
        assert farthest == pytest.approx(largest, rel=1e-5, abs=1e-15)


@pytest.mark.slow
@given(case=cases())
def test_errors_are_linear_in_the_tolerances_and_clearances_are_a_part(case: Case) -> None:
    poses = case.poses(4)
    base = tolerance_errors(case.design, poses)
    twice = Tolerances(**{name: 2 * value for name, value in vars(Tolerances()).items()})
    double = tolerance_errors(replace(case.design, tolerances=twice), poses)
    for name in ("worst", "clearance", "rms", "horizontal", "tilt", "rms_horizontal", "rms_tilt"):
        assert np.allclose(getattr(double, name), 2 * getattr(base, name), rtol=1e-12, atol=0)
    assert np.allclose(double.shares, base.shares)
    assert np.allclose(base.shares.sum(axis=-1), 1.0)
    play = replace(NO_TOLERANCES, pin_clearance=2e-5, guide_clearance=2e-5)
    alone = tolerance_errors(replace(case.design, tolerances=play), poses)
    assert np.allclose(alone.worst, base.clearance, rtol=1e-12, atol=0)
    exact = tolerance_errors(replace(case.design, tolerances=NO_TOLERANCES), poses)
    assert not exact.worst.any()
    assert not exact.shares.any()


def test_the_height_error_by_hand() -> None:
    """A shaft that is off by t moves z_5 of its leg by k t, and z by a third of it."""
    only = replace(NO_TOLERANCES, shaft=1e-4)
    found = tolerance_errors(replace(APPENDIX_4, tolerances=only), BY_HAND)
    assert np.allclose(found.worst[:, 3], 3e-4)
    assert np.allclose(found.rms[:, 3], 3e-4 / 3, rtol=1e-12)  # 3 t / 3 * sqrt(3) / sqrt(3)
    assert np.allclose(found.shares[:, 3, INDEX["shaft"]], 1.0)
    # two legs up, one down: the plane rises by 2 k t over 3/2 R_pl
    assert np.allclose(found.tilt, 2 * 3e-4 / 0.15)


def test_clearances_by_hand() -> None:
    """A guide that is c/2 off lifts its leg by (k - 1) c/2; a pin is a bar's tolerance of c/2."""
    guide = replace(NO_TOLERANCES, guide_clearance=2e-5)
    found = tolerance_errors(replace(APPENDIX_4, tolerances=guide), BY_HAND)
    assert np.allclose(found.worst[:, 3], 2 * 1e-5)
    pins = replace(NO_TOLERANCES, pin_clearance=2e-5)
    bars = replace(NO_TOLERANCES, bar=1e-5)
    found = tolerance_errors(replace(APPENDIX_4, tolerances=pins), BY_HAND)
    same = tolerance_errors(replace(APPENDIX_4, tolerances=bars), BY_HAND)
    assert np.allclose(found.worst, same.worst, rtol=1e-12)
    assert np.allclose(found.clearance, found.worst, rtol=1e-12)
    assert not same.clearance.any()
    assert not found.worst[:, 2].any()  # theta is the rotary actuators' and the axes' alone
    drawn = monte_carlo(replace(APPENDIX_4, tolerances=pins), BY_HAND, robots=300)
    shown = [0, 1, 3, 4, 5]  # bars do not turn the platform
    assert np.allclose(drawn.rms[:, shown] / found.rms[:, shown], 1, atol=0.2)


@pytest.mark.slow
@given(case=cases())
def test_rms_of_random_robots_is_that_of_the_first_order(case: Case) -> None:
    design = replace(case.design, tolerances=SMALL)
    poses = case.poses(2)
    drawn = monte_carlo(design, poses, robots=400, seed=1)
    assert drawn.errors.shape == (400, 2, 6)
    assert (drawn.solved == 1).all()
    wanted = tolerance_errors(design, poses)
    assert np.allclose(drawn.rms / wanted.rms, 1, atol=0.25)
    assert (drawn.quantile(1.0) <= wanted.worst).all()
    assert (drawn.quantile(0.5) < drawn.quantile(0.95)).all()


def test_random_robots_are_the_same_in_any_blocks() -> None:
    whole = monte_carlo(APPENDIX_4, BY_HAND, robots=50, seed=3)
    parts = monte_carlo(APPENDIX_4, BY_HAND, robots=30, seed=3, block=21)
    assert np.array_equal(whole.errors[:30], parts.errors)
    other = monte_carlo(APPENDIX_4, BY_HAND, robots=30, seed=4)
    assert not np.array_equal(other.errors, parts.errors)
    assert np.array_equal(parts.pose, BY_HAND)
    single = monte_carlo(APPENDIX_4, BY_HAND[1], robots=30, seed=3)
    assert np.allclose(single.errors, parts.errors[:, 1], rtol=0, atol=1e-15)


def test_random_robots_report_progress_and_can_be_canceled() -> None:
    seen: list[float] = []

    def progress(done: float) -> bool:
        seen.append(done)
        return done >= 0.4

    found = monte_carlo(APPENDIX_4, BY_HAND, robots=50, block=30, progress=progress)
    assert seen == [0.2, 0.4]
    assert found.canceled
    assert found.errors.shape == (20, 3, 6)
    late = monte_carlo(APPENDIX_4, BY_HAND, robots=5, progress=lambda done: done == 1.0)
    assert not late.canceled  # nothing was left to leave out


@pytest.mark.slow
def test_robots_without_a_solution_are_counted() -> None:
    loose = replace(APPENDIX_4, tolerances=replace(NO_TOLERANCES, bar=0.05))
    near = np.array([0.0, 0.0, 0.0, -0.95])
    found = monte_carlo(loose, near, robots=30)
    assert 0 < found.solved < 1
    assert np.isnan(found.errors[found.status != 0]).all()
    assert np.isinf(found.quantile(0.999)).all()
    assert np.isnan(found.rms).all()


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"robots": 0}, "robots: 1 to 1,000,000"),
        ({"robots": 10**7}, "robots: 1 to 1,000,000"),
        ({"robots": 500_001, "pose": BY_HAND[:2]}, "1 to 500,000 are possible with 2 poses"),
        ({"seed": -1}, "seed: a whole number"),
        ({"pose": (0, 0, 0, -3)}, "pose: a pose cannot be taken: the bars of a leg"),
        (
            {"pose": [[(0, 0, 0, -0.5), (0, 0, 0, -3)]]},
            r"pose: pose \(0, 1\) cannot be taken: the bars of a leg",
        ),
    ],
    ids=str,
)
def test_impossible_draws_are_refused(options: dict[str, Any], problem: str) -> None:
    pose = options.pop("pose", BY_HAND[0])
    with pytest.raises(InvalidInput, match=problem):
        monte_carlo(APPENDIX_4, pose, **options)


def test_one_robot_is_enough() -> None:
    assert monte_carlo(APPENDIX_4, BY_HAND, robots=1).errors.shape == (1, len(BY_HAND), 6)


def test_a_calibrated_robot_is_controlled_by_its_own_lengths() -> None:
    deviations = np.random.default_rng(0).uniform(-1e-3, 1e-3, (3, 14))
    design = with_deviations(APPENDIX_4, deviations)
    drawn = monte_carlo(replace(design, tolerances=NO_TOLERANCES), BY_HAND, robots=2)
    assert np.abs(drawn.errors).max() < 1e-12
    blind = manufactured_pose(design, BY_HAND)
    assert np.abs(blind.pose - BY_HAND).max() > 1e-4
    # first-order errors hardly differ from those of the drawn robot
    assert np.allclose(
        tolerance_errors(design, BY_HAND).worst,
        tolerance_errors(APPENDIX_4, BY_HAND).worst,
        rtol=0.2,
    )
    assert isinstance(drawn, MonteCarlo)


@pytest.mark.slow
def test_sensitivities_of_unequal_legs_are_slopes_of_their_own_poses() -> None:
    """Central differences of the solved pose, by every length of every leg."""
    deviations = np.random.default_rng(4).uniform(-5e-3, 5e-3, (3, 14))
    design = with_deviations(APPENDIX_4, deviations)
    own, step = design_lengths(design), 1e-6
    held = solve_actuators(design.geometry, own, BY_HAND).actuators
    slopes = design_sensitivities(design, BY_HAND).lengths
    for leg, length in np.ndindex(own.shape):
        change = np.zeros_like(own)
        change[leg, length] = step
        more, less = (
            solve_pose(design.geometry, own + sign * change, held, BY_HAND).coordinates
            for sign in (1.0, -1.0)
        )
        expected = (more - less) / (2 * step)
        np.testing.assert_allclose(slopes[..., leg, length], expected, atol=1e-6)


def test_an_error_of_theta_is_the_short_way_round() -> None:
    deviations = np.random.default_rng(4).uniform(-1e-3, 1e-3, (3, 14))
    design = replace(with_deviations(APPENDIX_4, deviations), tolerances=UNEVEN)
    poses = np.array([[0.0, 0.0, turn, -0.5] for turn in (np.pi, -np.pi, 3.0 * np.pi)])
    errors = monte_carlo(design, poses, robots=20).errors
    assert np.abs(errors[..., 2]).max() < 0.1
    np.testing.assert_allclose(errors[:, 1], errors[:, 0], atol=1e-9)


def test_fields_have_the_errors_of_their_poses() -> None:
    field = solve_field(
        APPENDIX_4.geometry,
        xy_grid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.3, 0.3, 7), 0.3, -0.5),
    )
    found = field_tolerance_errors(field, APPENDIX_4)
    poses = field.grid.poses()
    wanted = tolerance_errors(APPENDIX_4, poses)
    assert np.array_equal(found.worst, wanted.worst, equal_nan=True)
    assert np.array_equal(np.isnan(found.tilt), field.status != 0)
    assert field_tolerance_errors(field, replace(APPENDIX_4, gravity=1.0)) is found
    # shares, which no map shows, are 84 numbers a pose, and are there when asked for
    assert size_of(found) < 84 * found.tilt.nbytes
    assert np.array_equal(found.shares, wanted.shares, equal_nan=True)
    assert np.array_equal(np.isnan(found.shares).all(axis=(-1, -2)), field.status != 0)


@pytest.mark.slow
def test_maps_of_deviations_are_their_poses_and_say_what_cannot_be_assembled() -> None:
    deviations = np.zeros((3, 14))
    deviations[0, INDEX["bar_89"]] = -0.02
    deviations[1, INDEX["axis_angle"]] = 1e-3
    design = with_deviations(APPENDIX_4, deviations)
    grid = xy_grid(np.linspace(-0.3, 0.3, 5), np.linspace(-0.3, 0.3, 5), 0.3, -0.8)
    field = solve_field(APPENDIX_4.geometry, grid)
    wanted = by_manufacture(design, grid.poses())
    kinds = ("deviation", "tolerance", "rms_tolerance")
    for key in (key for key in QUANTITIES if key.startswith(kinds)):
        expected = np.where(field.status == 0, wanted[key], np.nan)
        assert np.allclose(
            QUANTITIES[key].over(field, design), expected, rtol=1e-9, atol=0, equal_nan=True
        )
    quantity = QUANTITIES["deviation_tilt"]
    assert quantity.missing is not None
    missing = quantity.missing(field, design)
    reachable = field.status == 0
    values = quantity.over(field, design)
    assert np.array_equal(np.isnan(values[reachable]), missing.code[reachable] != 0)
    found = {missing.words[code] for code in missing.code[reachable]}
    assert {"no-assembly:ok", "no-assembly:open"} <= found
    assert len(missing.texts) == len(missing.words)


UNEVEN = Tolerances(
    **{name: 1e-6 * number for number, name in enumerate(vars(Tolerances()), start=2)}
)


def test_errors_are_sums_and_roots_of_slopes_times_widths() -> None:
    """Of tolerances that are all different, at poses of which one is out of reach."""
    design = replace(APPENDIX_4, tolerances=UNEVEN)
    poses = np.array([*BY_HAND, [0.0, 0.0, 0.0, -3.0]]).reshape(2, 2, 4)
    found = tolerance_errors(design, poses)
    tolerance, clearance = tolerance_widths(UNEVEN), clearance_widths(UNEVEN)
    assert tolerance[0, INDEX["bar_43"]] == UNEVEN.bar
    assert tolerance[2, INDEX["axis_angle"]] == UNEVEN.axis_angle
    assert clearance[1, INDEX["bar_43"]] == UNEVEN.pin_clearance / 2
    assert clearance[1, INDEX["guide_height"]] == UNEVEN.guide_clearance / 2
    assert np.count_nonzero(clearance) == 3 * 7
    slopes = design_sensitivities(design, poses).lengths
    slopes[..., 2, :, :] = np.where(
        np.abs(slopes[..., 2, :, :]) < 1e-9, 0.0, slopes[..., 2, :, :]
    )  # what rounding leaves of theta
    size = np.abs(slopes)
    square = slopes**2 * (tolerance**2 + clearance**2) / 3.0
    total = square.sum(axis=(-1, -2))
    expected = {
        "worst": (size * (tolerance + clearance)).sum(axis=(-1, -2)),
        "clearance": (size * clearance).sum(axis=(-1, -2)),
        "rms": np.sqrt(total),
        "rms_horizontal": np.sqrt(total[..., 0] + total[..., 1]),
        "rms_tilt": np.sqrt(total[..., 4] + total[..., 5]),
        "shares": square.sum(axis=-2) / total[..., None],
    }
    for name, values in expected.items():
        np.testing.assert_allclose(
            getattr(found, name)[0], values[0], rtol=1e-9, atol=1e-15, err_msg=name
        )
        assert np.isnan(getattr(found, name)[1, 1]).all()
        assert np.isfinite(getattr(found, name)[1, 0]).all()
    assert np.isnan(found.horizontal).tolist() == [[False, False], [False, True]]
    assert np.isnan(found.tilt).tolist() == [[False, False], [False, True]]


def test_what_is_a_millionth_of_a_millionth_of_the_largest_counts_for_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the same coordinate's, whatever its unit makes of it; on both sides of it."""
    rng = np.random.default_rng(0)
    slopes = 1e-12 * np.array([0.95, -0.95, 1.05, -1.05])[rng.integers(0, 4, (2, 6, 3, 14))]
    slopes[..., 1, 3] = -1.0
    slopes *= 10.0 ** rng.uniform(-3, 3, (2, 6, 1, 1))
    monkeypatch.setattr(
        manufacture, "design_sensitivities", lambda *_: Sensitivities(slopes, slopes[..., 0])
    )
    found = tolerance_errors(replace(APPENDIX_4, tolerances=UNEVEN), BY_HAND[:2])
    largest = np.abs(slopes[..., 1, 3])
    counts = (np.abs(slopes) > 1e-12 * largest[..., None, None]).any(axis=-2)
    assert 0 < counts.mean() < 1
    np.testing.assert_array_equal(found.shares > 0, counts)


@pytest.mark.slow
def test_lengths_are_drawn_uniform_within_tolerances_and_clearances(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Around the design's own, in blocks of so many robots that 4096 poses are not exceeded."""
    drawn: list[Any] = []

    def solve(geometry: Any, lengths: Any, actuators: Any, near: Any) -> Any:
        drawn.append(lengths[:, 0])
        return solve_actuators(geometry, np.broadcast_to(nominal, (len(lengths), 1, 3, 14)), near)

    design = replace(APPENDIX_4, tolerances=UNEVEN)
    nominal = design_lengths(design)
    monkeypatch.setattr(manufacture, "solve_pose", solve)
    found = monte_carlo(design, BY_HAND, robots=3000, seed=4)
    assert [len(part) for part in drawn] == [1365, 1365, 270]
    np.testing.assert_allclose(found.errors, 0.0, atol=1e-12)
    off = np.concatenate(drawn) - nominal
    tolerance, clearance = tolerance_widths(UNEVEN), clearance_widths(UNEVEN)
    most = tolerance + clearance
    assert (np.abs(off) <= most * (1 + 1e-9)).all()
    assert (np.abs(off).max(axis=0) > 0.9 * most).all()
    np.testing.assert_allclose(
        off.std(axis=0), np.sqrt((tolerance**2 + clearance**2) / 3), rtol=0.06
    )
    assert np.abs(np.corrcoef(off.reshape(3000, 42).T) - np.eye(42)).max() < 0.1
    drawn.clear()
    monte_carlo(design, BY_HAND, robots=3, seed=4, block=1)
    assert [len(part) for part in drawn] == [1, 1, 1]


def test_statistics_of_drawn_robots_by_hand() -> None:
    errors = np.zeros((4, 2, 6))
    errors[:, 0, 0], errors[:, 1, 1] = [1.0, -2.0, 3.0, -4.0], [5.0, 6.0, np.nan, -7.0]
    status = np.zeros((4, 2), np.uint8)
    status[2, 1] = Closure.OPEN
    found = MonteCarlo(np.zeros((2, 4)), 0, errors, status, canceled=False)
    assert found.solved.tolist() == [1.0, 0.75]
    assert found.rms[0, 0] == pytest.approx(np.sqrt(7.5))
    assert np.isnan(found.rms[1, 1])
    assert [found.quantile(share)[0, 0] for share in (0.25, 0.5, 0.75, 1.0)] == [1.0, 2.0, 3.0, 4.0]
    assert [found.quantile(share)[1, 1] for share in (0.25, 0.5, 0.75, 1.0)] == [5, 6, 7, np.inf]


def test_poses_that_nominal_legs_do_not_reach_say_so_of_unequal_ones_too() -> None:
    deviations = np.zeros((3, 14))
    deviations[1, INDEX["shaft"]] = 1e-3
    design = with_deviations(APPENDIX_4, deviations)
    poses = np.array([BY_HAND[0], [0.0, 0.0, 0.0, -3.0], [np.nan] * 4])
    for one in (APPENDIX_4, design):
        found = manufactured_pose(one, poses)
        assert found.status.tolist() == [Closure.OK, Closure.OPEN, Closure.NOT_FINITE]
        assert np.isnan(found.pose[1:]).all()
    slopes = design_sensitivities(design, BY_HAND[0]).lengths
    moved = manufactured_pose(design, BY_HAND[0]).coordinates - [*BY_HAND[0], 0.0, 0.0]
    np.testing.assert_allclose(moved, slopes[:, 1, INDEX["shaft"]] * 1e-3, atol=5e-5)
