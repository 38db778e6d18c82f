"""Tables of maps, designs and loads on the platform whose results are made up.

No two numbers are alike, so that each cell can be told from all others.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import (
    design,
    forces,
    maps,
)
from paminsa_viz.blocks.external_load import load_notes
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4, Counterweight, KneeBranch
from paminsa_viz.model.drive import ACTUATORS, Drive
from paminsa_viz.model.load import LoadCase, LoadFrame
from tests.blocks.said import cells, said
from tests.support.samples import with_knee

# ------------------------------------------------------------------------------------------ maps


def test_numbers_of_a_map_are_of_the_cells_that_count() -> None:
    values = np.array([[1.0, -5.0, np.nan], [3.0, 100.0, 2.0]])
    counts = np.array([[True, True, True], [True, False, True]])
    found = maps._numbers(values, counts)
    assert found == {
        "least": -5.0, "largest": 3.0, "median_size": 2.5,
        "p90_size": pytest.approx(np.percentile([1.0, 5.0, 3.0, 2.0], 90)),
    }  # fmt: skip
    none = maps._numbers(values, np.zeros_like(counts))
    assert list(none) == list(found)
    assert np.isnan(list(none.values())).all()


def test_facts_of_a_map_are_those_of_its_cells() -> None:
    """Cells by status and leg, the area that can be reached, and the display unit."""
    limit = maps.Limit
    status = np.array([[limit.OK, limit.GUIDE, limit.STRETCHED], [limit.OK, limit.OK, limit.OK]])
    leg = np.array([[-1, 1, 0], [-1, -1, -1]], np.int8)
    values = np.arange(6.0).reshape(1, 2, 3)
    data: Any = SimpleNamespace(
        design=APPENDIX_4, reference=None, theta=0.2, z=-0.5, status=status.astype(np.uint8),
        leg=leg, x=np.array([0.01, 0.03, 0.05]), y=np.array([0.02, 0.07]), unit="N m",
        values=values, singular_radius=0.25, display=(10.0, "dN·m"),
    )  # fmt: skip
    facts = maps.maps_data(data, ("tau_1",), 1e9)
    assert facts["cells"] == [3, 2]
    assert facts["reached_area_m2"] == pytest.approx(4 * 0.02 * 0.05)
    words = {limit.OK: "ok", limit.GUIDE: f"{limit.GUIDE.word}:leg2",
             limit.STRETCHED: f"{limit.STRETCHED.word}:leg1"}  # fmt: skip
    counts = {words[limit.OK]: 4, words[limit.GUIDE]: 1, words[limit.STRETCHED]: 1}
    assert facts["cells_by_status"] == counts
    data.leg = None
    found = maps.maps_data(data, ("tau_1",), 1e9)["cells_by_status"]
    assert not any(":leg" in word for word in found)
    notes = said(maps.maps_blocks(data, facts))
    assert any("reached: 0.004 m²; singular circle: radius 250 mm" in text for text, _ in notes)
    data.singular_radius = None
    notes = said(maps.maps_blocks(data, facts))
    assert any(text.endswith("singular circle: none") for text, _ in notes)
    assert "published" not in facts
    table: Any = maps.maps_blocks(data, facts)[2]
    assert table.literal
    assert table.head == ("[dN·m]", "Least", "Largest", "Median size", "90 % of size <")
    counted = values[0][maps._counting(data, 1e9)]
    assert cells(table)[0][:3] == ("tau_1", *(maps.number(10 * end) for end in (
        counted.min(), counted.max())))  # fmt: skip
    of_torques = {"maps": dict.fromkeys(maps.TORQUES, facts["maps"]["tau_1"])}
    table = maps.maps_blocks(data, facts | of_torques)[2]
    assert table.head[3:] == ("Median |tau|", "90 % of |tau| <")
    published: Any = SimpleNamespace(position=np.zeros((2, 2)), torque=np.ones((2, 4)))
    beside = maps.maps_data(data, ("tau_1",), 1e9, published)
    assert beside.pop("published") == maps.off_published(data, published)
    assert beside.keys() == facts.keys()


def test_a_difference_counts_where_both_robots_do() -> None:
    other = APPENDIX_4.vary({"geometry.platform_radius": 0.2})
    x = y = np.linspace(-0.3, 0.3, 13)

    def counted(design: Any, reference: Any) -> np.ndarray:
        data: Any = SimpleNamespace(
            design=design, reference=reference, x=x, y=y, theta=0.3, z=-0.5
        )  # fmt: skip
        return maps._counting(data, 8.0)

    one, two = counted(APPENDIX_4, None), counted(other, None)
    assert (one & ~two).any()
    assert (two & ~one).any()
    np.testing.assert_array_equal(counted(APPENDIX_4, other), one & two)


def test_who_carries_a_load() -> None:
    """The bearings alone the moments about x and y, the actuators the rest; then what they need."""
    loaded = APPENDIX_4.vary(
        {f"load.{name}": 1.0 + i for i, name in enumerate(
            ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"))}
    )  # fmt: skip
    pose = np.array([0.0, 0.0, 0.0, -0.5])
    (drive, _), (bearings, _) = said(load_notes(loaded, pose))
    for value in ("F_x = 1 N", "F_y = 2 N", "F_z = 3 N", "M_z = 6 N"):
        assert value in drive
        assert value not in bearings
    assert all(name in drive for name in ACTUATORS)
    for value in ("M_x = 4 N", "M_y = 5 N"):
        assert value in bearings
        assert value not in drive
    # Off the center the force's own moments are in the numbers: nothing is to be added to them.
    beside = loaded.vary({"load.point_y": 0.5, "load.point_z": 0.1})
    _, (bearings, _) = said(load_notes(beside, pose))
    assert bearings.startswith("The bearings alone carry M_x = 5.3 N·m, M_y = 5.1 N·m: ")
    turning = loaded.vary({f"load.{name}": 0.0 for name in ("force_y", "moment_y")})
    turning = replace(turning, load=replace(turning.load, frame=LoadFrame.PLATFORM))
    turned = " ".join(
        text for text, _ in said(load_notes(turning, np.add(pose, (0.0, 0.0, 0.3, 0.0))))
    )
    for name, size in (("F", "N"), ("M", "N·m")):
        along = 1.0 if name == "F" else 4.0
        for axis, part in (("x", np.cos(0.3)), ("y", np.sin(0.3))):
            assert f"{name}_{axis} = {along * part:.4g} {size}" in turned
    ((nothing, _),) = said(load_notes(APPENDIX_4, pose))
    assert nothing.startswith("No external force")
    assert forces._limits(APPENDIX_4).words == 2
    driven = replace(APPENDIX_4, drives=(Drive("m", rated_torque=2.0), None, None, None))
    assert [row[:2] for row in cells(forces._limits(driven))] == [
        ("M1", "drive"), ("M2", "default"), ("M3", "default"), ("M4", "default"),
    ]  # fmt: skip


def test_quantities_that_a_robot_has_none_of_say_why(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each reason once, with all the quantities that it holds for."""
    known, *rest = forces.find(("payload", "speed", "moment", "turn_speed"))

    class Missing:
        key, unit, title = "payload", "N", "none"

        def __init__(self, symbol: str, reason: str) -> None:
            self.symbol, self.reason = symbol, reason

        def over(self, here: Any, design: Any) -> float:
            raise InvalidInput("design", self.reason)

    given = [known, Missing("A", "one"), Missing("B", "two"), Missing("C", "one")]
    monkeypatch.setattr(forces, "find", lambda keys: given)
    metrics = [SimpleNamespace(value=lambda over, n=n: n) for n in (1.5, 2.5, 3.5)]
    monkeypatch.setattr(forces, "global_indices", lambda keys: metrics)
    table = forces.index_table(APPENDIX_4, np.array([0.0, 0.0, 0.0, -0.5]), (), "About. ")
    assert len(rest) == 3
    assert cells(table)[0][3:] == ("1.5 kg", "2.5 kg", "3.5 kg")
    assert [row[2:] for row in cells(table)[1:]] == [("–",) * 4] * 3
    assert table.words == 2
    assert table.caption.startswith("About. At the report’s pose")
    assert table.caption.endswith(
        " A, C: no value, design: one. B: no value, design: two."
    )  # fmt: skip


