"""Margins of answers and of their limits, quantity by quantity, against single designs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import Spring, spring_torques
from paminsa_viz.engines.verification import torque_scale
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, LoadCase
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.reach import check_reach, home_pose
from paminsa_viz.model.statics import static_torques
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.answer import engine_check
from paminsa_viz.synthesis.answer.checks import (
    AnswerMargins,
    build_yield,
    built_robots,
    fraction,
)
from paminsa_viz.synthesis.answer.engine_check import MujocoCheck, _at_rest, _row
from paminsa_viz.synthesis.masses.case import InnerCase, find_goal
from paminsa_viz.synthesis.masses.program import inner_program
from paminsa_viz.synthesis.masses.space import (
    bound_margins,
    inner_space,
    limits_at_rest,
    sampled_solution,
    within,
)
from paminsa_viz.synthesis.search.extremes import Extent, least_on_samples
from paminsa_viz.trajectory import Trajectory
from tests.synthesis.inner_cases import SPRING, case, motion, poses
from tests.synthesis.robots import cylinder

TURN = 0.3
PLACE = cylinder(0.2, 0.2)
SPRINGS = (Spring(SPRING.first, SPRING.second, 1000.0, 0.15),)


@cache
def short() -> Trajectory:
    return motion().take(np.arange(0, motion().size, 5))


def test_margins_at_rest_are_the_least_of_their_own_poses() -> None:
    bounds = (
        Requirement("max_torque", high=9.0), Requirement("tau_2", low=-9.0, high=12.0),
        Requirement("f_4", high=500.0, z=(-0.6, -0.5)),
        Requirement("tau_1", low=-7.0, theta=(0.0, 0.1)),
    )  # fmt: skip
    asked = AnswerMargins(Requirements(bounds, (-TURN, TURN), PLACE), SPRINGS)
    pose = asked.poses()
    held = static_torques(APPENDIX_4, pose) + spring_torques(APPENDIX_4.geometry, SPRINGS, pose)
    found = asked(APPENDIX_4)
    for bound in bounds:
        theta, z = bound.theta or (-9, 9), bound.z or (-9, 9)
        near = 1e-9
        inside = (pose[:, 2] >= theta[0] - near) & (pose[:, 2] <= theta[1] + near)
        inside &= (pose[:, 3] >= z[0] - near) & (pose[:, 3] <= z[1] + near)
        assert 0 < inside.sum() <= len(pose)
        value = {
            "max_torque": np.abs(held[:, :3]).max(axis=1), "tau_1": held[:, 0],
            "tau_2": held[:, 1], "f_4": held[:, 3],
        }[bound.quantity]  # fmt: skip
        least = float(bound.margin(value[inside]).min())
        assert found[requirement_label(bound)] == pytest.approx(least, rel=1e-12)
    assert (pose[:, 2].min(), pose[:, 2].max()) == pytest.approx((-TURN, TURN))
    assert np.hypot(*pose[:, :2].T).max() == pytest.approx(0.1)
    assert len(np.unique(np.round(pose[:, 2], 9))) == 9
    assert len(np.unique(np.round(pose[:, 3], 9))) == 9


def test_what_takes_long_is_measured_where_it_has_to_hold() -> None:
    high = Requirement("stiffness_x", low=1e3, z=(-0.55, 0.0), theta=(0.0, 0.1))
    nowhere = replace(high, z=(0.0, 1.0))
    asked = AnswerMargins(Requirements((high, nowhere), (-TURN, TURN), PLACE))
    found = asked(APPENDIX_4)
    part = Extent(replace(PLACE, center=(0.0, 0.0, -0.525), size=(0.2, 0.2, 0.05)), (0.0, 0.1))
    least = least_on_samples("stiffness_x", APPENDIX_4, part)
    assert found[requirement_label(high)] == pytest.approx(least - 1e3, rel=1e-9)
    assert found[requirement_label(nowhere)] == np.inf


def test_margins_of_motions_are_those_of_the_actuators_they_are_of() -> None:
    asked = AnswerMargins(Requirements(), (), (short(),), 5.0, 7.0)
    for index in range(4):
        for sign in (1.0, -1.0):
            torque = np.zeros((3, 4))
            torque[1, index] = sign * 2.0
            rows = asked.motion_margins(short(), torque)
            margins = [row[3] for row in rows]
            assert margins == ([3.0, 7.0] if index < 3 else [5.0, 5.0])
    assert [row[:3] for row in rows] == [
        (f"torque of M1-M3 on {short().name}", "N m", 5.0),
        (f"force of M4 on {short().name}", "N", 7.0),
    ]
    assert replace(asked, motion_force=None).motion_margins(short(), np.zeros((1, 4)))[0][3] == 5.0
    assert replace(asked, motion_torque=None, motion_force=None).motion_margins(
        short(), np.zeros((1, 4))
    ) == []  # fmt: skip
    states = short().pose, short().velocity, short().acceleration
    torque = inverse_dynamics(APPENDIX_4, *states, load=short().load).torque
    torque += spring_torques(APPENDIX_4.geometry, SPRINGS, short().pose)
    asked = replace(asked, springs=SPRINGS, requirements=Requirements((), (-TURN, TURN), PLACE))
    found = asked(APPENDIX_4)
    most = np.abs(torque).max(axis=0)
    assert found[f"torque of M1-M3 on {short().name}"] == pytest.approx(5.0 - most[:3].max())
    assert found[f"force of M4 on {short().name}"] == pytest.approx(7.0 - most[3])
    solved = sampled_solution(APPENDIX_4.geometry, short(), APPENDIX_4.gravity)
    assert found[f"run {short().name}"] == solved.check.closest.margin


def test_a_margin_of_zero_is_met_and_the_most_frequent_is_named_first() -> None:
    names = iter(range(100))

    def margins(design: Any) -> dict[str, float]:
        n = next(names)
        return {"never": 0.0, "often": 1.0 - n % 2 * 2, "rare": -1.0 if n % 5 == 0 else 0.5}

    told: list[float] = []
    found = build_yield(APPENDIX_4, margins, samples=20, progress=lambda d: bool(told.append(d)))
    assert list(found.missed.items()) == [("often", 10), ("rare", 4)]
    assert found.fraction.passed == 20 - len({*range(1, 20, 2), *range(0, 20, 5)})
    assert found.worst == {"never": 0.0, "often": -1.0, "rare": -1.0}
    assert not found.canceled
    assert told == pytest.approx([0.4, 0.8, 1.0])
    assert found.fraction.confidence == 0.95
    # ended with the last part is not ended
    assert not build_yield(APPENDIX_4, lambda _: {}, samples=8, progress=lambda d: True).canceled
    whole = build_yield(APPENDIX_4, lambda _: {"a": 0.1})
    assert whole.fraction.samples == 400
    worst = build_yield(APPENDIX_4, lambda _: {"a": float("nan")}, samples=2).worst
    assert worst == {"a": -np.inf}


def test_every_mass_but_the_payload_is_off_by_two_percent_at_most() -> None:
    design = replace(APPENDIX_4, payload=replace(APPENDIX_4.payload, mass=3.0))
    first, *others = built_robots(design, 60)
    assert first is not None
    for path in MASS_PATHS:
        value = design.value(path)
        shares = np.array([robot.value(path) / value for robot in (first, *others) if value])
        if path == "payload.mass":
            assert (shares == 1.0).all()
        elif value and PARAMETER[path].unit == "kg":
            assert 0.015 < np.abs(shares - 1).max() <= 0.02 * (1 + 1e-9), path
    again, more = built_robots(design, 1), built_robots(design, 1, seed=1)
    assert again[0] == built_robots(design, 1, seed=0)[0] != more[0]
    assert built_robots(design, 1, mass_tolerance=0.0)[0] is not None
    lightest = min(robot.links.b3 for robot in (first, *others) if robot is not None)
    found = build_yield(design, lambda robot: {"b3": robot.links.b3}, samples=60)
    assert found.worst == {"b3": lightest}
    for samples, tolerance in ((0, 0.1), (1, 1.0), (1, -1e-9)):
        with pytest.raises(InvalidInput):
            built_robots(design, samples, mass_tolerance=tolerance)


def test_a_part_is_from_none_to_all_of_at_least_one() -> None:
    for passed, samples in ((0, 1), (1, 1)):
        assert fraction(passed, samples).value == passed
    assert fraction(3, 4).value == 0.75
    for passed, samples in ((0, 0), (-1, 3), (4, 3)):
        with pytest.raises(InvalidInput, match="no part of anything"):
            fraction(passed, samples)
    for confidence in (0.0, 1.0, -0.5):
        with pytest.raises(InvalidInput, match="confidence"):
            fraction(1, 2, confidence)


@pytest.mark.parametrize("limit", [0.5, -0.5, 20.0, -20.0, 1.0])
def test_a_bound_may_be_broken_by_a_millionth_of_itself(limit: float) -> None:
    most = 1e-6 * max(1.0, abs(limit))
    for engine, met in ((-most, True), (-0.99 * most, True), (-1.01 * most, False), (1.0, True)):
        row = _row("a", "N", 3, 0.5, engine, limit)
        assert (row.met, row.engine, row.computed, row.poses) == (met, engine, 0.5, 3)
    good, bad = _row("a", "N", 3, 0.0, 0.0, 1.0), _row("a", "N", 3, 0.0, -1.0, 1.0)
    for rows, difference, passed in (
        ((good, good), 1e-6, True), ((good, bad), 1e-7, False), ((good,), 1.1e-6, False),
    ):  # fmt: skip
        assert MujocoCheck("3", rows, (), difference).passed is passed


def test_bars_at_rest_have_inertias_of_a_body() -> None:
    thick = APPENDIX_4.vary({"inertias.b4_axial": 5 * APPENDIX_4.value("inertias.b4_transverse")})
    found = _at_rest(thick)
    assert found.value("inertias.b4_axial") == pytest.approx(
        1.9 * found.value("inertias.b4_transverse")
    )
    assert found.vary({"inertias.b4_axial": thick.value("inertias.b4_axial")}) == thick
    assert _at_rest(APPENDIX_4) == APPENDIX_4


class MadeUpEngine:
    """An engine that has the formulas' torques, and off by so much at rest and on each motion."""

    made: list[MadeUpEngine]
    off: tuple[float, ...]

    def __init__(self, design: Design, springs: Any) -> None:
        self.design, self.springs, self.asked = design, springs, np.empty((0, 4))
        self.errors = iter(self.off)
        self.made.append(self)

    def static_torques(self, pose: Any) -> Any:
        self.asked = pose
        torque = static_torques(self.design, pose)
        torque += spring_torques(self.design.geometry, self.springs, pose)
        return torque + np.array([next(self.errors), 0.0, 0.0, 0.0])

    def inverse_dynamics(self, pose: Any, velocity: Any, acceleration: Any, *, load: Any) -> Any:
        torque = inverse_dynamics(self.design, pose, velocity, acceleration, load=load).torque
        torque += spring_torques(self.design.geometry, self.springs, pose)
        return torque + np.array([next(self.errors), 0.0, 0.0, 0.0])


