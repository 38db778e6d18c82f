"""Bounds, fronts, spreads and the paper's balance, part by part."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import (
    Changes,
    MassRange,
    SpringPlace,
    at_joint,
    beyond,
    fit_springs,
    on_slider,
    paper_balance,
    pareto,
    sensitivity,
    tolerance,
    tornado,
    whole_mass,
)
from paminsa_viz.balancing.changes import mass_space
from paminsa_viz.balancing.convex import MaxAbs
from paminsa_viz.balancing.effects import sizes_in_motion
from paminsa_viz.balancing.optimum import ACTIVE, active_bounds, movable_bounds
from paminsa_viz.balancing.paper_balance import _exact, _in_the_way
from paminsa_viz.balancing.program import Program, Variable
from paminsa_viz.balancing.terms import MP2
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Counterweight, static_imbalance, static_torques
from paminsa_viz.model.lumped import MASS_PATHS, lumped_coefficients
from tests.balancing.robots import workspace

# ---------------------------------------------------------------- the paper's balance


def space(*ranges: Any) -> Any:
    masses = tuple(one for one in ranges if isinstance(one, MassRange))
    weights = tuple(one for one in ranges if not isinstance(one, MassRange))
    return mass_space(APPENDIX_4, Changes(masses, weights))


def test_a_weight_that_is_added_where_one_is_makes_it_heavier() -> None:
    """They are one disc, whose room is larger than that of either."""
    held = (Counterweight("b3", 7, 0.2, 0.7), Counterweight("b3", 4, 0.2, 0.1))
    design = replace(APPENDIX_4, counterweights=held)
    changes = Changes((), (beyond("b3", 7, 0.3, 5.0),))
    places = [(0.1 + 0.1 + 1e-16, 1.25), (0.3, 0.5)]
    after = mass_space(design, changes).design_of([places]).counterweights
    assert after == (replace(held[0], mass=1.95), held[1], Counterweight("b3", 7, 0.3, 0.5))


def test_bounds_in_the_way_have_the_effect_of_a_unit_on_the_side_that_helps() -> None:
    made = space(
        MassRange("joints.j7", 0.1, 1.5), MassRange("joints.j9", 0.2, 0.3),
        MassRange("joints.j2", 0.1, 0.2), beyond("b8", 8, 0.3, 2.0),
    )  # fmt: skip
    slopes = {
        path: static_imbalance(APPENDIX_4.vary({path: APPENDIX_4.value(path) + 1.0}))
        - static_imbalance(APPENDIX_4)
        for path in ("joints.j7", "joints.j9")
    }
    weighted = replace(APPENDIX_4, counterweights=(Counterweight("b8", 8, 0.25, 1.0),))
    lever = static_imbalance(weighted) - static_imbalance(APPENDIX_4)
    far = replace(APPENDIX_4, counterweights=(Counterweight("b8", 8, 0.3, 1.0),))
    farthest = static_imbalance(far) - static_imbalance(APPENDIX_4)
    name = made.variables[3].name
    masses = [[(0.0, 1.5)], [(0.0, 0.2)], [(0.0, 0.1)]]
    for target in (2.5, -2.5):
        for places, effect in (([(0.25, 2.0)], lever), ([], farthest)):
            found = _in_the_way(made, SimpleNamespace(levers=[*masses, places]), target)  # type: ignore
            rows = {item.name: item for item in found}
            assert rows.keys() == {"joints.j7", "joints.j9", name}  # m_2 has no effect
            for path, slope in (*slopes.items(), (name, effect)):
                item = rows[path]
                assert item.price == pytest.approx(abs(slope))
                assert item.unit == "kg"
                side = "high" if slope * target < 0 else "low"
                assert item.side == side
                variable = next(v for v in made.variables if v.name == path)
                assert item.bound == getattr(variable, side)
            prices = [item.price for item in found]
            assert prices == sorted(prices, reverse=True)


def test_rounding_is_taken_out_by_the_free_mass_of_most_effect() -> None:
    """Not by one at its bound, one without effect, or one that is not there."""
    ranges = (
        MassRange("joints.j2", 0.0, 1.0), MassRange("joints.j7", 0.0, 9.0),
        MassRange("joints.j9", 0.0, 0.3),
    )  # fmt: skip
    made = space(*ranges, beyond("b8", 8, 0.3, 2.0))
    held = [[(0.0, 0.5)], [(0.0, 3.0)], [(0.0, 0.259)], []]
    levers = [list(places) for places in held]
    found = _exact(made, levers)
    changed = [number for number in range(4) if found[number] != held[number]]
    # joint 9 has three times the effect of joint 7
    assert changed == [2]
    assert held == levers  # what was given stays
    fixed = [[(0.0, 0.5)], [(0.0, 3.0)], [(0.0, 0.3)], []]
    found = _exact(made, fixed)
    assert [number for number in range(4) if found[number] != fixed[number]] == [1]
    assert abs(static_imbalance(made.design_of(found))) < 1e-14
    # nothing that is free, or nothing with an effect: as it was
    for bound in ([[(0.0, 0.5)], [(0.0, 9.0)], [(0.0, 0.3)], []],
                  [[(0.0, 0.5)], [(0.0, 0.0)], [(0.0, 0.0)], []]):  # fmt: skip
        assert _exact(made, bound) == bound
    # a weight with two places, of which one is empty: the other is moved, and not below nothing
    weight = [[(0.0, 0.5)], [(0.0, 0.0)], [(0.0, 0.0)], [(0.0, 0.0), (0.3, 1.5)]]
    found = _exact(made, weight)
    assert found[:3] == weight[:3]
    assert found[3][0] == (0.0, 0.0)
    assert found[3][1][0] == 0.3
    assert found[3][1][1] >= 0.0


# ---------------------------------------------------------------- bounds, fronts and spreads


def test_bounds_move_as_far_as_they_have_to_within_rounding() -> None:
    made = space(MassRange("joints.j7", 0.1, 1.5), MassRange("joints.j9", 0.2, 0.3))
    row = np.eye(1, len(made.start), MP2)

    def needed(target: float) -> dict[tuple[str, str], float]:
        limit = MaxAbs(row, np.array([-target]))
        found = movable_bounds(made, Program(made.start, made.variables, (), ((0.0, limit),)))
        own = {variable.name: variable for variable in made.variables}
        assert all(item.bound == getattr(own[item.name], item.side) for item in found)
        return {(item.name, item.side): item.needed for item in found}

    ends = [
        static_imbalance(APPENDIX_4.vary({"joints.j7": j7, "joints.j9": j9}))
        for j7, j9 in ((1.5, 0.2), (0.1, 0.3))
    ]
    # within the bounds nothing has to move
    assert needed(0.5 * sum(ends)) == {}
    for target in (ends[0] - 0.1, ends[1] + 0.1):
        ((name, side), value) = next(iter(needed(target).items()))
        low, high = next((v.low, v.high) for v in made.variables if v.name == name)
        assert value < low if side == "low" else value > high


def test_a_bound_that_is_not_reached_is_not_active() -> None:
    """Masses at an end within a millionth of their range; levers by the mass that is there."""
    made = space(MassRange("joints.j7", 1.0, 3.0), beyond("b8", 8, 0.3, 2.0))

    def found(amounts: Any, places: Any, prices: Any = (0.5, 0.5), slope: float = -4.0) -> Any:
        solution: Any = SimpleNamespace(
            amounts=np.array(amounts), levers=[[(0.0, amounts[0])], places],
            prices=np.array(prices), slopes=np.array([0.0, slope]), limit_prices=np.zeros(0),
        )  # fmt: skip
        return [(item.name, item.side, item.price) for item in active_bounds(made, solution)]

    name = made.variables[1].name
    inside = (0.15, 1.0)
    assert found((2.0, 1.0), [inside]) == []
    assert found((1.0 + 1.9e-6, 1.0), [inside]) == [("joints.j7", "low", 0.5)]
    assert found((1.0 + 2.1e-6, 1.0), [inside]) == []
    assert found((3.0 - 1.9e-6, 1.0), [inside], (-0.5, 0.5)) == [("joints.j7", "high", 0.5)]
    assert found((3.0 - 2.1e-6, 1.0), [inside], (-0.5, 0.5)) == []
    assert found((2.0, 1.5), [(0.3 - 2e-7, 1.5)]) == [(name, "farthest", 6.0)]
    assert found((2.0, 1.5), [(0.3 - 4e-7, 1.5)]) == []
    assert found((2.0, 1.5), [(2e-7, 0.5), (0.3, 1.0)], slope=4.0) == [
        (name, "nearest", 2.0), (name, "farthest", 0.0),
    ]  # fmt: skip
    near = ACTIVE * 2.0
    for amount in (1e-9, near):
        assert found((2.0, amount), [(0.3, amount)]) == [(name, "low", 0.5)]
    assert found((2.0, 1.0 + near), [(0.1, 1.0), (0.3, near)]) == []


def test_a_front_holds_the_first_term_within_rounding_of_its_best(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By a share of the larger of what is least and what was before; its ends and the levels."""
    first, second = (SimpleNamespace(label=name, unit="N") for name in ("a", "b"))
    asked: list[Any] = []

    def optimize(design: Any, changes: Any, goal: Any, *, limits: Any) -> Any:
        held = {term.label: most for term, most in limits}
        asked.append((goal.label, held))
        before = {"a": -8.0, "b": 3.0}
        after = {"a": -2.0 if goal is first else 1.0, "b": -6.0 if goal is second else 5.0}
        if held and goal is second:
            after = {"a": held.get("a"), "b": 4.0}
        if held and goal is first:
            after = {"a": 7.0 - held["b"], "b": held["b"]}
        order = [goal, second if goal is first else first] if held else [goal]
        values = [
            SimpleNamespace(label=term.label, before=before[term.label], after=after[term.label])
            for term in order
        ]
        return SimpleNamespace(objective=after[goal.label], values=values)

    monkeypatch.setattr(pareto, "optimize", optimize)
    told: list[float] = []
    front = pareto.pareto_front(
        APPENDIX_4, Changes(()), first, second, points=5, progress=lambda d: bool(told.append(d))
    )  # type: ignore
    assert asked[0] == ("a", {})
    assert asked[1] == ("b", {"a": pytest.approx(-2.0 + 8e-9, rel=1e-12)})
    assert asked[2] == ("b", {})
    assert asked[3] == ("a", {"b": pytest.approx(-6.0 + 6e-9, rel=1e-12)})
    assert [row[1]["b"] for row in asked[4:]] == pytest.approx([1.5, -1.0, -3.5])
    assert [point.second for point in front.points] == pytest.approx([4.0, 1.5, -1.0, -3.5, -6.0])
    assert front.before == (-8.0, 3.0)
    assert (front.labels, front.units) == (("a", "b"), ("N", "N"))
    assert told == [0.4, 0.6, 0.8, 1.0]


