"""Tables of maps, designs, loads on the platform and balance whose results are made up.

No two numbers are alike, so that each cell can be told from all others.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing.effects import IN_MOTION, Effect
from paminsa_viz.blocks import (
    balance,
    design,
    forces,
    maps,
)
from paminsa_viz.blocks.external_load import load_notes
from paminsa_viz.model.design import APPENDIX_4, Counterweight
from paminsa_viz.model.drive import ACTUATORS, Drive
from paminsa_viz.trajectory import PRESET, analyze
from tests.blocks.said import cells, said

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
        leg=leg, x=np.array([0.0, 0.02, 0.04]), y=np.array([0.0, 0.05]), unit="N m",
        values=values, singular_radius=0.25, display=(1.0, "N·m"),
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
    ((nothing, _),) = said(load_notes(APPENDIX_4, pose))
    assert nothing.startswith("No external force")
    driven = replace(APPENDIX_4, drives=(Drive("m", rated_torque=2.0), None, None, None))
    assert [row[:2] for row in cells(forces._limits(driven))] == [
        ("M1", "drive"), ("M2", "default"), ("M3", "default"), ("M4", "default"),
    ]  # fmt: skip


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
    assert rows["links", "b1_kg"][:3] == (f"{b1:.10g}", f"{1.5 * b1:.10g}", "+50 %")
    assert rows["load", "force_x_N"][:3] == ("0", "2", "")
    assert rows["counterweights", ""][0] == "–"
    assert rows["counterweights", ""][1].count(" kg on ") == 2
    assert rows["drives", "M1"][:2] == ("–", other.drives[0].summary)  # type: ignore
    assert len(rows) == 4
    assert said(design.difference_blocks(one, one, ("", "")))[0][0].startswith("the designs")
    assert design.changes_text(one) == "as Appendix 4"
    assert design.changes_text(other) == "5 values differ from Appendix 4"
    assert design.changes_text(APPENDIX_4.vary({"links.b1": 2.0})).startswith("1 value differs")
    data = design.difference_data(one, other)
    assert data["differences"] == {
        "links.b1_kg": {"first": b1, "second": 1.5 * b1},
        "load.force_x_N": {"first": 0.0, "second": 2.0},
    }
    assert data["drives"]["second"] == {"M1": other.drives[0]}
    assert not {"drives", "counterweights"} & design.difference_data(one, one).keys()


def test_a_design_beside_appendix_4() -> None:
    note, table = design.design_blocks(APPENDIX_4)
    assert note.text == "All values are those of the paper's Appendix 4."  # type: ignore
    headings = [row.cells[0] for row in table.rows if row.kind == "group"]  # type: ignore
    assert "Payload" not in headings
    driven = replace(APPENDIX_4, drives=(Drive("motor"), None, None, None))
    assert "which has no drives" in design.design_blocks(driven)[0].text  # type: ignore
    loaded = APPENDIX_4.vary({"payload.mass": 2.0})
    note, table = design.design_blocks(loaded)
    assert note.text == "1 value differs from the paper's Appendix 4."  # type: ignore
    marked = [row for row in table.rows if row.kind == "marked"]  # type: ignore
    assert [row.cells[2:] for row in marked] == [("2 kg", "0 kg", "new")]
    headings = [row.cells[0] for row in table.rows if row.kind == "group"]  # type: ignore
    assert "Payload" in headings
    weights = (Counterweight("b3", 4, 0.05, 0.5),)
    held = replace(loaded.vary({"links.b1": 2.0}), counterweights=weights, drives=driven.drives)
    note, _, table = design.design_blocks(held)
    assert note.text == (  # type: ignore
        "2 values differ from the paper's Appendix 4; every leg carries 1 counterweight; it has "
        "drives."
    )
    assert cells(table) == [(weights[0].place, "0.5 kg")]


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


# --------------------------------------------------------------------------------------- balance


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
    assert table.rows[2].cells[1:] == ("4", "1", "−75.0 %")
    kinds = [getattr(row.cells[-1], "kind", "") for row in table.rows]
    assert kinds == ["plain", "", "plain", "bad", "plain"]  # by more than half a percent
    assert "more torque" in table.caption
    assert "more torque" not in balance.effects_table([*found[:2], found[3]]).caption
    assert not balance.grown(effect("mass", "kg", 20.0, 25.0))
    assert balance.grown(effect("M1", "N m", 0.0, 1e-6, group))
    assert not balance.grown(effect("M1", "N m", 0.0, 1e-10, group))


def test_a_balanced_design_needs_nothing() -> None:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(5)
    balanced = balance.balance(APPENDIX_4).after
    kinds = {
        name: said(balance.balance_blocks(analyze(one, trajectory)))
        for name, one in (("before", APPENDIX_4), ("after", balanced))
    }
    assert ("The design is balanced: M1 to M3 carry no weight.", "ok") in kinds["after"]
    assert all(kind != "ok" for _, kind in kinds["before"])
