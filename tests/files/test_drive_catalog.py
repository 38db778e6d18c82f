"""Catalogs of drives: the shipped one, a user's own, and what is refused, with row and column."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any

import pytest

from paminsa_viz.actuation.catalog import CatalogError
from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.payload import payload_change, payload_time_scaling
from paminsa_viz.actuation.ratios import SCANNED, WIDEST, ratio_intervals
from paminsa_viz.actuation.selection import select_drives
from paminsa_viz.actuation.sizing import size_drives
from paminsa_viz.actuation.wrench_capability import DEFAULT_LIMITS
from paminsa_viz.files import drive_catalog
from paminsa_viz.files.drive_catalog import (
    LARGEST_CATALOG,
    LONGEST_NAME,
    MOST_ROWS,
    generic_catalog,
    load_catalog,
    read_catalog,
)
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.trajectory import PRESETS
from paminsa_viz.units import COLUMN_UNITS
from tests.support.documentation import defaults_of, missing

HEAD = "kind,name,source,rotor_inertia_g_cm2,rated_torque_mNm,peak_torque_Nm,rated_speed_rpm,"
HEAD += "top_speed_rad_per_s,envelope_rpm_Nm,gear_ratio,efficiency,brake"
BELL = "o\x07ne"
MOTOR = "motor,one,own measurement,30,320,0.95,3000,600,0 0.95; 3000 0.95; 6000 0.4,,,yes"


def test_a_catalog_and_a_name_may_be_as_long_as_documented(monkeypatch: pytest.MonkeyPatch) -> None:
    name = LONGEST_NAME * "o"
    text = f"{HEAD}\n{MOTOR.replace('one', name)}"
    monkeypatch.setattr(drive_catalog, "MOST_ROWS", 2)
    monkeypatch.setattr(drive_catalog, "LARGEST_CATALOG", len(text))
    (motor,) = read_catalog(text, "my.csv").motors
    assert motor.name == name
    for longer, told in (
        (text + " ", "larger"),
        (text.replace(name, "o") + "\n#\n" + MOTOR, "2 rows"),
    ):
        with pytest.raises(CatalogError, match=told):
            read_catalog(longer, "my.csv")


def test_numbers_are_read_in_the_units_of_their_columns() -> None:
    found = read_catalog(f"# mine\n{HEAD}\n\n{MOTOR}\n gear ,two,x,,,,,,,50,0.8,\n", "my.csv")
    (motor,), (gear,) = found.motors, found.gears
    assert motor.rotor_inertia == pytest.approx(3e-6)
    assert motor.rated_torque == pytest.approx(0.32)
    assert motor.rated_speed == pytest.approx(3000 * 2 * math.pi / 60)
    assert motor.envelope[2] == pytest.approx((6000 * 2 * math.pi / 60, 0.4))
    assert motor.brake
    assert not gear.brake
    assert (gear.gear_ratio, gear.efficiency) == (50.0, 0.8)
    assert found.sources == {"one": "own measurement", "two": "x"}
    assert found.pairs(0).drive(0).reflected_inertia == pytest.approx(2500 * 3e-6)


def test_catalogs_are_separated_as_other_tables_are() -> None:
    """By semicolons and tabs as well, then with a decimal comma, but for commas of names."""
    text = "\n".join(["# 1,5; no", "", HEAD, MOTOR, "# x", "gear,two,a b,,,,,,,50,0.8,"])
    expected = read_catalog(text, "my.csv")
    for separator in ";\t":
        rows = list(csv.reader(io.StringIO(text)))
        for decimal in ",.":
            out = io.StringIO()
            cells = [[c.replace(".", decimal) if c[:1].isdigit() else c for c in r] for r in rows]
            csv.writer(out, delimiter=separator).writerows(cells)
            assert read_catalog(out.getvalue(), "my.csv") == expected
    head = HEAD.replace(",", ";")
    row = "motor;a, b. c;x;1,5;320;0.95;3000;600;;;;"
    with pytest.raises(CatalogError, match=r"row 2, column peak_torque_Nm: '0.95' has a point"):
        read_catalog(f"{head}\n{row}", "my.csv")
    (motor,) = read_catalog(f"{head}\n{row.replace('0.95', '0,95')}", "my.csv").motors
    assert (motor.name, motor.peak_torque) == ("a, b. c", 0.95)
    assert motor.rotor_inertia == pytest.approx(1.5e-7)


@pytest.mark.parametrize("speed", COLUMN_UNITS["rad/s"])
@pytest.mark.parametrize("torque", COLUMN_UNITS["N m"])
def test_envelopes_are_read_in_every_pair_of_units(speed: str, torque: str) -> None:
    """A corner at 300 rad/s and 0.4 N m, written in the units of the column."""
    w, tau = 300.0 / COLUMN_UNITS["rad/s"][speed], 0.4 / COLUMN_UNITS["N m"][torque]
    head = HEAD.replace("envelope_rpm_Nm", f"envelope_{speed}_{torque}")
    row = MOTOR.replace("0 0.95; 3000 0.95; 6000 0.4", f"0 {2 * tau!r}; {w!r} {tau!r}")
    (motor,) = read_catalog(f"{head}\n{row}", "my.csv").motors
    assert motor.envelope == (
        pytest.approx((0.0, 0.8), rel=1e-12), pytest.approx((300.0, 0.4), rel=1e-12)
    )  # fmt: skip


def test_a_file_is_read_to_its_end_or_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path, text = tmp_path / "my.csv", f"{HEAD}\n{MOTOR}"
    monkeypatch.setattr(drive_catalog, "LARGEST_CATALOG", len(text))
    path.write_text(text)
    assert load_catalog(path) == read_catalog(text, "my.csv")
    path.write_text(f"{text}\n")
    with pytest.raises(CatalogError, match="is larger than"):
        load_catalog(path)


@pytest.mark.slow
def test_the_shipped_catalog_is_generic_and_drives_every_preset() -> None:
    catalog = generic_catalog()
    parts = [*catalog.motors, *catalog.gears, *catalog.transmissions]
    assert set(catalog.sources.values()) == {"generic"}
    assert all("generic" in part.name or part.name == "no gear" for part in parts)
    for preset in PRESETS:
        motion = preset.build(APPENDIX_4.geometry).sample(200)
        for j, load in enumerate(duty_cycle(APPENDIX_4, [Duty(motion)]).loads):
            feasible = size_drives(load, catalog.pairs(j)).feasible
            assert 1 <= feasible.sum() < len(feasible)


@pytest.mark.parametrize(
    ("text", "row", "column", "told"),
    [
        ("", None, "", "first line names the columns"),
        ("kind|name|source\n", 1, "kind|name|source", "did you mean source"),
        ("zzzz,name,source\n", 1, "zzzz", "there are name, source, kind, rotor_inertia,"),
        (
            HEAD.replace("rated_torque_mNm", "rated_torque"),
            1,
            "rated_torque",
            "not known; there are rated_torque_Nm",
        ),
        (HEAD.replace("_g_cm2", "_oz_in2"), 1, "rotor_inertia_oz_in2", "its unit is missing"),
        (HEAD.replace("efficiency", "eficiencia"), 1, "eficiencia", "did you mean efficiency"),
        (HEAD.replace("envelope_rpm_Nm", "envelope"), 1, "envelope", "envelope_rpm_Nm"),
        (f"{HEAD},peak_torque_mNm", 1, "peak_torque_Nm", "two columns"),
        (HEAD.replace(",source", ""), 1, "source", "missing"),
        (f"{HEAD}\n{MOTOR},3", 2, "", "13 cells, and there are 12 columns"),
        (f"{HEAD}\n{MOTOR.replace('motor', 'engine')}", 2, "kind", "there are motor, gear"),
        (f"{HEAD}\n{MOTOR.replace('own measurement', '')}", 2, "source", '"generic"'),
        (f"{HEAD}\n{MOTOR.replace('320', '')}", 2, "rated_torque_mNm", "each motor needs it"),
        (f"{HEAD}\n{MOTOR.replace('320', '0,32')}", 2, "", "cells"),
        (f"{HEAD}\n{MOTOR.replace('320', '0.3 Nm')}", 2, "rated_torque_mNm", "a number is needed"),
        (f"{HEAD}\n{MOTOR.replace('320', '3_20')}", 2, "rated_torque_mNm", "a number is needed"),
        (f"{HEAD}\n{MOTOR.replace('30,', '-30,', 1)}", 2, "rotor_inertia_g_cm2", "at least 0"),
        (f"{HEAD}\n{MOTOR.replace('320', 'inf')}", 2, "rated_torque_mNm", "finite"),
        (f"{HEAD}\n{MOTOR.replace('6000', '2000')}", 2, "envelope_rpm_Nm", "increase"),
        (f"{HEAD}\n{MOTOR.replace('0.4', '')}", 2, "envelope_rpm_Nm", "pairs"),
        (f"{HEAD}\n{MOTOR.replace('yes', 'maybe')}", 2, "brake", "yes or no"),
        (f"{HEAD}\ngear,two,x,,,,,,,50,1.2,", 2, "efficiency", "at most 1"),
        (f"{HEAD}\ngear,two,x,,,,,,,0,0.9,", 2, "gear_ratio", "above 0"),
        (f"{HEAD}\nscrew,two,x,,,,,,,,,", 2, "lead", "lead_mm"),
        ("x" * (LARGEST_CATALOG + 1), None, "", "is larger than 5 MB"),
        ("\n".join([HEAD, *[MOTOR] * MOST_ROWS]), None, "", f"has more than {MOST_ROWS:,} rows"),
        (f'{HEAD}\n\nmotor,"one', 3, "", "is not valid CSV: "),
        (HEAD.replace("envelope_rpm_Nm", "envelop_rpm_Nm"), 1, "envelop_rpm_Nm", "envelope_rpm_Nm"),
        (f"{HEAD}\n{MOTOR.replace('one', BELL)}", 2, "name", "one line of printable text"),
        (f"{HEAD}\n{MOTOR.replace('one', 201 * 'o')}", 2, "name", "at most 200 characters"),
        (f"{HEAD}\n{MOTOR.replace('one', ' ')}", 2, "name", "a name is needed"),
        (HEAD.replace("efficiency", "peak"), 1, "peak", "did you mean peak_torque_Nm, peak_t"),
        (HEAD.replace("efficiency", "weight"), 1, "weight", "there are name, source, kind"),
    ],
    ids=range(33),
)
def test_impossible_catalogs_are_refused_in_one_line(
    text: str, row: int | None, column: str, told: str
) -> None:
    with pytest.raises(CatalogError) as caught:
        read_catalog(text, "my.csv")
    assert (caught.value.row, caught.value.column) == (row, column)
    assert told in caught.value.problem
    place = "" if row is None else f", row {row}"
    place += f", column {column}" if column else ""
    assert str(caught.value) == f"my.csv{place}: {caught.value.problem}".replace(BELL, r"o\x07ne")
    assert "\n" not in str(caught.value)


def test_numbers_of_the_documentation_are_those_of_the_program() -> None:
    rotary, lift = DEFAULT_LIMITS[0], DEFAULT_LIMITS[3]
    assert DEFAULT_LIMITS[:3] == (rotary,) * 3
    assert all(one.peak == one.rated for one in DEFAULT_LIMITS)
    drives = [
        f"up to {LARGEST_CATALOG:,} bytes and {MOST_ROWS:,} rows, a name up to {LONGEST_NAME} char",
        f"Such drives are scanned ({SCANNED:,} ratios",
        f"goes up to {WIDEST:g} times the lower one".replace("e+0", "e"),
    ]
    forces = [
        f"{rotary.rated:g} N·m and {rotary.speed:g} rad/s for M1 to M3, {lift.rated:g} N and "
        f"{lift.speed:g} m/s for M4"
    ]
    assert missing("drives", drives) == missing("forces", forces) == []


@pytest.mark.parametrize(
    ("function", "defaults"),
    [
        (Duty, {"repeats": 1.0, "dwell": 0.0}),
        (duty_cycle, {"slower": 1.0}),
        (payload_change, {"slower": 1.0}),
        (payload_time_scaling, {"share": 0.05}),
        (select_drives, {"order": "mass", "inertia_ratio": math.inf, "same": False}),
        (size_drives, {"inertia_ratio": math.inf}),
        (ratio_intervals, {"inertia_ratio": math.inf}),
    ],
)
def test_defaults_are_those_of_the_descriptions(function: Any, defaults: dict[str, Any]) -> None:
    """One motion at its own pace, any ratio of inertias, a change of a twentieth."""
    assert defaults_of(function, defaults) == defaults


def test_a_catalog_without_a_part_says_which(tmp_path: Path) -> None:
    path = tmp_path / "motors.csv"
    path.write_text(f"{HEAD}\n{MOTOR}\n")
    with pytest.raises(CatalogError, match="no gear"):
        load_catalog(path).pairs(0)
    with pytest.raises(CatalogError, match="no gear and no screw or belt"):
        load_catalog(path).pairs(3)
    with pytest.raises(CatalogError, match="cannot be read: no such file"):
        load_catalog(tmp_path / "none.csv")
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CatalogError, match="UTF-8"):
        load_catalog(path)
