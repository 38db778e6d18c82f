"""Tables of accuracy, loads, stiffness and logs whose results are made up.

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
    accuracy,
    identification,
    loads,
    stiffness,
)
from paminsa_viz.blocks.kinds import Row, Table
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.design import APPENDIX_4, PARAMETER
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.elastic import BARS
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.quantities import QUANTITIES
from tests.blocks.said import cells, said

POSE = (0.03, -0.02, 0.25, -0.52)

# -------------------------------------------------------------------------------------- accuracy


def tolerances() -> Any:
    """Shares of the lengths in the variances: a half, a quarter and so on, then very little."""
    shares = np.tile(0.5 ** np.arange(1.0, len(LENGTHS) + 1), (6, 1))
    six = np.arange(1.0, 7.0)
    return SimpleNamespace(
        worst=1e-6 * six, clearance=2e-7 * six, rms=5e-7 * six, shares=shares, horizontal=7e-6,
        rms_horizontal=8e-6, tilt=9e-6, rms_tilt=1e-5,
    )  # fmt: skip


def test_errors_by_tolerances_in_their_order_with_the_lengths_that_count() -> None:
    table, note = accuracy.tolerance_blocks(tolerances())
    rows = cells(table)
    assert [row[0].partition(" [")[0] for row in rows] == [
        "x", "y", "position", "z", "θ", "tilt about x", "tilt about y", "tilt",
    ]  # fmt: skip
    assert rows[0][1:4] == ("1.00", "0.200", "0.500")
    assert rows[3][1:4] == ("4.00", "0.800", "2.00")  # z is the fourth coordinate
    arcsec = 3600 * 180 / math.pi * 1e-6
    assert rows[4][1] == f"{3 * arcsec:.3f}"
    assert rows[2] == ("position [µm]", "7.00", "–", "8.00")
    assert float(rows[7][1]) == pytest.approx(9 * arcsec, abs=0.01)
    first = [f"{one.symbol} {share:.1f} %" for one, share in zip(LENGTHS, (50.0, 25.0, 12.5, 6.2))]  # noqa: B905
    assert rows[0][4] == ", ".join(first)
    keys = [getattr(cell, "quantity", "") for cell in table.rows[0].cells[1:4]]  # type: ignore
    assert keys == ["tolerance_x", "", "rms_tolerance_x"]
    assert all(key in QUANTITIES for key in keys if key)
    keys = [getattr(cell, "quantity", "") for cell in table.rows[5].cells[1:4]]  # type: ignore
    assert keys == ["", "", ""]
    found = tolerances()
    found.worst[2] = np.nan
    assert said(accuracy.tolerance_blocks(found))[0][1] == "warn"
    assert note.kind == "muted"  # type: ignore


def test_shares_are_listed_down_to_half_a_percent_the_largest_first() -> None:
    found = tolerances()
    found.shares = found.shares[:, ::-1]
    table = accuracy.shares_table(found, 3)
    kept = [0.5**n for n in range(1, len(LENGTHS) + 1) if 0.5**n >= 0.005]
    assert [row.cells[1] for row in table.rows] == [f"{100 * share:.1f} %" for share in kept]
    assert [row.cells[1].share for row in table.rows] == kept  # type: ignore
    symbols = [one.symbol for one in LENGTHS[::-1]]
    assert [row.cells[0] for row in table.rows] == symbols[: len(kept)]
    assert [row.hint for row in table.rows] == [one.label for one in LENGTHS[::-1]][: len(kept)]
    assert "variance of z" in table.caption


def test_robots_drawn_at_random_and_those_that_cannot_be_assembled() -> None:
    errors = np.arange(60.0).reshape(10, 6) * 1e-6
    drawn = SimpleNamespace(
        errors=errors, ok=np.arange(10) > 1, seed=7, rms=np.full(6, 3e-6),
        quantile=lambda share: np.arange(1.0, 7.0) * share * 1e-6,
    )  # fmt: skip
    blocks = accuracy.robots_blocks(drawn)  # type: ignore
    assert cells(blocks[0])[0] == ("x [µm]", "0.500", "0.950", "0.997", "3.00")
    assert cells(blocks[0])[2][:2] == ("z [µm]", "2.00")
    assert blocks[0].head[0] == "10 robots, seed 7"  # type: ignore
    assert said(blocks)[-1] == ("2 of 10 robots cannot be assembled.", "bad")
    drawn.ok = np.ones(10, bool)
    assert len(accuracy.robots_blocks(drawn)) == 2  # type: ignore


def test_what_the_drives_errors_are_made_of() -> None:
    held = DriveAccuracy(2e-4, 3e-5, 4e-4, 5e-5, 6e-4, 7e-5)
    values = {name: getattr(held, name) for name in (
        "resolution_rotary", "resolution_linear", "backlash_rotary", "backlash_linear",
        "control_rotary", "control_linear",
    )}  # fmt: skip
    text = accuracy._parts(held)
    rotary, linear = text.removesuffix(".").split("; ")
    assert linear == (
        f"M4 within ±{1e6 * held.half_widths[3]:.3g} µm: half a count of "
        f"{1e6 * values['resolution_linear']:.3g} µm, half a backlash of "
        f"{1e6 * values['backlash_linear']:.3g} µm, controller "
        f"±{1e6 * values['control_linear']:.3g} µm"
    )
    assert rotary.startswith("M1 to M3 within ±")
    assert f"half a count of {math.degrees(values['resolution_rotary']):.3g}°" in rotary
    assert accuracy.drives_note(held).text == f"{text.split(':')[0]}; {linear.split(':')[0]}."


# ----------------------------------------------------------------------------------------- loads


def test_loads_of_a_leg_alone() -> None:
    rows = (
        Row(("5", "platform", "B4", *(f"{n}" for n in range(6))), hint="h"),
        Row(("M_k", "B10", "base", *(f"{n}" for n in range(6, 12)))),
    )
    table = Table(("Joint", "On", "From", *"abcdef"), rows, words=3)
    for leg in range(3):
        one = loads.of_leg(table, leg)
        assert one.head == ("Joint", "On", *"abcdef"[2 * leg : 2 * leg + 2])
        assert one.rows[0].cells[2:] == (f"{2 * leg}", f"{2 * leg + 1}")
        assert one.rows[1].cells[0] == f"M{leg + 1}"
        assert one.words == 2
    narrow = replace(table, head=("Bar", *"abcdef"), words=1, rows=(Row(("B1", *"012345")),))
    assert loads.of_leg(narrow, 1).rows[0].cells == ("B1", "2", "3")


def test_forces_below_rounding_are_zero_and_infinite_ones_are_left_out() -> None:
    assert loads._text(0.9e-9) == loads._text(-0.9e-9) == loads._text(0.0)
    assert loads._text(1.1e-9) != loads._text(0.0)
    assert loads._text(math.inf) == loads._text(-math.inf) == ""
    assert loads._text(0.5, "1:%") == "50.0"
    inner = np.arange(1.0, 1.0 + 9 * len(BARS)).reshape(3, len(BARS), 3)
    use = 0.01 * np.arange(1.0, 1.0 + 3 * len(BARS)).reshape(3, len(BARS))
    table = loads.bars_table(inner, use)
    assert [row.cells[0] for row in table.rows] == [bar.upper() for bar in BARS]
    for place, row in enumerate(table.rows):
        for leg in range(3):
            found = [float(cell) for cell in row.cells[1 + 4 * leg : 5 + 4 * leg]]
            assert found == pytest.approx([*inner[leg, place], 100 * use[leg, place]], rel=5e-3)
    hints = [getattr(cell, "hint", "") for cell in table.head[1:5]]
    assert [bool(hint) for hint in hints] == [False, False, False, True]


# ------------------------------------------------------------------------------------- stiffness


def test_shares_of_parts_in_load_cases() -> None:
    count = len(stiffness.SHARE_LABELS)
    one, other = np.zeros(count), np.zeros(count)
    one[:4], other[:4] = (0.6, 0.0004, 0.1, 0.0005), (0.1, 0.0004, 0.8, 0.0)
    table = stiffness.shares_table({"a": one, "b": other})
    assert table.head == ("Part", "a", "b")
    labels = stiffness.SHARE_LABELS
    assert cells(table) == [
        (labels[2], "10.0 %", "80.0 %"), (labels[0], "60.0 %", "10.0 %"),
        (labels[3], "0.1 %", "0.0 %"),
    ]  # fmt: skip
    assert [cell.share for cell in table.rows[0].cells[1:]] == [0.1, 0.8]  # type: ignore


def test_a_deflection_with_its_load_and_tilt() -> None:
    wrench = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    twist = np.array([1e-3, 2e-3, -3e-3, 3e-4, 4e-4, 1e-13])
    table = stiffness.deflection_table("case", wrench, twist)
    assert cells(table) == [
        ("x [mm]", "1 N", "1.00"), ("y [mm]", "2 N", "2.00"), ("z [mm]", "3 N", "−3.00"),
        ("about x [mrad]", "4 N·m", "0.300"), ("about y [mrad]", "5 N·m", "0.400"),
        ("about z [mrad]", "6 N·m", "0.000"), ("tilt [mrad]", "", "0.500"),
    ]  # fmt: skip
    moved: Any = SimpleNamespace(actuators=np.array([1e-4, 2e-4, -3e-4, 5e-4]), tilt=2e-4)
    text = stiffness.compensation_text(moved)
    for part in ("M1 0.1 mrad", "M2 0.2 mrad", "M3 −0.3 mrad", "M4 0.5 mm", "tilt of 0.2 mrad"):
        assert part in text


def test_natural_frequencies_beside_those_of_the_drives() -> None:
    rows = cells(stiffness.modes_table([3.9, 5.5, 7.25, 8.0], [4.1, 6.0]))
    assert rows == [
        ("1", "3.900", "4.100"), ("2", "5.500", "6.000"), ("3", "7.250", "–"), ("4", "8.000", "–"),
    ]  # fmt: skip
    table = stiffness.modes_table([3.9, 5.5], [])
    keys = [row.cells[1].quantity for row in table.rows]  # type: ignore
    assert keys == ["frequency_1", ""]


def test_axes_have_the_stiffness_of_the_drives_where_one_moves_along_them() -> None:
    design_ = APPENDIX_4
    found = stiffness.platform_stiffness(design_, POSE)
    table = stiffness.directions_table(design_, found)
    alone = np.linalg.inv(stiffness.drive_stiffness(design_, np.array(POSE)))
    expected = {0: alone[0, 0], 1: alone[1, 1], 5: alone[2, 2], 2: alone[3, 3]}
    for axis, row in enumerate(table.rows[:6]):
        if axis not in expected:
            assert row.cells[2] == "rigid"
            continue
        scale = 1e-3 if axis < 3 else 1.0
        assert float(row.cells[2]) == pytest.approx(scale / expected[axis], rel=1e-3)
        assert row.cells[1].quantity in QUANTITIES  # type: ignore
    assert [row.cells[1].quantity for row in table.rows] == [  # type: ignore
        "stiffness_x", "stiffness_y", "stiffness_z", "", "", "stiffness_theta",
        "stiffness_horizontal", "stiffness_tilt",
    ]  # fmt: skip


# ---------------------------------------------------------------------------------------- a log


def estimate(**changes: Any) -> Any:
    parameter = SimpleNamespace(unit="m", label="a length", design=0.3)
    values = {"parameter": parameter, "symbol": "l", "known": True, "value": 0.301,
              "half_width": 0.002, "reason": lambda: "why"}  # fmt: skip
    return SimpleNamespace(**values | changes)


def test_estimates_are_marked_where_the_design_is_outside_their_interval() -> None:
    items = [
        estimate(), estimate(value=0.303), estimate(value=0.297), estimate(value=0.3015),
        estimate(known=False),
    ]  # fmt: skip
    findings: Any = SimpleNamespace(identification=SimpleNamespace(estimates=items))
    table = identification.estimates_table(findings)
    assert [row.kind for row in table.rows] == ["plain", "marked", "marked", "plain", "muted"]
    assert table.rows[0].cells == ("l [mm]", "a length", "301.0 ± 2.0", "300")
    assert table.rows[4].cells[2] == "unknown"
    assert table.rows[0].hint == "why"


def cause(text: str, named: bool, explains: float, unit: str = "m") -> Any:
    return SimpleNamespace(
        text=text, named=named, explains=explains, unit=unit, value=0.002, half_width=0.0001
    )


def test_named_causes_come_before_others_that_explain_something() -> None:
    named = cause("n", True, 0.5)
    others = [cause(f"o{i}", False, 0.1 - 0.01 * i) for i in range(8)]
    none = cause("z", False, 0.0)
    causes = SimpleNamespace(named=[named], ranked=[named, none, *others], unseen=["a", "b"])
    findings: Any = SimpleNamespace(causes=causes)
    table = identification.causes_table(findings)
    assert [row.cells[0] for row in table.rows] == ["n", *(f"o{i}" for i in range(5))]
    assert table.rows[0].cells[1:] == ("2.00 ± 0.10 mm", "50.0 %", "yes")
    assert table.rows[1].cells[2:] == ("10.0 %", "no")
    assert [row.kind for row in table.rows[:2]] == ["marked", "muted"]
    assert identification.cause_size(cause("s", False, 0.1, "")) == "0.200 ± 0.010 %"
    assert identification.unseen_note(findings).text.endswith("log: a; b.")


@pytest.mark.parametrize(("holds", "kind"), [(True, "ok"), (False, "bad"), (None, "plain")])
def test_the_identity_of_the_masses_and_the_verdict(holds: bool | None, kind: str) -> None:
    identity: Any = SimpleNamespace(holds=holds, value=0.5, half_width=0.25, z=3.9)
    note = identification.identity_note(identity)
    assert note.kind == kind
    if holds is not None:
        word = "holds" if holds else "fails"
        assert note.text == f"Identity of the masses: {word}, 0.50 ± 0.25 N, z = 3.9."
    for named in ((), (cause("a", True, 0.5), cause("b", True, 0.1))):
        findings: Any = SimpleNamespace(
            identification=SimpleNamespace(identity=identity), causes=SimpleNamespace(named=named)
        )
        verdict = identification._verdict(findings)
        fails = bool(named) or holds is False
        assert verdict.kind == ("bad" if fails else "ok")
        assert ("may be wrong: a; b" in verdict.text) == bool(named)
        assert ("A spring may be" in verdict.text) == (not named and holds is False)
        assert verdict.text.endswith(note.text)


def test_masses_that_a_log_tells_and_those_that_keep_their_design() -> None:
    parameter = PARAMETER["links.b1"]
    items = [
        SimpleNamespace(parameter=parameter, value=1.25, told=told, prior=1.2, deviation=0.05)
        for told in (True, False)
    ]
    findings: Any = SimpleNamespace(nearest=SimpleNamespace(masses=items))
    table = identification.masses_table(findings)
    assert [row.cells[2:] for row in table.rows] == [
        ("1.250 ± 0.050", "1.2", ""), ("1.25", "1.2", "as designed: not in the log"),
    ]  # fmt: skip
    assert [row.kind for row in table.rows] == ["plain", "muted"]


def test_checks_by_other_logs() -> None:
    check = SimpleNamespace(log=SimpleNamespace(name="two"), ratio=np.array([1.0, 1.1, 1.2, 1.3]))
    payload = SimpleNamespace(
        mass=2.0, half_width=0.1, free_mass=2.5, free_half_width=0.2, drift=3.0,
        drift_half_width=0.3, gain=None,
    )  # fmt: skip

    def rows(**changes: Any) -> list[tuple[str, ...]]:
        found: Any = SimpleNamespace(**{"validation": None, "payload": None} | changes)
        return cells(identification.checks_table(found))

    assert rows() == []
    ratios = ", ".join(f"{name} {r:.3g}" for name, r in zip(ACTUATORS, check.ratio, strict=True))
    assert rows(validation=check) == [
        ("Second log, “two”", f"residual over its own fit’s: {ratios}")
    ]
    found = rows(payload=payload)
    assert found == [
        ("Payload", "2.00 ± 0.10 kg"),
        ("if F_4 drifted between the logs", "2.50 ± 0.20 kg, a drift of 3.00 ± 0.30 N"),
    ]
    payload.gain = (0.98, 0.01)
    assert rows(payload=payload)[2] == ("Common gain of the torques", "0.980 ± 0.010")