def test_differences_are_exactly_the_values_that_differ() -> None:
    other = APPENDIX_4.vary({"links.b3": 0.5, "gravity": 1.62})
    rows = design.changes_table(APPENDIX_4, other).rows
    assert [(row.cells[2], row.cells[3:5]) for row in rows] == [
        ("links.b3", ("0.406", "0.5")), ("gravity", ("9.81", "1.62")),
    ]  # fmt: skip
    assert design.changes_table(other, other).rows == ()


def test_computed_maps_beside_published_ones() -> None:
    position = np.array([[0.01, 0.02], [-0.03, 0.05], [0.9, 0.9]])
    poses = np.column_stack([position, np.full(3, 0.2), np.full(3, -0.5)])
    torque = maps.static_torques(APPENDIX_4, poses)
    off = np.array([[0.1, 1.0, np.nan, 2.0], [-0.3, -2.0, np.nan, np.nan], [0.0] * 4])
    data: Any = SimpleNamespace(design=APPENDIX_4, theta=0.2, z=-0.5)
    published: Any = SimpleNamespace(position=position, torque=torque - off)
    found = maps.off_published(data, published)
    names = list(maps.TORQUE_NAMES)
    assert list(found) == [names[0], names[1], names[3]]
    assert found[names[0]]["positions"] == 2
    assert found[names[0]]["largest_difference"] == pytest.approx(0.3)
    assert found[names[1]]["rms_difference"] == pytest.approx(math.sqrt(2.5))
    assert found[names[3]]["positions"] == 1


