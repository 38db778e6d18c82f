"""Words, marks and data of drives that are made up: every case, and no two numbers alike."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.actuation.ratios import GearRatios
from paminsa_viz.actuation.selection import DriveFigures
from paminsa_viz.blocks import drives, forces
from paminsa_viz.blocks.drives import (
    FIGURES_HEAD,
    cycle_text,
    facts_table,
    figures_table,
    margin_text,
    own_table,
    ratio_table,
)
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.drive import ACTUATORS, Drive
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.units import NONE
from tests.blocks.said import cells, said

POSE = np.array([0.05, -0.02, 0.2, -0.55])

MOTOR = Drive(
    "motor", gear_ratio=50.0, rated_torque=2.0, peak_torque=5.0, top_speed=400.0, mass=1.25,
    cost=700.0, encoder_counts=1000.0,
)  # fmt: skip


def on_a_load(**changes: Any) -> DriveFigures:
    values: dict[str, Any] = {
        "drive": MOTOR, "feasible": True, "use": 0.75, "limit": "RMS torque", "rms": 1.5,
        "peak": 3.0, "top_speed": 100.0, "top_power": 222.0, "envelope": 0.6,
        "inertia_ratio": 4.5, "thermal": 0.321, "ratios": (20.0, 80.0),
    }  # fmt: skip
    return DriveFigures(**values | changes)


def test_figures_of_a_drive_stand_below_their_headings() -> None:
    table = figures_table("c", [("1", on_a_load()), ("2", on_a_load(feasible=False, use=1.75))])
    first, second = table.rows
    assert dict(zip(FIGURES_HEAD, first.cells, strict=True)) == {
        "": "1", "Drive": "motor", "Ratio": "50", "Margin": "25 %", "Limited by": "RMS torque",
        "RMS [N·m]": "1.5", "Peak [N·m]": "3", "Speed [rpm]": "955", "Power [W]": "222",
        "Inertia ratio": "4.5", "Winding": "32 %", "Mass [kg]": "1.25", "Cost": "700",
    }  # fmt: skip
    assert second.cells[3] == "−75 %"
    assert [row.kind for row in table.rows] == ["plain", "marked"]
    assert [row.cells[3].kind for row in table.rows] == ["plain", "bad"]  # type: ignore
    assert (table.words, table.literal) == (2, True)


@pytest.mark.parametrize(
    ("use", "feasible", "shown"),
    [(1.0005, False, "−1 %"), (1.0, True, "0 %"), (0.9, True, "10 %"), (math.inf, False, "−∞ %")],
)
def test_a_margin_is_rounded_down(use: float, feasible: bool, shown: str) -> None:
    """A drive that is 0.05 % too weak has no margin of 0 %, as one has that is just enough."""
    assert margin_text(on_a_load(use=use, feasible=feasible), "plain") == shown
    odd = on_a_load(rms=1.23456, peak=2.34567, top_power=3.45678, inertia_ratio=4.56789)
    (row,) = figures_table("", [("", odd)]).rows
    assert [row.cells[FIGURES_HEAD.index(name)] for name in (
        "RMS [N·m]", "Peak [N·m]", "Power [W]", "Inertia ratio",
    )] == ["1.23", "2.35", "3.46", "4.57"]  # fmt: skip
    nameless = replace(MOTOR, name="", mass=None, cost=None)
    ((_, name, *_, winding, mass, cost),) = cells(
        figures_table("", [("", on_a_load(drive=nameless, thermal=math.nan))])
    )
    assert (name, winding, mass, cost) == (nameless.summary, NONE, NONE, NONE)


def test_a_drive_without_limits_has_no_margin_and_no_limit_that_decides() -> None:
    ((_, _, _, margin, limit, *_),) = cells(figures_table("", [("", on_a_load(use=0.0, limit=""))]))
    assert (margin, limit) == (NONE, NONE)


def test_own_drives_are_there_or_not_on_a_load_or_without() -> None:
    screw = replace(MOTOR, name="", transmission="screw", lead=0.02)
    design = replace(APPENDIX_4, drives=(MOTOR, None, MOTOR, screw))
    weak = on_a_load(feasible=False)
    table = own_table(design, [on_a_load(), None, weak, None])
    assert [row.cells[:2] for row in table.rows] == [
        ("M1", "motor"), ("M2", "none"), ("M3", "motor"), ("M4", screw.summary),
    ]  # fmt: skip
    assert [row.kind for row in table.rows] == ["plain", "plain", "marked", "plain"]
    assert [row.color for row in table.rows] == list(ACTUATOR_COLORS)
    assert table.rows[0].cells[3].kind == "ok"  # type: ignore
    assert table.rows[2].cells[3].kind == "bad"  # type: ignore
    assert table.rows[1].cells[2:] == ("", NONE)
    assert (table.words, table.literal) == (2, True)


def test_drives_of_a_design_and_whether_they_keep_up(monkeypatch: pytest.MonkeyPatch) -> None:
    motor = replace(
        MOTOR, gear_ratio=12.3456, rotor_inertia=1.23456e-4, rated_torque=0.123456,
        peak_torque=0.234567,
    )  # fmt: skip
    design = replace(APPENDIX_4, drives=(motor, None, replace(motor, peak_torque=None), None))
    monkeypatch.setattr(drives, "duty_cycle", lambda design, duties: None)

    def blocks(found: list[Any], first: Any = None, held: Any = design) -> list[Any]:
        monkeypatch.setattr(drives, "size_design", lambda cycle, design: found)
        analysis: Any = SimpleNamespace(design=held, failure=first, trajectory=None)
        return drives.drives_blocks(analysis)

    good, weak = on_a_load(), on_a_load(feasible=False)
    _, table, verdict, own = blocks([good, None, good, None])
    assert [row.cells[0] for row in table.rows] == ["M1", "M3"]
    inertia = f"{motor.reflected_inertia:.3g} kg·m²"
    assert table.rows[0].cells[2:] == ("12.35", inertia, "0.123 N·m", "0.235 N·m")
    assert table.rows[1].cells[5] == NONE
    assert (table.words, table.literal) == (2, True)
    assert verdict.kind == "ok"
    assert len(own.rows) == 4
    verdict = blocks([good, None, weak, None])[2]
    assert (verdict.text, verdict.kind) == ("Too weak for this motion, repeated: M3.", "bad")
    assert len(blocks([], first="why")) == 3
    assert blocks([], first="why")[2].kind == "bad"
    assert blocks([], held=APPENDIX_4) == []
    free = replace(design, drives=(None, replace(motor, rated_torque=None), None, None))
    assert blocks([None] * 4, held=free)[1].rows[0].cells[4] == NONE


def test_what_a_drive_gives_beside_its_limits() -> None:
    rows = {label: rest for label, *rest in cells(facts_table(on_a_load()))}
    assert rows == {
        "RMS torque": ["1.5 N·m", "75 % of 2"], "Peak torque": ["3 N·m", "60 % of 5"],
        "Envelope": ["60 %", "largest share of it used"],
        "Top speed": ["954.9 rpm", "25 % of 3820"],
        "Peak power": ["222 W", ""], "Inertia ratio": ["4.5", "robot over motor"],
        "Winding": ["32 %", "temperature rise"], "Gear ratio": ["50", "20 to 80 fit"],
        "One count": ["130 µrad", "of the encoder"],
    }  # fmt: skip
    free = replace(MOTOR, rated_torque=None, peak_torque=None, top_speed=None, encoder_counts=None)
    rows = {
        label: rest
        for label, *rest in cells(facts_table(on_a_load(drive=free, ratios=(math.nan,) * 2)))
    }
    for label in ("RMS torque", "Peak torque", "Top speed"):
        assert rows[label][1] == ""
    assert rows["Top speed"][0] == "955 rpm"
    assert rows["One count"][0] == NONE
    assert rows["Gear ratio"][1] == "no ratio fits"
    screw = replace(MOTOR, transmission="screw", lead=0.02)
    rows = {label: rest for label, *rest in cells(facts_table(on_a_load(drive=screw)))}
    assert rows["One count"][0] == "0.4 µm"  # 20 mm / 50 / 1000


def test_limits_of_a_drive_whose_torque_falls() -> None:
    """The peak is that at rest, the top speed that of the last corner."""
    falling = replace(
        MOTOR, peak_torque=None, top_speed=None, envelope=((0.0, 6.0), (200.0, 4.0), (500.0, 1.0))
    )
    table = facts_table(on_a_load(drive=falling, top_power=222.22, inertia_ratio=4.56789))
    rows = {label: rest for label, *rest in cells(table)}
    assert rows["Peak torque"][1] == "50 % of 6"
    assert rows["Top speed"][1] == "20 % of 4775"
    assert (rows["Peak power"][0], rows["Inertia ratio"][0]) == ("222 W", "4.57")
    assert table.literal


def test_ratios_of_motors_and_how_they_were_found() -> None:
    found = [
        GearRatios("M1", "a", low, high, scanned, gaps)
        for low, high in ((10.0, 20.0), (None, 5.0), (5.0, None))
        for scanned, gaps in ((False, False), (True, False), (True, True))
    ]
    how = ["", "by scan", "by scan, with gaps"]
    assert cells(ratio_table(found)) == [
        ("M1", "a", text, way) for text, way in product(["10 to 20", "none", "none"], how)
    ]
    assert ratio_table(found).words == 4


def test_loads_and_lists_of_drives_by_actuator(monkeypatch: pytest.MonkeyPatch) -> None:
    """M1 to M3 as one where they have the same drive; M4 in newtons."""
    loads = tuple(
        SimpleNamespace(
            name=name,
            peak=1.50123,
            rms=0.75012,
            top_speed=2.25012,
            top_power=3.50123,
            inertia=0.12501,
        )
        for name in ACTUATORS
    )
    monkeypatch.setattr(drives, "size_design", lambda cycle, design: [None] * 4)

    def blocks(same: bool, advice: tuple[str, ...] = ("",) * 4, driven: bool = False) -> list:
        sizings = [SimpleNamespace(table=range(10 + j)) for j in range(4)]
        found: Any = SimpleNamespace(
            cycle=SimpleNamespace(loads=loads), same=same, sizings=sizings,
            rows=[range(1 + j) for j in range(4)], figures=lambda j, n: [on_a_load()] * min(n, 2),
        )  # fmt: skip
        design = replace(APPENDIX_4, drives=(MOTOR,) * 3 + (None,)) if driven else APPENDIX_4
        return drives.selection_blocks(design, found, 2, advice)

    table, *lists = blocks(False)
    assert cells(table)[0] == (
        "M1", "1.5 N·m", "0.75 N·m", "129°/s", "3.5 W", "0.125 kg·m²",
    )  # fmt: skip
    assert cells(table)[3] == ("M4", "1.5 N", "0.75 N", "2.25 m/s", "3.5 W", "0.125 kg")
    assert [one.caption for one in lists] == [
        "M1: 1 of 10 drives is feasible.",
        *(f"M{j + 1}: {1 + j} of {10 + j} drives are feasible." for j in range(1, 4)),
    ]
    assert [[row[0] for row in cells(one)] for one in lists] == [["1", "2"]] * 4
    _, *lists = blocks(True)
    assert [one.caption.partition(":")[0] for one in lists] == ["M1 to M3", "M4"]
    advised = blocks(True, ("a slower motion", "", "", ""))
    assert said(advised) == [
        ("M1 to M3: 1 of 10 drives is feasible.", "bad"), ("a slower motion.", "plain"),
    ]  # fmt: skip
    sizings = [SimpleNamespace(table=range(10 + j)) for j in range(4)]
    duty = SimpleNamespace(
        trajectory=SimpleNamespace(name="m", duration=1.5), repeats=2.0, dwell=0.25
    )
    selection: Any = SimpleNamespace(
        cycle=SimpleNamespace(loads=loads, duties=(duty,)), feasible=True, sizings=sizings,
        rows=[range(2 + j) for j in range(4)], figures=lambda j, n: [on_a_load()] * n,
    )  # fmt: skip
    weak = [on_a_load(feasible=False, use=1.75), None, None, None]
    monkeypatch.setattr(drives, "size_design", lambda cycle, design: weak)
    catalog: Any = SimpleNamespace(name="c")
    data = drives.selection_data(APPENDIX_4, catalog, selection, 2, ("", "b", "", ""))
    assert data["motions"] == [{"name": "m", "duration_s": 1.5, "repeats": 2.0, "dwell_s": 0.25}]
    second = data["actuators"][1]
    assert [second[key] for key in ("name", "peak", "pairs", "feasible", "advice")] == [
        "M2", 1.50123, 11, 3, "b",
    ]  # fmt: skip
    assert [one["margin"] for one in second["drives"]] == [0.25, 0.25]
    assert [one and one["margin"] for one in data["own"]] == [-0.75, None, None, None]
    monkeypatch.setattr(drives, "size_design", lambda cycle, design: [None] * 4)
    own = blocks(False, driven=True)[1]
    assert own.caption.startswith("The design’s own drives")
    assert len(blocks(False, driven=True)) == len(blocks(False)) + 1


def test_motions_of_a_cycle() -> None:
    motions = [
        SimpleNamespace(trajectory=SimpleNamespace(name=name, duration=t), repeats=n, dwell=d)
        for name, t, n, d in (("a", 1.5, 1.0, 0.0), ("b", 2.0, 3.0, 0.25))
    ]
    cycle: Any = SimpleNamespace(duties=motions)
    assert cycle_text(cycle) == ("a (1.5 s, once, dwell 0 s), b (2 s, 3 times, dwell 0.25 s)")


def test_limits_are_those_of_drives_or_the_default_and_the_nearest_one_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limits: Any = SimpleNamespace(
        rated=(1.0, 2.0, 3.0, 400.0), peak=(5.0, 6.0, 7.0, 800.0), speed=(1.0, 2.0, 3.0, 0.5)
    )
    monkeypatch.setattr(forces, "actuator_limits", lambda design: limits)
    screw = Drive("axis", rotor_inertia=2e-5, transmission="screw", lead=0.01)
    table = forces._limits(replace(APPENDIX_4, drives=(None, MOTOR, None, screw)))
    assert table.head == ("Actuator", "Limits of", "Continuous", "Peak", "Speed")
    assert table.words == 2
    assert cells(table) == [
        ("M1", "default", "1 N·m", "5 N·m", "57.3°/s"),
        ("M2", "drive", "2 N·m", "6 N·m", "114.6°/s"),
        ("M3", "default", "3 N·m", "7 N·m", "171.9°/s"),
        ("M4", "drive", "400 N", "800 N", "0.5 m/s"),
    ]
    faces: Any = SimpleNamespace(faces=("a", "b", "c"), limiting_face=1)
    monkeypatch.setattr(forces, "wrench_polytope", lambda design, pose: faces)
    monkeypatch.setattr(forces, "index_table", lambda *given: "table")
    for sign, word in ((1.0, "M3 at +T"), (-1.0, "M3 at −T")):
        at = SimpleNamespace(horizontal_limit=(2, sign))
        monkeypatch.setattr(forces, "capability", lambda design, pose, at=at: at)
        made: Any = forces._capability(APPENDIX_4, POSE)
        assert f"limited by {word}; the face" in made[1].text
        assert made[1].text.endswith("nearest to zero is b.")


def test_quantities_that_have_no_value_say_why_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def over(field: Any, design: Any, key: str = "") -> float:
        if key in ("p", "q", "r"):
            raise InvalidInput("design", "no " + ("drive" if key == "r" else "payload"))
        return 2.0

    def found(keys: Any) -> list[Any]:
        return [
            SimpleNamespace(key=key, symbol=key.upper(), title=f"title {key}", unit="N",
                            over=lambda field, design, key=key: over(field, design, key))
            for key in keys
        ]  # fmt: skip

    monkeypatch.setattr(forces, "find", found)
    metrics = [SimpleNamespace(value=lambda over, number=number: number) for number in (3, 4, 5)]
    monkeypatch.setattr(forces, "global_indices", lambda keys: metrics)
    table = forces.index_table(APPENDIX_4, POSE, ["p", "s", "q", "r"], "About. ")
    assert table.words == 2
    assert cells(table) == [
        ("P", "title p", *[NONE] * 4), ("S", "title s", "2 N", "3 N", "4 N", "5 N"),
        ("Q", "title q", *[NONE] * 4), ("R", "title r", *[NONE] * 4),
    ]  # fmt: skip
    assert table.caption.startswith("About. At the report’s pose")
    assert table.caption.endswith(
        " P, Q: no value, design: no payload. R: no value, design: no drive."
    )
