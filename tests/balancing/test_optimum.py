"""Optima: as good as their dual bounds, better than random designs, with the designs' values."""

from __future__ import annotations

import time
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
    along,
    beyond,
    optimize,
)
from paminsa_viz.balancing.changes import mass_space
from paminsa_viz.balancing.optimum import ACTIVE, active_bounds
from paminsa_viz.balancing.program import Solution
from paminsa_viz.model import APPENDIX_4, BAR_ENDS, Drive, Friction
from paminsa_viz.trajectory import Trajectory, analyze, solve_trajectory
from tests.balancing.robots import PATHS, changes, field, measured, random_measures, solved, terms
from tests.support.cases import Case, cases

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("term", terms(), ids=lambda term: term.label)
def test_optimum_meets_its_dual_bound_and_beats_random_designs(term: Term) -> None:
    result = optimize(APPENDIX_4, changes(), term)
    scale = max(abs(result.values[0].before), abs(result.objective))
    assert result.lower_bound <= result.objective + 1e-12 * scale
    assert result.gap <= 1e-8 * scale
    (value,) = result.values
    for design, found in ((APPENDIX_4, value.before), (result.after, value.after)):
        assert found == pytest.approx(measured(design)[term.label], rel=2e-5, abs=1e-7)
    values = random_measures()[term.label]
    assert values.min() >= result.lower_bound - 1e-4 * abs(result.lower_bound) - 1e-9
    assert values.min() < value.before


def test_weighted_sums_and_limits() -> None:
    goals = [(1.0, TrajectoryPeak(solved())), (2.0, TrajectoryRms(solved())), (0.1, AddedMass())]
    limits = [(StaticPeak(field()), 2.0), (AddedMass(), 10.0)]
    result = optimize(APPENDIX_4, changes(), goals, limits=limits)
    assert result.gap <= 1e-8 * result.objective
    found = measured(result.after)
    for limit, most in limits:
        assert found[limit.label] <= most + 1e-8
    total = sum(weight * found[term.label] for weight, term in goals)
    assert result.objective == pytest.approx(total, rel=1e-5)
    drawn = random_measures()
    allowed = np.all([drawn[limit.label] <= most for limit, most in limits], axis=0)
    assert allowed.sum() > 5
    assert sum(w * drawn[term.label][allowed] for w, term in goals).min() > result.lower_bound


@given(case=cases(), seed=st.integers(0, 1000))
def test_random_problems_have_a_certified_optimum(case: Case, seed: int) -> None:
    rng = np.random.default_rng(seed)
    design = case.design
    states = case.states(24)
    motion = Trajectory(np.linspace(0.0, 1.0, 24), *states)
    solved = solve_trajectory(design.geometry, motion, gravity=design.gravity)
    assume(solved.check.possible)
    masses = tuple(
        MassRange(p, rng.uniform(0, 1) * design.value(p), rng.uniform(1, 3) * design.value(p))
        for p in (*PATHS, "joints.j2", "platform.mass")
        if rng.uniform() < 0.6
    )
    ranges = tuple(
        CounterweightRange(bar, joint, -0.1, rng.choice([-0.1, 0.2]), rng.uniform(0.1, 8))
        for bar, ends in BAR_ENDS.items()
        for joint in ends
        if rng.uniform() < 0.4
    )
    what = Changes(masses, ranges)
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


def test_friction_and_another_gravity_count() -> None:
    friction = Friction(viscous_rotary=0.3, coulomb_rotary=0.5, viscous_linear=5.0)
    servo = Drive(rotor_inertia=2e-4, gear_ratio=50.0, coulomb=0.02)
    axis = Drive(rotor_inertia=1e-4, transmission="screw", lead=0.01)
    drives = (servo, servo, servo, axis)
    design = replace(APPENDIX_4, friction=friction, gravity=3.7, drives=drives)
    for term, unit in (
        (TrajectoryPeak(solved()), "N m"), (TrajectoryPeak(solved(), LIFT), "N")
    ):  # fmt: skip
        result = optimize(design, changes(), term)
        (value,) = result.values
        assert value.unit == unit
        for robot, found in ((design, value.before), (result.after, value.after)):
            assert found == pytest.approx(measured(robot)[term.label], rel=1e-9)
        assert result.gap <= 1e-8 * result.objective


