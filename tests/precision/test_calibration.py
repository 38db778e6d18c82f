"""Calibration of synthetic measurements: what is found, how well, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.blocks.calibration import fitted_text
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    KneeBranch,
    check_reach,
    inverse_kinematics,
    measure_singularity,
)
from paminsa_viz.model.reach import home_pose
from paminsa_viz.precision.calibration import KNOWN, calibrate, describe, known_within
from paminsa_viz.precision.calibration_problem import (
    CalibrationProblem,
    _candidates,
    measuring_poses,
)
from paminsa_viz.precision.leg_lengths import INDEX, deviation_array, with_deviations
from paminsa_viz.precision.measurements import (
    InvalidMeasurement,
    Measurements,
    coordinate_scales,
    length_scales,
    predict,
    rotation_coordinates,
)
from tests.support.samples import enlarged, random_design, random_poses

SIX, FOUR = 6, 4


def readings(design: Design, poses: int, seed: int = 0) -> Measurements:
    """Return well spread poses and the nominal robot's actuators, not yet measured."""
    drawn = random_poses(np.random.default_rng(seed), design, poses)
    return Measurements(inverse_kinematics(design.geometry, drawn).actuators, drawn)


def measure(
    design: Design, true: Any, poses: int, width: int, noise: float = 0.0, seed: int = 0
) -> Measurements:
    """Measure a robot with deviations (3, 14), with Gaussian noise [m] of the scaled poses."""
    at = readings(design, poses, seed)
    found = predict(design, true, at)
    assert found.ok.all()
    scales = coordinate_scales(design)
    error = np.random.default_rng(seed + 1).normal(size=(poses, 6)) * noise / scales
    return Measurements(at.actuators, (found.coordinates + error)[:, :width])


def random_deviations(seed: int, size: float = 5e-4) -> Any:
    return np.random.default_rng(seed).uniform(-size, size, (3, 14))


@pytest.mark.slow
@pytest.mark.parametrize(("width", "rank"), [(SIX, 30), (FOUR, 28)])
def test_thirty_combinations_show_in_six_coordinates_and_28_in_four(width: int, rank: int) -> None:
    for seed in range(2):
        design = APPENDIX_4 if seed == 0 else random_design(np.random.default_rng(seed))
        size = design.geometry.base_radius / 700
        data = measure(design, random_deviations(seed, size), 20, width, 1e-5)
        found = calibrate(design, data)
        assert found.rank == rank
        assert found.singular_values[rank - 1] > 1e-3 * found.singular_values[0]
        assert found.singular_values[rank] < 1e-12 * found.singular_values[0]
        assert found.singular_values.shape == (42,)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("knee", "width"), [(KneeBranch.LOWER, SIX), (KneeBranch.UPPER, FOUR)], ids=str
)
def test_exact_measurements_predict_held_back_poses_exactly(knee: KneeBranch, width: int) -> None:
    design = APPENDIX_4.with_knee(knee)
    true = random_deviations(1)
    data = measure(design, true, 40, width)
    found = calibrate(design, data, validate=0.3)
    assert found.after_held.poses == 12
    assert found.before_held.rms[:2].min() > 1e-4
    assert found.after_held.largest.max() < 1e-12
    assert found.improved
    # legs that differ show all of their lengths, if the measurements are exact
    assert len(found.combinations) == 42
    assert found.determined.all()
    assert np.abs(deviation_array(found.design) - true).max() < 1e-9
    other = readings(design, 20, seed=9)
    wanted = predict(design, true, other).coordinates
    got = predict(design, deviation_array(found.design), other).coordinates
    assert np.abs(got - wanted).max() < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("width", [SIX, FOUR])
def test_noise_stays_what_it_is_on_held_back_poses(width: int) -> None:
    noise = 2e-5
    data = measure(APPENDIX_4, random_deviations(2), 100, width, noise)
    found = calibrate(APPENDIX_4, data, validate=0.3)
    assert found.noise == pytest.approx(noise, rel=0.15)
    scaled = found.after_held.rms * coordinate_scales(APPENDIX_4)[:width]
    assert (scaled < 1.8 * noise).all()
    assert (found.after.rms < found.before.rms / 5).all()
    assert 28 <= len(found.combinations) < 42
    assert not found.determined.all()


@pytest.mark.slow
def test_intervals_cover_what_is_true() -> None:
    """Of 95 % intervals, about 95 % hold the true value of their combination."""
    scale, hits = length_scales(APPENDIX_4), []
    for seed in range(7):
        true = random_deviations(seed, 3e-4)
        data = measure(APPENDIX_4, true, 40, SIX, 3e-5, seed=100 * seed)
        found = calibrate(APPENDIX_4, data)
        for item in found.combinations:
            assert item.value == pytest.approx(
                float((item.weights * scale * deviation_array(found.design)).sum()), abs=1e-12
            )
            miss = float((item.weights * scale * true).sum()) - item.value
            hits.append(abs(miss) < item.half_width)
            assert item.half_width < KNOWN
    assert len(hits) > 200
    assert 0.90 < np.mean(hits) < 0.985


