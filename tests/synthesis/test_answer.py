"""Answers: margins, fractions of robots built within tolerances, and MuJoCo's opinion."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import SpringPlace, at_joint, on_slider
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Counterweight
from paminsa_viz.model.accuracy import NO_TOLERANCES, Tolerances
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.studies.executors import processes
from paminsa_viz.synthesis import Regime, RegimeState, SynthesisCase, SynthesisResult, synthesize
from paminsa_viz.synthesis.answer import checks
from paminsa_viz.synthesis.answer.checks import AnswerMargins, build_yield, built_robots, fraction
from paminsa_viz.synthesis.answer.engine_check import check_by_mujoco
from paminsa_viz.synthesis.masses.program import solve_inner
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.trajectory import Trajectory
from tests.synthesis.inner_cases import case, motion, poses
from tests.synthesis.test_prices import one_length
from tests.synthesis.test_search_masses import NUMBERS, looser


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


@pytest.mark.slow
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


@pytest.mark.slow
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


def crank_margin(design: Design) -> dict[str, float]:
    """Margin to a crank of at most 0.4201 m, and of at least 0.41985 m."""
    crank = design.geometry.crank_length
    return {"long": 0.4201 - crank, "short": crank - 0.41985}


@pytest.mark.parametrize("true", [0.02, 0.5, 0.9])
def test_interval_covers_a_known_part_as_often_as_it_says(true):
    n = 60
    rng = np.random.default_rng(1)
    found = [fraction(int(k), n, 0.9) for k in rng.binomial(n, true, 2000)]
    covered = np.mean([f.low <= true <= f.high for f in found])
    assert 0.9 - 0.02 <= covered <= 0.995


def test_interval_is_that_of_the_binomial_tails():
    from scipy.stats import binomtest

    for passed, samples in ((0, 10), (3, 17), (17, 17), (199, 400)):
        found = fraction(passed, samples, 0.95)
        reference = binomtest(passed, samples).proportion_ci(0.95, method="exact")
        assert (found.low, found.high) == pytest.approx((reference.low, reference.high), abs=1e-12)


@pytest.mark.slow
def test_yield_of_a_known_uniform_part():
    found = build_yield(APPENDIX_4, crank_margin, samples=500, seed=3)
    # +-0.2 mm, of which +0.1 mm and -0.15 mm are allowed: 5/8
    assert found.fraction.low <= 0.625 <= found.fraction.high
    assert list(found.missed) == ["long", "short"]
    assert sum(found.missed.values()) == 500 - found.fraction.passed
    assert found.worst["long"] == pytest.approx(-1e-4, abs=2e-6)


def test_same_seed_same_robots_wherever_they_are_measured():
    first = build_yield(APPENDIX_4, crank_margin, samples=40, seed=7)
    other = build_yield(APPENDIX_4, crank_margin, samples=40, seed=8)
    assert first.worst != other.worst
    with processes(1) as workers:
        assert build_yield(APPENDIX_4, crank_margin, samples=40, seed=7, workers=workers).worst == (
            first.worst
        )


def test_robots_are_within_their_tolerances():
    exact = replace(APPENDIX_4, tolerances=NO_TOLERANCES)
    (same,) = built_robots(exact, 1, mass_tolerance=0.0)
    for path in ("coupler_length", "magnification", "platform_joint_height"):
        name = f"geometry.{path}"
        assert same.value(name) == pytest.approx(APPENDIX_4.value(name), rel=1e-15)
    design = replace(
        APPENDIX_4,
        tolerances=Tolerances(bar=1e-3, guide_height=0.0, joint_height=5e-4),
        counterweights=(Counterweight("b8", 8, 0.1, 2.0),),
    )
    robots = built_robots(design, 300, mass_tolerance=0.1, seed=2)
    for path, nominal, most in (
        ("geometry.crank_length", 0.42, 1e-3), ("geometry.coupler_length", 0.63, 2e-3),
        ("geometry.platform_joint_height", 0.0275, 5e-4), ("geometry.base_radius", 0.35, 2e-4),
        ("counterweights.0.mass", 2.0, 0.2), ("links.b4", design.links.b4, 0.1 * design.links.b4),
    ):  # fmt: skip
        off = np.array([robot.value(path) - nominal for robot in robots])
        assert 0.9 * most < np.abs(off).max() <= most * (1 + 1e-9)
        assert off.min() < 0 < off.max()
    for robot in robots:
        ratio = robot.links.b4 / design.links.b4
        assert robot.inertias.b4_axial == pytest.approx(ratio * design.inertias.b4_axial)
        assert robot.payload == design.payload
        # B7 as drilled: joint 4 is at l_B4/k from 9
        part = robot.geometry.coupler_length / robot.geometry.magnification
        assert abs(part - 0.21) <= 1e-3 * (1 + 1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_draw_at_its_end_is_the_end_of_a_tolerance(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bar B4 has two parts, and a joint 5 its height in the platform and that of the guide."""

    class OneSided:
        def uniform(self, low: float, high: float, shape: Any) -> Any:
            return np.full(shape, high if side > 0 else low)

    monkeypatch.setattr(np.random, "default_rng", lambda seed: OneSided())
    own = Tolerances(
        bar=1e-3, shaft=2e-3, axis_radius=3e-3, joint_radius=4e-3, joint_height=5e-4,
        guide_height=7e-4,
    )  # fmt: skip
    (robot,) = built_robots(replace(APPENDIX_4, tolerances=own), 1, mass_tolerance=0.1)
    g, was = robot.geometry, APPENDIX_4.geometry
    expected = {
        "crank_length": 1e-3, "coupler_length": 2e-3, "shaft_length": 2e-3, "base_radius": 3e-3,
        "platform_radius": 4e-3, "platform_joint_height": 1.2e-3,
    }  # fmt: skip
    for name, most in expected.items():
        assert getattr(g, name) - getattr(was, name) == pytest.approx(side * most, rel=1e-9)
    assert robot.links.b4 == pytest.approx((1 + 0.1 * side) * APPENDIX_4.links.b4)