# --------------------------------------------------------------------------------------- designs


def test_in_what_designs_differ() -> None:
    one = APPENDIX_4
    other = replace(
        APPENDIX_4.vary({"links.b1": 1.5 * APPENDIX_4.links.b1, "load.force_x": 2.0}),
        counterweights=(Counterweight("b3", 4, 0.05, 0.5), Counterweight("b8", 8, 0.05, 0.25)),
        drives=(Drive("motor"), None, None, None),
    )  # fmt: skip
    (table,) = design.difference_blocks(one, other, ("one", "two"))
    rows = {row[:2]: row[2:] for row in cells(table)}
    b1 = APPENDIX_4.links.b1
    assert rows["links", "b1_kg"][:3] == (f"{b1:.10g}", f"{1.5 * b1:.10g}", "+50.0 %")
    assert rows["load", "force_x_N"][:3] == ("0", "2", "new")
    places = [weight.place for weight in other.counterweights]
    weights = [row[2:] for row in cells(table) if row[0] == "counterweights"]
    assert weights == [("0", "0.5", "new", places[0]), ("0", "0.25", "new", places[1])]
    rounded = tuple(replace(one, mass=one.mass * (1 - 1e-14)) for one in other.counterweights)
    (unequal,) = design.difference_blocks(
        other, replace(other, counterweights=rounded), ("one", "two")
    )
    assert {row[4] for row in cells(unequal)} == {"≈ 0 %"}
    heavier = replace(other, counterweights=(rounded[0], replace(rounded[1], mass=0.5)))
    compared = design.changes_table(other, heavier, ("one", "two"))
    assert [row[0] for row in cells(compared)] == [f"on {places[1]} [kg]"]
    assert rows["drives", "M1"][:2] == ("–", other.drives[0].summary)  # type: ignore
    motor = Drive("motor", coulomb=0.004, envelope=((0.0, 1.5), (100.0, 0.5)))
    driven, worn = (
        replace(one, drives=(replace(motor, **more), None, None, None))
        for more in ({}, {"coulomb": 0.006, "brake": True, "peak_torque": 2.0, "envelope": ()})
    )
    (table_of_drives,) = design.difference_blocks(driven, worn, ("one", "two"))
    changes = {row[:2]: row[2:] for row in cells(table_of_drives)}
    assert changes["drives.M1", "coulomb_Nm"] == (
        "0.004", "0.006", "+50.0 %", "c_r, Coulomb friction, at the motor shaft",
    )  # fmt: skip
    assert changes["drives.M1", "peak_torque_Nm"][:3] == ("–", "2", "")
    assert changes["drives.M1", "brake"][:3] == ("false", "true", "")
    assert changes["drives.M1", "envelope"][:2] == ("0 1.5; 100 0.5", "–")
    assert len(changes) == 1 + 4
    assert len(cells(table)) == 5
    assert said(design.difference_blocks(one, one, ("", "")))[0][0].startswith("the designs")
    assert design.changes_text(one) == "as Appendix 4"
    assert design.changes_text(other) == "5 values differ from Appendix 4"
    assert design.changes_text(APPENDIX_4.vary({"links.b1": 2.0})).startswith("1 value differs")
    grams = {"joints.j7": 280.0, "links.b1": 0.0, "friction.coulomb_rotary": 9.0, "links.b8": 20.0}
    text = "4 values differ from Appendix 4; check the unit of j7_kg = 280 (instead of 0.28)"
    assert design.changes_text(APPENDIX_4.vary(grams)) == text
    each = {f"joints.j{number}": 1e-4 for number in (2, 4, 7, 8, 9)}
    assert design.changes_text(APPENDIX_4.vary(each)).endswith(" and 2 more")
    data = design.difference_data(one, other)
    assert data["differences"] == {
        "links.b1_kg": {"first": b1, "second": 1.5 * b1},
        "load.force_x_N": {"first": 0.0, "second": 2.0},
    }
    held = data["drives"]["second"]["M1"]
    assert (held["name"], held["rotor_inertia_kg_m2"], held["peak_torque_Nm"]) == ("motor", 0, None)
    assert data["counterweights"]["second"][1] == {
        "bar": "b8", "joint": 8, "beyond_m": 0.05, "mass_kg": 0.25,
    }  # fmt: skip
    assert not {"drives", "counterweights"} & design.difference_data(one, one).keys()


