"""Words, marks and data of results that are made up: every case of each, and no two numbers alike.

What a cell says follows from one field of the result, whatever a solver would find.
"""

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
from paminsa_viz.balancing import whole_mass
from paminsa_viz.blocks import clearance as clearance_words
from paminsa_viz.blocks import drives, trajectory
from paminsa_viz.blocks.balance import mass_facts
from paminsa_viz.blocks.drives import (
    FIGURES_HEAD,
    cycle_text,
    facts_table,
    figures_table,
    own_table,
    ratio_table,
)
from paminsa_viz.blocks.trajectory import (
    crossings_table,
    passages_blocks,
    published_differences,
    published_notes,
    reference_note,
    shortest_data,
    simulation_data,
    simulation_notes,
    trajectory_blocks,
    trajectory_data,
)
from paminsa_viz.clearance import PairGroup
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.drive import ACTUATORS, Drive
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.trajectory import (
    PRESET,
    CrossingDrift,
    ShortestMotion,
    ShortestStretch,
    TrajectoryAnalysis,
    analyze,
)
from paminsa_viz.trajectory.check import PathEvent
from paminsa_viz.units import NONE
from tests.blocks.said import cells, said

# ------------------------------------------------------------------------------------------ drives

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
        analysis: Any = SimpleNamespace(
            design=held, check=SimpleNamespace(first=first), trajectory=None
        )
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
        "RMS torque": ["1.5 N·m", "75 % of 2"], "peak torque": ["3 N·m", "60 % of 5"],
        "envelope": ["60 %", ""], "top speed": ["954.9 rpm", "25 % of 3820"],
        "peak power": ["222 W", ""], "inertia ratio": ["4.5", "robot over motor"],
        "winding": ["32 %", "temperature rise"], "gear ratio": ["50", "20 to 80 fit"],
        "one count": ["130 µrad", "of the encoder"],
    }  # fmt: skip
    free = replace(MOTOR, rated_torque=None, peak_torque=None, top_speed=None, encoder_counts=None)
    rows = {
        label: rest
        for label, *rest in cells(facts_table(on_a_load(drive=free, ratios=(math.nan,) * 2)))
    }
    for label in ("RMS torque", "peak torque", "top speed"):
        assert rows[label][1] == ""
    assert rows["top speed"][0] == "955 rpm"
    assert rows["one count"][0] == NONE
    assert rows["gear ratio"][1] == "no ratio fits"
    screw = replace(MOTOR, transmission="screw", lead=0.02)
    rows = {label: rest for label, *rest in cells(facts_table(on_a_load(drive=screw)))}
    assert rows["one count"][0] == "0.4 µm"  # 20 mm / 50 / 1000


