"""Torques of an engine next to those of the formulas."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.engines.verification import verify
from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.plots.verified import engine_torques, verification_figures
from paminsa_viz.trajectory import Trajectory, analyze, paper_like

MOTION = paper_like(APPENDIX_4.geometry).lasting(0.4).sample(60)


def test_an_engine_draws_the_same_curve_with_friction_too() -> None:
    rubbing = APPENDIX_4.vary({"friction.coulomb_rotary": 0.3, "friction.viscous_linear": 5.0})
    analysis = analyze(rubbing, MOTION)
    found = engine_torques(analysis)
    assert found.name.startswith("MuJoCo ")
    np.testing.assert_allclose(found.torque, analysis.torque, rtol=0, atol=1e-11)
    plain = engine_torques(analyze(APPENDIX_4, MOTION))
    assert np.abs(plain.torque - found.torque).max() > 0.1


def test_where_the_motion_fails_there_is_no_torque() -> None:
    sinking = MOTION.pose - np.linspace(0, 0.6, MOTION.size)[:, None] * [0, 0, 0, 1]
    motion = Trajectory(MOTION.t, sinking, MOTION.velocity, MOTION.acceleration)
    analysis = analyze(APPENDIX_4, motion)
    found = engine_torques(analysis)
    assert np.array_equal(np.isnan(found.torque), np.isnan(analysis.torque))
    assert 0 < np.isnan(found.torque).sum() < found.torque.size


def test_engine_samples_are_limited() -> None:
    with pytest.raises(InvalidInput, match="at most 10 samples"):
        engine_torques(analyze(APPENDIX_4, MOTION), most=10)


@pytest.mark.slow
def test_a_verification_has_a_figure_for_each_engine_and_for_the_published_formulas() -> None:
    found = verify(APPENDIX_4, MOTION, poses=5, misprints=())
    figures = verification_figures(found)
    assert len(figures) == len(found.engines) + 1
    assert figures[0].stem == "formulas_mujoco"
    assert figures[-1].stem == "formulas_as_published_mujoco"
    for figure in figures:
        own, other = figure.data.panels[0].traces
        assert np.array_equal(other.values, found.engines[0].dynamic.reference[:, 0]) == (
            "mujoco" in figure.stem
        )
        apart = np.abs(own.values - other.values).max()
        assert (apart > 1e-3) == ("published" in figure.stem)