def test_so_many_samples_that_are_no_robots_are_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten for each that is asked for; fewer are counted."""
    left = [0]

    class Draws:
        def __init__(self, seed: int) -> None:
            pass

        def uniform(self, low: float, high: float, size: int) -> Any:
            left[0] -= 1
            return np.full(size, 1.0 if left[0] >= 0 else 0.0) * [0, 0, 0, -1, -1, 0]

    monkeypatch.setattr(np.random, "default_rng", Draws)
    pose = [0.0, 0.0, 0.0, -0.5]
    lengths = {"geometry.crank_length": 0.9, "geometry.coupler_length": 0.9}
    for samples, bad in ((1, 10), (2, 20), (1, 3), (1, 0)):
        left[0] = bad
        found = tolerance.length_tolerance(APPENDIX_4, lengths, pose, samples=samples)
        assert (found.impossible, len(found.peaks)) == (bad, samples)
        assert found.nominal == pytest.approx(np.abs(static_torques(APPENDIX_4, pose)[:3]).max())
    left[0] = 11
    with pytest.raises(InvalidInput, match="hardly any sample"):
        tolerance.length_tolerance(APPENDIX_4, lengths, pose, samples=1)


def test_poses_that_a_sample_cannot_take_are_counted_and_a_peak_has_no_sign() -> None:
    poses = np.array([[0.1, 0.0, 0.2, -0.5], [0.0, 0.0, 0.0, -9.0], [0.05, -0.02, -0.3, -0.6]])
    peak, lost = tolerance._peak(APPENDIX_4, poses)
    assert lost == 1
    torque = static_torques(APPENDIX_4, poses[[0, 2]])[:, :3]
    assert peak == pytest.approx(np.abs(torque).max())
    mirrored = poses * [-1, 1, -1, 1]
    assert tolerance._peak(APPENDIX_4, mirrored)[0] == pytest.approx(peak)
    smallest = [tolerance._peak(APPENDIX_4, row[None])[0] for row in poses[[0, 2]]]
    assert max(smallest) == pytest.approx(peak)
    assert torque.max() != pytest.approx(-torque.min())
    assert tolerance._peak(APPENDIX_4, poses[1:2]) == (0.0, 1)


def test_a_motion_that_cannot_begin_has_no_sizes() -> None:
    nothing = sizes_in_motion(SimpleNamespace(summary=()))  # type: ignore
    assert nothing.shape == (3, 4)
    assert np.isnan(nothing).all()
    sizes = (1.0, 2.0, 3.0, 4.0)
    loads = [SimpleNamespace(peak=-n, rms=2.0 * n, top_power=-3.0 * n) for n in sizes]
    found = sizes_in_motion(SimpleNamespace(summary=loads))  # type: ignore
    np.testing.assert_array_equal(found, np.outer([1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0]))


def test_masses_are_changed_by_their_share_and_slopes_by_a_millionth(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At least a millionth of a gram, where a mass is next to nothing."""
    light = APPENDIX_4.vary({"joints.j9": 1e-4, "joints.j7": 0.5})
    asked: list[float] = []
    base = np.zeros(60)

    def outputs(state: Any) -> Any:
        asked.append(float(state[-1]))
        return np.full(5, state[-1] ** 3)

    for path in ("joints.j9", "joints.j7"):
        value = light.value(path)
        whole = SimpleNamespace(variables=[Variable(path, 0.0, 1.0, np.ones((3, 60)))])
        monkeypatch.setattr(sensitivity, "mass_space", lambda *_, s=whole: s)
        monkeypatch.setattr(sensitivity, "AMOUNTS", 60)
        asked.clear()
        (bar,) = sensitivity._mass_bars(light, outputs, base, 0.05, [path])
        step = 1e-6 * max(value, 1e-3)
        assert asked[:4] == pytest.approx([-0.05 * value, 0.05 * value, -step, step])
        assert bar.derivative == pytest.approx(np.full(5, step**2))
        assert (bar.path, bar.unit, bar.value) == (path, "kg", value)
        assert bar.symbol != path
        assert bar.plus == pytest.approx(np.full(5, (0.05 * value) ** 3))