def test_a_design_beside_appendix_4() -> None:
    note, table = design.design_blocks(APPENDIX_4)
    assert note.text == "All values are those of the paper’s Appendix 4."  # type: ignore
    headings = [row.cells[0] for row in table.rows if row.kind == "group"]  # type: ignore
    assert "Payload" not in headings
    driven = replace(APPENDIX_4, drives=(Drive("motor"), None, None, None))
    said_of_drives = "The design has drives; all other values are those of the paper’s Appendix 4."
    assert said(design.design_blocks(driven))[0][0] == said_of_drives
    loaded = APPENDIX_4.vary({"payload.mass": 2.0})
    note, table = design.design_blocks(loaded)
    assert note.text == "1 value differs from the paper’s Appendix 4."  # type: ignore
    marked = [row for row in table.rows if row.kind == "marked"]  # type: ignore
    assert [row.cells[2:] for row in marked] == [("2 kg", "0 kg", "new")]
    headings = [row.cells[0] for row in table.rows if row.kind == "group"]  # type: ignore
    assert "Payload" in headings
    turning = replace(APPENDIX_4, load=LoadCase(frame=LoadFrame.PLATFORM))
    note, table = design.design_blocks(with_knee(turning, KneeBranch.UPPER))
    assert note.text == "2 values differ from the paper’s Appendix 4."  # type: ignore
    marked = [row for row in table.rows if row.kind == "marked"]  # type: ignore
    assert [(row.cells[0], *row.cells[2:]) for row in marked] == [
        ("knee", "upper", "lower", ""), ("frame", "platform", "world", ""),
    ]  # fmt: skip
    weights = (Counterweight("b3", 4, 0.05, 0.5),)
    held = replace(loaded.vary({"links.b1": 2.0}), counterweights=weights, drives=driven.drives)
    note, _, table = design.design_blocks(held)
    assert note.text == (  # type: ignore
        "2 values differ from the paper’s Appendix 4; every leg carries 1 counterweight; it has "
        "drives."
    )
    assert cells(table) == [(weights[0].place, "0.5 kg")]


def test_tables_of_designs_have_their_words_and_digits() -> None:
    exact = APPENDIX_4.vary({"links.b1": 1.23456789})
    weight = Counterweight("b3", 4, 0.05, 0.123456789)
    motor = Drive("motor", gear_ratio=12.5)
    held = replace(exact, counterweights=(weight,), drives=(motor, None, None, None))
    _, table, weights = design.design_blocks(held)
    (marked,) = (row for row in table.rows if row.kind == "marked")  # type: ignore
    assert marked.cells[2] == "1.23457 kg"
    assert (table.words, design.design_blocks(APPENDIX_4)[1].words) == (2, 2)  # type: ignore
    assert cells(weights) == [(weight.place, "0.12346 kg")]
    assert design.values_table(held).words == 4
    shown = cells(design.values_table(held))
    assert ("drives.M1", "gear_ratio", "12.5", "n, gear ratio") in shown
    assert sum(row[0] == "drives.M1" for row in shown) == 2  # with its name
    assert ("counterweights", "mass_kg", "0.123456789", weight.place) in shown
    data = design.values_data(held)
    assert list(data["drives"]["M1"].values()) == list(vars(motor).values())
    assert list(data["counterweights"][0].values()) == list(vars(weight).values())
    assert data["values"]["links.b1_kg"] == 1.23456789
    assert "drives" not in design.values_data(exact)
    assert design.difference_blocks(held, exact, ("a", "b"))[0].words == 6  # type: ignore
    for sign in (1.0, -1.0):
        pushed, harder = (APPENDIX_4.vary({"load.force_x": sign * force}) for force in (4.0, 5.0))
        (row,) = cells(design.difference_blocks(pushed, harder, ("a", "b"))[0])
        assert row[4] == "+25.0 %"
    pushed, back = (APPENDIX_4.vary({"load.force_x": force}) for force in (4.0, -4.0))
    (row,) = cells(design.difference_blocks(pushed, back, ("a", "b"))[0])
    assert row[4] == "−200 %"
    stiff, other = APPENDIX_4, APPENDIX_4.vary({"elastic.ball": 2e4})
    for pair in ((stiff, other), (other, stiff)):
        (row,) = cells(design.difference_blocks(*pair, ("a", "b"))[0])
        (known,) = cells(design.changes_table(*pair))
        assert ("rigid" in row, "rigid" in known, row[4], known[5]) == (True, True, "–", "–")


