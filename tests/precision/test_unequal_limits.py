"""Unequal legs where there is no pose, and deviations that are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.files.design_file import read_design, write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import (
    APPENDIX_4,
    inverse_kinematics,
)
from paminsa_viz.model.accuracy import LENGTH_NAMES, LegDeviations
from paminsa_viz.precision.closure_equations import closure_equations
from paminsa_viz.precision.leg_lengths import (
    INDEX,
    LENGTHS,
    design_lengths,
    deviation_array,
    nominal_lengths,
    with_deviations,
)
from paminsa_viz.precision.unequal_legs import (
    Closure,
    nominal_pose,
    sensitivities,
    solve_actuators,
    solve_pose,
)
from tests.precision.deviations import nominal_slopes, random_deviations, reasons
from tests.support.cases import BY_HAND


@pytest.mark.slow
def test_what_has_no_solution_says_why() -> None:
    g = APPENDIX_4.geometry
    pose = BY_HAND[0]
    actuators = inverse_kinematics(g, pose).actuators
    lengths = np.stack([nominal_lengths(g)] * 4)
    lengths[1, 0, INDEX["bar_89"]] = np.nan
    lengths[2, 0, INDEX["bar_89"]] = 2.0
    lengths[3, 2, INDEX["bar_43"]] = 2.0
    found = solve_pose(g, lengths, actuators, pose)
    assert reasons(found) == [Closure.OK, Closure.NOT_FINITE, Closure.OPEN, Closure.OPEN]
    assert np.isnan(found.coordinates[1:]).all()
    assert np.isnan(found.actuators[1:]).all()
    assert all(reason.reason() for reason in Closure)


def test_no_number_at_a_singular_pose() -> None:
    """On the singular circle of theta = 0, |(x, y)| = R_b - R_pl, the platform is loose."""
    g = APPENDIX_4.geometry
    radius = g.base_radius - g.platform_radius
    pose = np.array([0.6 * radius, 0.8 * radius, 0.0, -0.5])
    found = solve_pose(g, nominal_lengths(g), inverse_kinematics(g, pose).actuators, pose)
    loose = nominal_slopes(g, pose)
    assert np.isnan(loose.lengths).all()
    assert np.isnan(loose.actuators).all()
    assert reasons(found) == [Closure.SINGULAR]
    # Beside it deviations decide whether there is an assembly, often far away: all are exact, on
    # the nominal robot's side of the locus, or none.
    near = pose * [1 - 1e-9, 1 - 1e-9, 1, 1]
    lengths = nominal_lengths(g) + random_deviations(0, 1e-3, 50)
    actuators = inverse_kinematics(g, near).actuators
    bad = solve_pose(g, lengths, actuators, near)
    assert 10 < bad.ok.sum() < 40
    assert np.isnan(bad.pose[~bad.ok]).all()
    state = np.concatenate([bad.coordinates, bad.slides, bad.actuators], axis=-1)[bad.ok]
    closed = closure_equations(lengths[bad.ok], state, g.knee.sign)
    assert np.abs(closed.gap).max() < 1e-12
    sides = np.linalg.slogdet(closed.by_state[:, :, :9])[0]
    assert (sides == -1).all()  # as inside the circle for all |theta| < 73 degrees


def test_an_unreachable_pose_has_no_sensitivities() -> None:
    g = APPENDIX_4.geometry
    assert np.isnan(nominal_slopes(g, [0, 0, 0, -3.0]).lengths).all()
    found = solve_actuators(g, nominal_lengths(g), [0, 0, 0, -3.0])
    assert reasons(found) == [Closure.OPEN]


def test_deviations_and_arrays_are_the_same_numbers() -> None:
    values = random_deviations(0, 1e-3)
    design = with_deviations(APPENDIX_4, values)
    assert np.array_equal(deviation_array(design), values)
    assert design.leg3.guide_height == values[2, INDEX["guide_height"]]
    assert design.value("leg2.bar_94") == values[1, 0]
    assert not deviation_array(APPENDIX_4).any()
    assert np.array_equal(design_lengths(design), nominal_lengths(APPENDIX_4.geometry) + values)
    assert [item.name for item in LENGTHS] == list(LENGTH_NAMES)
    assert APPENDIX_4.leg1.zero
    assert not design.leg1.zero
    assert with_deviations(design, np.zeros((3, 14))) == APPENDIX_4


def test_design_files_hold_deviations_and_tolerances() -> None:
    design = with_deviations(APPENDIX_4, random_deviations(1, 1e-3))
    design = design.vary({"tolerances.bar": 1e-5, "leg2.shaft": 0.0})
    text = write_design(design)
    assert read_design(text, "robot.toml") == design
    assert "[leg1]" in text
    assert "bar_m = 1e-05" in text
    assert "shaft_clearance" not in text
    plain = write_design(APPENDIX_4)
    assert not any(f"[{table}]" in plain for table in ("leg1", "leg2", "leg3", "tolerances"))
    with pytest.raises(
        DesignFileError, match=r"line 3, \[leg2\] bar_94_m = 1000000000.0: .* at most 100"
    ):
        read_design("schema_version = 1\n[leg2]\nbar_94_m = 1e9\n", "robot.toml")


def test_deviations_of_any_leg_are_taken_as_those_of_a_leg() -> None:
    off = APPENDIX_4.vary({"leg1.bar_94": 1e-4})
    assert replace(APPENDIX_4, leg1=LegDeviations(bar_94=1e-4)) == off
    assert replace(APPENDIX_4, leg2=off.leg1) == APPENDIX_4.vary({"leg2.bar_94": 1e-4})
    with pytest.raises(InvalidDesign, match=r"leg3 = .* a LegDeviations is needed"):
        replace(APPENDIX_4, leg3=0.1)  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", [(14,), (2, 14), (3, 13), (5, 3, 13)], ids=str)
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(InvalidInput, match="3 legs and 14 lengths"):
        solve_pose(APPENDIX_4.geometry, np.zeros(shape), np.zeros(4), np.zeros(4))


def test_bad_deviations_are_refused() -> None:
    with pytest.raises(InvalidDesign, match="bar_94 = nan"):
        LegDeviations(bar_94=float("nan"))
    with pytest.raises(InvalidDesign, match="at most 100 in size"):
        with_deviations(APPENDIX_4, np.full((3, 14), 200.0))
    with pytest.raises(InvalidInput, match="batch shapes"):
        solve_pose(APPENDIX_4.geometry, np.zeros((5, 3, 14)), np.zeros((4, 4)), np.zeros(4))


@pytest.mark.slow
def test_batches_of_lengths_and_poses_are_solved_one_by_one() -> None:
    """With one that cannot be closed among them; sensitivities as well."""
    g = APPENDIX_4.geometry
    poses = BY_HAND[:3]
    actuators = inverse_kinematics(g, poses).actuators
    lengths = nominal_lengths(g) + random_deviations(2, 1e-3, 2, 1)
    lengths[1, 0, 2, INDEX["bar_43"]] = 2.0
    forward, back = (
        solve_pose(g, lengths, actuators, poses), solve_actuators(g, lengths, poses)
    )  # fmt: skip
    slopes = sensitivities(g, lengths, forward)
    assert forward.status.tolist() == [[Closure.OK] * 3, [Closure.OPEN] * 3]
    assert (slopes.lengths.shape, slopes.actuators.shape) == ((2, 3, 6, 3, 14), (2, 3, 6, 4))
    for lost in (forward.coordinates, forward.actuators, back.actuators, slopes.lengths):
        assert np.isnan(lost[1]).all()
    for column in range(3):
        here = lengths[0, 0], actuators[column], poses[column]
        one = solve_pose(g, *here)
        assert one.status.shape == ()
        same = sensitivities(g, lengths[0, 0], one)
        pairs = [
            (one.pose, forward.pose), (one.tilt, forward.tilt), (one.slides, forward.slides),
            (one.actuators, forward.actuators), (one.coordinates, forward.coordinates),
            (same.lengths, slopes.lengths), (same.actuators, slopes.actuators),
            (solve_actuators(g, here[0], here[2]).actuators, back.actuators),
        ]  # fmt: skip
        for single, batch in pairs:
            np.testing.assert_allclose(single, batch[0, column], rtol=1e-9, atol=1e-12)


def test_inputs_that_are_no_numbers_are_told_from_bars_that_cannot_close() -> None:
    g = APPENDIX_4.geometry
    lost = np.array([BY_HAND[0], [np.nan, 0.0, 0.0, -0.5], [np.inf, 0.0, 0.0, -0.5]])
    far = np.array([[0.0, 0.0, 0.0, -3.0], [0.3, 0.0, 0.0, -0.85]])  # for all legs, and for one
    for found in (nominal_pose(g, np.concatenate([lost, far])),
                  solve_actuators(g, nominal_lengths(g), np.concatenate([lost, far]))):  # fmt: skip
        assert reasons(found) == [
            Closure.OK, Closure.NOT_FINITE, Closure.NOT_FINITE, Closure.OPEN, Closure.OPEN,
        ]  # fmt: skip
        for rows in (found.pose, found.tilt, found.slides, found.actuators):
            np.testing.assert_array_equal(np.isnan(rows).any(axis=-1), [False, *[True] * 4])
    actuators = inverse_kinematics(g, BY_HAND[0]).actuators
    for column in range(4):
        wrong = actuators.copy()
        wrong[column] = np.nan
        assert reasons(solve_pose(g, nominal_lengths(g), wrong, BY_HAND[0])) == [Closure.NOT_FINITE]