@pytest.mark.parametrize("change", [-0.1, 0.0, 1.0, 1.5])
def test_changes_are_parts_between_none_and_all(change: float) -> None:
    with pytest.raises(InvalidInput, match="between 0 and 1"):
        tornado(APPENDIX_4, workspace(), change=change, paths=["joints.j9"])


def test_an_unknown_measure_of_springs_is_refused_and_a_spring_of_no_length_pulls_nowhere() -> None:
    place = SpringPlace(on_slider(0.3), at_joint(9), 2000.0, 0.0, 0.2)
    with pytest.raises(InvalidInput, match="'peak' or 'rms'"):
        fit_springs(APPENDIX_4, [place], [0.0, 0.0, 0.0, -0.5], measure="mean")
    same = SpringPlace(at_joint(9), at_joint(9), 2000.0, 0.0, 0.2)
    found = fit_springs(APPENDIX_4, [same], [[0.1, 0.0, 0.2, -0.5], [0.0, 0.0, 0.0, -0.6]])
    assert found.after == pytest.approx(found.before)
    assert found.reach == ((0.0, 0.0),)
    torque = static_torques(APPENDIX_4, [[0.1, 0.0, 0.2, -0.5], [0.0, 0.0, 0.0, -0.6]])[:, :3]
    assert found.before == pytest.approx(np.abs(torque).max())


