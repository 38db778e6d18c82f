"""``trajectory``: its numbers are the model's, its exit code says whether the motion can be run."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from paminsa_viz.cli.arguments import parse
from paminsa_viz.cli.trajectory import DESCRIPTION, FLAGS
from paminsa_viz.files.columns import LOAD, PARTS, POSE, TORQUES, VELOCITY, part_columns
from paminsa_viz.files.design_file import save_design
from paminsa_viz.files.logs import read_log
from paminsa_viz.identification import log_poses
from paminsa_viz.model import APPENDIX_4, Friction, KneeBranch, Misprint
from paminsa_viz.trajectory import (
    PRESET,
    Trajectory,
    analyze,
    compare,
    point_to_point,
    preset_center,
    via_points,
)
from tests.support import commands
from tests.support.samples import random_design, with_knee

pytestmark = pytest.mark.slow


run = partial(commands.run, "trajectory")
run_json = partial(commands.run_json, "trajectory")


def read(path: str) -> dict[str, np.ndarray]:
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(line for line in file if not line.startswith("#"))
    return dict(zip(header, np.array(rows).T, strict=True))


def numbers(table, names) -> np.ndarray:
    return np.stack([table[name].astype(float) for name in names], axis=1)


def write(columns: Sequence[Any]) -> str:
    """Write poses as a table, with times before them or without."""
    rows = np.column_stack(columns).tolist()
    head = ["t_s", *POSE][-len(rows[0]) :]
    lines = [",".join(head), *(",".join(map(repr, row)) for row in rows)]
    Path("motion.csv").write_text("\n".join(lines) + "\n")
    return "motion.csv"


def preset(key: str, knee: KneeBranch = KneeBranch.LOWER, rate: float = 1000.0) -> Trajectory:
    return PRESET[key].build(with_knee(APPENDIX_4.geometry, knee)).sample(rate)


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_numbers_are_those_of_the_model(capsys, knee) -> None:
    rng = np.random.default_rng(3)
    design = replace(
        random_design(rng), geometry=APPENDIX_4.geometry, friction=Friction(0.1, 0.2, 3.0, 4.0),
    )  # fmt: skip
    save_design(design, "robot.toml")
    found = run_json(capsys, "--design", "robot.toml", "--preset", "arch", "--rate", "300",
                 "--knee", knee.value, "--printed")  # fmt: skip
    motion = preset("arch", knee, 300.0)
    for data, misprints in ((found, Misprint.NONE), (found["printed"], Misprint.ALL)):
        expected = analyze(with_knee(design, knee), motion, misprints=misprints).summary
        for got, actuator in zip(data["actuators"], expected, strict=True):
            for key, value in vars(actuator).items():
                (name,) = [name for name in got if re.fullmatch(rf"{key}(_[a-zA-Z])?", name)]
                assert got[name] == pytest.approx(value, rel=1e-9), name
    assert found["ok"]
    assert found["failure"] is None
    assert found["trajectory"]["samples"] == motion.size


def test_the_summary_reads_well(capsys) -> None:
    code, out, err = run(capsys)
    assert (code, err) == (0, "")
    assert "It is not the motion of the paper's Figs. 8-11" in out
    lines = out.splitlines()
    rows = {line.split()[0]: line.split()[1:3] for line in lines if line.startswith("M")}
    peaks = [["-2.564", "N·m"], ["2.169", "N·m"], ["3.976", "N·m"], ["249.9", "N"]]
    assert rows == dict(zip(("M1", "M2", "M3", "M4"), peaks, strict=True))
    assert "The robot can run it. It comes nearest to a limit (" in out
    assert "73.1 mm to spare" in out
    out.encode("cp1252")  # a terminal of Windows can print it


def test_a_written_table_gives_the_same_again(capsys) -> None:
    run(capsys, "--preset", "circle", "--rate", "200", "--out", "a.csv")
    first = analyze(APPENDIX_4, preset("circle", rate=200.0))
    table = read("a.csv")
    np.testing.assert_allclose(numbers(table, TORQUES), first.torque, atol=1e-12)
    run(capsys, "--file", "a.csv", "--out", "b.npz", "--out", "b.csv")
    np.testing.assert_allclose(numbers(read("b.csv"), TORQUES), first.torque, atol=1e-12)
    with np.load("b.npz") as arrays:
        np.testing.assert_array_equal(arrays["x_m"], first.trajectory.pose[:, 0])


def test_help_lists_the_columns_of_a_written_table(capsys) -> None:
    rows = [f"{time},0.1,0.0,0.0,-0.5,1,2,3,4,5,6" for time in (0.0, 0.05, 0.1)]
    Path("motion.csv").write_text("\n".join([",".join(["t_s", *POSE, *LOAD]), *rows]))
    assert run(capsys, "--file", "motion.csv", "--out", "a.csv")[0] == 0
    assert run(capsys, "--simulate", "pd", "--rate", "50", "--out", "b.csv")[0] == 0
    of_motion, of_simulation = (
        DESCRIPTION[DESCRIPTION.index(first) : DESCRIPTION.index(last)]
        for first, last in (("Columns of", "With --simulate"), ("With --simulate", "Exit code"))
    )
    names = re.compile(r"\b[a-zA-Z]+\d?_\w+|\bstatus")
    by_cause = [name for part in PARTS for name in part_columns(part)]
    assert ", ".join(PARTS) in of_motion
    assert [n for n in read("a.csv") if n in by_cause] == by_cause
    listed = [n for n in names.findall(of_motion) if n not in by_cause]
    assert listed == [n for n in read("a.csv") if n not in by_cause]
    common = ("t_s", *POSE, *VELOCITY, *TORQUES)
    assert names.findall(of_simulation) == [n for n in read("b.csv") if n not in common]


def test_the_shortest_motion_reaches_its_limit(capsys) -> None:
    words = "--preset arch --stretch --max-torque 4 --max-turn-speed 200 --out a.csv"
    found = run_json(capsys, *words.split())
    torques = numbers(read("a.csv"), TORQUES[:3])
    assert np.abs(torques).max() == pytest.approx(4.0, rel=1e-4)
    assert np.abs(torques).max() <= 4.0
    assert found["shortest"]["quantity"].startswith("torque of M")


def test_the_shortest_motion_is_the_time_optimal_one(capsys) -> None:
    """By whichever name of the flag: quicker than the stretched law, a torque at its limit."""
    words = "--preset arch --shortest --max-torque 4 --max-turn-speed 200 --out a.csv"
    flags = [
        parse(FLAGS, text.split(), "trajectory", "")
        for text in (words, words.replace("--shortest", "--minimum-time"))
    ]
    assert flags[0] == flags[1]
    found = run_json(capsys, *words.split())
    table = read("a.csv")
    torque = np.abs(numbers(table, TORQUES[:3])).max(axis=1) / 4.0
    turn = np.abs(table["omega_rad_s"].astype(float)) / np.radians(200.0)
    used = np.maximum(torque, turn)
    assert used.max() <= 1.0 + 1e-3
    assert np.mean(used > 0.97) > 0.85
    assert found["trajectory"]["duration_s"] < 0.8 * found["shortest"]["stretched_s"]


def test_a_limit_of_jerk_stretches_and_says_why(capsys) -> None:
    words = ("--preset", "arch", "--shortest", "--max-acceleration", "3", "--max-jerk", "40")
    found = run_json(capsys, *words)
    assert found["trajectory"]["duration_s"] == found["shortest"]["stretched_s"]
    assert "jerk is not convex" in found["shortest"]["note"]
    assert "jerk is not convex" in run(capsys, *words)[1]


def test_degrees_are_degrees(capsys) -> None:
    run_json(capsys, "--shortest", "--max-turn-speed", "90", "--out", "a.csv")
    speed = read("a.csv")["omega_rad_s"].astype(float)
    assert np.abs(speed).max() == pytest.approx(np.pi / 2, rel=1e-6)


def test_waypoints_are_passed_in_the_given_time(capsys) -> None:
    poses = preset_center(APPENDIX_4.geometry) + np.array(
        [[0, 0, 0, 0], [0.05, 0.02, 0.2, 0.03], [-0.04, 0.06, -0.1, -0.02]]
    )
    file = write([np.arange(3), poses])
    found = run_json(capsys, "--file", file, "--waypoints", "--duration", "4", "--out", "a.csv")
    assert found["trajectory"]["notes"] == []  # those on a table of samples are of another motion
    assert found["trajectory"]["duration_s"] == 4.0
    table = read("a.csv")
    path, speed = numbers(table, POSE), table["vx_m_s"].astype(float)
    np.testing.assert_allclose(path[[0, 2000, 4000]], poses, atol=1e-9)
    assert speed[0] == speed[-1] == pytest.approx(0.0, abs=1e-12)


def test_waypoints_without_times_get_them_as_those_of_the_page_do(capsys) -> None:
    poses = preset_center(APPENDIX_4.geometry) + np.array(
        [[0, 0, 0, 0], [0.05, 0.02, 0.2, 0.03], [-0.04, 0.06, -0.1, -0.02]]
    )
    words = ("--file", write([poses]), "--waypoints")
    run_json(capsys, *words, "--duration", "4", "--out", "a.csv")
    wanted = via_points(poses, 4.0).sample().pose
    np.testing.assert_allclose(numbers(read("a.csv"), POSE), wanted, atol=1e-12)
    code, _, err = run(capsys, *words)
    assert code == 2
    assert "motion.csv has no times t_s, so that --waypoints needs --duration" in err
    code, _, err = run(capsys, "--file", write([poses[:1]]), "--waypoints", "--duration", "4")
    assert (code, "motion.csv: at least two waypoints are needed" in err) == (2, True)


def test_a_singularity_is_crossed_within_the_torque_limit(capsys) -> None:
    file = write([np.array([[0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5]])])
    words = f"--file {file} --waypoints --cross --max-torque 10 --out a.csv".split()
    found = run_json(capsys, *words)
    assert found["trajectory"]["duration_s"] == pytest.approx(0.372, abs=1e-3)
    assert "singular rotation" in " ".join(found["trajectory"]["notes"])
    assert np.abs(numbers(read("a.csv"), TORQUES[:3])).max() < 10.1
    Path("heavy.toml").write_text("schema_version = 1\n[links]\nb4_kg = 0.9\n")
    code, out, _ = run(capsys, *words, "--reference", "heavy.toml")
    assert code == 0
    assert 'reference "heavy": fails at 0.1794 s: torques have no bound' in out
    heavy = ("--file", "a.csv", "--design", "heavy.toml")
    code, out, err = run(capsys, *heavy, "--out", "heavy.csv", "--out", "heavy.html")
    assert (code, "can run it" in out, err.count("\n")) == (1, False, 1)
    why = "at 0.1794 s: torques have no bound"
    assert f"cannot be run: {why}" in err
    assert f"# first failure: {why}" in Path("heavy.csv").read_text()
    assert f"The motion fails {why}" in Path("heavy.html").read_text()
    code, _, err = commands.run("loads", capsys, *heavy)
    assert (code, f"cannot be run: {why}" in err) == (1, True)
    code, _, err = run(capsys, *words[:-3], "5")
    assert (code, err.count("\n")) == (1, 1)
    assert "times as large" in err


def test_a_motion_out_of_reach_is_exit_code_1_with_the_place(capsys) -> None:
    x = np.array([0, 0.45, 0.9])
    file = write([np.arange(3.0), x, 0 * x, 0 * x, 0 * x - 0.5])
    code, out, err = run(capsys, "--file", file, "--rate", "500", "--out", "far.svg")
    assert (code, err.count("\n")) == (1, 1)
    assert "cannot be run: at 0." in err
    assert "it fails at 0." in out
    assert Path("far.svg").read_bytes().startswith(b"<?xml")
    code, out, _ = run(capsys, "--file", file, "--rate", "500", "--json")
    data = json.loads(out)
    assert (code, data["ok"], len(data["actuators"])) == (1, False, 4)
    assert 0 < data["failure"]["t_s"] < 2


def test_a_motion_that_fails_at_once_has_no_numbers_and_no_page(capsys) -> None:
    start = np.add(preset_center(APPENDIX_4.geometry), (0.9, 0, 0, 0))
    motion = point_to_point(start, start + 0.01).sample(10)
    file = write([motion.t, motion.pose])
    code, out, err = run(capsys, "--file", file, "--out", "far.html", "--out", "far.csv.npz")
    assert code == 1
    assert "leg 1" in err
    assert "far.html: not written" in err
    assert "far.csv.npz: written" in out
    assert not Path("far.html").exists()


def test_too_weak_actuators_are_exit_code_1(capsys) -> None:
    words = ("--shortest", "--max-force", "100")
    code, out, err = run(capsys, *words)
    assert (code, out) == (1, "")
    assert "no duration is long enough" in err
    code, out, _ = run(capsys, *words, "--json")
    assert (code, json.loads(out)["ok"]) == (1, False)


def test_a_simulation_carries_what_its_controller_does_not_know(capsys) -> None:
    words = ("--preset", "line", "--rate", "200", "--simulate", "computed-torque")
    exact = run_json(capsys, *words)["simulation"]
    written = ("--out", "run.csv", "--log", "log.csv")
    found = run_json(capsys, *words, "--payload-mismatch", "0.5", *written)
    loaded, log = found["simulation"], read_log("log.csv")
    assert found["files"] == ["run.csv", "log.csv"]
    assert exact["largest_distance_m"] < 1e-6 < loaded["largest_distance_m"]
    assert loaded["payload_kg"] == 0.5
    table = read("run.csv")
    error = numbers(table, POSE) - numbers(table, [f"wanted_{name}" for name in POSE])
    np.testing.assert_allclose(np.abs(error).max(axis=0), loaded["largest_error"])
    poses, _ = log_poses(APPENDIX_4, log, start=numbers(table, POSE)[0])
    np.testing.assert_allclose(poses, numbers(table, POSE), atol=1e-9)
    np.testing.assert_array_equal(log.torque, numbers(table, TORQUES))
    assert "# controller: computed torque\n" in Path("log.csv").read_text(encoding="utf-8")


def test_a_log_that_identify_would_refuse_is_not_written(capsys) -> None:
    words = ("--preset", "line", "--rate", "15", "--log", "log.csv")
    code, _, err = run(capsys, *words, "--simulate", "pd")
    assert (code, Path("log.csv").exists()) == (1, False)
    assert "log.csv: not written; t: there are 14.7 rows a second; at least 20 are needed" in err
    assert run(capsys, *words)[0] == 2


def test_a_simulation_that_stops_is_exit_code_1(capsys) -> None:
    words = ("--preset", "line", "--rate", "100", "--payload-mismatch", "1")
    code, out, err = run(capsys, *words, "--simulate", "feed-forward")  # it sinks
    assert code == 1
    assert "the simulation stopped at" in err
    assert "it stopped at" in out


def test_files_are_what_their_ending_says(capsys) -> None:
    save_design(replace(APPENDIX_4.vary({"links.b4": 0.3}), name="Light"), "light.toml")
    names = ("a.png", "a.pdf", "a.html")
    files = [word for name in names for word in ("--out", name)]
    found = run_json(capsys, "--preset", "line", "--rate", "100", "--reference", "light.toml",
                 "--figure", "power", "--dpi", "50", "--width", "100", *files)  # fmt: skip
    assert found["files"] == list(names)
    assert Image.open(io.BytesIO(Path("a.png").read_bytes())).width == round(100 / 25.4 * 50)
    assert Path("a.pdf").read_bytes().startswith(b"%PDF")
    assert b'id="motion-data"' in Path("a.html").read_bytes()
    motion = preset("line", rate=100.0)
    light = analyze(APPENDIX_4.vary({"links.b4": 0.3}), motion)
    ratio = compare(light, analyze(APPENDIX_4, motion))[0].peak
    got = found["reference"]["actuators"][0]["peak"] / found["actuators"][0]["peak"]
    assert abs(got) == pytest.approx(ratio)


def test_an_engine_is_compared_with_friction_on_both_sides(capsys) -> None:
    pytest.importorskip("pinocchio")
    save_design(replace(APPENDIX_4, friction=Friction(0.5, 0.1, 5.0, 2.0)), "rough.toml")
    run_json(capsys, "--preset", "line", "--rate", "50", "--design", "rough.toml", "--engine",
         "pinocchio", "--out", "a.svg")  # fmt: skip
    from paminsa_viz.files.design_file import load_design
    from paminsa_viz.plots.verified import engine_torques

    analysis = analyze(load_design("rough.toml"), preset("line", rate=50.0))
    other = engine_torques(analysis, "pinocchio", most=None)
    np.testing.assert_allclose(other.torque, analysis.torque, atol=1e-9)
    assert Path("a.svg").exists()


def test_published_torques_are_drawn_and_compared(capsys) -> None:
    """A table of the computed torques, M1 and M4, each off by a known amount."""
    run(capsys, "--preset", "line", "--out", "own.csv")
    table = read("own.csv")
    t = table["t_s"].astype(float)
    m1, m4 = table["tau1_Nm"].astype(float) + 0.25, table["f4_N"].astype(float)
    numbers_of = np.stack([t, m1, m4], axis=1)[::10].tolist()
    rows = [",".join(map(repr, row)) for row in numbers_of]
    Path("fig6.csv").write_text("# digitized\nt_s,tau1_Nm,f4_N\n" + "\n".join(rows) + "\n")
    words = ("--preset", "line", "--published", "fig6.csv")
    found = run_json(capsys, *words, "--out", "a.svg")["published"]
    assert found[0]["largest_difference"] == pytest.approx(0.25, rel=1e-9)
    assert found[0]["rms_difference"] == pytest.approx(0.25, rel=1e-9)
    assert found[1] is None
    assert found[2] is None
    assert found[3]["largest_difference"] < 1e-9
    assert "fig6" in Path("a.svg").read_text(encoding="utf-8")
    code, out, _ = run(capsys, *words, "--figure", "comparison", "--out", "b.svg")
    assert code == 0
    assert "published fig6, M1: computed off by at most 0.25 N·m, RMS 0.25 N·m" in out
    drawn = Path("b.svg").read_text(encoding="utf-8")
    assert "fig6" in drawn
    assert "Difference of M4" in drawn
    assert "Difference of M2" not in drawn  # the table lacks it; the motion does not fail


def test_the_balanced_robot_has_the_torques_that_the_paper_prints(capsys) -> None:
    """The worked example: none of gravity on M1 to M3, on a motion that is all but at rest."""
    from paminsa_viz.balancing import balance
    from paminsa_viz.files.design_file import save_design

    save_design(balance(APPENDIX_4).after, "balanced.toml")
    example = Path(__file__).parents[2] / "published" / "paper-balanced-gravity.csv"
    words = ("--preset", "circle", "--duration", "600", "--rate", "2", "--published", str(example))
    balanced = run_json(capsys, *words, "--design", "balanced.toml")["published"]
    assert all(one["largest_difference"] < 1e-4 for one in balanced[:3])
    assert balanced[3] is None
    as_it_is = run_json(capsys, *words)["published"]
    assert max(one["largest_difference"] for one in as_it_is[:3]) > 1.0