@pytest.mark.parametrize("index", range(8))
def test_each_draw_of_a_length_is_of_one_part(index: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Independent of all others: two parts of B4, five lengths, and two heights of joint 5."""

    class OneAtATime:
        def uniform(self, low: float, high: float, shape: Any) -> Any:
            return high * np.eye(8)[[index]] if shape[1] == 8 else np.zeros(shape)

    monkeypatch.setattr(np.random, "default_rng", lambda seed: OneAtATime())
    own = Tolerances(
        bar=1e-3, shaft=2e-3, axis_radius=3e-3, joint_radius=4e-3, joint_height=5e-4,
        guide_height=7e-4,
    )  # fmt: skip
    (robot,) = built_robots(replace(APPENDIX_4, tolerances=own), 1)

    def lengths(design: Design) -> Any:
        g = design.geometry
        upper = g.coupler_length / g.magnification
        return np.array([
            upper, g.coupler_length - upper, g.crank_length, g.shaft_length, g.base_radius,
            g.platform_radius, g.platform_joint_height,
        ])  # fmt: skip

    expected = np.zeros(7)
    expected[min(index, 6)] = (1e-3, 1e-3, 1e-3, 2e-3, 3e-3, 4e-3, 5e-4, 7e-4)[index]
    assert lengths(robot) - lengths(APPENDIX_4) == pytest.approx(expected, abs=1e-12)


def test_what_is_no_robot_meets_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "built_robots", lambda *_, **more: [APPENDIX_4, None, None])
    found = build_yield(APPENDIX_4, lambda _: {"a": 1.0}, samples=3)
    assert (found.fraction.passed, found.missed) == (1, {"no robot": 2})
    assert found.worst == {"a": 1.0, "no robot": -np.inf}


def test_it_can_be_canceled_and_says_so():
    found = build_yield(APPENDIX_4, crank_margin, samples=100, progress=lambda done: done >= 0.16)
    assert found.canceled
    assert found.fraction.samples == 16
    nan = build_yield(APPENDIX_4, lambda _: {"torque": float("nan")}, samples=3)
    assert nan.missed == {"torque": 3}
    assert nan.fraction.high < 1


def test_wrong_numbers_are_refused():
    for samples, tolerance, confidence in ((0, 0.1, 0.9), (5, 1.0, 0.9), (5, 0.1, 1.0)):
        with pytest.raises(InvalidInput):
            build_yield(
                APPENDIX_4, crank_margin, samples=samples, mass_tolerance=tolerance,
                confidence=confidence,
            )  # fmt: skip
    with pytest.raises(InvalidInput):
        fraction(3, 2)


@pytest.mark.slow
@pytest.mark.parametrize("springs", [False, True])
def test_mujoco_confirms_the_optimum_and_its_active_bounds(springs):
    asked = case(springs=springs)
    found = solve_inner(APPENDIX_4, asked, poses())
    short = motion().take(np.arange(0, motion().size, 4))
    bounds = (*asked.bounds, Requirement("condition", high=10.0))
    margins = AnswerMargins(
        Requirements(bounds), found.springs, (short,), found.objective, asked.motion_force
    )
    checked = check_by_mujoco(found.design, margins, poses(), count=10)
    assert checked.passed
    assert checked.difference < 1e-6
    assert checked.left_out == ("condition",)
    assert [row.unit for row in checked.rows] == ["N m", "N", "N m", "N"]
    assert all(row.engine == pytest.approx(row.computed, abs=1e-4) for row in checked.rows)
    # a bound that is reached has no margin by MuJoCo's torques either
    assert abs(checked.rows[0].engine) < 1e-4
    tighter = tuple(replace(b, high=0.99 * b.high) for b in asked.bounds)
    margins = AnswerMargins(Requirements(tighter), found.springs)
    assert not check_by_mujoco(found.design, margins, poses()).passed


def test_margins_of_what_is_quick_are_those_of_the_whole_check():
    bounds = (
        Requirement("condition", low=1.0), Requirement("reach_margin", low=0.01),
        Requirement("max_torque", high=9.0), Requirement("stiffness_x", high=1e9),
    )  # fmt: skip
    place = Workspace(WorkspaceShape.CYLINDER, (0.1, 0.1, 0.1), (0.0, 0.0, -0.55))
    asked = Requirements(bounds, (-0.2, 0.2), place)
    expected = {item.label: item.margin for item in check_requirements(APPENDIX_4, asked).items}
    assert AnswerMargins(asked)(APPENDIX_4) == expected
    assert {requirement_label(bound) for bound in bounds} <= set(expected)


def test_poses_out_of_reach_are_refused():
    with pytest.raises(InvalidInput, match="out of reach"):
        check_by_mujoco(
            APPENDIX_4, AnswerMargins(Requirements()), np.array([[0.0, 0.0, 0.0, -3.0]])
        )
