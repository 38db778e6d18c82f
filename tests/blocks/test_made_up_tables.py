"""Tables of accuracy, loads and stiffness whose results are made up.

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
    loads,
    stiffness,
)
from paminsa_viz.blocks.kinds import Row, Table
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.elastic import BARS
from paminsa_viz.precision.drive_errors import Bound
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.studies.region import Region
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
    drawn.errors, drawn.ok = errors[:1], np.ones(1, bool)
    assert accuracy.robots_blocks(drawn)[0].head[0] == "1 robot, seed 7"  # type: ignore


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


def test_shares_are_listed_from_half_a_percent_on() -> None:
    found = tolerances()
    found.shares = np.zeros((6, len(LENGTHS)))
    found.shares[1, :4] = (0.0048, 0.005, 0.0052, 0.6)
    rows = accuracy.shares_table(found, 1).rows
    assert [row.cells[1] for row in rows] == ["60.0 %", "0.5 %", "0.5 %"]


def drive_rows(count: int) -> list[Any]:
    """Errors of five coordinates, of which no two numbers are alike."""
    units = {"x": "m:um", "y": "m:um", "xy": "m:um", "z": "m:um", "θ": "rad:arcsec"}
    shape = np.linspace(0.0, 1.0, count) ** 2
    return [
        SimpleNamespace(
            name=name, unit=unit, worst=1e-5 * (n + 1 + shape), linear=2e-5 * (n + 1 + shape),
            rms=3e-5 * (n + 1 + shape),
        )
        for n, (name, unit) in enumerate(units.items())
    ]  # fmt: skip


def test_errors_by_the_drives_at_a_pose_and_over_a_region(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the pose each kind, over the region median, 95 % and largest of the exact ones."""
    unbounded = Bound.SINGULAR
    errors = SimpleNamespace(rows=drive_rows(41), poses=41, unbounded={unbounded: 7})
    monkeypatch.setattr(accuracy, "region_errors", lambda field, accuracy, reached: errors)
    monkeypatch.setattr(accuracy, "error_rows", lambda found: drive_rows(2))
    region = Region(0.12, theta=(0.0, 0.5), z=(-0.5, -0.6))
    over: Any = SimpleNamespace(design=APPENDIX_4, region=region, field=None, reached=None)
    here: Any = SimpleNamespace(ok=True, reason=lambda: "", pose=POSE)
    parts, at, wide, lost = accuracy.drive_blocks(here, over)
    assert said([parts])[0][0].startswith("M1 to M3 within")
    assert said([lost]) == [
        ("No bound at 7 of the 41 poses: the pose is singular.", "warn"),
    ]  # fmt: skip
    names = ["x [µm]", "y [µm]", "position [µm]", "z [µm]", "θ [″]"]
    assert [row[0] for row in cells(at)] == [row[0] for row in cells(wide)] == names
    for n, (one, other) in enumerate(zip(cells(at), cells(wide), strict=True)):
        factor = 1e6 if n < 4 else 3600 * 180 / math.pi
        shape = np.linspace(0.0, 1.0, 41) ** 2
        median, most = np.quantile(shape, [0.5, 0.95])
        assert [float(cell) for cell in one[1:]] == pytest.approx(
            [factor * k * 1e-5 * (n + 1) for k in (1, 2, 3)], rel=5e-3
        )
        ends = (1e-5 * median, 1e-5 * most, 1e-5, 2e-5 * median, 3e-5 * median)
        sizes = [k * 1e-5 * (n + 1) + end for k, end in zip((1, 1, 1, 2, 3), ends, strict=True)]
        assert [float(cell) for cell in other[1:]] == pytest.approx(
            [factor * size for size in sizes], rel=5e-3
        )
    keys = [cell.quantity for cell in at.rows[2].cells[1:]]  # type: ignore
    assert keys == ["error_horizontal", "linear_error_horizontal", "rms_error_horizontal"]
    assert all(key in QUANTITIES for key in keys)
    where = "within 120 mm of the axis at θ 0°, 28.65° and z −500 mm, −600 mm"
    assert f"over 41 poses {where}." in wide.caption  # type: ignore
    here.ok, here.reason = False, lambda: "why"
    none = accuracy.drive_blocks(here, over)[1]
    assert said([none]) == [
        ("No bound at the pose: why. The linear estimate is no bound.", "bad"),
    ]  # fmt: skip
    data = accuracy.accuracy_data(APPENDIX_4, here, region, errors)  # type: ignore
    assert list(data["errors"]) == ["x_m", "y_m", "horizontal_m", "z_m", "theta_rad"]
    assert data["errors"]["y_m"] == {"worst": 2e-5, "linear": 4e-5, "rms": pytest.approx(6e-5)}
    whole = data["region"]["errors"]["x_m"]["worst"]
    assert whole["largest"] == 2e-5
    assert whole["median"] == pytest.approx(1e-5 * (1 + median))
    assert whole["p95"] == pytest.approx(1e-5 * (1 + most))
    assert data["region"]["unbounded"] == {unbounded.word: 7}
    assert (data["bounded"], data["reason"]) == (False, "why")
    keys = ("M1_rad", "M2_rad", "M3_rad", "M4_m")
    assert data["half_widths"] == dict(zip(keys, APPENDIX_4.accuracy.half_widths, strict=True))
    assert data["deviations"] == dict(zip(keys, APPENDIX_4.accuracy.deviations, strict=True))


