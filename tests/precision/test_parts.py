"""Rows and statistics of errors, deviations of designs, and what calibration takes by itself."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.precision import error_rows as rows
from paminsa_viz.precision.calibration import Calibration, calibrate, describe
from paminsa_viz.precision.calibration_plan import plan_calibration
from paminsa_viz.precision.calibration_problem import CalibrationProblem, measuring_poses
from paminsa_viz.precision.drive_errors import Bound
from paminsa_viz.precision.leg_lengths import (
    INDEX,
    LENGTHS,
    design_lengths,
    deviation_array,
    lengths_only,
    nominal_lengths,
    with_deviations,
)
from paminsa_viz.precision.measurements import (
    InvalidMeasurement,
    Measurements,
    errors_of,
    predict,
    prediction_errors,
    rotation_coordinates,
    simulated_measurements,
)


def errors(shape: tuple[int, ...]) -> Any:
    """Errors of poses of any batch shape, no two alike; a reason where there is no bound."""
    count = int(np.prod(shape, dtype=int))
    four = np.arange(1.0, 4.0 * count + 1).reshape(*shape, 4)
    one = np.arange(1.0, count + 1).reshape(shape)
    status = np.full(shape, Bound.OK, np.uint8)
    status.ravel()[1::3] = Bound.SINGULARITY
    status.ravel()[2::3] = Bound.LIMIT
    return SimpleNamespace(
        worst=four, linear=100 + four, rms=1000 + four, horizontal=5000 + one,
        linear_horizontal=6000 + one, rms_horizontal=7000 + one, status=status,
    )  # fmt: skip


@pytest.mark.parametrize("shape", [(), (5,), (2, 3)])
def test_rows_of_errors_are_those_of_the_coordinates(shape: tuple[int, ...]) -> None:
    found = errors(shape)
    named = {row.name: row for row in rows.error_rows(found)}
    assert list(named) == ["x", "y", "xy", "z", "θ"]
    for name, place in (("x", 0), ("y", 1), ("z", 3), ("θ", 2)):
        for kind in rows.STATISTICS_OF:
            np.testing.assert_array_equal(
                getattr(named[name], kind), getattr(found, kind)[..., place].ravel()
            )
    for kind, part in (("worst", ""), ("linear", "linear_"), ("rms", "rms_")):
        plane = getattr(found, f"{part}horizontal")
        np.testing.assert_array_equal(getattr(named["xy"], kind), np.ravel(plane))
    assert [row.unit for row in named.values()] == ["m:um"] * 4 + ["rad:arcsec"]


def test_errors_over_a_region_are_those_of_its_poses(monkeypatch: pytest.MonkeyPatch) -> None:
    found = errors((4, 3))
    monkeypatch.setattr(rows, "field_drive_errors", lambda field, accuracy: found)
    here = np.zeros((4, 3), bool)
    here[0], here[2, 1], here[3, 0] = True, True, True
    over = rows.region_errors(None, None, here)  # type: ignore
    assert over.poses == 5
    np.testing.assert_array_equal(over.rows[3].linear, found.linear[..., 3][here])
    counts = {bound: int((found.status[here] == bound).sum()) for bound in Bound}
    assert over.unbounded == {Bound.SINGULARITY: 2, Bound.LIMIT: 1}
    assert counts[Bound.OK] == 2
    values = np.array([np.nan, 4.0, 1.0, 2.0, np.nan, 3.0])
    assert rows.statistics(values) == (2.5, pytest.approx(3.85), 4.0)
    assert np.isnan(rows.statistics(np.array([np.nan]))).all()


def test_deviations_of_a_design_and_its_lengths() -> None:
    values = np.random.default_rng(0).uniform(-1e-3, 1e-3, (3, len(LENGTHS)))
    heavy = APPENDIX_4.vary({"payload.mass": 2.0, "geometry.crank_length": 0.5})
    crooked = with_deviations(heavy, values)
    np.testing.assert_array_equal(deviation_array(crooked), values)
    assert crooked.payload == heavy.payload
    np.testing.assert_allclose(
        design_lengths(crooked), nominal_lengths(heavy.geometry) + values, rtol=1e-15
    )
    bare = lengths_only(crooked)
    assert bare.geometry == heavy.geometry
    assert bare.payload == APPENDIX_4.payload
    np.testing.assert_array_equal(deviation_array(bare), values)
    for wrong in (values[None], values[0], values[:2]):
        with pytest.raises(InvalidInput, match="14"):
            with_deviations(heavy, wrong)


@pytest.mark.parametrize("shape", [(), (6,), (2, 3), (3, 3)])
def test_rotations_of_any_batch_shape(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(1)
    count = int(np.prod(shape, dtype=int))
    theta, tilt = rng.uniform(-3.0, 3.0, count), rng.uniform(-0.5, 0.5, (count, 2))
    turned = Rotation.from_rotvec(np.column_stack([tilt, np.zeros(count)]))
    matrix = (Rotation.from_euler("z", theta[:, None]) * turned).as_matrix()
    found = rotation_coordinates(matrix.reshape(*shape, 3, 3))
    np.testing.assert_allclose(found, np.column_stack([theta, tilt]).reshape(*shape, 3), atol=1e-12)
    if count > 1:  # one that is none is enough
        for bad in (np.diag([1.0, 1.0, -1.0]), 1.001 * np.eye(3)):
            wrong = matrix.copy()
            wrong[1] = bad
            with pytest.raises(InvalidInput, match="rotation matrices"):
                rotation_coordinates(wrong.reshape(*shape, 3, 3))


def test_errors_of_residuals_by_hand() -> None:
    found = errors_of(np.array([[3.0, -1.0], [-4.0, 1.0]]))
    assert found.rms == pytest.approx([np.sqrt(12.5), 1.0])
    assert found.largest.tolist() == [4.0, 1.0]
    assert found.poses == 2
    none = errors_of(np.zeros((0, 6)))
    assert none.poses == 0
    assert none.rms.shape == none.largest.shape == (6,)
    assert np.isnan(none.rms).all()


def test_what_deviations_miss_measured_poses_by() -> None:
    asked = plan_calibration(APPENDIX_4, 12).measurements
    true = np.random.default_rng(2).uniform(-3e-4, 3e-4, (3, len(LENGTHS)))
    exact = predict(APPENDIX_4, true, asked).coordinates
    off = exact.copy()
    off[:, 1] += 2e-4
    off[3, 0] -= 5e-4
    found = prediction_errors(APPENDIX_4, true, Measurements(asked.actuators, off))
    assert found.rms[1] == pytest.approx(2e-4)
    assert found.largest[:2] == pytest.approx([5e-4, 2e-4])
    assert found.rms[0] == pytest.approx(5e-4 / np.sqrt(12))
    assert found.poses == 12


def test_poses_that_a_design_has_not_are_named() -> None:
    asked = plan_calibration(APPENDIX_4, 12).measurements
    problem = CalibrationProblem(APPENDIX_4, asked)
    actuators = asked.actuators.copy()
    actuators[4, 3] += 5.0
    lost = replace(asked, actuators=actuators)
    found = predict(APPENDIX_4, deviation_array(APPENDIX_4), lost)
    assert not found.ok[4]
    with pytest.raises(InvalidMeasurement, match="the design has no such pose") as caught:
        problem.require_near(found, lost)
    assert caught.value.index == 4


@pytest.mark.slow
def test_defaults_are_those_of_the_documentation() -> None:
    """Six coordinates, 20 µm; legs off by half a millimeter, measured to 10 µm; seed 0."""
    plan = plan_calibration(APPENDIX_4, 12)
    again = plan_calibration(APPENDIX_4, 12, coordinates=6, noise=2e-5, seed=0)
    assert plan.noise == 2e-5
    np.testing.assert_array_equal(plan.half_widths, again.half_widths)
    np.testing.assert_array_equal(
        plan.measurements.poses[:, :4], measuring_poses(APPENDIX_4, 12, coordinates=6, seed=0)
    )
    assert plan.measurements.poses.shape == (12, 6)
    assert not plan.measurements.poses[:, 4:].any()
    asked = plan.measurements
    drawn = simulated_measurements(APPENDIX_4, asked)
    same = simulated_measurements(APPENDIX_4, asked, size=5e-4, noise=1e-5, seed=0)
    np.testing.assert_array_equal(drawn.poses, same.poses)
    exact = simulated_measurements(APPENDIX_4, asked, noise=0.0)
    off = (drawn.poses - exact.poses)[:, [0, 1, 3]]
    assert off.std() == pytest.approx(1e-5, rel=0.4)


@pytest.mark.slow
def test_a_share_of_the_poses_is_held_back() -> None:
    asked = plan_calibration(APPENDIX_4, 24).measurements
    measured = simulated_measurements(APPENDIX_4, asked)
    whole = calibrate(APPENDIX_4, measured)
    assert not whole.held.any()
    assert whole.improved
    count = len(measured)
    assert (whole.before.poses, whole.before_held.poses) == (count, 0)
    part = calibrate(APPENDIX_4, measured, validate=0.25)
    assert part.held.sum() == round(0.25 * count)
    other = calibrate(APPENDIX_4, measured, validate=0.25, seed=1)
    assert (other.held != part.held).any()
    np.testing.assert_array_equal(
        part.held, calibrate(APPENDIX_4, measured, validate=0.25, seed=0).held
    )
    for wrong in (-0.01, 0.91, np.nan):
        with pytest.raises(InvalidInput, match=r"a share from 0 to 0\.9 is needed"):
            calibrate(APPENDIX_4, measured, validate=wrong)
    # nine tenths are possible, but leave too few
    with pytest.raises(InvalidInput) as caught:
        calibrate(APPENDIX_4, measured, validate=0.9)
    assert "a share from" not in str(caught.value)


def test_deviations_of_lengths_are_the_roots_of_their_variances() -> None:
    """Angles by the radius that turned them into lengths; none where a length is not told."""
    made: Any = Calibration.__new__(Calibration)
    weights = np.zeros((3, len(LENGTHS)))
    weights[0, INDEX["bar_94"]] = 1.0
    turned = np.zeros((3, len(LENGTHS)))
    turned[2, INDEX["axis_angle"]] = 1.0
    for name, value in (
        ("combinations", [SimpleNamespace(weights=one) for one in (weights, turned)]),
        ("covariance", np.diag(np.full(42, 4e-8))), ("start", APPENDIX_4),
    ):  # fmt: skip
        object.__setattr__(made, name, value)
    found = made.standard_deviations
    assert found[0, INDEX["bar_94"]] == pytest.approx(2e-4)
    assert found[2, INDEX["axis_angle"]] == pytest.approx(2e-4 / 0.35)
    assert np.isfinite(found).sum() == 2


def test_what_is_better_counts_angles_by_the_radius_of_the_platform() -> None:
    made: Any = Calibration.__new__(Calibration)
    object.__setattr__(made, "start", APPENDIX_4)

    def improved(old: list[float], new: list[float], held: bool = False) -> bool:
        pair = [SimpleNamespace(rms=np.array([*one, 0, 0, 0]), poses=9) for one in (old, new)]
        none = SimpleNamespace(rms=np.full(6, np.nan), poses=0)
        for name, one in (("before", pair[0]), ("after", pair[1])):
            object.__setattr__(made, name, none if held else one)
            object.__setattr__(made, f"{name}_held", one if held else none)
        return made.improved

    for held in (False, True):
        assert not improved([1.0, 0.0, 0.5], [1.1, 0.0, 0.0], held)
        assert improved([1.0, 0.0, 0.0], [0.9, 0.0, 1.0], held)
        assert improved([1.0, 0.0, 1.0], [1.0, 0.0, 0.9], held)
        assert not improved([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], held)


def test_a_combination_is_said_by_its_leading_lengths_with_their_signs() -> None:
    weights = np.zeros((3, len(LENGTHS)))
    weights[0, 0], weights[1, 2], weights[2, 1] = -0.7, 0.6, -0.3
    weights[0, 3], weights[1, 1] = 0.2, 0.1
    made: Any = SimpleNamespace(weights=weights)
    s = [one.symbol for one in LENGTHS]
    leading = f"-0.70 {s[0]}(1) + 0.60 {s[2]}(2) - 0.30 {s[1]}(3) + 0.20 {s[3]}(1)"
    assert describe(made) == leading
    assert describe(made, 1) == f"-0.70 {s[0]}(1)"
    made.weights = -weights
    assert describe(made, 2) == f"0.70 {s[0]}(1) - 0.60 {s[2]}(2)"
    made.weights = np.zeros((3, len(LENGTHS)))
    made.weights[0, 3] = 1.0
    assert describe(made, 2) == f"1.00 {s[3]}(1) + 0.00 {s[0]}(1)"
    equal = np.zeros((3, len(LENGTHS)))
    equal[2, 0] = equal[0, 1] = 0.5
    made.weights = equal
    assert describe(made, 2) == f"0.50 {s[1]}(1) + 0.50 {s[0]}(3)"
