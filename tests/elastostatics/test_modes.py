"""The eigenproblem of small vibrations, and its matrices against those of MuJoCo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.elastostatics.drive_stiffness import drive_matrix, drive_modes
from paminsa_viz.elastostatics.modes import natural_modes
from paminsa_viz.model import APPENDIX_4, LoadCase, LoadFrame
from paminsa_viz.model.drive import Drive
from tests.elastostatics.linearized import linearized
from tests.support import samples

seeds = st.integers(0, 2**32 - 1)


def matrices(seed: int, size: int, count: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Draw positive definite stiffness and mass matrices (count, size, size)."""
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(2, count, size, size))
    eye = 0.1 * np.eye(size)
    return 1e5 * roots[0] @ np.swapaxes(roots[0], 1, 2) + eye, roots[1] @ np.swapaxes(
        roots[1], 1, 2
    ) + eye


@given(seed=seeds, size=st.integers(1, 7))
def test_modes_solve_the_generalized_eigenproblem(seed: int, size: int) -> None:
    k, m = matrices(seed, size)
    found = natural_modes(k, m)
    assert found.ok.all()
    for i in range(len(k)):
        expected = scipy.linalg.eigh(k[i], m[i], eigvals_only=True)
        assert (2 * np.pi * found.frequencies[i]) ** 2 == pytest.approx(expected, rel=1e-6)
        shapes = found.shapes[i]
        assert shapes.T @ m[i] @ shapes == pytest.approx(np.eye(size), abs=1e-7)
        energy = np.diagonal(shapes.T @ k[i] @ shapes)
        assert energy == pytest.approx((2 * np.pi * found.frequencies[i]) ** 2, rel=1e-6)


def test_a_pose_without_stiffness_has_no_frequency() -> None:
    """Singular, soft in one direction, or unknown: NaN, and the other poses are not touched."""
    k, m = matrices(1, 4, 7)
    k[1] = k[1] - np.linalg.eigvalsh(k[1])[0] * np.eye(4)  # singular
    k[2, 0, 0] = -1.0
    k[3, 1, 2] = np.nan
    m[4, 1, 2] = np.nan
    k[5, 0] = k[5, :, 0] = 0.0
    found = natural_modes(k, m)
    assert found.ok.tolist() == [True, False, False, False, False, False, True]
    assert np.isnan(found.frequencies[1:6]).all()
    assert np.isnan(found.shapes[1:6]).all()
    assert np.isfinite(found.frequencies[[0, 6]]).all()


def test_a_stiffness_has_to_be_more_than_rounding_in_every_unit() -> None:
    """Of two coordinates in which alike springs of unit stiffness all but cancel: 1e-11 of it."""
    for share, firm in ((0.99e-11, False), (1.01e-11, True)):
        k = np.array([[1.0, share - 1.0], [share - 1.0, 1.0]])
        units = 1e-4 ** np.arange(2)
        for scale in (np.ones((2, 2)), np.outer(units, units)):
            assert bool(natural_modes(k * scale, np.eye(2) * scale).ok) is firm


def test_batches_of_any_shape_give_the_modes_of_each() -> None:
    k, m = matrices(3, 4, 6)
    flat, found = natural_modes(k, m), natural_modes(k.reshape(2, 3, 4, 4), m.reshape(2, 3, 4, 4))
    np.testing.assert_array_equal(found.frequencies, flat.frequencies.reshape(2, 3, 4))
    np.testing.assert_array_equal(found.shapes, flat.shapes.reshape(2, 3, 4, 4))


def test_the_lowest_modes_alone_are_those_of_all() -> None:
    k, m = matrices(2, 6)
    few, every = natural_modes(k, m, 2), natural_modes(k, m)
    assert few.frequencies.tolist() == every.frequencies[:, :2].tolist()
    assert few.shapes.shape == (3, 6, 2)


def test_a_coordinate_without_mass_has_an_infinite_frequency() -> None:
    found = natural_modes(np.diag([4.0, 9.0]), np.diag([1.0, 0.0]))
    assert found.frequencies.tolist() == [pytest.approx(2 / (2 * np.pi)), np.inf]


@pytest.mark.slow
@pytest.mark.parametrize("frame", list(LoadFrame))
def test_drives_alone_vibrate_as_mujoco_does(frame: LoadFrame) -> None:
    """Springs at the actuators of MuJoCo's model, which hold weight and load."""
    pytest.importorskip("mujoco")
    rng = np.random.default_rng(7)
    load = LoadCase(12.0, -7.0, -30.0, moment_z=1.5, point_x=0.04, frame=frame)
    for design in (replace(APPENDIX_4, load=load), samples.random_design(rng)):
        springs = np.diagonal(drive_matrix(design))
        for pose in samples.random_poses(rng, design, 3):
            stiffness, mass = linearized(design, pose, springs)
            expected = natural_modes(0.5 * (stiffness + stiffness.T), mass)
            found = drive_modes(design, pose)
            assert found.ok == expected.ok
            assert found.frequencies == pytest.approx(expected.frequencies, rel=1e-7, nan_ok=True)


def test_inertia_of_locked_motors_has_no_part() -> None:
    motor = Drive("servo", gear_ratio=100.0, rotor_inertia=1e-4)
    pose = np.array([0.02, -0.03, 0.2, -0.5])
    driven = replace(APPENDIX_4, drives=(motor, motor, motor, None))
    assert any(driven.drive_inertia)
    found = drive_modes(driven, pose).frequencies
    assert found.tolist() == drive_modes(APPENDIX_4, pose).frequencies.tolist()