def test_legs_of_their_own_lengths_put_the_platform_off(monkeypatch: pytest.MonkeyPatch) -> None:
    assert accuracy.own_legs(APPENDIX_4, POSE).text.startswith("All legs have the lengths")
    assert len(accuracy.manufacture_blocks(APPENDIX_4, POSE)) == 2
    own = APPENDIX_4.vary({"leg1.bar_94": 1e-4})
    assert len(accuracy.manufacture_blocks(own, POSE)) == 3
    moved = SimpleNamespace(
        ok=True, pose=np.add(POSE, (1e-5, -2e-5, 1e-4, 4.5678e-5)), tilt=(2e-4, -3e-4),
        reason=lambda: "why",
    )  # fmt: skip
    monkeypatch.setattr(accuracy, "manufactured_pose", lambda design, pose: moved)
    note = accuracy.own_legs(own, POSE)
    assert note.text.endswith(
        "put the platform off by x 10 µm, y −20 µm, z 45.7 µm, θ 20.6″, tilt about x 41.3″, "
        "tilt about y −61.9″."
    )
    assert accuracy.manufacture_blocks(own, POSE)[-1] == note
    moved.ok = False
    assert said([accuracy.own_legs(own, POSE)]) == [
        ("The design’s own legs have no position: why.", "bad")
    ]
    moved.coordinates = np.arange(6.0)
    robots: Any = SimpleNamespace(
        errors=np.zeros((9, 6)), seed=3, solved=0.5, rms=np.arange(6.0),
        quantile=lambda share: share * np.arange(1.0, 7.0),
    )  # fmt: skip
    data = accuracy.manufacture_data(own, POSE, robots)
    assert data["actual"] == dict(
        zip(("x_m", "y_m", "theta_rad", "z_m", *list(data["worst"])[4:]), range(6), strict=True)
    )
    assert list(data["robots"]["p95"].values()) == pytest.approx(0.95 * np.arange(1.0, 7.0))
    assert data["robots"]["count"] == 9
    assert data["actual_reason"] == "why"
    assert "robots" not in accuracy.manufacture_data(own, POSE, None)


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


def on_a_motion() -> Any:
    """Loads of which each is the number of its place."""
    joints, bars = len(loads.JOINTS), len(BARS)
    at = np.arange(3.0 * joints).reshape(3, joints)
    use = 1e-4 * np.arange(2.0 * 3 * bars).reshape(2, 3, bars)
    use[:, 1] = use[::-1, 1]  # of leg 2 the first sample has the most
    return SimpleNamespace(
        peak=100.0 + at, peak_time=200.0 + at, rms=300.0 + at, equivalent=400.0 + at,
        travel=500.0 + at, bar_peak=1.0 + np.arange(9.0 * bars).reshape(3, bars, 3),
        utilization=use, design=APPENDIX_4, trajectory=SimpleNamespace(name="t"),
    )  # fmt: skip