@pytest.mark.parametrize("reached", [True, False])
def test_the_solvers_rounding_is_taken_out_where_the_balance_is_exact(
    monkeypatch: pytest.MonkeyPatch, reached: bool
) -> None:
    """And where it is not, what the solver found stays."""
    solve = paper_balance.solve

    def rough(program: Program) -> Any:
        found = solve(program)
        levers = [[(lever, amount + 1e-7) for lever, amount in places] for places in found.levers]
        return replace(found, levers=levers)

    monkeypatch.setattr(paper_balance, "solve", rough)
    ranges = Changes((MassRange("joints.j7", 0.1, 9.0 if reached else 1.5),))
    after = paper_balance.balance(APPENDIX_4, ranges).after
    if reached:
        assert abs(static_imbalance(after)) < 1e-14
    else:
        assert after.joints.j7 == 1.5 + 1e-7


def test_inertia_follows_a_mass_that_is_there() -> None:
    """In proportion to it; that of a bar without mass stays as it is."""
    for value in (0.7, 0.0):
        bare = APPENDIX_4.vary({"links.b8": value})
        for follows in (True, False):
            made = mass_space(bare, Changes((MassRange("links.b8", 0.0, 1.0, follows),)))
            heavier = bare.vary({"links.b8": value + 0.5})
            if follows and value:
                held = {p: bare.value(p) for p in MASS_PATHS if p.startswith("inertias.b8_")}
                share = (value + 0.5) / value
                heavier = heavier.vary({path: share * inertia for path, inertia in held.items()})
            change = lumped_coefficients(heavier) - lumped_coefficients(bare)
            np.testing.assert_allclose(made.variables[0].effect[0, :18], 2 * change, atol=1e-12)


