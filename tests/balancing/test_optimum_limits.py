"""Bounds and limits of an optimum: what relaxing buys, and what is said if they cannot be met."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import count

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import (
    ActiveConstraint,
    AddedMass,
    Changes,
    CounterweightRange,
    Imbalance,
    InfeasibleBounds,
    MassChange,
    MassRange,
    Optimum,
    StaticPeak,
    Term,
    TrajectoryPeak,
    TrajectoryRms,
    balance,
    beyond,
    optimize,
)
from paminsa_viz.errors import PaminsaError
from paminsa_viz.model import (
    APPENDIX_4,
    Grid,
    InvalidDesign,
    InvalidInput,
    Misprint,
    solve_field,
    static_imbalance,
)
from paminsa_viz.trajectory import solve_trajectory
from tests.balancing.robots import PATHS, changes, field, measured, solved, trajectory, workspace
from tests.support.samples import enlarged, prototype_times


@pytest.mark.slow
@pytest.mark.parametrize("times", [0.01, 10.0])
def test_limits_of_small_and_large_robots_are_kept_as_closely(times: float) -> None:
    """Of a hundredth of the lengths the torques are 10^-8 of the prototype's."""
    design = enlarged(APPENDIX_4, times)
    x = times * np.linspace(-0.1, 0.1, 5)
    poses = Grid.over((0.0, 0.0, 0.0, -0.5 * times), x=x, theta=np.linspace(-0.5, 0.5, 3))
    peak, added = StaticPeak(solve_field(design.geometry, poses)), AddedMass()
    what = Changes(tuple(MassRange(p, 0.7 * design.value(p), 1.2 * design.value(p)) for p in PATHS))
    least = optimize(design, what, peak).objective
    kept = optimize(design, what, added, limits=[(peak, 1.01 * least)])
    assert kept.values[1].after == pytest.approx(1.01 * least, rel=1e-6)
    wider = optimize(design, what, added, limits=[(peak, 1.0101 * least)])
    (price,) = [item.price for item in kept.active if item.side == "limit"]
    assert kept.objective - wider.objective == pytest.approx(1e-4 * least * price, rel=1e-3)
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(design, what, added, limits=[(peak, 0.999 * least), (added, 1e3 * times**3)])
    (short,) = caught.value.limits
    assert (short.label, short.attainable) == (peak.label, pytest.approx(least, rel=1e-7))


@pytest.mark.slow
def test_what_is_attainable_is_as_exact_for_any_goal() -> None:
    what, peak = changes(), TrajectoryPeak(solved())
    least = optimize(APPENDIX_4, what, peak).objective
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, what, [(1e9, StaticPeak(field()))], limits=[(peak, 0.5 * least)])
    assert caught.value.limits[0].attainable == pytest.approx(least, rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("term", [TrajectoryPeak(solved()), TrajectoryRms(solved())])
def test_multipliers_equal_the_gain_of_relaxed_bounds(term: Term) -> None:
    # no two of the same place, or mass could be exchanged between them
    masses = tuple(mass for mass in changes().masses if mass.path != "joints.j7")
    what = Changes(masses, changes().counterweights[:2])
    limit = (StaticPeak(field()), 0.5)
    result = optimize(APPENDIX_4, what, term, limits=[limit])
    h = 1e-4

    def gain(item: ActiveConstraint, step: float) -> float:
        """By how much the optimum falls for a bound moved outward by a step."""
        outward = -step if item.side in ("low", "nearest") else step
        moved = {item.side: item.bound + outward}
        below = moved.get("limit", 0.5)
        other = Changes(
            tuple(replace(m, **moved) if m.path == item.name else m for m in what.masses),
            tuple(replace(r, **moved) if r.name == item.name else r for r in what.counterweights),
        )
        again = optimize(APPENDIX_4, other, term, limits=[(limit[0], below)])
        return result.objective - again.objective

    seen = set()
    for item in result.active:
        if item.price > 1e-3 and not (item.side == "low" and item.bound == 0):
            seen.add(item.side)
            # a convex optimum: relaxing buys no more than the multiplier says, tightening costs
            # no less, and in so small a step both are near to it
            assert gain(item, h) == pytest.approx(item.price * h, rel=0.02)
            assert gain(item, -h) == pytest.approx(-item.price * h, rel=0.02)
    assert {"low", "limit"} <= seen
    prices = [item.price for item in result.active]
    assert prices == sorted(prices, reverse=True)
    assert len(set(prices)) > 2


def test_price_of_an_upper_bound_is_the_gain_per_kilogram() -> None:
    """With joint 7 alone |M_p2| is linear in its mass, until it vanishes at 3.063 kg."""
    fixed = Changes((MassRange("joints.j7", 1.0, 1.0),))
    slope = static_imbalance(APPENDIX_4.vary({"joints.j7": 0.0})) - static_imbalance(
        APPENDIX_4.vary({"joints.j7": 1.0})
    )
    for what, sides in (
        (fixed, {"low": 0.0, "high": slope}),
        (Changes((MassRange("joints.j7", 0.1, 1.0),)), {"high": slope}),
        (Changes((MassRange("joints.j7", 4.0, 5.0),)), {"low": slope}),
    ):
        result = optimize(APPENDIX_4, what, Imbalance())
        assert {item.side: item.price for item in result.active} == pytest.approx(sides, rel=1e-9)


@pytest.mark.parametrize("term", [StaticPeak(field()), TrajectoryRms(solved())])
def test_price_of_a_place_is_the_gain_per_meter(term: Term) -> None:
    """A kilogram whose lever one would like shorter or longer than its range allows."""
    seen = set()
    for bar, joint in (("b8", 8), ("b8", 9), ("b4", 5), ("b3", 7)):

        def best(first: float, last: float, bar: str = bar, joint: int = joint) -> Optimum:
            place = CounterweightRange(bar, joint, first, last, high=1.0, low=1.0)
            return optimize(APPENDIX_4, Changes((), (place,)), term)

        result, h = best(0.05, 0.2), 1e-4
        for item in result.active:
            if item.side in ("nearest", "farthest"):
                seen.add(item.side)
                assert item.bound == (0.05 if item.side == "nearest" else 0.2)
                more, less = [
                    best(0.05 - step, 0.2) if item.side == "nearest" else best(0.05, 0.2 + step)
                    for step in (h, -h)
                ]
                gained = (less.objective - more.objective) / (2 * h)
                assert item.price == pytest.approx(gained, rel=0.01)
                assert item.price > 0
    assert seen == {"nearest", "farthest"} or (isinstance(term, TrajectoryRms) and seen)


def test_bounds_that_need_not_move_are_not_named() -> None:
    """One mass pulls the wrong way: it stays at its least, and the other's bound has to move."""
    goal = 0.5 * static_imbalance(APPENDIX_4.vary({"joints.j7": 1.0, "joints.j5": 0.7}))
    what = Changes((MassRange("joints.j7", 0.1, 1.0), MassRange("joints.j5", 0.7, 0.9)))
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, what, MassChange(), limits=[(Imbalance(), goal)])
    named = {(item.name, item.side): item.needed - item.bound for item in caught.value.relax}
    assert all(abs(moved) > 1e-6 for moved in named.values())
    assert ("joints.j7", "high") in named or ("joints.j5", "low") in named
    assert len(named) == 1


