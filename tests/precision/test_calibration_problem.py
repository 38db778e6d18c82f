"""The least squares of a calibration, and the choice of poses, worked out another way."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import t as student

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    KneeBranch,
    check_reach,
    inverse_kinematics,
    measure_singularity,
)
from paminsa_viz.precision import calibration_problem
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.calibration_problem import (
    CalibrationProblem,
    _candidates,
    measuring_poses,
    require_enough,
)
from paminsa_viz.precision.leg_lengths import INDEX, deviation_array
from paminsa_viz.precision.measurements import InvalidMeasurement, Measurements, predict
from tests.precision.deviations import random_deviations
from tests.support.samples import random_poses

RADII = np.array([1.0, 1.0, 0.1, 1.0, 0.1, 0.1])
"""What turns coordinates of the platform into lengths: R_pl of Appendix 4's robot for angles."""


def level(poses: Any, width: int = 6) -> Measurements:
    """Poses (n, 4) that are measured exactly."""
    rows = np.concatenate([poses, np.zeros((len(poses), 2))], axis=1)[:, :width]
    return Measurements(inverse_kinematics(APPENDIX_4.geometry, poses).actuators, rows)


POSES = random_poses(np.random.default_rng(0), APPENDIX_4, 15)


@pytest.mark.parametrize("width", [4, 6])
def test_residuals_and_their_slopes_are_those_of_predicted_poses_in_meters(width: int) -> None:
    told: list[float] = []
    problem = CalibrationProblem(
        APPENDIX_4, level(POSES, width), lambda part: bool(told.append(part))
    )
    deviations = random_deviations(1, 5e-4)
    values = problem.scaled(deviations)
    # angles of axes and actuators count with R_b, those in the platform with R_pl
    scale = np.ones(14)
    scale[[INDEX["axis_angle"], INDEX["actuator_zero"]]] = 0.35
    scale[INDEX["joint_angle"]] = 0.1
    np.testing.assert_allclose(values, (deviations * scale).ravel())
    np.testing.assert_allclose(problem.unscaled(values), deviations)

    def missed(at: Any) -> Any:
        found = predict(APPENDIX_4, problem.unscaled(at), problem.measured).coordinates
        return ((found[:, :width] - problem.measured.poses) * RADII[:width]).ravel()

    np.testing.assert_allclose(problem.residuals(values), missed(values), atol=1e-15)
    problem.jacobian(values)
    assert len(told) == 1  # the same values are solved once
    assert (problem.rows, problem.width) == (15 * width, width)
    step = np.random.default_rng(2).normal(size=42)
    slope = (missed(values + 1e-6 * step) - missed(values - 1e-6 * step)) / 2e-6
    np.testing.assert_allclose(problem.jacobian(values) @ step, slope, atol=1e-6)
    still = np.zeros(42)
    np.testing.assert_allclose(problem.equal_legs(), problem.jacobian(still), atol=1e-10)
    squares = (missed(values) ** 2).sum()
    assert problem.noise(values, 30) == pytest.approx(np.sqrt(squares / (15 * width - 30)))
    assert problem.noise(still, 30) < 1e-13
    own = predict(APPENDIX_4, deviations, problem.measured).coordinates[:, :width]
    exact = CalibrationProblem(APPENDIX_4, replace(problem.measured, poses=own))
    assert exact.noise(values, 30) == np.finfo(float).eps  # of a meter: never nothing


@pytest.mark.parametrize("fitted", [0, 30, 42])
def test_intervals_are_those_of_student_with_what_is_left_of_the_rows(fitted: int) -> None:
    problem = CalibrationProblem(APPENDIX_4, level(POSES))
    assert problem.margin(fitted) == pytest.approx(student.ppf(0.975, 90 - fitted), rel=1e-9)