def test_limits_of_a_drive_whose_torque_falls() -> None:
    """The peak is that at rest, the top speed that of the last corner."""
    falling = replace(
        MOTOR, peak_torque=None, top_speed=None, envelope=((0.0, 6.0), (200.0, 4.0), (500.0, 1.0))
    )
    table = facts_table(on_a_load(drive=falling, top_power=222.22, inertia_ratio=4.56789))
    rows = {label: rest for label, *rest in cells(table)}
    assert rows["peak torque"][1] == "50 % of 6"
    assert rows["top speed"][1] == "20 % of 4775"
    assert (rows["peak power"][0], rows["inertia ratio"][0]) == ("222 W", "4.57")
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
            rows=[range(2 + j) for j in range(4)], figures=lambda j, n: [on_a_load()] * min(n, 2),
        )  # fmt: skip
        design = replace(APPENDIX_4, drives=(MOTOR,) * 3 + (None,)) if driven else APPENDIX_4
        return drives.selection_blocks(design, found, 2, advice)

    table, *lists = blocks(False)
    assert cells(table)[0] == (
        "M1", "1.5 N·m", "0.75 N·m", "2.25 rad/s", "3.5 W", "0.125 kg·m²",
    )  # fmt: skip
    assert cells(table)[3] == ("M4", "1.5 N", "0.75 N", "2.25 m/s", "3.5 W", "0.125 kg")
    assert [one.caption for one in lists] == [
        f"M{j + 1}: {2 + j} of {10 + j} drives are feasible." for j in range(4)
    ]
    assert [[row[0] for row in cells(one)] for one in lists] == [["1", "2"]] * 4
    _, *lists = blocks(True)
    assert [one.caption.partition(":")[0] for one in lists] == ["M1 to M3", "M4"]
    advised = blocks(True, ("a slower motion", "", "", ""))
    assert said(advised) == [
        ("M1 to M3: 2 of 10 drives are feasible.", "bad"), ("a slower motion.", "plain"),
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
    assert own.caption.startswith("The design's own drives")
    assert len(blocks(False, driven=True)) == len(blocks(False)) + 1


def test_motions_of_a_cycle() -> None:
    motions = [
        SimpleNamespace(trajectory=SimpleNamespace(name=name, duration=t), repeats=n, dwell=d)
        for name, t, n, d in (("a", 1.5, 1.0, 0.0), ("b", 2.0, 3.0, 0.25))
    ]
    cycle: Any = SimpleNamespace(duties=motions)
    assert cycle_text(cycle) == ("a (1.5 s, 1 times, dwell 0 s), b (2 s, 3 times, dwell 0.25 s)")


# --------------------------------------------------------------------------------------- clearance


def distances(least: Any, pair: Any) -> Any:
    """A clearance of poses with pairs (a of leg 1, b), (a of leg 2, b), (M1, c)."""
    names = (("a of leg 1", "b"), ("a of leg 2", "b"), ("M1", "c"))
    return clearance_words.Clearance(
        SimpleNamespace(names=names), np.array(least, float), np.array(pair),  # type: ignore
        np.zeros((*np.shape(pair), 2, 3)),
    )  # fmt: skip


def test_nearest_bodies_of_many_poses_are_counted_by_kind() -> None:
    over = distances([0.004, 0.002, np.nan, -0.003, 0.01, 0.02], [0, 1, -1, 2, 0, 2])
    kinds = clearance_words.nearest_kinds(over)
    assert kinds == [(("a", "b"), 3, 0.002), (("M", "c"), 2, -0.003)]
    note, table = clearance_words.region_blocks(over)
    text = "5 of 6 poses can be taken; 20.0 % of them have less than 0 mm."
    assert said([note]) == [(text, "warn")]
    assert cells(table) == [("a", "b", "3", "2 mm"), ("M", "c", "2", "−3 mm")]
    note, _ = clearance_words.region_blocks(over, 0.01, "samples")
    text = "5 of 6 samples can be taken; 60.0 % of them have less than 10 mm."
    assert said([note]) == [(text, "warn")]
    apart = distances([0.004, 0.002], [0, 1])
    assert said(clearance_words.region_blocks(apart))[0][1] == "ok"
    none = distances([np.nan, np.nan], [-1, -1])
    assert said(clearance_words.region_blocks(none)) == [("0 of 2 poses can be taken.", "warn")]
    data = clearance_words.clearance_data(APPENDIX_4, 0, {}, distances(np.nan, -1), over, 0.005)
    assert data["least"] is None
    assert (data["poses"]["drawn"], data["poses"]["reached"]) == (6, 5)
    assert data["poses"]["below"] == 3
    assert data["poses"]["nearest"][1] == {"bodies": ("M", "c"), "poses": 2, "least_m": -0.003}
    here = distances(0.004, 1)
    groups = dict(zip(PairGroup, [here] + [distances(np.nan, -1)] * len(PairGroup)))  # noqa: B905
    data = clearance_words.clearance_data(APPENDIX_4, 0, groups, here, None, 0.005)
    assert data["least"]["bodies"] == ("a of leg 2", "b")
    assert data["least"]["distance_m"] == 0.004
    assert "poses" not in data
    table, note = clearance_words.pose_blocks(groups, here)
    assert cells(table) == [(next(iter(PairGroup)).value, "a of leg 2", "b", "4 mm")]
    assert said([note]) == [("Least clearance: 4 mm, a of leg 2 and b.", "ok")]
    kinds = [clearance_words.verdict(d, ("a", "b"), 0.005).kind for d in (-1e-3, 4e-3, 5e-3)]
    assert kinds == ["bad", "warn", "ok"]
    assert clearance_words.verdict(np.nan, ("", "")).kind == "muted"
    assert clearance_words.verdict(4e-3, ("a", "b")).kind == "ok"
    assert clearance_words.verdict(0.0, ("a", "b"), 0.005).kind == "warn"
    assert (table.words, clearance_words.region_blocks(over)[1].words) == (3, 2)  # type: ignore
    first = distances(0.004, 0)
    table, note = clearance_words.pose_blocks(dict.fromkeys(PairGroup, first), first)
    assert len(table.rows) == len(PairGroup)  # type: ignore
    assert said([note])[0][0].endswith("a of leg 1 and b.")
    data = clearance_words.clearance_data(APPENDIX_4, 0, {}, first, over, 0.004)
    assert data["least"]["bodies"] == ("a of leg 1", "b")
    assert data["poses"]["below"] == 2


def test_one_pose_that_can_be_taken_is_enough_for_a_table() -> None:
    note, table = clearance_words.region_blocks(distances([np.nan, 0.004], [-1, 1]))
    assert said([note])[0][0].startswith("1 of 2 poses can be taken; 0.0 %")
    assert cells(table) == [("a", "b", "1", "4 mm")]


def test_most_kinds_of_bodies_are_listed_up_to_a_number() -> None:
    count = clearance_words.MOST + 3
    over = distances(np.arange(count) * 1e-3, np.arange(count))
    letters = "abcdefghijklmnopqrstuvwxyz"
    object.__setattr__(
        over, "shapes", SimpleNamespace(names=[(letters[i], "x") for i in range(count)])
    )
    _, table = clearance_words.region_blocks(over)
    assert len(cells(table)) == clearance_words.MOST


# -------------------------------------------------------------------------------------- trajectory

POSE = (0.01, 0.02, 0.1, -0.5)


def test_shortest_durations_as_data() -> None:
    plan: Any = SimpleNamespace(duration=1.0)
    stretch = ShortestStretch(plan, "speed of M1", 3.0, "rad/s", 0.5)
    assert shortest_data(stretch) == {
        "quantity": "speed of M1", "limit": 3.0, "unit": "rad/s", "t_s": 0.5,
    }  # fmt: skip
    best = ShortestMotion(plan, "speed of M1", 3.0, "rad/s", 0.5, 1.25, "why")
    assert shortest_data(best) == {**shortest_data(stretch), "stretched_s": 1.25, "note": "why"}


def checked_so(analysis: TrajectoryAnalysis, **events: PathEvent) -> TrajectoryAnalysis:
    solved = replace(analysis.solved, check=replace(analysis.check, **events))  # type: ignore
    return replace(analysis, solved=solved)


def test_a_motion_that_can_be_run_or_not() -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)
    whole = analyze(APPENDIX_4, motion)
    assert whole.check.first is None
    near = PathEvent(0.25, Limit.STRETCHED, 1, 0.0123, POSE)
    for leg, who in ((1, ", leg 2"), (0, ", leg 1"), (-1, "")):
        one = checked_so(whole, closest=replace(near, leg=leg))
        notes = said(trajectory_blocks(one))
        noun = Limit.STRETCHED.noun
        assert notes[1] == (
            f"The robot can run it. It comes nearest to a limit ({noun}{who}) at 0.25 s, with "
            "12.3 mm to spare.", "ok",
        )  # fmt: skip
        data = trajectory_data(one)
        assert data["closest"]["leg"] == (leg + 1 if leg >= 0 else None)
        assert data["failure"] is None
        assert data["closest"]["margin_m"] == 0.0123
    assert said([reference_note(whole)]) == [('reference "Appendix 4": can run it too', "ok")]
    failed = checked_so(whole, first=near)
    notes = said(trajectory_blocks(failed))
    assert notes[1][1] == "bad"
    assert notes[1][0].endswith("The numbers are of the time before.")
    assert said([reference_note(failed)])[0][1] == "bad"
    data = trajectory_data(failed)["failure"]
    assert (data["t_s"], data["leg"], data["pose"]) == (0.25, 2, POSE)
    assert data["explanation"] == near.explanation