def test_loads_on_a_motion_have_their_places() -> None:
    found = on_a_motion()
    joints, bars = loads.motion_blocks(found)
    most = found.utilization.max(axis=0)
    data = loads.motion_data(found)
    assert len(data["legs"]) == 3
    for leg in range(3):
        for place, (joint, row) in enumerate(zip(loads.JOINTS, joints.rows, strict=True)):
            numbers = [size + len(loads.JOINTS) * leg + place for size in (100, 200, 300, 400, 500)]
            assert [float(cell) for cell in row.cells[1 + 4 * leg : 5 + 4 * leg]] == numbers[:4]
            keyed = data["legs"][leg]["joints"][joint.key]
            assert list(keyed.values()) == numbers
            assert list(keyed)[-1] == ("travel_m" if joint.key == "guide" else "travel_rad")
        for place, (bar, row) in enumerate(zip(BARS, bars.rows, strict=True)):
            assert float(row.cells[4 + 4 * leg]) == pytest.approx(100 * most[leg, place], rel=1e-2)
            one = data["legs"][leg]["bars"][bar]
            assert list(one) == ["N_N", "V_N", "M_Nm", "utilization"]
            assert list(one.values()) == [*found.bar_peak[leg, place], most[leg, place]]
    assert (joints.words, bars.words) == (1, 1)
    assert loads._text(loads.ROUNDING) == "1.00·10⁻⁹"


def test_loads_of_joint_5_alone_are_those_in_its_forces() -> None:
    pose = np.array(POSE)
    forces = loads.joint_forces(APPENDIX_4, pose)
    (table,) = (loads.joints_table(forces, None),)
    for leg in range(3):
        across = [row.cells[4 + 4 * leg] for row in table.rows]
        assert across == [loads._text(one) for one in forces.force[leg, :, 1]]
    data = loads.pose_data(APPENDIX_4, POSE, forces, loads.sideways_forces(APPENDIX_4, pose))
    assert len(data["legs"]) == 3


def test_loads_of_a_motion_that_fails_say_up_to_where(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loads, "motion_loads", lambda analysis: on_a_motion())
    check = SimpleNamespace(possible=True)
    analysis: Any = SimpleNamespace(design=APPENDIX_4, check=check, failure=None)
    assert loads.until_text(analysis) == ""
    whole = loads.loads_blocks(analysis, POSE)
    assert not any(kind == "warn" for _, kind in said(whole))
    analysis.failure = SimpleNamespace(explanation="at a limit")
    assert loads.until_text(analysis) == "The motion fails at a limit"  # its torques alone
    check.possible = False
    text = "Up to where the motion fails at a limit"
    assert loads.until_text(analysis) == text
    assert (f"{text}:", "warn") in said(loads.loads_blocks(analysis, POSE))
    far = loads.loads_blocks(analysis, (2.0, 0.0, 0.0, -0.5))
    assert said(far)[0][0].startswith(f"{loads.NO_FORCES}: ")
    assert said(far)[0][1] == "bad"
    monkeypatch.setattr(loads, "motion_loads", lambda analysis: None)
    assert said(loads.loads_blocks(analysis, POSE))[-1] == (
        "The robot cannot run the trajectory from its start.", "bad",
    )  # fmt: skip


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


def test_a_small_deflection_is_in_small_units_and_has_no_rounding() -> None:
    twist = np.array([0.0, 1e-25, -1.52e-7, 1e-22, 0.0, 0.0])
    table = stiffness.deflection_table("case", np.zeros(6), twist)
    assert [row[::2] for row in cells(table)][1:4] == [
        ("y [µm]", "0.000"), ("z [µm]", "−0.152"), ("about x [mrad]", "0"),
    ]  # fmt: skip
    turned = stiffness.deflection_table("case", np.zeros(6), np.array([0, 0, 1e-3, 0, 0, 4.85e-6]))
    assert cells(turned)[5][0] == "about z [″]"
    assert cells(turned)[5][2] == "1.00"
    actuators = np.array([1e-24, 0.0, 0.0, 5.07e-8])
    text = stiffness.compensation_text(SimpleNamespace(actuators=actuators, tilt=1.7e-21))  # type: ignore[arg-type]
    assert "M3 0 mrad, M4 0.0507 µm; a tilt of 0 mrad remains" in text


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
    assert [row.cells[0].partition("[")[2] for row in table.rows] == [
        *["N/mm]"] * 3, *["N·m/rad]"] * 3, "N/mm]", "N·m/rad]",
    ]  # fmt: skip
    assert [row.cells[1].quantity for row in table.rows] == [  # type: ignore
        "stiffness_x", "stiffness_y", "stiffness_z", "", "", "stiffness_theta",
        "stiffness_horizontal", "stiffness_tilt",
    ]  # fmt: skip


