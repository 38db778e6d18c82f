"""Bounds and limits of an optimum: what relaxing buys, and what is said if they cannot be met."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

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
    beyond,
    optimize,
)
from paminsa_viz.model import (
    APPENDIX_4,
    InvalidDesign,
    InvalidInput,
    Misprint,
    solve_field,
    static_imbalance,
)
from paminsa_viz.trajectory import solve_trajectory
from tests.balancing.measuring import measured
from tests.balancing.robots import changes, field, solved, trajectory, workspace


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
        below, other = 0.5, what
        outward = -step if item.side in ("low", "nearest") else step
        if item.side == "limit":
            below += outward
        elif any(mass.path == item.name for mass in what.masses):
            other = replace(what, masses=tuple(
                replace(mass, **{item.side: item.bound + outward})
                if mass.path == item.name else mass for mass in what.masses
            ))  # fmt: skip
        else:
            other = replace(what, counterweights=tuple(
                replace(rail, **{item.side: item.bound + outward})
                if rail.name == item.name else rail for rail in what.counterweights
            ))  # fmt: skip
        return (
            result.objective
            - optimize(APPENDIX_4, other, term, limits=[(limit[0], below)]).objective
        )

    seen = set()
    for item in result.active:
        if item.price > 1e-3 and not (item.side == "low" and item.bound == 0):
            seen.add(item.side)
            # a convex optimum: relaxing buys no more than the multiplier says, tightening costs
            # no less, and in so small a step both are near to it
            assert gain(item, h) == pytest.approx(item.price * h, rel=0.02)
            assert gain(item, -h) == pytest.approx(-item.price * h, rel=0.02)
    assert {"low", "limit"} <= seen


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


def test_limit_is_infeasible_if_nothing_may_change() -> None:
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
    wider = {item.name: item for item in caught.value.relax}

    def relaxed(name: str, low: float, high: float) -> tuple[float, float]:
        item = wider.get(name)
        if item is None:
            return low, high
        return (
            (max(item.needed - 1e-7, 0), high) if item.side == "low" else (low, item.needed + 1e-7)
        )

    ranges = []
    for mass in what.masses:
        low, high = relaxed(mass.path, mass.low, mass.high)
        ranges.append(replace(mass, low=low, high=high))
    rails = []
    for rail in what.counterweights:
        low, high = relaxed(rail.name, rail.low, rail.high)
        rails.append(replace(rail, low=low, high=high))
    result = optimize(
        APPENDIX_4, Changes(tuple(ranges), tuple(rails)), AddedMass(),
        limits=[(TrajectoryRms(solved()), 0.5)],
    )  # fmt: skip
    assert measured(result.after)["RMS torque of M1-M3 on the trajectory"] < 0.5 + 1e-6


def test_every_infeasible_limit_is_reported() -> None:
    limits = [(AddedMass(), -4.0), (StaticPeak(field()), 0.0)]
    with pytest.raises(InfeasibleBounds) as caught:
        optimize(APPENDIX_4, changes(0.2), MassChange(), limits=limits)
    assert len(caught.value.limits) == 2
    assert all(item.attainable >= item.limit for item in caught.value.limits)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: MassRange("joints.j7", 2.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", -1.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", 0.0, np.inf), "joints.j7"),
        (lambda: beyond("b8", 8, -0.1, 1.0), "B8"),
        (lambda: CounterweightRange("b8", 8, 0.0, 0.1, 1.0, 2.0), "B8"),
        (lambda: Changes((MassRange("joints.j7", 0, 1), MassRange("joints.j7", 0, 2))), "j7"),
        (
            lambda: optimize(APPENDIX_4, Changes((MassRange("inertias.b3_axial", 0, 1),)),
                             AddedMass()),
            "inertias.b3_axial",
        ),
        (
            lambda: optimize(APPENDIX_4, Changes((MassRange("counterweights.0.mass", 0, 1),)),
                             AddedMass()),
            "counterweights.0.mass",
        ),
        (lambda: optimize(APPENDIX_4, Changes(), [(-1.0, AddedMass())]), "added mass"),
        (
            lambda: optimize(APPENDIX_4.vary({"geometry.base_radius": 0.36}), Changes(),
                             StaticPeak(field())),
            "field",
        ),
        (
            lambda: optimize(APPENDIX_4, Changes(), TrajectoryPeak(solve_trajectory(
                APPENDIX_4.geometry, trajectory(), misprints=Misprint.APP3_MC4))),
            "trajectory",
        ),
        (
            lambda: optimize(
                APPENDIX_4.vary({"geometry.guide_stroke": 0.05}), Changes(),
                StaticPeak(solve_field(APPENDIX_4.vary(
                    {"geometry.guide_stroke": 0.05}).geometry, workspace())),
            ),
            "field",
        ),
    ],
)  # fmt: skip
def test_impossible_requests_are_rejected(make, named: str) -> None:
    with pytest.raises((InvalidInput, InvalidDesign), match=named):
        make()


def test_failing_trajectory_is_rejected() -> None:
    short = APPENDIX_4.vary({"geometry.guide_stroke": 0.1})
    with pytest.raises(InvalidInput, match="whole trajectory"):
        optimize(short, Changes(), TrajectoryPeak(solve_trajectory(short.geometry, trajectory())))