def test_price_of_a_limit_of_zero_is_what_relaxing_it_gains() -> None:
    def best(below: float) -> Optimum:
        limit = [(StaticPeak(field()), below), (AddedMass(), 100.0)]
        return optimize(APPENDIX_4, changes(), TrajectoryRms(solved()), limits=limit)

    exact, relaxed = best(0.0), best(1e-4)
    prices = {item.name: item.price for item in exact.active if item.side == "limit"}
    assert list(prices) == ["peak static torque"]  # the other one is far away
    assert prices["peak static torque"] == pytest.approx(
        (exact.objective - relaxed.objective) / 1e-4, rel=1e-2
    )


def test_limit_is_infeasible_without_changes() -> None:
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, Changes(), AddedMass(), limits=[(TrajectoryRms(solved()), 0.1)])
    now = measured(APPENDIX_4)["RMS torque of M1-M3 on the trajectory"]
    assert caught.value.limits[0].attainable == pytest.approx(now, rel=1e-4)
    assert caught.value.relax == ()


def test_infeasible_limits_report_attainable_values_and_relaxations() -> None:
    what = changes(0.2)
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, what, AddedMass(), limits=[(TrajectoryRms(solved()), 0.5)])
    (short,) = caught.value.limits
    least = optimize(APPENDIX_4, what, TrajectoryRms(solved())).objective
    assert short.attainable == pytest.approx(least, rel=1e-7)
    assert "RMS torque of M1-M3" in str(caught.value)
    assert caught.value.relax
    moved = {item.name: {item.side: item.needed} for item in caught.value.relax}
    relaxed = Changes(
        tuple(replace(mass, **moved.get(mass.path, {})) for mass in what.masses),
        tuple(replace(place, **moved.get(place.name, {})) for place in what.counterweights),
    )
    result = optimize(APPENDIX_4, relaxed, TrajectoryRms(solved()))
    assert result.objective == pytest.approx(0.5, abs=1e-6)


def test_every_infeasible_limit_is_reported() -> None:
    limits = [(AddedMass(), -4.0), (TrajectoryRms(solved()), 0.5)]
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, changes(0.2), MassChange(), limits=limits)
    assert len(caught.value.limits) == 2
    assert all(item.attainable > item.limit for item in caught.value.limits)