def by_made_up_engine(
    monkeypatch: pytest.MonkeyPatch, off: tuple[float, ...], asked: AnswerMargins, pose: Any = None
) -> tuple[MujocoCheck, MadeUpEngine]:
    """What an engine that is off says of a thick bar's robot, and the engine."""
    engine = type("Own", (MadeUpEngine,), {"made": [], "off": off})
    monkeypatch.setattr(engine_check, "SprungMujocoRobot", engine)
    monkeypatch.setattr(engine_check, "load_mujoco", lambda: SimpleNamespace(__version__="9.1"))
    found = engine_check.check_by_mujoco(THICK, asked, pose)
    return found, engine.made[0]


THICK = APPENDIX_4.vary({"inertias.b4_axial": 5 * APPENDIX_4.value("inertias.b4_transverse")})


def test_an_engine_is_asked_for_random_poses_and_the_worst_of_each_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bounds = (
        Requirement("max_torque", high=9.0), Requirement("condition", high=9.0),
        Requirement("f_4", low=50.0, high=300.0, z=(-0.6, -0.5)), Requirement("tau_1", low=-8.0),
        Requirement("tau_2", high=9.0, z=(3.0, 4.0)),
    )  # fmt: skip
    asked = AnswerMargins(Requirements(bounds, (-TURN, TURN), PLACE), SPRINGS)
    found, engine = by_made_up_engine(monkeypatch, (0.25,), asked)
    pose = asked.poses()
    held = static_torques(THICK, pose) + spring_torques(THICK.geometry, SPRINGS, pose)
    high = (pose[:, 3] >= -0.6 - 1e-9) & (pose[:, 3] <= -0.5 + 1e-9)
    lift = np.where(high, np.minimum(held[:, 3] - 50.0, 300.0 - held[:, 3]), np.inf)
    rows = [int(np.flatnonzero((pose == one).all(axis=1))[0]) for one in engine.asked]
    assert rows == sorted(set(rows))
    random = set(np.random.default_rng(0).permutation(len(pose))[:60].tolist())
    assert random <= set(rows)
    worst = set()
    for margin in (-np.abs(held[:, :3]).max(axis=1), lift, held[:, 0]):
        fifth = np.sort(margin)[4]  # mirrored poses are equally bad but for rounding
        assert np.sort(margin[rows])[:5] == pytest.approx(np.sort(margin)[:5], rel=1e-9)
        worst |= set(np.flatnonzero(margin <= fifth + 1e-9 * abs(fifth)).tolist())
    assert set(rows) <= random | worst
    assert len(rows) <= 60 + 3 * 5
    assert engine.springs == SPRINGS
    assert engine.design == _at_rest(THICK.without_friction())
    assert (found.version, found.left_out) == ("9.1", ("condition",))
    off = held[rows] + [0.25, 0.0, 0.0, 0.0]
    expected = [
        (len(rows), *(9.0 - np.abs(t[:, :3]).max() for t in (held[rows], off))),
        (int(high[rows].sum()), *[float(lift[rows].min())] * 2),
        (len(rows), *(8.0 + t[:, 0].min() for t in (held[rows], off))),
    ]
    for row, (count, ours, engines) in zip(found.rows, expected, strict=True):
        assert row.poses == count
        assert (row.computed, row.engine) == pytest.approx((ours, engines), rel=1e-9)
        assert row.met is bool(engines >= 0.0)
    scale = torque_scale(THICK, pose[rows], off)
    assert found.difference == pytest.approx(0.25 / scale[0])