def test_robots_differ_by_more_than_rounding_and_by_what_is_left_open() -> None:
    """A stroke that is set differs from one that follows the guide's length."""

    def rows(first: Any, second: Any) -> list[tuple[str, ...]]:
        return [row[2:5] for row in cells(design.changes_table(first, second))]

    b1 = APPENDIX_4.links.b1
    for share, differs in ((0.95e-9, False), (1.05e-9, True)):
        other = APPENDIX_4.vary({"links.b1": b1 * (1 + share)})
        assert bool(rows(APPENDIX_4, other)) == differs
    for force, differs in ((0.95e-12, False), (1.05e-12, True)):
        assert bool(rows(APPENDIX_4, APPENDIX_4.vary({"load.force_x": force}))) == differs
    exact = APPENDIX_4.vary({"links.b1": 1.23456789})
    assert rows(APPENDIX_4, exact) == [("links.b1", "1.221", "1.23457")]
    stroke = APPENDIX_4.geometry.stroke
    stored = APPENDIX_4.vary({"geometry.guide_stroke": stroke})
    follows = f"{1e3 * stroke:.6g} (l_B10)"
    assert rows(APPENDIX_4, stored) == [
        ("geometry.guide_stroke", follows, follows.removesuffix(" (l_B10)"))
    ]
    assert rows(stored, APPENDIX_4)[0][1:] == rows(APPENDIX_4, stored)[0][:0:-1]
    assert rows(stored, stored) == []


def test_choices_counterweights_and_drives_in_which_robots_differ() -> None:
    motor = Drive("motor", gear_ratio=12.5)
    one = replace(
        APPENDIX_4, counterweights=(Counterweight("b3", 4, 0.05, 0.1234567),
                                    Counterweight("b3", 4, 0.05, 0.5)),
    )  # fmt: skip
    other = replace(
        APPENDIX_4.with_knee(KneeBranch.UPPER), drives=(None, motor, None, None),
        counterweights=(Counterweight("b8", 8, 0.05, 0.7654321),),
    )  # fmt: skip
    assert [row[2:] for row in cells(design.changes_table(one, other))] == [
        ("geometry.knee", "lower", "upper"), ("", "0.623457", "0", "−100 %"),
        ("", "0", "0.765432", "new"), ("", "no drive", "12.5:1"),
    ]  # fmt: skip
    row = design.changes_table(one, other).rows[-1]
    assert row.cells[0] == "M2"
    assert row.cells[4].hint == motor.summary  # type: ignore
    for changes, wanted in (
        ({"name": "other"}, [("M2", "drive", "motor, 12.5:1", "other, 12.5:1")]),
        (
            {"coulomb": 0.006, "top_speed": 2 * np.pi, "brake": True},
            [
                ("M2 c_r [N·m]", "Coulomb friction, at the motor shaft", "0", "0.006", "new"),
                ("M2 w_p [°/s]", "top speed", "–", "360"),
                ("M2 brake", "holds the load while the robot waits", "false", "true"),
            ],
        ),
    ):
        varied = replace(other, drives=(None, replace(motor, **changes), None, None))
        found = cells(design.changes_table(other, varied))
        assert [(*row[:2], *filter(None, row[3:])) for row in found] == wanted
    assert cells(design.changes_table(one, other, under="geometry")) == []


def test_choices_of_a_design_stand_behind_the_numbers_of_their_table() -> None:
    tables = [row.cells[0] for row in design.values_table(APPENDIX_4).rows]
    for _table, name in design.CHOICES:
        rows = design.values_table(APPENDIX_4).rows
        (place,) = [i for i, row in enumerate(rows) if row.cells[1] == name]
        later = [row.cells[0] for row in rows[place + 1 :]]
        assert rows[place].cells[0] not in later or design.CHOICES.count((_table, name)) > 1
    blocks = [tables[0]]
    for one in tables:
        if one != blocks[-1]:
            blocks.append(one)
    assert len(blocks) == len(set(blocks))