def test_spreads_of_many_poses_are_those_of_each() -> None:
    poses = workspace().poses().reshape(-1, 4)[:1200:50].reshape(2, -1, 4)
    every = tolerance.mass_tolerance(APPENDIX_4, 0.02, poses)
    for name in ("torque", "torque_deviation", "torque_worst"):
        alone = [
            getattr(tolerance.mass_tolerance(APPENDIX_4, 0.02, pose), name)
            for pose in poses.reshape(-1, 4)
        ]
        np.testing.assert_allclose(getattr(every, name).reshape(-1, 3), alone, rtol=1e-9)


def test_a_mass_changes_once_and_its_inertia_with_it() -> None:
    heavy = MassRange("links.b8", 0.0, 3.0)
    with pytest.raises(InvalidInput, match="twice"):
        Changes((heavy, MassRange("joints.j7", 0.0, 1.0), heavy))
    made = space(heavy)
    held = APPENDIX_4.links.b8
    after = made.design_of([[(0.0, 2 * held)]])
    assert after.links.b8 == 2 * held
    for path in ("inertias.b8_axial", "inertias.b8_transverse"):
        assert after.value(path) == pytest.approx(2 * APPENDIX_4.value(path))


@pytest.mark.parametrize("path", ["counterweights.1.mass", "counterweights.0.beyond"])
def test_what_is_no_mass_of_the_design_cannot_change(path: str) -> None:
    weighted = replace(APPENDIX_4, counterweights=(Counterweight("b8", 8, 0.1, 1.0),))
    with pytest.raises(InvalidInput):
        mass_space(weighted, Changes((MassRange(path, 0.0, 1.0),)))


@pytest.mark.parametrize("seed", range(3))
def test_states_are_those_of_the_designs_that_they_stand_for(seed: int) -> None:
    """Coefficients, the whole mass and the amounts; a range without mass leaves no weight."""
    rng = np.random.default_rng(seed)
    design = replace(
        APPENDIX_4, counterweights=(Counterweight("b3", 7, 0.1, 0.8),),
        payload=replace(APPENDIX_4.payload, mass=1.5),
    )  # fmt: skip
    paths = ("links.b4", "joints.j7", "platform.mass", "payload.mass", "counterweights.0.mass")
    masses = tuple(MassRange(path, 0.1, 4.0) for path in paths)
    weights = (beyond("b8", 8, 0.3, 2.0), beyond("b3", 7, 0.2, 1.0))
    made = mass_space(design, Changes(masses, weights))
    legs = sum(design.value(p) for p in MASS_PATHS if p.startswith(("joints.", "links."))) + 0.8
    whole = 3 * legs + design.platform.mass + 1.5
    assert whole_mass(design) == pytest.approx(whole)
    amounts = rng.uniform(0.1, 4.0, len(paths))
    places = [[(0.05, 0.7), (0.3, 0.4)], [(0.2, 0.0)] if seed else []]
    levers = [*([(0.0, float(amount))] for amount in amounts), *places]
    state = Program(made.start, made.variables, ()).state(levers)
    after = made.design_of(levers)
    assert [weight.mass for weight in after.counterweights] == [amounts[4], 0.7, 0.4]
    np.testing.assert_allclose(state[:18], lumped_coefficients(after), rtol=1e-9, atol=1e-9)
    assert state[18] == pytest.approx(whole_mass(after))
    np.testing.assert_allclose(state[19:], [*amounts, 1.1, 0.0])
    np.testing.assert_allclose(made.before[:18], lumped_coefficients(design), rtol=1e-12)
    assert made.before[18] == pytest.approx(whole)
    assert made.before[19:].tolist() == [*(design.value(path) for path in paths), 0.0, 0.0]
    assert made.counts.tolist() == [3, 3, 1, 1, 3, 3, 3]