def test_the_largest_difference_of_an_engine_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """At rest or on any motion, for which the bars have their own inertias."""
    other = replace(short(), name="other")
    motions = (short(), other)
    asked = AnswerMargins(Requirements((), (-TURN, TURN), PLACE), SPRINGS, motions, 5.0, 700.0)
    for off in ((0.1, 0.0, 0.0), (0.0, 0.2, 0.1), (0.0, 0.0, -0.1)):
        found, engine = by_made_up_engine(monkeypatch, off, asked, asked.poses()[:9])
        assert engine.design == THICK.without_friction()
        again = engine.__class__(engine.design, SPRINGS)
        states = [(m.pose, m.velocity, m.acceleration) for m in motions]
        torques = [again.static_torques(engine.asked)]
        torques += [again.inverse_dynamics(*s, load=short().load) for s in states]
        places = [engine.asked, *(m.pose for m in motions)]
        scales = [torque_scale(THICK, *two)[0] for two in zip(places, torques, strict=True)]
        assert found.difference == pytest.approx(np.max(np.abs(off) / scales))
        expected = [
            (most - np.abs(torque[:, part]).max(), 0.0 if part.start else error)
            for torque, error in zip(torques[1:], off[1:], strict=True)
            for part, most in ((slice(0, 3), 5.0), (slice(3, 4), 700.0))
        ]
        assert len(found.rows) == 4
        for row, (margin, error) in zip(found.rows, expected, strict=True):
            assert row.engine == pytest.approx(margin)
            assert abs(row.computed - row.engine) <= abs(error) * (1 + 1e-9)
            assert row.poses == short().size
    pose = asked.poses()[:3].copy()
    pose[1, 3] = -3.0
    for wrong in (pose, pose[:0]):
        with pytest.raises(InvalidInput, match="none out of reach"):
            by_made_up_engine(monkeypatch, (0.0, 0.0, 0.0), asked, wrong)


