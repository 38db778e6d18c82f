"""An answer as a whole: built within tolerances, in MuJoCo, with springs and motions."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from paminsa_viz.balancing import SpringPlace, at_joint, on_slider
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import Regime, RegimeState, SynthesisCase, SynthesisResult, synthesize
from paminsa_viz.synthesis.answer.checks import AnswerMargins, build_yield
from paminsa_viz.synthesis.answer.engine_check import check_by_mujoco
from paminsa_viz.trajectory import Trajectory
from tests.synthesis.test_inner_search import NUMBERS, looser
from tests.synthesis.test_prices import one_length


def answer(case: SynthesisCase) -> SynthesisResult:
    """Return the answer with the lengths of `NUMBERS`, as if a search had ended there."""
    best = tuple(NUMBERS[0].tolist())
    state = RegimeState(Regime.SMALLER, 200, 1, (best,) * 5, best, (1.0,), True)
    return synthesize(replace(case, regimes=(Regime.SMALLER,)), states=(state,))


@cache
def sprung_answer() -> SynthesisResult:
    """Return the answer of `sprung`."""
    return answer(sprung())


def sprung() -> SynthesisCase:
    """Return the arch with a spring, a bound on torque at rest, and few samples."""
    case = looser()
    motion = case.inner.motions[0].take(np.arange(0, case.inner.motions[0].size, 40))
    inner = replace(
        case.inner, motions=(motion,), motion_torque=20.0,
        springs=(SpringPlace(on_slider(0.2), at_joint(9), 2000.0, 0.0, 0.2),),
    )  # fmt: skip
    bounds = (*case.requirements.bounds, Requirement("max_torque", high=0.4))
    return replace(case, inner=inner, requirements=replace(case.requirements, bounds=bounds))


@pytest.mark.slow
def test_a_bound_that_is_reached_is_broken_by_half_of_the_robots():
    # the crank is as short as the reach allows: with no margin about every second is too short
    answers = [synthesize(one_length(margin=margin)) for margin in (0.0, 0.005)]
    found = [
        build_yield(answer.design, AnswerMargins.of(answer), samples=60).fraction
        for answer in answers
    ]
    assert 0.2 < found[0].value < 0.8
    assert found[1].value == 1.0
    assert found[1].low > 0.9


def test_margins_count_springs_and_motions():
    result = sprung_answer()
    assert result.feasible
    assert result.inner is not None
    asked = AnswerMargins.of(result)
    margins = asked(result.design)
    names = list(margins)
    assert any("F" in name and "300" in name for name in names)
    # the spring's share: without it the bound at rest is broken
    plain = replace(asked, springs=())(result.design)
    (torque,) = [name for name in names if "max" in name and "0.4" in name]
    assert margins[torque] >= -1e-6
    assert plain[torque] < -0.5
    motion = [name for name in names if name.startswith("torque of M1-M3")]
    assert margins[motion[0]] == pytest.approx(20.0 - result.objective, rel=1e-6)
    far = replace(asked.motions[0], pose=asked.motions[0].pose + np.array([0.5, 0.0, 0.0, 0.0]))
    beyond = replace(asked, motions=(far,))(result.design)
    assert beyond[f"run {far.name}"] == -np.inf
    assert isinstance(far, Trajectory)


def test_mujoco_confirms_an_answer_with_springs_and_motions():
    result = sprung_answer()
    asked = AnswerMargins.of(result)
    checked = check_by_mujoco(result.design, asked)
    assert checked.passed
    assert checked.left_out == ("condition",)
    assert len(checked.rows) == 4
    heavier = replace(result.design, links=replace(result.design.links, b8=5.0))
    assert not check_by_mujoco(heavier, asked).passed


@pytest.mark.slow
def test_built_robots_miss_what_the_answer_reaches():
    result = sprung_answer()
    found = build_yield(result.design, AnswerMargins.of(result), samples=20, seed=1)
    assert 0 < found.fraction.value < 1
    assert any("0.4" in name for name in found.missed)
