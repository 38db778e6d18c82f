"""``drives``: feasible motors and gears, what is lacking, the design that is saved."""

from __future__ import annotations

from pathlib import Path

import pytest

from paminsa_viz.files.design_file import load_design
from tests.support.commands import check_refused, run, run_json

MOTORS = """kind,name,source,rotor_inertia_kg_cm2,rated_torque_Nm,peak_torque_Nm,rated_speed_rpm,\
top_speed_rpm,gear_ratio,efficiency,lead_mm,lead_efficiency,mass_kg
motor,small,test,0.04,0.32,0.95,3000,6000,,,,,0.5
motor,weak,test,0.001,0.002,0.004,3000,6000,,,,,0.1
gear,box,test,,,,,,50,0.8,,,0.4
gear,stage,test,,,,,,2,0.9,,,0.3
screw,spindle,test,,,,,,,,10,0.9,2
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.csv").write_text(MOTORS)


@pytest.mark.slow
def test_generic_drives_fit_the_default_motion(capsys) -> None:
    found = run_json("drives", capsys, "--rows", "2")
    assert found["feasible"]
    assert found["catalog"] == "generic sizes"
    units = [(one["unit"], one["speed_unit"], one["inertia_unit"]) for one in found["actuators"]]
    assert units == [("N m", "rad/s", "kg m^2")] * 3 + [("N", "m/s", "kg")]
    for actuator in found["actuators"]:
        masses = [drive["mass_kg"] for drive in actuator["drives"]]
        assert masses == sorted(masses)
        assert all(drive["feasible"] and drive["margin"] >= 0 for drive in actuator["drives"])


@pytest.mark.slow
def test_the_saved_design_has_the_first_drives_and_keeps_their_limits(capsys) -> None:
    words = ("--same", "--order", "margin", "--out", "driven.toml")
    found = run_json("drives", capsys, *words)
    design = load_design("driven.toml")
    assert design.name == "driven"
    names = [actuator["drives"][0]["name"] for actuator in found["actuators"]]
    assert [drive.name for drive in design.drives] == names
    assert len(set(names[:3])) == 1
    again = run_json("drives", capsys, "--design", "driven.toml", "--rows", "1")
    assert [own["feasible"] for own in again["own"]] == [True] * 4


def test_several_motions_with_repetitions_and_dwells(capsys) -> None:
    cycle = ("--cycle", "arch", "3", "0.5", "--cycle", "circle", "1", "2")
    found = run_json("drives", capsys, *cycle, "--catalog", "mine.csv", "--rows", "1")
    assert [motion["repeats"] for motion in found["motions"]] == [3, 1]
    assert [motion["dwell_s"] for motion in found["motions"]] == [0.5, 2]


def test_ratios_of_every_motor(capsys) -> None:
    code, out, _ = run("drives", capsys, "--ratios", "--catalog", "mine.csv", "--preset", "arch")
    lines = [row.split() for row in out.splitlines()[2:]]  # below the design and the motion
    assert code == 0
    assert [row[0] for row in lines[1:]] == [f"M{j}" for j in (1, 1, 2, 2, 3, 3, 4, 4)]
    assert [row[-1] == "none" for row in lines[1:]] == [False, True] * 4
    words = ("--ratios", "--catalog", "mine.csv", "--preset", "arch")
    found = run_json("drives", capsys, *words)
    assert (found["design"], found["catalog"]) == ("Appendix 4", "mine.csv")


@pytest.mark.slow
def test_what_would_make_a_drive_fit_is_said(capsys) -> None:
    Path("weak.csv").write_text(MOTORS.replace("motor,small", "# motor,small"))
    older = ("--save", "no.toml")  # the name that --out had here
    code, out, err = run("drives", capsys, "--catalog", "weak.csv", *older)
    assert (code, err) == (1, "")
    assert "no drive fits; the nearest is weak, box, whose" in out
    assert "no slower motion makes one fit" in out
    assert not Path("no.toml").exists()
    Path("slow.csv").write_text(MOTORS.replace("6000,,,,,0.5", "700,,,,,0.5"))
    code, out, _ = run("drives", capsys, "--catalog", "slow.csv", "--preset", "arch")
    assert code == 1
    assert "times as long make one fit" in out


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("--catalog", "none.csv"), "none.csv"),
        (("--catalog", "bad.csv"), "bad.csv, row 2, column rotor_inertia_kg_cm2"),
        (("--cycle", "ellipse", "1", "0"), "--cycle ellipse"),
        (("--cycle", "arch", "0", "0"), "--cycle arch 0 0: a count of at least 1"),
        (("--cycle", "arch", "1", "0", "--preset", "arch"), "--cycle excludes"),
        (("--dwell", "-1"), "dwell"),
        (("--inertia-ratio", "0"), "viz: --inertia-ratio: a"),
        (("--rows", "0"), "--rows"),
        (("--order", "color"), "--order"),
        (("--out", "robot.csv"), "--out robot.csv"),
        (("--save", "robot.csv"), "--out robot.csv"),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(value),
)
def test_impossible_words_are_refused_in_one_line(words, place: str, capsys) -> None:
    Path("bad.csv").write_text(MOTORS.replace("0.04", "-0.04"))
    check_refused("drives", capsys, *words, place=place)