def test_a_limit_that_can_be_met_is_not_reported_beside_one_that_cannot() -> None:
    what = Changes((MassRange("joints.j7", 0.2, 2.0),))
    limits = [(AddedMass(), 20.0), (Imbalance(), 0.5)]
    with pytest.raises(InfeasibleBounds, match=r"it: \|M_p2\| of at most 0.5 N") as caught:
        optimize(APPENDIX_4, what, MassChange(), limits=limits)
    (short,) = caught.value.limits
    heaviest = APPENDIX_4.vary({"joints.j7": 2.0})
    assert short.attainable == pytest.approx(abs(static_imbalance(heaviest)), rel=1e-9)


def test_an_infeasible_limit_is_reported_with_the_other_limits_kept() -> None:
    """Without added mass the peak static torque stays above its least value."""
    peak, added = StaticPeak(field()), AddedMass()
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, changes(0.2), MassChange(), limits=[(added, 0.0), (peak, 0.0)])
    mass, torque = (item.attainable for item in caught.value.limits)
    kept = optimize(APPENDIX_4, changes(0.2), peak, limits=[(added, 0.0)]).objective
    assert torque == pytest.approx(kept, rel=1e-7)
    assert torque > 1.01 * optimize(APPENDIX_4, changes(0.2), peak).objective
    least = optimize(APPENDIX_4, changes(0.2), added, limits=[(peak, 0.0)]).objective
    assert mass == pytest.approx(least, rel=1e-7)


def test_a_heavy_robot_is_told_the_bound_that_would_do_as_the_prototype_is() -> None:
    """Of five times the lengths and 125 times the masses; the bound then needs some 300 kg."""
    for size, least in ((1.0, 1.0), (5.0, 125.0)):
        robot, place = prototype_times(size), beyond("b3", 7, 0.1, 0.5)
        with pytest.raises(InfeasibleBounds) as caught:
            balance(robot, Changes((), (place,)), AddedMass(), exact=True)
        (moved,) = caught.value.relax
        assert (moved.name, moved.side) == (place.name, "high")
        assert least < moved.needed < 5 * least
        wide = replace(place, high=1.001 * moved.needed)
        assert abs(static_imbalance(balance(robot, Changes((), (wide,)), AddedMass()).after)) < 1e-6


EXTREMES = st.sampled_from([0.0, 1e-300, 1e-12, 0.1, 1.0, 50.0, 1e4, 1e308, np.nan])


@given(data=st.data())
def test_extreme_bounds_are_rejected_or_certified(data) -> None:
    """Warnings are errors here, so that an overflow fails the test."""
    draw = lambda: data.draw(EXTREMES)  # noqa: E731
    offered = [TrajectoryPeak(solved()), TrajectoryRms(solved()), StaticPeak(field())]
    try:
        what = Changes(
            (MassRange("joints.j7", draw(), draw()), MassRange("links.b3", 0.0, draw())),
            (CounterweightRange("b8", 8, 0.0, draw(), draw()),),
        )
        limits = [(AddedMass(), draw())] if data.draw(st.booleans()) else []
        goals = [(draw(), data.draw(st.sampled_from(offered))), (1.0, AddedMass())]
        result = optimize(APPENDIX_4, what, goals, limits=limits)
    except PaminsaError:
        return
    assert result.lower_bound <= result.objective + 1e-9 * abs(result.objective)
    assert np.isfinite([result.objective, result.lower_bound]).all()


def with_one_mass(path: str) -> Changes:
    return Changes((MassRange(path, 0, 1),))


LARGER = APPENDIX_4.vary({"geometry.base_radius": 0.36})
SHORT = APPENDIX_4.vary({"geometry.guide_stroke": 0.05})


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: MassRange("joints.j7", 2.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", -1.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", 0.0, np.inf), "joints.j7"),
        (lambda: beyond("b8", 8, -0.1, 1.0), "B8"),
        (lambda: CounterweightRange("b8", 8, 0.0, 0.1, 1.0, 2.0), "B8"),
        (lambda: Changes((MassRange("joints.j7", 0, 1), MassRange("joints.j7", 0, 2))), "j7"),
        *(
            (partial(optimize, APPENDIX_4, with_one_mass(path), AddedMass()), path)
            for path in ("inertias.b3_axial", "counterweights.0.mass")
        ),
        (partial(optimize, APPENDIX_4, Changes(), [(-1.0, AddedMass())]), "added mass"),
        *(
            (partial(optimize, robot, Changes(), term), named)
            for robot, term, named in (
                (LARGER, StaticPeak(field()), "field"),
                (SHORT, StaticPeak(solve_field(SHORT.geometry, workspace())), "field"),
                (SHORT, TrajectoryPeak(solve_trajectory(SHORT.geometry, trajectory())), "whole"),
                (APPENDIX_4, TrajectoryPeak(solve_trajectory(
                    APPENDIX_4.geometry, trajectory(), misprints=Misprint.APP3_MC4
                )), "misprints"),
            )
        ),
    ],
    ids=count(),
)  # fmt: skip
def test_impossible_requests_are_rejected(make, named: str) -> None:
    with pytest.raises((InvalidInput, InvalidDesign), match=named):
        make()