def test_each_limit_of_a_program_is_its_quantity_of_the_design() -> None:
    """At rest, on motions, and of other goals; with a load, no spring, one side and both."""
    design = replace(APPENDIX_4, load=LoadCase(force_x=3.0, force_z=-8.0))
    bounds = (
        Requirement("max_torque", high=4.0), Requirement("f_4", low=-3.0, high=225.0),
        Requirement("tau_1", low=-5.0, high=5.0), Requirement("tau_2", low=-5.0, high=6.0),
        Requirement("tau_3", low=-4.0),
    )  # fmt: skip
    asked = replace(
        case("peak_torque", springs=True), motions=(short(),), bounds=bounds, motion_torque=3.0,
        motion_force=240.0, most=(("moving_mass", 50.0), ("energy", 90.0)),
    )  # fmt: skip
    program = inner_program(design, asked, poses())
    state = program.space.before
    held = static_torques(design, poses())
    states = short().pose, short().velocity, short().acceleration
    driven = inverse_dynamics(design, *states, load=short().load).torque
    mass = find_goal("moving_mass", free=True, motions=1).term(program.space, program.motions)
    energy = find_goal("energy", free=True, motions=1).term(program.space, program.motions)
    expected = [
        ("high", 4.0, np.abs(held[:, :3]).max()), ("high", 225.0, held[:, 3].max()),
        ("low", -3.0, -held[:, 3].min()), ("high", 5.0, np.abs(held[:, 0]).max()),
        ("high", 6.0, held[:, 1].max()), ("low", -5.0, -held[:, 1].min()),
        ("low", -4.0, -held[:, 2].min()), ("high", 3.0, np.abs(driven[:, :3]).max()),
        ("high", 240.0, np.abs(driven[:, 3]).max()), ("high", 50.0, mass.value(state)),
        ("high", 90.0, energy.value(state)),
    ]  # fmt: skip
    assert [(item.side, item.bound) for item in program.limits] == [row[:2] for row in expected]
    for item, (side, bound, value) in zip(program.limits, expected, strict=True):
        assert item.term.value(state) == pytest.approx(value, rel=1e-9), item.label
        assert item.limit == (-bound if side == "low" else bound)
    units = [item.unit for item in program.limits[7:]]
    assert units == ["N m", "N", "kg", "J"]
    assert [item.requirement for item in program.limits[:7]] == [
        bounds[0], *bounds[1:2] * 2, bounds[2], *bounds[3:4] * 2, bounds[4],
    ]  # fmt: skip
    # each actuator of a motion by itself
    matrix, offset = program.motions[0][1:]
    found = matrix @ state + offset
    np.testing.assert_allclose(found, driven, rtol=1e-9, atol=1e-9)