def test_without_changes_the_design_stays() -> None:
    began = time.perf_counter()
    result = optimize(APPENDIX_4, Changes(), TrajectoryRms(solved()))
    assert 0 < result.seconds <= time.perf_counter() - began
    assert result.after == APPENDIX_4
    assert result.active == ()
    assert result.gap <= 1e-9 * result.objective
    fixed = MassRange("joints.j7", 0.28, 0.28)
    assert optimize(APPENDIX_4, Changes((fixed,)), TrajectoryPeak(solved())).after == APPENDIX_4


def test_inertia_follows_a_link_only_on_request() -> None:
    for follows in (True, False):
        what = Changes((MassRange("links.b4", 0.336, 0.336, inertia_follows=follows),))
        after = optimize(APPENDIX_4, what, AddedMass()).after
        share = 0.5 if follows else 1.0
        assert after.inertias.b4_transverse == pytest.approx(share * 0.048)


@pytest.mark.parametrize(("off", "reached"), [(0.0, True), (0.95e-6, True), (1.05e-6, False)])
def test_bounds_are_reached_within_a_millionth_of_their_range(off: float, reached: bool) -> None:
    """Of an amount from 1 to 3 kg, and of the lever of one from -1 to 1."""
    weight = beyond("b8", 8, 0.2, 4.0)
    space = mass_space(APPENDIX_4, Changes((MassRange("links.b4", 1.0, 3.0),), (weight,)))
    first, last = space.variables[1].span
    near = off * (last - first)
    for amount, lever, sides in (
        (1.0 + 2.0 * off, first + near, ("low", "nearest")),
        (3.0 - 2.0 * off, last - near, ("high", "farthest")),
    ):
        found = Solution(
            state=space.before, amounts=np.array([amount, 2.0]),
            levers=(((0.0, amount),), ((lever, 2.0),)), value=0.0, bound=0.0,
            prices=np.zeros(2), slopes=np.zeros(2), limit_prices=np.zeros(0), rounds=1,
        )  # fmt: skip
        touched = tuple(item.side for item in active_bounds(space, found))
        assert touched == (sides if reached else ())


def test_a_place_exactly_at_the_border_of_an_end_is_at_it() -> None:
    weight = beyond("b8", 8, 0.2, 4.0)
    space = mass_space(APPENDIX_4, Changes((), (weight,)))
    first, last = space.variables[0].span
    for side, lever in (
        ("nearest", first + ACTIVE * (last - first)), ("farthest", last - ACTIVE * (last - first))
    ):  # fmt: skip
        found = Solution(
            space.before, np.array([2.0]), (((lever, 2.0),),), 0.0, 0.0, np.zeros(1), np.zeros(1),
            np.zeros(0), 1,
        )  # fmt: skip
        assert [item.side for item in active_bounds(space, found)] == [side]


def test_a_weight_that_is_best_at_one_lever_is_one_weight() -> None:
    """The solver leaves a part of it, of the size of rounding, at the end of its range."""
    ranges = (beyond("b3", 7, 0.2, 0.5), along(APPENDIX_4.geometry, "b8", 0.7))
    after = optimize(APPENDIX_4, Changes((), ranges), TrajectoryRms(solved())).after
    (weight,) = after.counterweights
    assert (weight.bar, weight.joint, weight.mass) == ("b3", 7, 0.5)
    assert 0.0 < weight.beyond < 0.2
    alone = [
        measured(replace(APPENDIX_4, counterweights=(replace(weight, beyond=weight.beyond + s),)))[
            TrajectoryRms(solved()).label
        ]
        for s in (-1e-3, 0.0, 1e-3)
    ]
    assert alone[1] < min(alone[0], alone[2])
