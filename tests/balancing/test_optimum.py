"""Optima: as good as their dual bounds, better than thousands of random designs, honest numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from paminsa_viz.balancing import (
    LIFT,
    AddedMass,
    Changes,
    CounterweightRange,
    Imbalance,
    MassChange,
    MassRange,
    StaticPeak,
    Term,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
    beyond,
    optimize,
    whole_mass,
)
from paminsa_viz.model import APPENDIX_4, BAR_ENDS, Counterweight, Friction, lumped_coefficients
from paminsa_viz.trajectory import Trajectory, analyze, solve_trajectory
from tests.balancing.measuring import RANDOM, measured, of_random, terms
from tests.balancing.robots import PATHS, changes, field, random_choices, solved, trajectory
from tests.support.cases import Case, cases

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("term", terms(), ids=lambda term: term.label)
def test_optimum_meets_its_dual_bound_and_beats_random_designs(term: Term) -> None:
    what = changes()
    result = optimize(APPENDIX_4, what, term)
    scale = max(abs(result.values[0].before), abs(result.objective))
    assert result.lower_bound <= result.objective + 1e-12 * scale
    assert result.gap <= 1e-8 * scale
    # what it says of both designs is what the designs themselves say
    for design, said in (
        (APPENDIX_4, result.values[0].before), (result.after, result.values[0].after)
    ):  # fmt: skip
        assert said == pytest.approx(measured(design)[term.label], rel=2e-5, abs=1e-7)
    c, mass = random_choices(np.random.default_rng(0), what, RANDOM)
    values = of_random(term, c, mass)
    assert values.min() >= result.lower_bound * (1 - 1e-4 * np.sign(result.lower_bound)) - 1e-9
    assert values.min() < result.values[0].before


def test_random_designs_are_of_the_family_that_is_optimized() -> None:
    """The coefficients of random choices are those of designs written down by hand."""
    what = Changes(
        (MassRange("links.b4", 0.5, 0.5), MassRange("joints.j7", 1.0, 1.0)),
        (
            CounterweightRange("b3", 7, 0.1, 0.1, 2.0, 2.0),
            CounterweightRange("b8", 8, 0.2, 0.2, 1.0, 1.0),
        ),
    )
    d = APPENDIX_4
    share = 0.5 / d.links.b4
    design = replace(
        d.vary({
            "links.b4": 0.5, "joints.j7": 1.0,
            "inertias.b4_axial": share * d.inertias.b4_axial,
            "inertias.b4_transverse": share * d.inertias.b4_transverse,
        }),
        counterweights=(Counterweight("b3", 7, 0.1, 2.0), Counterweight("b8", 8, 0.2, 1.0)),
    )  # fmt: skip
    c, mass = random_choices(np.random.default_rng(0), what, 3)
    np.testing.assert_allclose(c[:, 0], lumped_coefficients(design), rtol=1e-10, atol=1e-12)
    assert mass[0] == pytest.approx(whole_mass(design), rel=1e-13)
    result = optimize(d, what, AddedMass())
    np.testing.assert_allclose(
        lumped_coefficients(result.after), lumped_coefficients(design), rtol=1e-12, atol=1e-12
    )


def test_weighted_sums_and_limits() -> None:
    what = changes()
    goals = [(1.0, TrajectoryPeak(solved())), (2.0, TrajectoryRms(solved())), (0.1, AddedMass())]
    limits = [(StaticPeak(field()), 2.0), (AddedMass(), 3.0)]
    result = optimize(APPENDIX_4, what, goals, limits=limits)
    assert result.gap <= 1e-8 * result.objective
    found = measured(result.after)
    assert found["peak static torque"] <= 2.0 + 1e-8
    assert found["added mass"] <= 3.0 + 1e-8
    by_label = {value.label: value for value in result.values[:3]}
    assert result.objective == pytest.approx(
        sum(weight * by_label[term.label].after for weight, term in goals), rel=1e-12
    )
    c, mass = random_choices(np.random.default_rng(1), what, RANDOM)
    allowed = (of_random(limits[0][0], c, mass) <= 2.0) & (of_random(AddedMass(), c, mass) <= 3.0)
    total = sum(w * of_random(term, c[:, allowed], mass[allowed]) for w, term in goals)
    assert allowed.sum() > 20
    assert total.min() > result.lower_bound


@given(case=cases(), seed=st.integers(0, 1000))
def test_any_robot_on_any_motion(case: Case, seed: int) -> None:
    """Random robots, motions, bounds, rails and weights: always an optimum with its proof."""
    rng = np.random.default_rng(seed)
    design = case.design
    states = case.states(24)
    motion = Trajectory(np.linspace(0.0, 1.0, 24), *states)
    solved = solve_trajectory(design.geometry, motion, gravity=design.gravity)
    assume(solved.check.ok)
    masses = tuple(
        MassRange(p, rng.uniform(0, 1) * design.value(p), rng.uniform(1, 3) * design.value(p))
        for p in (*PATHS, "joints.j2", "platform.mass")
        if rng.uniform() < 0.6
    )
    rails = tuple(
        CounterweightRange(bar, joint, -0.1, rng.choice([-0.1, 0.2]), rng.uniform(0.1, 8))
        for bar, ends in BAR_ENDS.items()
        for joint in ends
        if rng.uniform() < 0.4
    )
    what = Changes(masses, rails)
    offered: list[Term] = [
        Imbalance(), AddedMass(), MassChange(), TrajectoryPeak(solved), TrajectoryRms(solved),
        TrajectoryEnergy(solved), TrajectoryPeak(solved, LIFT), TrajectoryRms(solved, LIFT),
    ]  # fmt: skip
    goals = [(rng.uniform(0.1, 2), offered[i]) for i in rng.permutation(len(offered))[:2]]
    held = offered[rng.integers(len(offered))]
    (least,) = optimize(design, what, held).values
    limit = least.after + rng.uniform() * max(least.before - least.after, 0.0)
    result = optimize(design, what, goals, limits=[(held, limit)])
    scale = sum(w * abs(v.before) for (w, _), v in zip(goals, result.values, strict=False))
    scale = max(abs(result.objective), scale)
    # a limit broken by a rounding error of 1e-9 of itself makes the objective as much smaller
    price = sum(item.price for item in result.active if item.side == "limit")
    below = 1e-12 * scale + 1e-9 * price * max(1.0, abs(limit))
    assert -below <= result.objective - result.lower_bound <= 1e-8 * scale + 1e-12
    assert result.values[2].after <= limit + 1e-8 * max(1.0, abs(limit))
    after = analyze(result.after, motion).torque
    for (_, term), value in zip(goals, result.values, strict=False):
        if isinstance(term, TrajectoryPeak):
            peak = np.abs(after[:, list(term.actuators)]).max()
            assert value.after == pytest.approx(peak, rel=1e-8, abs=1e-9 * np.abs(after).max())


def test_mass_moved_counts_both_ways() -> None:
    limit = (StaticPeak(field()), 0.5)
    result = optimize(APPENDIX_4, changes(), MassChange(), limits=[limit])
    paths = [mass.path for mass in changes().masses]
    moved = 3 * sum(abs(result.after.value(p) - APPENDIX_4.value(p)) for p in paths)
    moved += 3 * sum(weight.mass for weight in result.after.counterweights)
    assert result.objective == pytest.approx(moved, abs=1e-9)
    less = optimize(APPENDIX_4, changes(), AddedMass(), limits=[limit])
    assert less.objective < result.objective


def test_a_free_lever_is_at_least_as_good_as_any_fixed_one() -> None:
    """Levers in steps of 25 mm, each solved for itself, against the rail."""
    term = TrajectoryRms(solved())
    free = optimize(APPENDIX_4, Changes((), (beyond("b3", 7, 0.6, 0.6),)), term)
    levers = np.linspace(0.0, 0.6, 25)
    fixed = [
        optimize(APPENDIX_4, Changes((), (CounterweightRange("b3", 7, d, d, 0.6),)), term).objective
        for d in levers
    ]
    best = int(np.argmin(fixed))
    assert 0 < best < len(levers) - 1
    assert 0 <= fixed[best] - free.objective + 1e-9 < 2e-3
    (weight,) = free.after.counterweights
    assert weight.beyond == pytest.approx(levers[best], abs=0.026)


def test_friction_and_another_gravity_count() -> None:
    friction = Friction(viscous_rotary=0.3, coulomb_rotary=0.5, viscous_linear=5.0)
    design = replace(APPENDIX_4, friction=friction, gravity=3.7)
    for term in (TrajectoryPeak(solved()), TrajectoryPeak(solved(), LIFT)):
        result = optimize(design, changes(), term)
        for robot, said in (
            (design, result.values[0].before), (result.after, result.values[0].after)
        ):  # fmt: skip
            peaks = [abs(s.peak) for s in analyze(robot, trajectory()).summary]
            expected = max(peaks[:3]) if term.unit == "N m" else peaks[3]
            assert said == pytest.approx(expected, rel=1e-9)
        assert result.gap <= 1e-8 * result.objective


def test_nothing_may_change() -> None:
    result = optimize(APPENDIX_4, Changes(), TrajectoryRms(solved()))
    assert result.after == APPENDIX_4
    assert result.active == ()
    assert result.gap <= 1e-9 * result.objective
    fixed = MassRange("joints.j7", 0.28, 0.28)
    assert optimize(APPENDIX_4, Changes((fixed,)), TrajectoryPeak(solved())).after == APPENDIX_4


def test_inertia_follows_a_link_only_if_asked() -> None:
    for follows in (True, False):
        what = Changes((MassRange("links.b4", 0.336, 0.336, inertia_follows=follows),))
        after = optimize(APPENDIX_4, what, AddedMass()).after
        share = 0.5 if follows else 1.0
        assert after.inertias.b4_transverse == pytest.approx(share * 0.048)
