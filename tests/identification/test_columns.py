"""The columns that are fitted, and the sizes that intervals are measured by, by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.identification import (
    IdentificationSettings,
    base_parameters,
    columns,
    identity_row,
)
from paminsa_viz.identification.columns import base_scale, fit_model
from paminsa_viz.model import APPENDIX_4
from tests.support.samples import random_design

QUICK = IdentificationSettings(robustness=False)


def test_sizes_of_base_parameters_are_those_of_what_they_are_made_of() -> None:
    """M_p2 by the terms of the identity, products by the masses they couple, others their own."""
    for design in (APPENDIX_4, random_design(np.random.default_rng(3))):
        b, scale = np.abs(base_parameters(design)), base_scale(design)
        row = identity_row(design.geometry, design.gravity)
        assert scale[1] == pytest.approx(np.abs(row * b)[2:5].max())
        assert scale[[3, 4]] == pytest.approx([np.sqrt(b[2] * b[5]), np.sqrt(b[2] * b[6])])
        # the sixth of the platform's mass is at each leg: all of it at the radius of joints 5
        assert scale[10] == pytest.approx(6 * b[5] * design.geometry.platform_radius**2)
        own = [0, 2, 5, 6, 7, 8, 9]
        np.testing.assert_allclose(scale[own], b[own])


def test_columns_and_reports_of_actuators_and_legs_by_hand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A signal of each actuator's own; rotors against that of M3, legs against leg 3.

    What is reported of a rotor or leg is how it differs from the mean of all three.
    """
    rng = np.random.default_rng(2)
    speed, sign, growth, torque = rng.normal(size=(4, 6, 4)) * [1.0, 2.0, 3.0, 9.0]
    speed[:, 2] = 0.0  # it does not turn
    legs, rows = rng.normal(size=(6, 4, 3, 8)), rng.normal(size=(6, 4, 11))
    samples = SimpleNamespace(
        pose=None, velocity=None, acceleration=None, speed=speed, sign=sign, growth=growth
    )
    signals: Any = SimpleNamespace(samples=samples, torque=torque, smooth=np.asarray)
    monkeypatch.setattr(columns, "base_regressor", lambda *_: rows)
    monkeypatch.setattr(columns, "leg_base_regressor", lambda *_: legs)
    found = fit_model(APPENDIX_4, signals, replace(QUICK, rotors=True, legs=True))
    one = np.eye(4)
    expected = [rows, speed[..., None] * one, sign[..., None] * one]
    expected.append(np.broadcast_to(one[:, :3], (6, 4, 3)))
    expected.append(np.stack([growth * (one[i] - one[2]) for i in range(2)], axis=-1))
    expected += [legs[:, :, i] - legs[:, :, 2] for i in range(2)]
    np.testing.assert_allclose(found.columns, np.concatenate(expected, axis=-1), rtol=1e-12)
    parts = np.eye(8) * np.array([[1, 0], [0, 1], [-1, -1]])[:, :, None, None]
    np.testing.assert_array_equal(found.report[24:, 24:], np.block([[*row] for row in parts]))
    np.testing.assert_array_equal(found.report[:24, :24], np.eye(24))
    assert not found.report[:24, 24:].any()
    assert not found.report[24:, :24].any()
    units = ["N m s/rad"] * 3 + ["N s/m"] + ["N m"] * 3 + ["N"] + ["N m"] * 3 + ["kg m^2"] * 2
    assert [item.unit for item in found.parameters[11:24]] == units
    size = np.sqrt(np.mean(np.concatenate([speed, sign], axis=1) ** 2, axis=0))
    most = 0.1 * np.tile(torque.std(axis=0), 2) / np.where(size > 0, size, np.inf)
    assert [item.most for item in found.parameters[11:19]] == pytest.approx(most)


def test_columns_are_nothing_below_a_share_of_the_largest_torque(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each place by itself, over the parameter's size; of speeds that share of 1 rad/s or m/s."""
    rng, scale = np.random.default_rng(0), base_scale(APPENDIX_4)
    share = 1e-10 * np.array([0.95, 1.05])[rng.integers(0, 2, (4, 11))]
    wave = np.array([0.5, -1.0, 0.3])[:, None]
    rows = 4.0 * wave[..., None] * share / scale
    speed = wave * 1e-10 * np.array([0.95, 1.05, 1.0, 1.1])
    torque = np.tile(-4.0 * np.abs(wave), (1, 4))
    samples = SimpleNamespace(
        pose=None, velocity=None, acceleration=None, speed=speed, sign=speed, growth=speed
    )
    signals: Any = SimpleNamespace(samples=samples, torque=torque, smooth=np.asarray)
    monkeypatch.setattr(columns, "base_regressor", lambda *_: rows)
    settings = replace(QUICK, coulomb=False, offsets=False)
    found = fit_model(APPENDIX_4, signals, settings).columns
    np.testing.assert_array_equal(found[..., :11], np.where(share > 1e-10, rows, 0.0))
    kept = [False, True, False, True]
    expected = np.where(kept, speed, 0.0)[..., None] * np.eye(4)
    np.testing.assert_array_equal(found[..., 11:], expected)


@pytest.mark.parametrize("place", [2, 3, 4])
def test_the_size_of_the_second_weight_is_that_of_the_largest_term_of_the_identity(
    place: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    b = np.arange(1.0, 12.0)
    b[place] = -1e3
    monkeypatch.setattr(columns, "base_parameters", lambda _: b)
    row = identity_row(APPENDIX_4.geometry, APPENDIX_4.gravity)
    assert base_scale(APPENDIX_4)[1] == pytest.approx(abs(row[place] * b[place]))