@pytest.mark.slow
def test_a_small_robot_is_calibrated_alike_in_proportion() -> None:
    """A millimeter of it is no knowledge: its deviations are micrometers."""
    factor = 0.01
    data = measure(APPENDIX_4, random_deviations(5), 40, SIX, 1e-5)
    poses, actuators = data.poses * 1.0, data.actuators * 1.0
    poses[:, [0, 1, 3]] *= factor
    actuators[:, 3] *= factor
    found = calibrate(enlarged(APPENDIX_4, factor), Measurements(actuators, poses))
    large = calibrate(APPENDIX_4, data)
    assert found.noise == pytest.approx(factor * large.noise, rel=1e-3)
    halves = [[item.half_width for item in one.combinations] for one in (found, large)]
    assert halves[0] == pytest.approx(factor * np.array(halves[1]), rel=1e-3)
    assert max(halves[0]) < known_within(found.start.geometry) == factor * KNOWN
    assert "known to 0.01 mm" in fitted_text(found)


@pytest.mark.slow
def test_what_does_not_show_keeps_the_value_of_the_start() -> None:
    before = random_deviations(3, 2e-4)
    start = with_deviations(APPENDIX_4, before)
    data = measure(APPENDIX_4, before + random_deviations(4, 2e-4), 40, SIX, 5e-5)
    found = calibrate(start, data)
    change = ((deviation_array(found.design) - before) * length_scales(start)).ravel()
    basis = np.array([item.weights.ravel() for item in found.combinations])
    assert np.allclose(basis @ basis.T, np.eye(len(basis)), atol=1e-12)
    assert np.allclose(change, basis.T @ (basis @ change), atol=1e-12)
    assert len(basis) < 36
    weak = found.combinations[-1].half_width
    strong = found.combinations[0].half_width
    assert weak > strong
    trace = sum(item.half_width**2 for item in found.combinations)
    assert np.trace(found.covariance) == pytest.approx(trace / 1.96**2, rel=0.05)


def test_a_homing_error_is_found_at_its_motor() -> None:
    true = np.zeros((3, 14))
    true[1, INDEX["actuator_zero"]] = np.radians(0.5)
    found = calibrate(APPENDIX_4, measure(APPENDIX_4, true, 30, SIX))
    assert np.allclose(deviation_array(found.design), true, atol=1e-9)


@pytest.mark.slow
def test_angles_count_by_full_turns() -> None:
    data = measure(APPENDIX_4, random_deviations(0), 20, SIX, 1e-5)
    poses = data.poses + np.array([0, 0, 2 * np.pi, 0, 0, 0])
    found = calibrate(APPENDIX_4, replace(data, poses=poses))
    assert found.noise < 2e-5


@pytest.mark.slow
def test_combinations_are_named_by_their_leading_lengths() -> None:
    data = measure(APPENDIX_4, random_deviations(0), 30, SIX, 1e-5)
    first = calibrate(APPENDIX_4, data).combinations[0]
    text = describe(first)
    name = text.split()[1].split("(")[0]
    assert text.count("(") == 4
    leading = np.unravel_index(np.argmax(np.abs(first.weights)), (3, 14))
    assert name == "l_43"
    assert f"({leading[0] + 1})" in text


def test_too_few_or_unusable_measurements_are_refused() -> None:
    data = measure(APPENDIX_4, random_deviations(0), 10, FOUR)
    with pytest.raises(InvalidInput, match="at least 11 poses are needed, there are 10: 4 coord"):
        calibrate(APPENDIX_4, data)
    more = measure(APPENDIX_4, random_deviations(0), 10, SIX)
    with pytest.raises(InvalidInput, match="at least 8 poses are needed besides the 3 that are"):
        calibrate(APPENDIX_4, more, validate=0.3)
    with pytest.raises(InvalidInput, match=r"validate: a share from 0 to 0\.9"):
        calibrate(APPENDIX_4, more, validate=1.0)
    poses = more.poses.copy()
    poses[4, 3] = -3.0
    with pytest.raises(InvalidMeasurement, match=r"is 2\.\d* m away from what") as caught:
        calibrate(APPENDIX_4, replace(more, poses=poses))
    assert caught.value.index == 4
    assert caught.value.argument == "measured"
    assert str(caught.value).startswith("measured: ")
    poses[4, 3] = np.nan
    with pytest.raises(InvalidInput, match="poses: finite numbers"):
        Measurements(more.actuators, poses)
    with pytest.raises(InvalidInput, match="poses are needed"):
        Measurements(more.actuators[:4], more.poses)
    rows: Any = [[0, 0, 0, 1], [0, 1, 0, 1]]
    for values in (Measurements(rows, rows).actuators, Measurements(rows, rows).poses):
        assert values.dtype == np.float64
        assert values.tolist() == rows


def candidates6(poses: Any) -> Any:
    """Return level poses (n, 4) with their tilt of zero, (n, 6)."""
    return np.concatenate([poses, np.zeros((len(poses), 2))], axis=-1)


