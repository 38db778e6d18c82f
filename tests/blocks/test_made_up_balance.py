"""Tables of static balance whose results are made up.

No two numbers are alike, so that each cell can be told from all others.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing.effects import IN_MOTION, Effect
from paminsa_viz.blocks import balance
from paminsa_viz.blocks.balance import bound_name
from paminsa_viz.blocks.springs import GAP, springs_blocks
from paminsa_viz.blocks.tolerances import length_tolerance_blocks, mass_tolerance_blocks
from paminsa_viz.model.design import APPENDIX_4, Counterweight, KneeBranch
from paminsa_viz.trajectory import PRESET, analyze
from tests.blocks.said import cells, said


def test_a_balance_with_its_goals_masses_and_bounds() -> None:
    weight = Counterweight("b3", 7, 0.05, 0.75)
    after = replace(APPENDIX_4.vary({"joints.j7": 1.0, "inertias.b3_axial": 0.005}),
                    counterweights=(weight,))  # fmt: skip
    values = (
        SimpleNamespace(label="goal", limit=None, before=1.5, after=1.25, unit="N"),
        SimpleNamespace(label="mass", limit=2.5, before=-1e-13, after=2.0, unit="kg"),
    )
    bounds = (
        ("joints.j7", "high", 2.0, "kg", 0.5), ("links.b3", "low", 0.25, "kg", 0.3),
        ("links.b4", "low", 0.0, "kg", 0.2), ("lever", "farthest", 0.4, "m", 7.0),
        ("inner", "nearest", 0.0, "m", 7.0), ("free", "high", 1.0, "kg", 1e-10),
    )  # fmt: skip
    keys = ("name", "side", "bound", "unit", "price")
    active = tuple(SimpleNamespace(**dict(zip(keys, one, strict=True))) for one in bounds)
    found: Any = SimpleNamespace(
        before=APPENDIX_4, after=after, values=values, active=active, lower_bound=1.0,
        objective=1.25, gap=0.25, seconds=0.1,
    )  # fmt: skip
    goals, masses, reached, *notes = balance.optimum_blocks(found)
    assert cells(goals) == [("goal", "1.5", "1.25", "N"), ("mass, at most 2.5", "0", "2", "kg")]
    changes = {row[2]: row[3:] for row in cells(masses)}
    assert changes["joints.j7"] == ("0.28", "1", "+257 %")
    assert changes["inertias.b3_axial"] == ("0.0038", "0.005", "+31.6 %")
    assert len(changes) == 3  # and the counterweight
    assert [row[1:] for row in cells(reached)] == [
        ("joints.j7", "≤", "2 kg", "0.5 N / kg"), ("links.b3", "≥", "0.25 kg", "0.3 N / kg"),
        ("lever", "lever ≤", "400 mm", "0.07 N / 10 mm"),
    ]  # fmt: skip
    assert cells(reached)[0][0] == "m_7"
    assert said(notes)[-1] == (
        "Certified optimal (duality gap 0.25): within the bounds no goal is below 1 N; this is "
        "1.25 N.", "ok",
    )  # fmt: skip
    assert said(notes)[0][0].startswith(f"{weight.place}: ")
    # of several goals the sum is least, which has no unit
    several: Any = SimpleNamespace(**vars(found) | {"objective": 3.0})
    assert cells(balance.bounds_table(several))[0][4] == "0.5 / kg"
    assert "no weighted sum is below 1; this is 3." in balance.certificate_note(several).text
    none: Any = SimpleNamespace(**vars(found) | {"after": APPENDIX_4, "active": active[2:3]})
    blocks = balance.optimum_blocks(none)
    assert [type(block).__name__ for block in blocks] == ["Table", "Note", "Note"]
    assert said(blocks)[0] == ("No mass changes.", "muted")


def test_digits_and_thresholds_of_a_balance() -> None:
    def found(label: str, after: float, objective: float, left: Any = APPENDIX_4) -> Any:
        value = SimpleNamespace(label=label, limit=None, before=1.23456789, after=after, unit="N m")
        bounds = (("joints.j7", 2.0, 1.05e-9), ("joints.j5", 3.0, 1e-9), ("links.b3", 4.0, 0.5))
        active = tuple(
            SimpleNamespace(name=name, side="high", bound=bound + 1e-8, unit="kg", price=price)
            for name, bound, price in bounds
        )
        return SimpleNamespace(
            values=(value, SimpleNamespace(**vars(value) | {"label": "limit", "limit": 3.1234567})),
            active=active, objective=objective, after=left, before=APPENDIX_4, lower_bound=1.0,
            gap=1.0, seconds=0.5,
        )  # fmt: skip

    table: Any = balance.bounds_table(found("goal", 1.0, 1.0))
    assert table.words == 3
    assert cells(table) == [
        ("m_7", "joints.j7", "≤", "2 kg", "1.05·10⁻⁹ N·m / kg"),
        ("m_B3", "links.b3", "≤", "4 kg", "0.5 N·m / kg"),
    ]
    # what keeps M_p2 from zero, to either side, costs newtons
    heavy = APPENDIX_4.vary({"joints.j7": 9.0})
    assert balance.static_imbalance(heavy) * balance.static_imbalance(APPENDIX_4) < 0
    even = balance.balance(APPENDIX_4).after
    for left, unit in ((APPENDIX_4, "N"), (heavy, "N"), (even, "N·m")):
        cell = cells(balance.bounds_table(found("M_p2", 1.0, 1.0, left)))[1][4]
        assert cell == f"0.5 {unit} / kg"
    for after, objective, close in (
        (1.0, 1.0 + 0.95e-6, True), (1.0, 1.0 + 1.05e-6, False), (0.0, 0.95e-9, True),
        (0.0, 1.05e-9, False),
    ):  # fmt: skip
        assert (balance._minimized(found("goal", after, objective)) is not None) == close
    goals, *_ = balance.optimum_blocks(found("goal", 1.23456789, 1.0))
    assert cells(goals) == [
        ("goal", "1.23457", "1.23457", "N·m"),
        ("limit, at most 3.12346", "1.23457", "1.23457", "N·m"),
    ]
    for size, text in ((1e-9, "0"), (-1e-9, "0"), (1.05e-9, "1.05·10⁻⁹"), (-1.5, "−1.5")):
        assert balance._tidy(size, 6) == text
    assert balance._contributions(APPENDIX_4).words == 2


def test_masses_that_a_balance_changes_as_data() -> None:
    weight = Counterweight("b3", 7, 0.05, 0.75)
    before = replace(APPENDIX_4, counterweights=(weight,))
    after = replace(
        before.vary({"joints.j7": 1.0}), counterweights=(replace(weight, mass=0.5),)
    )  # fmt: skip
    found: Any = SimpleNamespace(
        before=before, after=after, values=("v",), active=("a",), objective=1.0, lower_bound=0.5,
        gap=0.25, seconds=0.125,
    )  # fmt: skip
    j7 = APPENDIX_4.joints.j7
    assert balance.changed_masses(found) == [
        ("joints.j7", j7, 1.0), ("counterweights.0.mass", 0.75, 0.5),
    ]  # fmt: skip
    data = balance.optimum_data(found)
    assert data.pop("counterweights") == [
        {"bar": "b3", "joint": 7, "beyond_m": 0.05, "mass_kg": 0.5}
        | {"room": balance.room_text(after.geometry, after.counterweights[0])}
    ]
    assert data == {
        "design": before.name, "knee": "lower", "values": ("v",), "active_bounds": ("a",),
        "objective": 1.0, "lower_bound": 0.5,
        "gap": 0.25, "seconds": 0.125,
        "changes": {"joints.j7": {"before": j7, "after": 1.0},
                    "counterweights.0.mass": {"before": 0.75, "after": 0.5}},
    }  # fmt: skip


def test_the_room_of_a_counterweight_is_rounded_to_the_safe_side(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    weight = Counterweight("b3", 7, 0.05, 0.75)

    def text(depth: float | None, geometry: Any = APPENDIX_4.geometry) -> str:
        room = None if depth is None else SimpleNamespace(
            inward=-0.0101, outward=0.0201, low=-0.0301, high=0.0401, clear_depth=depth
        )  # fmt: skip
        monkeypatch.setattr(balance, "counterweight_clearance", lambda *given: room)
        return balance.room_text(geometry, weight)

    assert text(None) == "The robot can take no pose."
    extent = "at most −10 mm inward and 21 mm outward of its leg axis, 31 mm below and 41 mm above"
    meet = "It can meet neither the platform nor the robot’s axis, where M4 is"
    assert extent in text(0.0)
    assert text(0.0).endswith(f"{meet}.")
    assert text(np.inf).endswith("It may run into the platform, or M4, at any height.")
    height = APPENDIX_4.geometry.platform_joint_height
    for knee, side, sign in ((KneeBranch.LOWER, "below", -1.0), (KneeBranch.UPPER, "above", 1.0)):
        z = sign * 0.30001 - height
        shown = f"{(np.floor if sign < 0 else np.ceil)(1e3 * z):.0f} mm".replace("-", "−")
        found = text(0.30001, APPENDIX_4.with_knee(knee).geometry)
        assert found.endswith(f"{meet}, while the platform is {side} z = {shown}.")
    assert balance._mm(0.012) == balance._mm(0.012, np.floor) == "12 mm"
    assert balance._mm(-0.0003) == "0 mm"


def test_the_papers_balance_or_what_comes_nearest_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(5)
    even = balance.balance(APPENDIX_4).after
    heavy = APPENDIX_4.vary({"joints.j7": 9.0})
    for after, begin in (
        (even, "The paper’s balance"), (heavy, "Within these bounds"),
        (APPENDIX_4.vary({"joints.j7": 0.4}), "Within these bounds"),
    ):  # fmt: skip
        optimum = SimpleNamespace(before=APPENDIX_4, after=after)
        monkeypatch.setattr(balance, "balance", lambda design, found=optimum: found)
        table, *others = balance._balanced(analyze(APPENDIX_4, trajectory))
        assert len(others) == 2
        assert table.caption.startswith(begin)  # type: ignore
    # too heavy is not balanced either, and what cannot begin the motion has no figure
    assert len(balance.balance_blocks(analyze(heavy, trajectory))) == 5
    far = replace(trajectory, pose=trajectory.pose + np.array([2.0, 0.0, 0.0, 0.0]))
    assert len(balance._balanced(analyze(APPENDIX_4, far))) == 2
    one, other = analyze(APPENDIX_4, far), analyze(APPENDIX_4, trajectory)
    monkeypatch.setattr(balance, "analyze", lambda *given, **options: one)
    monkeypatch.setattr(balance, "sizes_in_motion", lambda analysis: [np.zeros(4)] * len(IN_MOTION))
    assert len(balance._balanced(other)) == 2


def test_what_a_balance_changes_of_the_actuators() -> None:
    def effect(label: str, unit: str, before: float, after: float, group: str = "") -> Effect:
        return Effect(label, unit, before, after, group)

    group = next(iter(IN_MOTION))
    found = [
        effect("mass", "kg", 20.0, 25.0), effect("M1", "N m", 4.0, 1.0, group),
        effect("M2", "N m", 3.0, 3.3, group), effect("M4", "N", 100.0, 100.4, group),
    ]  # fmt: skip
    table = balance.effects_table(found)
    assert [row.cells[0] for row in table.rows] == [
        "mass [kg]", group, "M1 [N·m]", "M2 [N·m]", "M4 [N]",
    ]  # fmt: skip
    assert [row.kind for row in table.rows] == ["plain", "group", "plain", "plain", "plain"]
    assert table.rows[2].cells[1:] == ("4.000", "1.000", "−75.0 %")
    kinds = [getattr(row.cells[-1], "kind", "") for row in table.rows]
    assert kinds == ["plain", "", "plain", "bad", "plain"]  # by more than half a percent
    assert "more torque" in table.caption
    assert "more torque" not in balance.effects_table([*found[:2], found[3]]).caption
    assert not balance.grown(effect("mass", "kg", 20.0, 25.0))
    assert balance.grown(effect("M1", "N m", 0.0, 1e-6, group))
    assert not balance.grown(effect("M1", "N m", 0.0, 1e-9, group))
    assert balance.grown(effect("M1", "N m", 0.0, 1.05e-9, group))
    assert not balance.grown(effect("M1", "N m", 100.0, 100.48, group))
    assert balance.grown(effect("M1", "N m", 100.0, 100.52, group))
    (row,) = cells(balance.effects_table([effect("size", "m", 0.01234567, 0.02)]))
    assert row[:3] == ("size [mm]", "12.35", "20.00")


def test_a_design_is_balanced_below_a_billionth_of_a_newton(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    motion = analyze(APPENDIX_4, PRESET["arch"].build(APPENDIX_4.geometry).sample(5))
    for size, balanced in ((0.999e-9, True), (1e-9, False), (1.05e-9, False)):
        for left in (size, -size):
            monkeypatch.setattr(balance, "static_imbalance", lambda design, left=left: left)
            assert (len(balance.balance_blocks(motion)) == 3) == balanced
            caption = balance._balanced(motion)[0].caption  # type: ignore
            assert caption.startswith("The paper") == balanced


def test_a_balanced_design_needs_nothing() -> None:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(5)
    balanced = balance.balance(APPENDIX_4).after
    kinds = {
        name: said(balance.balance_blocks(analyze(one, trajectory)))
        for name, one in (("before", APPENDIX_4), ("after", balanced))
    }
    assert ("The design is balanced: M1 to M3 carry no weight.", "ok") in kinds["after"]
    assert all(kind != "ok" for _, kind in kinds["before"])


def test_springs_with_the_torques_that_they_leave() -> None:
    def shown(gap: float, helps: bool = True) -> Any:
        fit: Any = SimpleNamespace(
            springs=(SimpleNamespace(stiffness=1234.5, free_length=0.12345),),
            reach=((0.23456, 0.45678),), before=9.87654, after=1.23456, gap=gap, helps=helps,
        )  # fmt: skip
        torque = np.array([1.23456, -2.34567, 3.45678, 456.78912])
        return springs_blocks(fit, torque, np.array([0.12345, -0.23456, 0.0, 450.0]))

    spring, torques, note = shown(0.0012345)
    assert cells(spring) == [
        ("Stiffness on each leg", "1.234 N/mm"), ("Free length", "123.5 mm"),
        ("Length in use", "235 mm to 457 mm"),
    ]  # fmt: skip
    assert cells(torques) == [
        ("Largest on a coarse map [N·m]", "9.877", "1.235"),
        ("M1 at this pose [N·m]", "1.235", "0.123"), ("M2 at this pose [N·m]", "−2.346", "−0.235"),
        ("M3 at this pose [N·m]", "3.457", "0.000"), ("M4 at this pose [N]", "456.789", "450.000"),
    ]  # fmt: skip
    best = "Certified: no other stiffness and free length is better"
    assert said([note]) == [(f"{best} by more than 0.0012 N·m.", "plain")]
    assert GAP == 1e-6  # N m
    assert said(shown(GAP)) == [(f"{best}.", "plain")]
    assert said(shown(1.01 * GAP)) == [(f"{best} by more than 1·10⁻⁶ N·m.", "plain")]
    useless = "Certified: no spring between these points lowers the largest torque"
    assert said(shown(GAP, helps=False)) == [(f"{useless}.", "plain")]


def test_spreads_of_a_balance_by_masses_and_by_lengths() -> None:
    masses: Any = SimpleNamespace(
        nominal=-1.5, deviation=0.25, worst=0.75, torque=np.array([1.0, 2.0, 3.0]),
        torque_deviation=np.array([0.1, 0.2, 0.3]), torque_worst=np.array([1.5, 2.5, 3.5]),
        shares={"links.b4": 0.5, "joints.j7": 0.25, "links.b3": 0.15, "links.b8": 0.1},
    )  # fmt: skip
    table, note = mass_tolerance_blocks(masses)
    assert cells(table) == [
        ("M_p2 [N]", "−1.500", "0.250", "2.250"), ("M1 [N·m]", "1.000", "0.100", "1.500"),
        ("M2 [N·m]", "2.000", "0.200", "2.500"), ("M3 [N·m]", "3.000", "0.300", "3.500"),
    ]  # fmt: skip
    names = (f"{bound_name(path)} {share} %" for path, share in
             (("links.b4", 50), ("joints.j7", 25), ("links.b3", 15)))  # fmt: skip
    assert said([note]) == [(f"Of the variance: {', '.join(names)}.", "plain")]
    masses.shares = {}
    assert len(mass_tolerance_blocks(masses)) == 1

    lengths: Any = SimpleNamespace(
        nominal=1.25, peaks=np.array([1.0, 4.0, 2.0]), quantile=lambda share: 10.0 * share,
        lost=np.array([0, 1, 3]),
    )  # fmt: skip
    table, note = length_tolerance_blocks(lengths)
    assert table.head == ("Largest torque on a coarse map [N·m]", "")  # type: ignore
    assert cells(table) == [
        ("Nominal lengths", "1.250"), ("Half of 3 robots below", "5.000"),
        ("95 % below", "9.500"), ("Largest of all", "4.000"),
    ]  # fmt: skip
    assert said([note]) == [("2 of the robots cannot take all of the poses.", "plain")]
    lengths.lost = np.zeros(3)
    assert len(length_tolerance_blocks(lengths)) == 1
