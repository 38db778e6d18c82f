"""``sweep``: resumable tables of many designs."""

from __future__ import annotations

import csv
import os
import re
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.cli import main
from paminsa_viz.cli.arguments import parse
from paminsa_viz.cli.sweep import Sweep, study_of
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.studies import (
    MOTION_METRICS,
    DesignAxis,
    DesignGrid,
    DesignRange,
    RandomDesigns,
)
from paminsa_viz.studies.running import PART, run_study
from paminsa_viz.studies.study import Study
from tests.support import commands

pytestmark = pytest.mark.slow


run = partial(commands.run, "sweep")
run_json = partial(commands.run_json, "sweep")

GRID = ("--vary", "links.b3=0.2:0.6:3", "--vary", "joints.j7=0.1,0.3", "--cells", "8",
        "--out", "a.csv")  # fmt: skip
MOTION = ("--vary", "geometry.base_radius=0.2,0.35,0.5", "--cells", "8", "--out", "a.csv")
WORK = ("--random", "120", "--seed", "2", "--vary", "links.b3", "--vary", "geometry.base_radius",
        "--cells", "100", "--preset", "arch", "--out", "a.csv")  # fmt: skip
LONG = (*WORK, "--workers", "2")
"""More than a second of work."""


def test_flags_become_a_study_in_si_units() -> None:
    grid = ("links.b3=0.2:0.6:3", "joints.j7=0.1,0.3")
    flags = Sweep(out=Path("a"), vary=grid, radius=100.0, z=(500.0,), theta=(0.0, 180.0), cells=9,
                  scale_bars=True)  # fmt: skip
    study = study_of(flags, APPENDIX_4.with_knee(KneeBranch.UPPER))
    assert study.variation == DesignGrid(
        (DesignAxis("links.b3", (0.2, 0.4, 0.6)), DesignAxis("joints.j7", (0.1, 0.3)))
    )
    region = study.region
    assert (region.radius, region.z, region.cells) == (0.1, (0.5,), 9)
    assert region.theta == pytest.approx((0.0, 3.14159265))
    assert (study.design.geometry.knee, study.scale_bars) == (KneeBranch.UPPER, True)

    flags = Sweep(
        out=Path("a"), vary=("links.b3", "joints.j7=0.1:0.3"), random=7, seed=5, spread=0.5
    )
    b3 = APPENDIX_4.links.b3
    assert study_of(flags, APPENDIX_4).variation == RandomDesigns(
        (DesignRange("links.b3", 0.5 * b3, 1.5 * b3), DesignRange("joints.j7", 0.1, 0.3)), 7, 5
    )


@pytest.mark.parametrize(("words", "angles"), [("", (0, 30)), ("--theta 60 --theta 0", (60, 0))])
def test_given_angles_replace_the_default_ones(words, angles) -> None:
    line = f"--vary links.b3=1 --out a.csv {words}"
    flags = parse(Sweep, line.split(), "paminsa-viz sweep", "")
    theta = study_of(flags, APPENDIX_4).region.theta
    assert np.degrees(theta) == pytest.approx(angles)


def rows(name: str) -> list[dict[str, str]]:
    lines = Path(name).read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def test_a_grid_becomes_a_table_and_a_summary(capsys) -> None:
    code, out, err = run(capsys, *GRID)
    assert (code, err) == (0, "")
    assert "a.csv: 6 designs, " in out
    text = Path("a.csv").read_text()
    assert text.startswith("# format: paminsa_viz sweep 1\n# command: paminsa-viz sweep --vary ")
    assert "\n# vary links.b3 [kg]: 3 values, 0.2 to 0.6\n" in text
    found = [[row[name] for name in list(row)[:3]] for row in rows("a.csv")[:2]]
    assert found == [["0", "0.2", "0.1"], ["1", "0.2", "0.3"]]

    facts = run_json(capsys, *GRID, "--jobs", "1")  # the flag's older name
    assert (facts["rows"], facts["found"], facts["status"]) == (6, 6, {"ok": 6})
    assert facts["metrics"]["Mp2_N"]["largest_row"] in range(6)
    assert Path("a.csv").read_text() == text


def test_a_motion_adds_the_loads_of_the_trajectory_command(capsys) -> None:
    code, out, err = run(capsys, *MOTION, "--preset", "circle")
    assert (code, err) == (0, "")
    assert out.endswith("circle: 2 designs can run it, 1 singular\n")
    singular, ours, wide = rows("a.csv")
    assert (singular["motion"], singular["motion_fails_s"]) == ("singular", "0.0")
    assert {singular[metric.column] for metric in MOTION_METRICS} == {""}
    assert (ours["motion"], ours["motion_fails_s"], wide["motion"]) == ("ok", "", "ok")
    motors = commands.run_json("trajectory", capsys, "--preset", "circle")["actuators"]
    assert float(ours["motion_peak_torque_Nm"]) == max(abs(m["peak"]) for m in motors[:3])
    assert float(ours["motion_peak_force_N"]) == abs(motors[3]["peak"])
    facts = run_json(capsys, *MOTION, "--preset", "circle")
    assert (facts["found"], facts["motion"]["status"]) == (3, {"singular": 1, "ok": 2})
    assert facts["metrics"]["motion_energy_J"]["least_row"] in (1, 2)