@pytest.mark.parametrize("knee", list(KneeBranch))
@pytest.mark.parametrize("coordinates", [4, 6])
def test_proposed_poses_are_home_s_side_and_clear_of_limits(
    knee: KneeBranch, coordinates: int
) -> None:
    design = APPENDIX_4.with_knee(knee)
    geometry = design.geometry
    poses = measuring_poses(design, 12, coordinates=coordinates, seed=3)
    home = np.array(home_pose(geometry))
    height = poses[:, 3] + geometry.platform_joint_height
    assert (np.sign(height) == np.sign(home[3] + geometry.platform_joint_height)).all()
    reach = check_reach(geometry, poses)
    assert reach.ok.all()
    assert reach.margins.min() > 0.05 * geometry.base_radius
    found, start = measure_singularity(geometry, poses), measure_singularity(geometry, home)
    assert (found.condition < 10).all()
    assert (np.sign(found.determinant) == np.sign(start.determinant)).all()
    # they are spread: all of the heights and headings are seen
    assert np.ptp(poses[:, 2]) > 1.0
    assert np.ptp(poses[:, 3]) > 0.2


def test_poses_are_drawn_in_twenty_rounds_before_it_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    place = "paminsa_viz.precision.calibration_problem"
    drawn: list[int] = []

    def one_more(geometry: Any, poses: Any) -> Any:
        drawn.append(len(poses))
        return measure_singularity(geometry, poses)

    monkeypatch.setattr(f"{place}._DRAWN", 10)
    monkeypatch.setattr(f"{place}.measure_singularity", one_more)
    with pytest.raises(InvalidInput, match="of 800 poses found") as caught:
        measuring_poses(APPENDIX_4, 5)
    assert [count for count in drawn if count == 10] == [10] * 20
    found = int(str(caught.value).partition("only ")[2].split()[0])
    assert len(_candidates(APPENDIX_4, found, 0)) == found  # just enough


@pytest.mark.slow
def test_proposed_poses_show_more_than_random_ones() -> None:
    design = APPENDIX_4
    chosen = measuring_poses(design, 20)
    assert np.array_equal(chosen, measuring_poses(design, 20))
    assert np.array_equal(chosen[:10], measuring_poses(design, 10))
    assert check_reach(design.geometry, chosen).ok.all()
    assert len(np.unique(chosen, axis=0)) == 20
    # those that show most one by one are too much alike
    candidates = measuring_poses(design, 150)
    actuators = inverse_kinematics(design.geometry, candidates).actuators
    rows = CalibrationProblem(design, Measurements(actuators, candidates6(candidates))).equal_legs()
    left = np.linalg.svd(rows, full_matrices=False)[0][:, :30].reshape(150, -1, 30)
    leverage = (left**2).sum(axis=(1, 2))

    def information(of: Any) -> float:
        picked = left[of].reshape(-1, 30)
        return float(np.linalg.slogdet(picked.T @ picked)[1])

    assert information(np.arange(20)) > information(np.argsort(-leverage)[:20]) + 1
    random = random_poses(np.random.default_rng(0), design, 20)
    widths = []
    for poses in (chosen, random):
        actuators = inverse_kinematics(design.geometry, poses).actuators
        true = random_deviations(5, 3e-4)
        exact = predict(design, true, Measurements(actuators, poses)).coordinates
        noise = np.random.default_rng(1).normal(size=exact.shape) * 1e-5
        data = Measurements(actuators, exact + noise / coordinate_scales(design))
        found = calibrate(design, data)
        widths.append([item.half_width for item in found.combinations[:30]])
    assert (np.array(widths[0]) < np.array(widths[1])).mean() > 0.9
    for options in ({"poses": 0}, {"poses": 1001}, {"poses": 5, "coordinates": 5}):
        with pytest.raises(InvalidInput, match="are possible"):
            measuring_poses(design, **options)


def test_rotations_become_theta_and_tilt() -> None:
    random = np.random.default_rng(0)
    theta = random.uniform(-3.1, 3.1, 50)
    tilt = random.uniform(-0.8, 0.8, (50, 2))
    tilt[0] = 0.0
    turned = Rotation.from_rotvec(np.concatenate([tilt, np.zeros((50, 1))], axis=-1))
    matrices = (Rotation.from_euler("z", theta[:, None]) * turned).as_matrix()
    found = rotation_coordinates(matrices)
    assert np.allclose(found, np.concatenate([theta[:, None], tilt], axis=-1), atol=1e-12)
    sheared = np.eye(3) + np.array([[0.0, 1e-6, 0.0], [0.0] * 3, [0.0] * 3])
    np.testing.assert_allclose(
        rotation_coordinates(0.05 * np.eye(3) + 0.95 * sheared), 0, atol=1e-6
    )
    more = 1.05 * sheared - 0.05 * np.eye(3)  # axes off by more than a millionth
    for wrong in (np.eye(2), 2 * np.eye(3), np.diag([1.0, 1.0, -1.0]), more):
        with pytest.raises(InvalidInput, match="rotation matrices"):
            rotation_coordinates(wrong)