def test_rounding_beside_the_largest_value_is_zero() -> None:
    for size in (100.0, -100.0):
        values = np.array([size, 1.04e-7, -1.04e-7, 0.96e-7, -0.96e-7, 1e-9 * 100.0])
        kept = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 1.0])
        np.testing.assert_array_equal(stiffness._rounded(values), kept * values)


def test_shares_are_under_the_load_or_under_forces_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def shares(design: Any, pose: Any, wrench: Any = None, *, shear: bool) -> Any:
        asked.append((wrench, shear))
        return SimpleNamespace(share=np.full(len(stiffness.SHARE_LABELS), 0.1 * len(asked)))

    monkeypatch.setattr(stiffness, "strain_shares", shares)
    pose = np.array(POSE)
    assert list(stiffness.strain_cases(APPENDIX_4, pose, shear=True)) == [
        "force x", "force y", "force z", "moment z",
    ]  # fmt: skip
    np.testing.assert_array_equal([wrench for wrench, _ in asked], np.eye(6)[[0, 1, 2, 5]])
    assert all(shear for _, shear in asked)
    assert said(stiffness._loaded(APPENDIX_4, pose, shear=False)) == [
        (stiffness.NOTHING_DEFLECTED, "plain")
    ]
    carrying = APPENDIX_4.vary({"payload.mass": 2.0})  # its weight has one direction
    asked.clear()
    assert list(stiffness.strain_cases(carrying, pose, shear=False)) == ["load"]
    assert asked == [(None, False)]
    deflected, note, _ = stiffness._loaded(carrying, pose, shear=False)
    assert "payload and load" in deflected.caption  # type: ignore
    assert note.text.startswith("The motors bring")  # type: ignore


def test_tubes_and_the_ellipsoid_of_compliance() -> None:
    fit = SimpleNamespace(
        bar="B1", mass=1.23456, mass_ratio=0.12345, slender_ratio=0.23456, transverse_ratio=0.34567,
        axial_ratio=0.45678,
    )  # fmt: skip
    design = APPENDIX_4.vary({"elastic.b1_outer": 0.061, "elastic.b1_inner": 0.053})
    assert cells(stiffness.sections_table(design, [fit])) == [  # type: ignore
        ("B1", "61/53 mm", "1.235 kg", "0.123", "0.235", "0.346", "0.457")
    ]
    fit.mass = 0.00123456
    assert cells(stiffness.sections_table(design, [fit]))[0][2] == "0.00123 kg"  # type: ignore
    others = [SimpleNamespace(bar=f"B{i}", mass_ratio=r) for i, r in enumerate((0, 0.3, 0.4, 2, 5))]
    assert "(B1 3.3, B4 0.2 times" in stiffness.other_tubes(others)  # type: ignore
    assert stiffness.other_tubes(others[2:4]) == ""  # type: ignore
    table = stiffness._data(design)
    assert table.words == 2
    assert cells(table)[4][:2] == ("B1", "tube 61/53 mm")
    area = math.pi / 4 * (61.0**2 - 53.0**2)
    assert cells(table)[4][2].startswith(f"A {area:.4g} mm²")
    found: Any = SimpleNamespace(
        pose=np.array(POSE), softest_direction=0.12345,
        ellipsoid=lambda: (np.array([1e-9, 2e-6, 3e-6]), 5.0 - np.arange(9.0).reshape(3, 3)),
    )  # fmt: skip
    text = stiffness._ellipsoid_text(APPENDIX_4, found)
    assert text.startswith(
        "Compliance ellipsoid: 1·10⁻⁶, 0.002, 0.003 mm/N, softest along (3.00, 0.00, −3.00)."
    )
    assert stiffness.softest_text(found) == "7.07° from x"
    middle = stiffness.platform_stiffness(APPENDIX_4, np.array([0, 0, 0, POSE[3]]))
    assert stiffness.softest_text(middle) == "the same in all directions"
    assert "softest" not in stiffness._ellipsoid_text(APPENDIX_4, middle)
    real = stiffness.platform_stiffness(APPENDIX_4, POSE)
    stated = stiffness.stiffness_data(APPENDIX_4, real, shear=False)["stiffness"]
    alike = [real.along(axis) for axis in range(6)]
    np.testing.assert_array_equal(list(stated.values()), [*alike, real.horizontal, real.tilt])