def test_a_fit_within_a_basis_is_the_least_of_its_squares(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """About an origin of its own and from the guess: no step within the basis makes them less."""
    true = random_deviations(3, 3e-4)
    measured = replace(
        level(POSES), poses=predict(APPENDIX_4, true, level(POSES)).coordinates
        + np.random.default_rng(4).normal(size=(15, 6)) * 2e-5 / RADII,
    )  # fmt: skip
    problem = CalibrationProblem(APPENDIX_4, measured)
    basis = np.linalg.qr(np.random.default_rng(5).normal(size=(42, 12)))[0]
    origin = problem.scaled(random_deviations(6, 1e-4))
    guess, tried, residuals = origin + basis @ np.full(12, 1e-5), [], problem.residuals
    monkeypatch.setattr(problem, "residuals", lambda at: (tried.append(at), residuals(at))[1])
    found = problem.fit(origin, basis, guess)
    np.testing.assert_allclose(tried[0], guess, atol=1e-15)
    away = found - origin
    np.testing.assert_allclose(basis @ (basis.T @ away), away, atol=1e-14)
    slope = problem.jacobian(found).T @ problem.residuals(found)
    size = np.linalg.norm(problem.residuals(found)) * np.linalg.norm(problem.jacobian(found))
    assert np.abs(basis.T @ slope).max() < 1e-7 * size
    assert np.abs(slope).max() > 1e-3 * size


@pytest.mark.slow
def test_lengths_that_cannot_be_assembled_miss_by_ten_meters() -> None:
    problem = CalibrationProblem(APPENDIX_4, level(POSES))
    open_bars = np.zeros((3, 14))
    open_bars[0, INDEX["bar_89"]] = 2.0
    found = problem.residuals(problem.scaled(open_bars))
    np.testing.assert_array_equal(found, 10.0)
    assert not problem.jacobian(problem.scaled(open_bars)).any()


@pytest.mark.parametrize(("share", "fits"), [(0.299, True), (0.301, False), (-0.301, False)])
@pytest.mark.parametrize("column", [0, 2, 3, 5])
def test_measured_poses_are_within_three_tenths_of_the_base(
    share: float, fits: bool, column: int
) -> None:
    """Angles count with R_pl; the message says which pose, and how far it is off."""
    asked = level(POSES)
    problem = CalibrationProblem(APPENDIX_4, asked)
    found = predict(APPENDIX_4, np.zeros((3, 14)), asked)
    poses = asked.poses.copy()
    poses[7, column] -= share * 0.35 / RADII[column]
    poses[3, 1] += 0.2 * 0.35
    off = replace(asked, poses=poses)
    if fits:
        problem.require_near(found, off)
        return
    with pytest.raises(InvalidMeasurement, match=r"is 0\.105 m away") as caught:
        problem.require_near(found, off)
    assert caught.value.index == 7


@pytest.mark.parametrize(("width", "least"), [(4, 11), (6, 8), (42, 2)])
def test_there_have_to_be_more_rows_than_lengths(width: int, least: int) -> None:
    require_enough(least, width)
    with pytest.raises(InvalidInput, match=f"at least {least} poses are needed, there are"):
        require_enough(least - 1, width)
    with pytest.raises(InvalidInput, match="needed besides the 3 that are held back, there are 1"):
        require_enough(1, width, 3)


@pytest.mark.slow
@pytest.mark.parametrize("coordinates", [4, 6])
def test_each_pose_is_the_one_that_adds_most_to_the_determinant(coordinates: int) -> None:
    """Of the information about what candidates show, with a millionth of each to begin with."""
    chosen = measuring_poses(APPENDIX_4, 6, coordinates=coordinates, seed=5)
    drawn = _candidates(APPENDIX_4, 800, 5)
    problem = CalibrationProblem(APPENDIX_4, level(drawn, coordinates))
    rows = problem.equal_legs()
    spread = rows.T @ rows / len(drawn)
    sizes, directions = np.linalg.eigh(spread)
    shown = sizes > 1e-12 * sizes[-1]
    assert shown.sum() == (30 if coordinates == 6 else 28)
    white = (rows @ directions[:, shown] / np.sqrt(sizes[shown])).reshape(800, coordinates, -1)
    added = np.swapaxes(white, 1, 2) @ white
    known = 1e-6 * np.eye(int(shown.sum()))
    free = np.ones(800, bool)
    if coordinates == 6:
        again = measuring_poses(APPENDIX_4, 6, coordinates=6, seed=0)
        np.testing.assert_array_equal(measuring_poses(APPENDIX_4, 6), again)
    for pose in chosen:
        gain = np.where(free, np.linalg.slogdet(known + added)[1], -np.inf)
        best = int(np.argmax(gain))
        np.testing.assert_array_equal(drawn[best], pose)
        known, free[best] = known + added[best], False


@pytest.mark.parametrize("seed", [5, 114])
def test_of_candidates_that_show_very_different_things_all_are_taken_the_best_first(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of rows five powers of ten apart the millionth to begin with decides as well."""
    rng = np.random.default_rng(seed)
    slopes = rng.normal(size=(14, 6, 3, 14)) * 10 ** rng.uniform(-5, 0, (14, 6, 1, 1))
    candidates, nothing = np.arange(56.0).reshape(14, 4), lambda *_: None
    monkeypatch.setattr(calibration_problem, "_candidates", lambda *_: candidates)
    monkeypatch.setattr(calibration_problem, "nominal_pose", nothing)
    monkeypatch.setattr(
        calibration_problem, "sensitivities", lambda *_: SimpleNamespace(lengths=slopes)
    )
    chosen = measuring_poses(APPENDIX_4, 14, coordinates=4)[:, 0] / 4
    scale = np.ones(14)
    scale[[INDEX["axis_angle"], INDEX["actuator_zero"], INDEX["joint_angle"]]] = 0.35, 0.35, 0.1
    rows = (slopes[:, :4] * RADII[:4, None, None] / scale).reshape(14, 4, 42)
    size, ways = np.linalg.eigh(np.einsum("nic,nid->cd", rows, rows) / 14)
    white = rows @ ways / np.sqrt(size)
    known, left = 1e-6 * np.eye(42), list(range(14))
    for place in chosen:
        gains = [np.linalg.slogdet(known + white[i].T @ white[i])[1] for i in left]
        assert place == left.pop(int(np.argmax(gains)))
        known += white[int(place)].T @ white[int(place)]


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_candidates_fill_what_is_clear_of_limits_and_well_conditioned(knee: KneeBranch) -> None:
    design = APPENDIX_4.with_knee(knee)
    poses = _candidates(design, 2000, 1)
    assert len(poses) == 2000
    margin = check_reach(design.geometry, poses).margins.min(axis=(-1, -2))
    assert 0.05 * 0.35 < margin.min() < 0.052 * 0.35
    assert 9.7 < measure_singularity(design.geometry, poses).condition.max() < 10.0
    again = _candidates(design, 2000, 2)
    assert not np.isin(again[:, 0], poses[:, 0]).any()


@pytest.mark.parametrize(("poses", "candidates"), [(3, 800), (400, 800), (401, 802)])
def test_there_are_at_least_800_candidates_and_twice_as_many_as_poses(
    poses: int, candidates: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def drawn(design: Any, count: int, seed: int) -> Any:
        asked.append((count, seed))
        raise InvalidInput("poses", "enough is seen")

    monkeypatch.setattr(calibration_problem, "_candidates", drawn)
    with pytest.raises(InvalidInput, match="enough"):
        measuring_poses(APPENDIX_4, poses, seed=9)
    assert asked == [(candidates, 9)]


@pytest.mark.slow
@pytest.mark.parametrize("width", [4, 6])
def test_what_a_calibration_states_follows_from_its_problem_at_what_it_found(width: int) -> None:
    """Singular values, intervals, noise and covariance; and which combinations are known."""
    noise, true = 4e-6, random_deviations(7, 5e-4)
    poses = random_poses(np.random.default_rng(3), APPENDIX_4, 40)
    exact = predict(APPENDIX_4, true, level(poses)).coordinates
    exact += np.random.default_rng(8).normal(size=exact.shape) * noise / RADII
    measured = Measurements(level(poses).actuators, exact[:, :width])
    found = calibrate(APPENDIX_4, measured)
    problem = CalibrationProblem(APPENDIX_4, measured)
    rows, values = 40 * width, problem.scaled(deviation_array(found.design))
    equal = np.linalg.svd(problem.equal_legs(), compute_uv=False) / np.sqrt(rows)
    np.testing.assert_allclose(found.singular_values, equal, atol=1e-12)
    assert found.rank == (equal > 1e-8 * equal[0]).sum() < len(found.combinations)
    sizes = np.linalg.svd(problem.jacobian(values), compute_uv=False)
    count = len(found.combinations)
    assert found.noise == pytest.approx(problem.noise(values, count))
    assert found.noise == pytest.approx(noise, rel=0.2)
    student_half = student.ppf(0.975, rows - count) * found.noise
    shown = np.array([item.singular_value for item in found.combinations]) * np.sqrt(rows)
    np.testing.assert_allclose(shown, sizes[:count], rtol=1e-3)
    halves = np.array([item.half_width for item in found.combinations])
    np.testing.assert_allclose(halves, student_half / shown)
    assert halves.max() < 1e-3 < student_half / sizes[count]
    basis = np.array([item.weights.ravel() for item in found.combinations])
    np.testing.assert_allclose(basis @ basis.T, np.eye(count), atol=1e-12)
    np.testing.assert_allclose([item.value for item in found.combinations], basis @ values)
    np.testing.assert_allclose(
        found.covariance, basis.T @ np.diag((found.noise / shown) ** 2) @ basis, atol=1e-18
    )
    inside = (basis**2).sum(axis=0).reshape(3, 14) > 1 - 1e-6
    np.testing.assert_array_equal(found.determined, inside)


@pytest.mark.slow
@pytest.mark.parametrize(("least", "fitted"), [(1.05e-3, False), (0.95e-3, True)])
def test_combinations_are_fitted_whose_interval_is_within_a_millimeter(
    least: float, fitted: bool
) -> None:
    """The noise is made so large that the next one after some has the interval."""
    true = random_deviations(7, 5e-4)
    poses = random_poses(np.random.default_rng(3), APPENDIX_4, 40)
    exact = predict(APPENDIX_4, true, level(poses)).coordinates
    error = np.random.default_rng(8).normal(size=exact.shape) / RADII
    noise, place = 2e-6, 0
    for _ in range(4):
        measured = Measurements(level(poses).actuators, exact + noise * error)
        found = calibrate(APPENDIX_4, measured)
        count = len(found.combinations)
        problem = CalibrationProblem(APPENDIX_4, measured)
        values = problem.scaled(deviation_array(found.design))
        sizes = np.linalg.svd(problem.jacobian(values), compute_uv=False)
        place = place or count  # the first that is not fitted with little noise
        half = problem.margin(count) * found.noise / sizes[place]
        if abs(half / least - 1.0) < 0.01:
            break
        noise *= least / half
    assert half == pytest.approx(least, rel=0.01)
    assert count == place + fitted