def test_a_motion_beside_others_with_its_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Robots that cannot begin it have no rows, and the motion itself no figures then."""
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)
    whole = analyze(APPENDIX_4, motion)
    far = motion.pose + np.array([2.0, 0.0, 0.0, 0.0])
    nowhere = analyze(APPENDIX_4, replace(motion, pose=far))
    others = {"one": whole, "two": None, "three": nowhere}
    for given, names in ((None, [""]), (others, ["", ", one"])):
        table: Any = trajectory_blocks(whole, given)[-1]
        assert [row.cells[0] for row in table.rows] == [
            f"{name}{of}" for of in names for name in ACTUATORS
        ]
    assert said(trajectory_blocks(whole))[0][0].startswith(f"“{motion.name}” ({motion.kind}): ")
    nameless = replace(whole, solved=replace(
        whole.solved, trajectory=replace(motion, kind="")))  # fmt: skip
    text = said(trajectory_blocks(nameless))[0][0]
    assert text == f"“{motion.name}”: {motion.duration:.4g} s, {motion.size} samples."
    drawn: list[Any] = []
    monkeypatch.setattr(trajectory, "series_figure", lambda *a, **k: drawn.append((*a, k)))
    assert trajectory.motion_figures(nowhere) == []
    assert len(trajectory.motion_figures(whole)) == 4
    assert [kind for kind, *_ in drawn] == ["pose", "torques", "breakdown", "power"]
    assert [options["caption"] for *_, options in drawn] == [False, True, False, False]
    unbounded = SimpleNamespace(t=0.123456, locus=SimpleNamespace(label="circle"), residual=0.12345)
    object.__setattr__(nameless, "unbounded", (unbounded,))
    text, kind = said(trajectory_blocks(nameless))[2]
    assert text.startswith("At 0.1235 s this robot's torques have no bound")
    assert "t_sᵀ F = 0.123 N·m instead" in text
    assert kind == "bad"


def test_crossings_have_their_torques_in_the_limit_or_no_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(trajectory, "escape_inertia", lambda design, pose: 0.123456)
    items = [
        SimpleNamespace(
            locus=SimpleNamespace(label=name), t=t, residual=0.0123456,
            torque=(1.5, 2.5, -3.5, 450.0),
        )
        for name, t in (("circle", 0.123456), ("turn", 1.5))
    ]  # fmt: skip
    analysis: Any = SimpleNamespace(
        crossings=items, unbounded=items[1:], design=APPENDIX_4,
        trajectory=SimpleNamespace(at=lambda t: SimpleNamespace(pose=POSE)),
    )  # fmt: skip
    assert cells(crossings_table(analysis)) == [
        ("circle", "0.1235 s", "0.0123 N·m", "1.5 N·m", "2.5 N·m", "−3.5 N·m", "450 N",
         "0.123 kg·m²"),
        ("turn", "1.5 s", "0.0123 N·m", *["no bound"] * 4, "0.123 kg·m²"),
    ]  # fmt: skip


def test_passages_of_a_plan_have_their_speeds_and_drifts(monkeypatch: pytest.MonkeyPatch) -> None:
    item = SimpleNamespace(
        crossing=SimpleNamespace(s=0.56789, locus=SimpleNamespace(label="circle")),
        speed=1.2345, speed_range=(0.5, 2.0), residual=2.34e-14,
    )  # fmt: skip
    plan: Any = SimpleNamespace(
        crossings=(item, item), durations=(0.37234, 11.0), plan=SimpleNamespace(duration=0.5)
    )
    drifts = (
        CrossingDrift(0.2, 1.0, 0.01234, (3e-6, 4e-6, 1e-5, 9.0)),
        CrossingDrift(0.2, 1.0, 0.01234, (3e-9, 4e-9, -1e-8, 9.0)),
    )
    monkeypatch.setattr(trajectory, "payload_drift", lambda design, plan, error: drifts)
    monkeypatch.setattr(trajectory, "unplanned_torque", lambda item, duration: 1000 * duration)
    found = passages_blocks(APPENDIX_4, plan)
    row = ("circle", "0.5679", "1.23 1/s", "0.5 1/s", "2 1/s", "2·10⁻¹⁴ N·m", "500 N·m")
    assert cells(found[1]) == [row] * 2
    assert said(found) == [
        ("Within the limits 0.372 s to 11 s are possible.", "plain"),
        ("circle: 0.1 kg more payload lets the platform drift by 5 µm and 2.1″ in 12 ms.", "warn"),
        (
            "circle: 0.1 kg more payload lets the platform drift by less than 0.01 µm and less "
            "than 0.036″ in 12 ms.", "warn",
        ),
    ]  # fmt: skip
    for shift, text in (
        ((0.95e-8, 0.0, 1.7e-7, 1.0), "less than 0.01 µm and less than 0.036″"),
        ((0.0, 1.05e-8, -1.8e-7, 1.0), "0.01 µm and 0.037″"),
    ):
        assert f" by {text} in" in trajectory._drift_text(CrossingDrift(0.2, 1.0, 0.01, shift))
    plan.crossings, drifts = (), ()
    assert len(passages_blocks(APPENDIX_4, plan)) == 1


def test_numbers_that_a_report_opens_with() -> None:
    """The largest torque of M1 to M3 and force of M4, by their sizes."""
    peaks = [SimpleNamespace(peak=peak) for peak in (1.5, -7.12345, 2.5, -456.789)]
    analysis: Any = SimpleNamespace(summary=peaks, check=SimpleNamespace(first=None))
    facts = trajectory.trajectory_facts(analysis)
    assert [fact.value for fact in facts] == ["7.12 N·m", "456.8 N"]
    analysis.summary, analysis.check.first = (), "why"
    *rest, failed = trajectory.trajectory_facts(analysis)
    assert [fact.value for fact in rest] == [NONE, NONE]
    assert (failed.value, failed.kind) == ("fails", "bad")
    loaded = APPENDIX_4.vary({"payload.mass": 2.0})
    mass, imbalance = mass_facts(loaded)
    assert mass.value == f"{whole_mass(loaded):.4g} kg"
    assert imbalance.value == f"{static_imbalance(loaded):.3g} N".replace("-", "−")


def test_computed_torques_beside_a_published_table() -> None:
    torque = np.array([[1.0, 2.0, np.nan, 4.0], [3.0, -6.0, np.nan, np.nan]])
    off = np.array([[0.1, -0.5, np.nan, 3.0], [-0.3, 0.2, np.nan, np.nan]])
    table: Any = SimpleNamespace(name="other", torque=torque, differences=lambda t, tau: off)
    motion: Any = SimpleNamespace(trajectory=SimpleNamespace(t=None), torque=None)
    first, second, third, fourth = published_differences(motion, table)
    assert third is None
    assert first == {
        "rows": 2, "largest_difference": 0.3, "largest_published": 3.0,
        "rms_difference": pytest.approx(math.sqrt(0.05)),
    }  # fmt: skip
    assert second is not None
    assert (second["largest_difference"], second["largest_published"]) == (0.5, 6.0)
    assert fourth is not None
    assert (fourth["rows"], fourth["largest_difference"]) == (1, 3.0)
    notes = said(published_notes(motion, table))
    assert notes[2] == ("published other, M3: no value at a time of this motion", "warn")
    assert notes[1][0] == (
        "published other, M2: computed off by at most 0.5 N·m, RMS 0.381 N·m, of 6 N·m at 2 times"
    )
    assert notes[3][0].endswith("of 4 N at 1 times")


def test_a_simulated_robot_off_its_motion() -> None:
    error = np.array([[0.001, -0.002, 0.01, 0.0], [-0.003, 0.001, -0.02, 0.0005], [0.0] * 4])
    run: Any = SimpleNamespace(
        error=error, distance=np.array([0.003, 0.004, 0.002]), stopped=None,
        t=np.array([0.0, 1.0, 1.5]), energy_drift=np.array([-2e-6, 1e-6]),
        controller=SimpleNamespace(control=SimpleNamespace(value="torques"), bandwidth=10.0),
        design=APPENDIX_4.vary({"payload.mass": 1.5}),
    )  # fmt: skip
    notes = said(simulation_notes(run))
    assert notes[0] == (
        "simulated with torques, payload 1.5 kg: largest errors x 3 mm, y 2 mm, θ 1.15°, z 0.5 mm; "
        "at the end 2 mm from its place", "plain",
    )  # fmt: skip
    assert notes[1] == ("energy drift of the solution: 2·10⁻⁶ J", "plain")
    data = simulation_data(run)
    assert (data["end_t_s"], data["largest_distance_m"], data["end_distance_m"]) == (
        1.5,
        0.004,
        0.002,
    )
    assert data["largest_error"] == pytest.approx([0.003, 0.002, 0.02, 0.0005])
    assert data["energy_drift_J"] == 2e-6
    assert data["stopped"] is None
    run.stopped = PathEvent(0.75, Limit.SINGULAR, -1, 0.0, POSE)
    assert said(simulation_notes(run))[1][1] == "bad"
    assert simulation_data(run)["stopped"]["t_s"] == 0.75
