"""Plans of a calibration: what they promise is what calibrations of simulated robots find."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, check_reach, inverse_kinematics
from paminsa_viz.precision.calibration import _ROUNDS, calibrate
from paminsa_viz.precision.calibration_plan import plan_calibration
from paminsa_viz.precision.leg_lengths import deviation_array, with_deviations
from paminsa_viz.precision.measurements import InvalidMeasurement, predict, simulated_measurements
from paminsa_viz.progress import Canceled

NOISE = 2e-5


@pytest.mark.slow
@pytest.mark.parametrize(("width", "rank"), [(6, 30), (4, 28)])
def test_a_plan_promises_the_intervals_that_equal_legs_have(width: int, rank: int) -> None:
    plan = plan_calibration(APPENDIX_4, 40, coordinates=width, noise=NOISE)
    asked = plan.measurements
    assert asked.poses.shape == (40, width)
    assert check_reach(APPENDIX_4.geometry, asked.poses[:, :4]).ok.all()
    assert (asked.poses[:, 4:] == 0).all()
    readings = inverse_kinematics(APPENDIX_4.geometry, asked.poses[:, :4]).actuators
    np.testing.assert_array_equal(asked.actuators, readings)
    assert len(plan.half_widths) == rank
    # legs that are off by nothing: the calibration's first fit is of the same combinations
    found = calibrate(APPENDIX_4, simulated_measurements(APPENDIX_4, asked, size=0.0, noise=NOISE))
    promised = plan.half_widths * found.noise / NOISE
    measured = [item.half_width for item in found.combinations]
    common = min(len(measured), rank)
    np.testing.assert_allclose(measured[:common], promised[:common], rtol=0.02)


@pytest.mark.slow
def test_lengths_that_show_by_themselves_have_a_deviation_and_it_is_met() -> None:
    plan = plan_calibration(APPENDIX_4, 60, noise=NOISE)
    assert np.isfinite(plan.standard_deviations).tolist() == plan.determined.tolist()
    assert 0 < plan.determined.sum() < 42
    known = plan.determined
    misses = []
    for seed in range(5):
        data = simulated_measurements(
            APPENDIX_4, plan.measurements, size=1e-6, noise=NOISE, seed=seed
        )
        error = deviation_array(calibrate(APPENDIX_4, data).design)
        misses.append(error[known] / plan.standard_deviations[known])
    spread = float(np.sqrt(np.mean(np.square(misses))))
    assert 0.8 < spread < 1.25


@pytest.mark.slow
def test_a_better_device_and_more_poses_tell_more() -> None:
    one = plan_calibration(APPENDIX_4, 20, noise=NOISE)
    better = plan_calibration(APPENDIX_4, 20, noise=NOISE / 2)
    more = plan_calibration(APPENDIX_4, 60, noise=NOISE)
    np.testing.assert_allclose(better.half_widths, one.half_widths / 2)
    assert (more.half_widths < one.half_widths).all()


@pytest.mark.slow
def test_a_plan_can_be_ended_and_a_calibration_too() -> None:
    done: list[float] = []

    def end(part: float, **known: object) -> bool:
        done.append(part)
        return part > 0.4

    with pytest.raises(Canceled):
        plan_calibration(APPENDIX_4, 20, progress=end)
    assert done == [index / 20 for index in range(10)]
    asked = plan_calibration(APPENDIX_4, 20).measurements
    data = simulated_measurements(APPENDIX_4, asked)
    done.clear()
    with pytest.raises(Canceled):
        calibrate(APPENDIX_4, data, progress=end)
    assert done == sorted(done)
    assert done[0] == 0.0
    assert 0.4 < done[-1] < 1.0
    fits = [part * (1 + _ROUNDS) for part in sorted(set(done))]
    assert fits == pytest.approx(range(len(fits)))


@pytest.mark.slow
def test_residuals_are_of_the_measured_poses_in_their_order() -> None:
    asked = plan_calibration(APPENDIX_4, 30).measurements
    data = simulated_measurements(APPENDIX_4, asked, seed=3)
    found = calibrate(APPENDIX_4, data, validate=0.2, seed=4)
    assert found.held.sum() == found.after_held.poses == 6
    for lengths, residuals, all_of in (
        (deviation_array(found.start), found.residuals_before, (found.before, found.before_held)),
        (deviation_array(found.design), found.residuals_after, (found.after, found.after_held)),
    ):
        expected = predict(APPENDIX_4, lengths, data).coordinates - data.poses
        np.testing.assert_allclose(residuals, expected, atol=1e-14)
        for part, errors in zip((~found.held, found.held), all_of, strict=True):
            rms = np.sqrt((expected[part] ** 2).mean(axis=0))
            np.testing.assert_allclose(errors.rms, rms, rtol=1e-12)
    assert np.isfinite(found.standard_deviations).tolist() == found.determined.tolist()


@pytest.mark.slow
def test_simulated_measurements_are_off_as_stated() -> None:
    asked = plan_calibration(APPENDIX_4, 30, coordinates=4).measurements
    own = with_deviations(APPENDIX_4, np.full((3, 14), 1e-4))
    exact = simulated_measurements(own, asked, size=0.0, noise=0.0)
    wanted = predict(APPENDIX_4, deviation_array(own), asked).coordinates[:, :4]
    np.testing.assert_allclose(exact.poses, wanted, atol=1e-15)
    noisy = simulated_measurements(own, asked, size=0.0, noise=NOISE)
    drawn = np.random.default_rng(0)
    drawn.uniform(size=(3, 14))  # the lengths come first
    scale = NOISE / np.array([1.0, 1.0, 0.1, 1.0, 0.1, 0.1])  # angles by R_pl
    error = (drawn.standard_normal((30, 6)) * scale)[:, :4]
    np.testing.assert_allclose(noisy.poses - exact.poses, error, atol=1e-14)
    asked = plan_calibration(APPENDIX_4, 20).measurements
    assert len(simulated_measurements(APPENDIX_4, asked)) == 19  # one is nearly singular
    with pytest.raises(InvalidMeasurement, match="legs off by up to 10 m"):
        simulated_measurements(APPENDIX_4, asked, size=10.0)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ({"poses": 7}, "at least 8 poses"), ({"poses": 10, "coordinates": 4}, "at least 11 poses"),
        ({"poses": 0}, "1 to 1000"), ({"poses": 20, "noise": 0.0}, "above 0"),
        ({"poses": 20, "coordinates": 5}, "4 or 6"),
    ],
    ids=str,
)  # fmt: skip
def test_impossible_plans_are_refused(words, problem) -> None:
    with pytest.raises(InvalidInput, match=problem):
        plan_calibration(APPENDIX_4, **words)
