"""Optima: as good as their dual bounds, better than thousands of random designs, honest numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    BAR_ENDS,
    Counterweight,
    Design,
    Friction,
    InvalidDesign,
    InvalidInput,
    Misprint,
    lumped_coefficients,
    solve_field,
    static_torques,
)
from paminsa_viz.model.balancing import (
    LIFT,
    Active,
    AddedMass,
    Changes,
    Imbalance,
    InfeasibleBounds,
    MassChange,
    MassRange,
    Rail,
    StaticLift,
    StaticPeak,
    StaticRms,
    Term,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
    beyond,
    optimise,
    whole_mass,
)
from paminsa_viz.model.trajectory import Trajectory, analyse, solve_trajectory
from tests.model.balancing.robots import (
    PATHS,
    changes,
    field,
    random_choices,
    solved,
    trajectory,
    workspace,
)
from tests.model.cases import Case, cases

RANDOM = 10_000


def measured(design: Design) -> dict[str, float]:
    """Every term of a design, from the functions that analyse designs."""
    poses = workspace().poses()
    held = static_torques(design, poses).reshape(-1, 4)
    motion = analyse(design, trajectory())
    t = trajectory().t
    square = np.trapezoid(motion.torque**2, t, axis=0) / (t[-1] - t[0])
    return {
        "peak static torque": float(np.abs(held[:, :3]).max()),
        "RMS static torque": float(np.sqrt(np.mean(held[:, :3] ** 2))),
        "peak static force of M4": float(np.abs(held[:, 3]).max()),
        "peak torque of M1-M3 on the trajectory": max(abs(s.peak) for s in motion.summary[:3]),
        "RMS torque of M1-M3 on the trajectory": float(
            np.sqrt(np.mean([s.rms**2 for s in motion.summary[:3]]))
        ),
        "peak force of M4 on the trajectory": abs(motion.summary[3].peak),
        "RMS force of M4 on the trajectory": float(np.sqrt(square[3])),
        "driving energy on the trajectory": sum(s.driven for s in motion.summary),
        "added mass": whole_mass(design) - whole_mass(APPENDIX_4),
    }


def terms() -> list[Term]:
    return [
        StaticPeak(field()), StaticRms(field()), StaticLift(field()),
        TrajectoryPeak(solved()), TrajectoryRms(solved()),
        TrajectoryPeak(solved(), LIFT), TrajectoryRms(solved(), LIFT),
        TrajectoryEnergy(solved()), AddedMass(),
    ]  # fmt: skip


def of_random(term: Term, c: Any, mass: Any) -> Any:
    """A term of many designs at once, (count,), from c and the torques Y c themselves."""
    s, f = solved(), field()
    if isinstance(term, AddedMass):
        return mass - whole_mass(APPENDIX_4)
    if isinstance(term, (StaticPeak, StaticRms)):
        gamma = f.gamma[:3][np.isfinite(f.gamma[:3])]
        size = np.abs(gamma).max() if isinstance(term, StaticPeak) else np.sqrt(np.mean(gamma**2))
        return np.abs(c[1]) * size
    if isinstance(term, StaticLift):
        constant = 3.0 * (c[16] * 9.81 + 3 * c[0]) + 3 * c[2]
        lift = f.gamma[3][np.isfinite(f.gamma[3])]
        return np.abs(np.outer(lift, c[1]) + constant).max(axis=0)
    everything = isinstance(term, TrajectoryEnergy)
    actuators = list(range(4)) if everything else list(term.actuators)  # type: ignore[attr-defined]
    found = []
    for part in np.array_split(np.arange(c.shape[1]), 20):
        torque = np.einsum("nji,ik->njk", s.y[:, actuators], c[:, part])
        t = s.trajectory.t
        if everything:
            power = torque * s.speed[:, :, None]
            found.append(np.trapezoid(np.maximum(power, 0), t, axis=0).sum(axis=0))
        elif isinstance(term, TrajectoryPeak):
            found.append(np.abs(torque).max(axis=(0, 1)))
        else:
            square = np.trapezoid(torque**2, t, axis=0).mean(axis=0) / (t[-1] - t[0])
            found.append(np.sqrt(square))
    return np.concatenate(found)


@pytest.mark.parametrize("term", terms(), ids=lambda term: term.label)
def test_an_optimum_meets_its_dual_bound_and_no_random_design_is_better(term: Term) -> None:
    what = changes()
    result = optimise(APPENDIX_4, what, term)
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


def test_random_designs_are_of_the_family_that_is_optimised() -> None:
    """The coefficients of random choices are those of designs written down by hand."""
    what = Changes(
        (MassRange("links.b4", 0.5, 0.5), MassRange("joints.j7", 1.0, 1.0)),
        (Rail("b3", 7, 0.1, 0.1, 2.0, 2.0), Rail("b8", 8, 0.2, 0.2, 1.0, 1.0)),
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
    result = optimise(d, what, AddedMass())
    np.testing.assert_allclose(
        lumped_coefficients(result.after), lumped_coefficients(design), rtol=1e-12, atol=1e-12
    )


def test_weighted_sums_and_limits() -> None:
    what = changes()
    goals = [(1.0, TrajectoryPeak(solved())), (2.0, TrajectoryRms(solved())), (0.1, AddedMass())]
    limits = [(StaticPeak(field()), 2.0), (AddedMass(), 3.0)]
    result = optimise(APPENDIX_4, what, goals, limits=limits)
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


@pytest.mark.parametrize("term", [TrajectoryPeak(solved()), TrajectoryRms(solved())])
def test_multipliers_are_what_relaxed_bounds_buy(term: Term) -> None:
    # no two of the same place, or what is taken away from the one could be had from the other
    masses = tuple(mass for mass in changes().masses if mass.path != "joints.j7")
    what = Changes(masses, changes().rails[:2])
    limit = (StaticPeak(field()), 0.5)
    result = optimise(APPENDIX_4, what, term, limits=[limit])
    h = 1e-4

    def gain(item: Active, step: float) -> float:
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
            other = replace(what, rails=tuple(
                replace(rail, **{item.side: item.bound + outward})
                if rail.name == item.name else rail for rail in what.rails
            ))  # fmt: skip
        return (
            result.objective
            - optimise(APPENDIX_4, other, term, limits=[(limit[0], below)]).objective
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


def test_limits_that_can_not_be_met_say_what_can() -> None:
    what = changes(0.2)
    with pytest.raises(InfeasibleBounds) as caught:
        optimise(APPENDIX_4, what, AddedMass(), limits=[(TrajectoryRms(solved()), 0.5)])
    (short,) = caught.value.limits
    least = optimise(APPENDIX_4, what, TrajectoryRms(solved())).objective
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
    for rail in what.rails:
        low, high = relaxed(rail.name, rail.low, rail.high)
        rails.append(replace(rail, low=low, high=high))
    result = optimise(
        APPENDIX_4, Changes(tuple(ranges), tuple(rails)), AddedMass(),
        limits=[(TrajectoryRms(solved()), 0.5)],
    )  # fmt: skip
    assert measured(result.after)["RMS torque of M1-M3 on the trajectory"] < 0.5 + 1e-6


def test_several_limits_at_odds() -> None:
    limits = [(AddedMass(), -4.0), (StaticPeak(field()), 0.0)]
    with pytest.raises(InfeasibleBounds) as caught:
        optimise(APPENDIX_4, changes(0.2), MassChange(), limits=limits)
    assert len(caught.value.limits) == 2
    assert all(item.attainable > item.limit for item in caught.value.limits)


@given(case=cases(), seed=st.integers(0, 1000))
def test_any_robot_on_any_motion(case: Case, seed: int) -> None:
    """Random robots, motions, bounds, rails and weights: always an optimum with its proof."""
    rng = np.random.default_rng(seed)
    design = case.design
    states = case.states(24)
    motion = Trajectory(np.linspace(0.0, 1.0, 24), *states)
    solved = solve_trajectory(design.geometry, motion, case.assembly, gravity=design.gravity)
    assume(solved.check.ok)
    masses = tuple(
        MassRange(p, rng.uniform(0, 1) * design.value(p), rng.uniform(1, 3) * design.value(p))
        for p in (*PATHS, "joints.j2", "platform.mass")
        if rng.uniform() < 0.6
    )
    rails = tuple(
        Rail(bar, joint, -0.1, rng.choice([-0.1, 0.2]), rng.uniform(0.1, 8))
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
    (least,) = optimise(design, what, held).values
    limit = least.after + rng.uniform() * max(least.before - least.after, 0.0)
    result = optimise(design, what, goals, limits=[(held, limit)])
    scale = sum(w * abs(v.before) for (w, _), v in zip(goals, result.values, strict=False))
    scale = max(abs(result.objective), scale)
    assert -1e-12 * scale <= result.objective - result.lower_bound <= 1e-7 * scale + 1e-12
    assert result.values[2].after <= limit + 1e-8 * max(1.0, abs(limit))
    after = analyse(result.after, motion, case.assembly).torque
    for (_, term), value in zip(goals, result.values, strict=False):
        if isinstance(term, TrajectoryPeak):
            peak = np.abs(after[:, list(term.actuators)]).max()
            assert value.after == pytest.approx(peak, rel=1e-8, abs=1e-9 * np.abs(after).max())


def test_mass_moved_counts_both_ways() -> None:
    limit = (StaticPeak(field()), 0.5)
    result = optimise(APPENDIX_4, changes(), MassChange(), limits=[limit])
    paths = [mass.path for mass in changes().masses]
    moved = 3 * sum(abs(result.after.value(p) - APPENDIX_4.value(p)) for p in paths)
    moved += 3 * sum(weight.mass for weight in result.after.counterweights)
    assert result.objective == pytest.approx(moved, abs=1e-9)
    less = optimise(APPENDIX_4, changes(), AddedMass(), limits=[limit])
    assert less.objective < result.objective


def test_a_free_lever_is_at_least_as_good_as_any_fixed_one() -> None:
    """Levers in steps of 25 mm, each solved for itself, against the rail."""
    term = TrajectoryRms(solved())
    free = optimise(APPENDIX_4, Changes((), (beyond("b3", 7, 0.6, 0.6),)), term)
    levers = np.linspace(0.0, 0.6, 25)
    fixed = [
        optimise(APPENDIX_4, Changes((), (Rail("b3", 7, d, d, 0.6),)), term).objective
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
        result = optimise(design, changes(), term)
        for robot, said in (
            (design, result.values[0].before), (result.after, result.values[0].after)
        ):  # fmt: skip
            peaks = [abs(s.peak) for s in analyse(robot, trajectory()).summary]
            expected = max(peaks[:3]) if term.unit == "N m" else peaks[3]
            assert said == pytest.approx(expected, rel=1e-9)
        assert result.gap <= 1e-8 * result.objective


def test_nothing_may_change() -> None:
    result = optimise(APPENDIX_4, Changes(), TrajectoryRms(solved()))
    assert result.after == APPENDIX_4
    assert result.active == ()
    assert result.gap <= 1e-9 * result.objective
    fixed = MassRange("joints.j7", 0.28, 0.28)
    assert optimise(APPENDIX_4, Changes((fixed,)), TrajectoryPeak(solved())).after == APPENDIX_4


def test_inertia_follows_a_link_only_if_asked() -> None:
    for follows in (True, False):
        what = Changes((MassRange("links.b4", 0.336, 0.336, inertia_follows=follows),))
        after = optimise(APPENDIX_4, what, AddedMass()).after
        share = 0.5 if follows else 1.0
        assert after.inertias.b4_transverse == pytest.approx(share * 0.048)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: MassRange("joints.j7", 2.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", -1.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", 0.0, np.inf), "joints.j7"),
        (lambda: beyond("b8", 8, -0.1, 1.0), "B8"),
        (lambda: Rail("b8", 8, 0.0, 0.1, 1.0, 2.0), "B8"),
        (lambda: Changes((MassRange("joints.j7", 0, 1), MassRange("joints.j7", 0, 2))), "j7"),
        (
            lambda: optimise(APPENDIX_4, Changes((MassRange("inertias.b3_axial", 0, 1),)),
                             AddedMass()),
            "inertias.b3_axial",
        ),
        (
            lambda: optimise(APPENDIX_4, Changes((MassRange("counterweights.0.mass", 0, 1),)),
                             AddedMass()),
            "counterweights.0.mass",
        ),
        (lambda: optimise(APPENDIX_4, Changes(), [(-1.0, AddedMass())]), "added mass"),
        (
            lambda: optimise(APPENDIX_4.vary({"geometry.base_radius": 0.36}), Changes(),
                             StaticPeak(field())),
            "field",
        ),
        (
            lambda: optimise(APPENDIX_4, Changes(), TrajectoryPeak(solve_trajectory(
                APPENDIX_4.geometry, trajectory(), misprints=Misprint.APP3_MC4))),
            "trajectory",
        ),
        (
            lambda: optimise(
                APPENDIX_4.vary({"geometry.guide_stroke": 0.05}), Changes(),
                StaticPeak(solve_field(APPENDIX_4.vary(
                    {"geometry.guide_stroke": 0.05}).geometry, workspace())),
            ),
            "field",
        ),
    ],
)  # fmt: skip
def test_impossible_requests_are_refused(make, named: str) -> None:
    with pytest.raises((InvalidInput, InvalidDesign), match=named):
        make()


def test_a_trajectory_that_fails_is_refused() -> None:
    short = APPENDIX_4.vary({"geometry.guide_stroke": 0.1})
    with pytest.raises(InvalidInput, match="whole trajectory"):
        optimise(short, Changes(), TrajectoryPeak(solve_trajectory(short.geometry, trajectory())))