def test_the_two_extreme_poses_bound_all_where_masses_alone_count() -> None:
    asked = case()
    space = inner_space(APPENDIX_4, asked.changes(APPENDIX_4), ())
    held = static_torques(APPENDIX_4, poses())
    for name, columns in (("tau_2", [1]), ("max_torque", [0, 1, 2])):
        (item,) = limits_at_rest(space, Requirement(name, high=1.0), poses())
        rows = item.term.matrix
        assert len(rows) == 2 * len(columns)
        value = np.abs(held[:, columns]).max() if name == "max_torque" else held[:, columns].max()
        assert item.term.value(space.before) == pytest.approx(value)
    with pytest.raises(InvalidInput, match="no pose"):
        limits_at_rest(space, Requirement("tau_2", high=1.0, z=(3.0, 4.0)), poses())


def test_poses_just_beyond_the_ends_of_a_bound_count() -> None:
    bound = Requirement("tau_1", high=1.0, theta=(0.1, 0.2), z=(-0.6, -0.5))
    for column, ends in ((2, (0.1, 0.2)), (3, (-0.6, -0.5))):
        pose = np.tile([0.0, 0.0, 0.15, -0.55], (6, 1))
        pose[:, column] = [
            ends[0] - 1.1e-9, ends[0] - 0.9e-9, ends[0],
            ends[1], ends[1] + 0.9e-9, ends[1] + 1.1e-9,
        ]  # fmt: skip
        assert within(bound, pose).tolist() == [1, 2, 3, 4]
    torque = np.array([[1.0, -7.0, 3.0, 50.0], [-2.0, 1.0, 1.0, -4.0]])
    assert bound_margins(Requirement("max_torque", high=5.0), torque).tolist() == [-2.0, 3.0]
    assert bound_margins(Requirement("f_4", low=-5.0, high=60.0), torque).tolist() == [10.0, 1.0]
    assert bound_margins(Requirement("tau_2", low=-8.0), torque).tolist() == [1.0, 9.0]


