"""Masses and springs of given lengths: certificate, limits, brute force, other routes, drives."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from paminsa_viz.actuation.duty import Duty
from paminsa_viz.actuation.selection import size_design
from paminsa_viz.balancing import (
    CounterweightRange,
    SpringPlace,
    at_joint,
    beyond,
    on_guide,
    spring_torques,
    whole_mass,
)
from paminsa_viz.balancing.program import Program
from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    Drive,
    LoadCase,
    static_imbalance,
    static_torques,
    unit_torques,
)
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.case import InnerCase, linear_bounds
from paminsa_viz.synthesis.masses.drives import solve_with_drives
from paminsa_viz.synthesis.masses.program import inner_program, solve_inner
from paminsa_viz.synthesis.masses.space import (
    InnerInfeasible,
    inner_space,
    motion_rows,
    sampled_solution,
    static_rows,
)
from paminsa_viz.trajectory import PRESET, analyze, solve_trajectory
from paminsa_viz.trajectory.integrals import running_integral
from tests.synthesis.inner_cases import MASSES, SPRING, WEIGHTS, case, motion, poses


@pytest.mark.parametrize("springs", [False, True])
@pytest.mark.parametrize("goal", ["peak_torque", "energy", "moving_mass"])
def test_optimum_is_certified_and_holds_on_other_routes(goal, springs):
    found = solve_inner(APPENDIX_4, case(goal, springs=springs), poses())
    assert found.gap <= 1e-8 * found.objective
    # dynamics and statics of the design that comes out, not the rows of the program
    analysis = analyze(found.design, motion())
    torque = analysis.torque + spring_torques(APPENDIX_4.geometry, found.springs, motion().pose)
    speed = sampled_solution(APPENDIX_4.geometry, motion(), 9.81).speed
    power = np.maximum(torque * speed, 0.0).sum(axis=1)
    values = {
        "peak_torque": np.abs(torque[:, :3]).max(),
        "energy": running_integral(motion().t, power)[-1],
        "moving_mass": whole_mass(found.design) - found.design.payload.mass,
    }
    assert found.objective == pytest.approx(values[goal], rel=1e-8)
    held = found.held(poses())
    assert np.abs(held[:, :3]).max() <= 1.0 + 1e-8
    assert held[:, 3].max() <= 225.0 + 1e-6
    assert np.abs(torque[:, 3]).max() <= 240.0 + 1e-6


def test_rows_are_the_torques_of_designs_with_springs():
    places = (SPRING, SpringPlace(on_guide(0.1, 0.2), at_joint(4), 500.0, 0.0, 0.3))
    load = replace(APPENDIX_4, load=LoadCase(force_x=5.0, force_z=-10.0), gravity=9.0)
    space = inner_space(load, case().changes(load), places)
    rng = np.random.default_rng(3)
    for _ in range(5):
        levers = [
            [(float(rng.uniform(*v.span)), float(rng.uniform(v.low, v.high)))]
            for v in space.variables
        ]
        state = Program(space.start, space.variables, ()).state(levers)
        design, springs = space.design_of(levers), space.springs_of(state)
        assert all(spring.stiffness > 1.0 for spring in springs)
        held = spring_torques(load.geometry, springs, poses()) + static_torques(design, poses())
        matrix, offset = static_rows(space, poses())
        np.testing.assert_allclose(matrix @ state + offset, held, rtol=1e-9, atol=1e-9)
        moving = inverse_dynamics(
            design, motion().pose, motion().velocity, motion().acceleration
        ).torque
        moving += spring_torques(load.geometry, springs, motion().pose)
        solved = sampled_solution(load.geometry, motion(), load.gravity)
        matrix, offset = motion_rows(space, solved)
        np.testing.assert_allclose(matrix @ state + offset, moving, rtol=1e-8, atol=1e-8)


@pytest.mark.slow
def test_no_random_choice_within_the_bounds_is_better():
    bounds = (Requirement("max_torque", high=5.0), Requirement("f_4", high=280.0))
    loose = replace(case(), bounds=bounds, motion_force=300.0)
    found = solve_inner(APPENDIX_4, loose, poses())
    rng = np.random.default_rng(0)
    solved = sampled_solution(APPENDIX_4.geometry, motion(), 9.81)
    feasible = 0
    for _ in range(400):
        numbers: dict[str, float | None] = {}
        for mass in MASSES:
            name, ratio = mass.path.removeprefix("links."), rng.uniform(mass.low, mass.high)
            followers = (f"inertias.{name}_axial", f"inertias.{name}_transverse")
            for path in (mass.path, *followers):
                numbers[path] = ratio * APPENDIX_4.value(path)
        weights = tuple(
            Counterweight(w.bar, w.joint, rng.uniform(w.nearest, w.farthest), m)
            for w in WEIGHTS
            if (m := w.high * rng.uniform() ** 2) > 0
        )
        design = replace(APPENDIX_4.vary(numbers), counterweights=weights)
        torque, held = solved.torques(design), static_torques(design, poses())
        if (
            np.abs(held[:, :3]).max() <= 5.0
            and held[:, 3].max() <= 280.0
            and np.abs(torque[:, 3]).max() <= 300.0
        ):
            feasible += 1
            assert np.abs(torque[:, :3]).max() >= found.lower_bound * (1 - 1e-9)
    assert feasible > 10


def test_two_counterweights_by_brute_force():
    places = (("b8", 8, 0.25), ("b4", 9, 0.2))
    ranges = tuple(CounterweightRange(bar, joint, at, at, 4.0) for bar, joint, at in places)
    limit = (Requirement("max_torque", high=2.0),)
    two = InnerCase("peak_torque", (motion(),), (), ranges, bounds=limit)
    found = solve_inner(APPENDIX_4, two, poses())
    solved = sampled_solution(APPENDIX_4.geometry, motion(), 9.81)
    gamma = np.abs(unit_torques(APPENDIX_4.geometry, poses())[:, :3]).max()

    def measures(*masses: float) -> np.ndarray:
        weights = (Counterweight(*place, m) for place, m in zip(places, masses, strict=True))
        design = replace(APPENDIX_4, counterweights=tuple(weights))
        torque = solved.torques(design)[:, :3].ravel()
        return np.append(torque, gamma * static_imbalance(design))

    # linear in the masses, so three robots give all others
    start = measures(0.0, 0.0)
    first, second = measures(1.0, 0.0) - start, measures(0.0, 1.0) - start
    side = np.linspace(0.0, 4.0, 401)
    best = np.inf
    for mass in side:
        found_there = np.abs(start + mass * first + side[:, None] * second)
        kept = found_there[:, -1] <= 2.0
        best = min(best, found_there[kept, :-1].max(axis=1).min(initial=np.inf))
    assert found.lower_bound <= best
    assert found.objective == pytest.approx(best, rel=0.01)
    assert any(item.unit == "N m" and item.price > 0 for item in found.active)


@pytest.mark.slow
@pytest.mark.parametrize("springs", [False, True])
def test_shadow_prices_are_what_finite_differences_say(springs):
    base = case(springs=springs)
    found = solve_inner(APPENDIX_4, base, poses())
    priced = {item.name: item for item in found.active if item.side == "high"}
    step = 1e-4
    for name, field, size in (
        ("force of M4 on the motions", "motion_force", 240.0),
        ("Largest static torque of M1 to M3", "max_torque", 1.0),
        ("Static force of M4", "f_4", 225.0),
    ):
        values = []
        for change in (-step, step):
            bound = size * (1 + change)
            bounds = [b if b.quantity != field else replace(b, high=bound) for b in base.bounds]
            other = replace(base, bounds=tuple(bounds))
            if field == "motion_force":
                other = replace(other, motion_force=bound)
            values.append(solve_inner(APPENDIX_4, other, poses()).objective)
        slope = (values[0] - values[1]) / (2 * step * size)
        price = priced[name].price if name in priced else 0.0
        assert price == pytest.approx(slope, rel=1e-3, abs=1e-5)
    if not springs:
        assert any(item.price > 1e-3 and item.unit in ("N", "N m") for item in priced.values())


def test_external_load_and_gravity_count():
    design = replace(APPENDIX_4, load=LoadCase(force_x=20.0, moment_z=3.0), gravity=8.0)
    found = solve_inner(design, replace(case(), bounds=(), motion_force=None), poses())
    peak = np.abs(analyze(found.design, motion()).torque[:, :3]).max()
    assert found.objective == pytest.approx(peak, rel=1e-8)
    loaded = InnerCase(
        "moving_mass", (), MASSES, WEIGHTS, bounds=(Requirement("max_torque", high=10.0),)
    )
    found = solve_inner(design, loaded, poses())
    assert np.abs(static_torques(found.design, poses())[:, :3]).max() <= 10.0 + 1e-8


def test_a_bound_counts_at_its_own_headings_and_heights():
    bounds = (Requirement("tau_1", low=-0.2, high=0.4, theta=(0.4, 0.6), z=(-0.6, -0.55)),)
    found = solve_inner(
        APPENDIX_4, InnerCase("moving_mass", (), MASSES, WEIGHTS, (), bounds), poses()
    )
    held, at = found.held(poses())[:, 0], poses()
    inside = (at[:, 2] > 0.4) & (at[:, 3] < -0.55)
    assert inside.any()
    assert held[inside].max() <= 0.4 + 1e-8
    assert held[inside].min() >= -0.2 - 1e-8
    assert not (held[~inside].max() <= 0.4 and held[~inside].min() >= -0.2)


def test_what_cannot_be_met_says_by_how_much():
    tight = replace(case(), bounds=(Requirement("f_4", high=100.0),))
    with pytest.raises(InnerInfeasible, match="Static force of M4") as caught:
        solve_inner(APPENDIX_4, tight, poses())
    assert 0.1 < caught.value.excess < 2.0
    # the least relaxation of all limits together that the excess promises is one
    factor = 1 + caught.value.excess * (1 + 1e-6)
    relaxed = replace(
        tight, bounds=(Requirement("f_4", high=100.0 * factor),), motion_force=240.0 * factor
    )
    solve_inner(APPENDIX_4, relaxed, poses())
    far = np.array([[0.0, 0.0, 0.0, -2.0]])
    with pytest.raises(InnerInfeasible, match="out of reach") as caught:
        solve_inner(APPENDIX_4, case(), far)
    assert caught.value.excess == np.inf


def test_wrong_cases_are_refused():
    with pytest.raises(InvalidInput, match=r"M_p2 = 0"):
        InnerCase("static_torque", (motion(),), MASSES)
    with pytest.raises(InvalidInput, match="at least one motion"):
        InnerCase("peak_torque", (), MASSES)
    with pytest.raises(InvalidInput, match="are known"):
        InnerCase("beauty", (motion(),), MASSES)
    with pytest.raises(InvalidInput, match="condition"):
        InnerCase("moving_mass", (), MASSES, bounds=(Requirement("condition", high=10.0),))
    with pytest.raises(InvalidInput, match="no motion"):
        InnerCase("moving_mass", (), MASSES, motion_force=3.0)
    with pytest.raises(InvalidInput, match="twice"):
        InnerCase("moving_mass", (), MASSES + MASSES)
    kept = linear_bounds([Requirement("condition", high=10.0), Requirement("f_4", high=1.0)])
    assert [bound.quantity for bound in kept] == ["f_4"]


def test_motion_of_a_trial_is_that_of_the_full_solution():
    quick = sampled_solution(APPENDIX_4.geometry, motion(), 9.81)
    full = solve_trajectory(APPENDIX_4.geometry, motion())
    np.testing.assert_array_equal(quick.y, full.y)
    np.testing.assert_array_equal(quick.speed, full.speed)
    assert quick.check.possible
    assert quick.check.side == full.check.side
    small = replace(APPENDIX_4.geometry, coupler_length=0.4, crank_length=0.3)
    failing = sampled_solution(small, motion(), 9.81)
    assert not failing.check.possible
    assert failing.check.first.limit == solve_trajectory(small, motion()).check.first.limit
    wide = PRESET["circle"].build(APPENDIX_4.geometry).sample(20)
    shifted = replace(wide, pose=wide.pose + np.array([0.2, 0.0, 0.0, 0.0]))
    assert not sampled_solution(APPENDIX_4.geometry, shifted, 9.81).check.possible
    with pytest.raises(InnerInfeasible, match="the motion fails"):
        inner_program(APPENDIX_4, InnerCase(motions=(shifted,)), poses())


def test_a_tolerance_saves_rounds_and_is_kept():
    levers = replace(case(), counterweights=(*WEIGHTS, beyond("b3", 7, 0.3, 2.0)))
    exact = solve_inner(APPENDIX_4, levers, poses())
    rough = solve_inner(APPENDIX_4, levers, poses(), tolerance=1e-3)
    assert rough.rounds <= exact.rounds
    assert exact.objective <= rough.objective <= exact.objective * (1 + 2e-3)


@pytest.mark.slow
def test_masses_are_the_best_with_drives_that_fit_them():
    case = InnerCase("peak_torque", (motion(),), MASSES, WEIGHTS[:1])
    found = solve_with_drives(APPENDIX_4, case, poses(), generic_catalog())
    assert found.feasible
    driven = found.inner.design
    assert all(driven.drives)
    # the drives' own inertia counts: the optimum is another than without them
    assert found.inner.objective > solve_inner(APPENDIX_4, case, poses()).objective
    again = solve_inner(replace(APPENDIX_4, drives=driven.drives), case, poses())
    assert again.objective == pytest.approx(found.inner.objective, rel=1e-9)
    assert np.abs(analyze(driven, motion()).torque[:, :3]).max() == pytest.approx(
        found.inner.objective, rel=1e-8
    )
    sized = size_design(found.selection.cycle, driven)
    assert all(figures is not None and figures.feasible for figures in sized)


@pytest.mark.parametrize("fit", [True, False])
@pytest.mark.parametrize("settles", [True, False])
def test_drives_are_chosen_again_until_they_are_those_of_the_round_before(
    settles: bool, fit: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or six times, where two sets lead to each other; only what goes around is of interest."""
    place = "paminsa_viz.synthesis.masses.drives"
    weak, strong = (Drive(rotor_inertia=inertia) for inertia in (1e-5, 2e-5))
    asked: list[tuple[object, ...]] = []

    class Chosen:
        feasible = fit

        def __init__(self, design: Design) -> None:
            self.following = strong if design.drives[0] == weak or settles else weak

        def design(self, design: Design) -> Design:
            assert not any(design.drives)
            return replace(design, drives=(self.following,) * 3 + (None,))

    def select(cycle: Design, *given: object, **more: object) -> Chosen:
        asked.append((given, more))
        return Chosen(cycle)

    def cycle(design: Design, duties: list[Duty]) -> Design:
        asked.append(tuple(duties))
        return design

    monkeypatch.setattr(f"{place}.solve_inner", lambda design, *_: SimpleNamespace(design=design))
    monkeypatch.setattr(f"{place}.duty_cycle", cycle)
    monkeypatch.setattr(f"{place}.select_drives", select)
    case = InnerCase("peak_torque", (motion(),), MASSES, WEIGHTS[:1])
    found = solve_with_drives(APPENDIX_4, case, poses(), generic_catalog())
    assert (found.rounds, found.settled) == ((2, True) if settles else (6, False))
    assert found.feasible is (settles and fit)
    assert found.inner.design.drives[0] == (strong if settles else weak)
    # each motion once, and drives that may differ, unless it is said
    assert asked[0] == (Duty(motion()),)
    assert asked[1] == ((generic_catalog(),), {"order": "mass", "same": False})
    asked.clear()
    duties = [Duty(motion(), 3)]
    solve_with_drives(
        APPENDIX_4, case, poses(), generic_catalog(), duties=duties, order="cost", same=True
    )
    assert asked[0] == tuple(duties)
    assert asked[1] == ((generic_catalog(),), {"order": "cost", "same": True})
    with pytest.raises(InvalidInput, match="at least one"):
        solve_with_drives(APPENDIX_4, case, poses(), generic_catalog(), duties=[])


def test_springs_and_missing_motions_are_refused():
    with pytest.raises(InvalidInput, match="without springs"):
        solve_with_drives(
            APPENDIX_4, InnerCase("moving_mass", (), MASSES, springs=(SPRING,)), poses(),
            generic_catalog(),
        )  # fmt: skip
    with pytest.raises(InvalidInput, match="at least one"):
        solve_with_drives(
            APPENDIX_4, InnerCase("moving_mass", (), MASSES), poses(), generic_catalog()
        )
