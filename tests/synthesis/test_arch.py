"""Worked case (c): the arch's answer as the documentation has it, and robots near it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.synthesis import Density, Regime
from paminsa_viz.synthesis.search.evaluation import Evaluator
from paminsa_viz.trajectory import analyze, check_path
from paminsa_viz.trajectory.planners import arch, round_trip
from tests.synthesis.arch_case import arch_case

ANSWER = {
    "geometry.base_radius": 0.30932129119695545,
    "geometry.platform_radius": 0.08000053704497243,
    "geometry.magnification": 3.4132757918120165,
    "geometry.crank_length": 0.3706458785491439,
    "geometry.coupler_length": 0.2782969084830305,
    "workspace.z": -0.2335830537890331,
}
"""What ``paminsa-viz synthesize arch`` finds with seed 0."""


@pytest.mark.slow
def test_the_answer_holds_and_no_robot_near_it_is_better():
    case = arch_case()
    best = np.array([ANSWER[path] for path in case.paths])
    found = Evaluator(case, Regime.SMALLER, Density().finer(2)).evaluate(best[None])[0]
    assert found.feasible
    assert found.objective == pytest.approx(2.8951, abs=1e-3)
    assert found.trial.inner.gap < 1e-6
    # at 1 kHz, analyzed with the design: between 200 samples a second there is hardly more
    turn, z = np.radians(30.0), ANSWER["workspace.z"]
    start, goal = (-0.15, 0.0, -turn, z - 0.05), (0.15, 0.0, turn, z - 0.05)
    motion = round_trip(arch(start, goal, 0.1, 1.0)).sample()
    design = found.trial.design
    assert check_path(design.geometry, motion).ok
    torque = np.abs(analyze(design, motion).torque)
    assert torque[:, :3].max() == pytest.approx(found.objective, rel=1e-3)
    assert torque[:, 3].max() < 300.0 * (1 + 2e-4)
    evaluator = Evaluator(case, Regime.SMALLER)
    steps = np.concatenate([np.diag(side * np.abs(best)) for side in (-0.01, 0.01, 0.003)])
    low, high = case.bounds.T
    near = evaluator.evaluate(np.clip(best + steps, low, high))
    values = [item.objective for item in near if item.feasible]
    assert len(values) >= 4
    assert min(values) > 0.99 * found.objective


def test_the_force_of_m4_on_the_motion_is_a_limit():
    case = arch_case()
    best = np.array([[ANSWER[path] for path in case.paths]])
    tight = replace(case, inner=replace(case.inner, motion_force=250.0))
    assert not Evaluator(tight, Regime.SMALLER).evaluate(best)[0].feasible