@pytest.mark.parametrize("index", [0, 20])
def test_a_motion_that_leaves_the_reach_fails_at_its_first_pose_beyond(index: int) -> None:
    """Or is nearest to a limit at its worst sample; what cannot be taken has no torque."""
    t = np.linspace(0.0, 1.0, 41)
    pose = np.tile(home_pose(APPENDIX_4.geometry), (41, 1))
    pose[:, 3] -= 0.1 * t
    still = np.zeros_like(pose)
    good = Trajectory(t, pose, still, still, name="drop")
    found = sampled_solution(APPENDIX_4.geometry, good, 9.81)
    assert found.check.first is None
    assert found.check.possible
    assert found.check.until == 41
    least = check_reach(APPENDIX_4.geometry, pose).margins.min(axis=(1, 2))
    assert found.check.closest.margin == pytest.approx(least.min())
    assert found.check.closest.t == t[int(least.argmin())]
    far = pose.copy()
    far[index, 3] = far[-1, 3] = -3.0
    bad = sampled_solution(APPENDIX_4.geometry, replace(good, pose=far), 9.81)
    assert bad.check.first is not None
    assert bad.check.first.t == t[index]
    assert bad.check.until == index
    assert bad.check.first.pose == tuple(far[index])
    assert bad.check.first.margin < 0.0
    missing = np.isnan(bad.torques(APPENDIX_4)).any(axis=1)
    assert np.flatnonzero(missing).tolist() == [index, 40]
    singular = pose.copy()
    singular[index, 2] = 1.5  # beyond acos(R_pl/R_b), 1.28 rad
    turned = sampled_solution(APPENDIX_4.geometry, replace(good, pose=singular), 9.81).check
    others = 20 if index else 1  # its own side is that of the first pose
    assert turned.first is not None
    assert turned.first.t == t[index if index else others]


def test_a_stiffness_at_its_end_is_named_in_its_unit() -> None:
    soft = replace(SPRING, max_stiffness=5.0)
    asked = InnerCase("peak_torque", (short(),), case().masses, (), (soft,))
    program = inner_program(APPENDIX_4, asked, poses())
    found = program.solve()
    assert found.springs[0].stiffness == pytest.approx(5.0)
    spring = f"{soft.first.name} to {soft.second.name}"
    rows = {(item.name, item.side): (item.unit, item.bound) for item in found.active}
    assert rows[spring, "high"] == ("N/m", 5.0)
    assert {unit for (name, _), (unit, _) in rows.items() if name != spring} == {"kg"}
    prices = [item.price for item in found.active]
    assert prices == sorted(prices, reverse=True)