def test_a_table_of_another_study_is_named_and_kept(capsys) -> None:
    assert main(["trajectory", "--preset", "arch", "--out", "motion.csv"]) == 0
    capsys.readouterr()
    ours = (*MOTION, "--file", "motion.csv")
    assert run(capsys, *ours)[0] == 0
    whole = Path("a.csv").read_bytes()
    left = whole[:-9]  # as after a kill in the middle of the last row
    Path("a.csv").write_bytes(left)
    motion = Path("motion.csv").read_text()
    last = motion.splitlines()[-1]
    changed = motion.replace(last, last.replace("0.", "0.0000001", 1))
    for words, text, place in (
        ((*MOTION, "--preset", "line"), motion, 'motion is "motion, 1201 samples in 1.2 s", not'),
        (MOTION, motion, 'not "none"'),
        (ours, changed, "whose hash of the motion's samples is"),
        ((*ours, "--radius", "50"), motion, 'whose region radius [m] is "0.175", not "0.05"; '),
    ):
        Path("motion.csv").write_text(text)
        code, out, err = run(capsys, *words)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert "a.csv: holds another study, whose " in err
        assert place in err
        assert err.endswith(
            "; take another name, or begin again with restart (--restart on the command line)\n"
        )
        assert Path("a.csv").read_bytes() == left
    assert run(capsys, *ours)[0] == 0
    assert Path("a.csv").read_bytes() == whole
    assert run(capsys, *ours, "--radius", "50", "--restart")[0] == 0
    assert Path("a.csv").read_bytes() != whole


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> bytes:
    """The table of the long command without a stop, from a single process."""
    path = tmp_path_factory.mktemp("sweep") / "a.csv"
    varied = ("links.b3", "geometry.base_radius")
    flags = Sweep(out=path, vary=varied, random=120, seed=2, cells=100, preset="arch")
    run_study(study_of(flags, APPENDIX_4), path, command=" ".join(["paminsa-viz sweep", *LONG]))
    return path.read_bytes()


def alive(number: str) -> bool:
    try:
        return "\nState:\tZ" not in Path(f"/proc/{number}/status").read_text()
    except FileNotFoundError:
        return False


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGINT])
def test_after_a_stop_the_same_command_finishes_the_same_table(capsys, whole, stop) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "paminsa_viz", "sweep", *LONG],
        text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    path = Path("a.csv")
    eventually(lambda: path.exists() and b"\n7," in path.read_bytes(), 60)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    process.send_signal(stop)
    out, err = process.communicate(timeout=30)
    assert len(children) >= 2
    eventually(lambda: not any(map(alive, children)), 10)
    left = path.read_bytes()
    rows = left.count(b"\n") - whole.count(b"\n") + 120
    assert 8 <= rows < 120
    assert whole.startswith(left)
    if stop == signal.SIGINT:
        assert (process.returncode, out) == (130, "")
        assert re.fullmatch(
            r"paminsa-viz: stopped after \d+ of 120 rows; the same command resumes it\n", err
        )
        # The signal may come between the writing of a part and the counting of it.
        assert 0 <= rows - int(err.split()[3]) <= PART
        return  # what is left begins as the whole table does, as after a kill

    path.write_bytes(left[:-5])  # as if it had come in the middle of a row
    # In this process alone, which makes the same rows.
    facts = run_json(capsys, *WORK, "--workers", "1")
    assert (facts["rows"], facts["found"]) == (120, rows - 1)
    assert path.read_bytes() == whole


def eventually(condition, timeout: float) -> None:
    end = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_a_row_that_was_changed_is_named(capsys) -> None:
    assert run(capsys, *GRID)[0] == 0
    text = Path("a.csv").read_text()
    for new in ("2,0.41,", "2,x,"):
        edited = text.replace("\n2,0.4,", f"\n{new}")
        assert edited != text
        Path("a.csv").write_text(edited)
        row = edited[: edited.index(f"\n{new}")].count("\n") + 2
        place = f"a.csv, row {row}: was changed after it was written"
        commands.check_refused("sweep", capsys, *GRID, place=place)


def test_a_cluster_makes_the_same_table(capsys) -> None:
    distributed = pytest.importorskip("distributed")
    assert run(capsys, *GRID)[0] == 0
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as local:
        words = (*GRID[:-1], "b.csv", "--dask", local.scheduler_address)
        assert run(capsys, *words)[0] == 0
    assert rows("a.csv") == rows("b.csv")


def die(_: object) -> None:
    os._exit(3)


def test_a_worker_that_dies_is_exit_code_1(capsys, monkeypatch) -> None:
    monkeypatch.setattr(Study, "rows", property(lambda self: die))
    code, out, err = run(capsys, *GRID, "--workers", "2")
    assert (code, out) == (1, "")
    assert err.count("\n") == 1
    assert "a worker process died" in err
    assert "0 of 6 rows are written" in err
