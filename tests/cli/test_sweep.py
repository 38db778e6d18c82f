"""``sweep``: tables that survive a kill, and complaints in one line."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from paminsa_viz.cli import COMMANDS, main
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

GRID = ("--vary", "links.b3=0.2:0.6:3", "--vary", "joints.j7=0.1,0.3", "--cells", "8")
LONG = ("--random", "120", "--seed", "2", "--vary", "links.b3", "--vary", "geometry.base_radius",
        "--cells", "100", "--preset", "arch", "--jobs", "2", "--out", "a.csv")  # fmt: skip
"""More than a second of work."""


def test_flags_become_a_study_in_si_units() -> None:
    assert "sweep" in COMMANDS
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


def test_a_grid_becomes_a_table_and_a_summary(capsys, folder) -> None:
    code, out, err = run(capsys, *GRID, "--out", "a.csv")
    assert (code, err) == (0, "")
    assert "a.csv: 6 designs, " in out
    text = (folder / "a.csv").read_text()
    assert text.startswith("# format: paminsa_viz sweep 1\n# command: paminsa-viz sweep --vary ")
    assert "\n# vary links.b3 [kg]: 3 values, 0.2 to 0.6\n" in text
    assert [line.split(",")[:3] for line in text.splitlines()[-6:-4]] == [
        ["0", "0.2", "0.1"],
        ["1", "0.2", "0.3"],
    ]

    before = (folder / "a.csv").read_bytes()
    code, out, _ = run(capsys, *GRID, "--out", "a.csv", "--jobs", "1", "--json")
    told = json.loads(out)
    assert (code, told["rows"], told["found"], told["status"]) == (0, 6, 6, {"ok": 6})
    assert told["metrics"]["Mp2_N"]["largest_row"] in range(6)
    assert (folder / "a.csv").read_bytes() == before


def test_another_study_does_not_overwrite_a_table(capsys, folder) -> None:
    run(capsys, *GRID, "--out", "a.csv")
    before = (folder / "a.csv").read_bytes()
    code, out, err = run(capsys, *GRID, "--radius", "50", "--out", "a.csv")
    assert (code, out) == (2, "")
    assert err == (
        'paminsa-viz: a.csv: holds another study, whose region radius [m] is "0.175", not "0.05"; '
        "take another name, or begin again\n"
    )
    assert (folder / "a.csv").read_bytes() == before
    assert run(capsys, *GRID, "--radius", "50", "--out", "a.csv", "--restart")[0] == 0
    assert (folder / "a.csv").read_bytes() != before


MOTION = ("--vary", "geometry.base_radius=0.2,0.35,0.5", "--cells", "8", "--out", "a.csv")


def rows(path: Path) -> list[dict[str, str]]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def test_a_motion_adds_what_the_trajectory_command_says_of_it(capsys, folder) -> None:
    code, out, err = run(capsys, *MOTION, "--preset", "circle")
    assert (code, err) == (0, "")
    assert out.endswith("circle: 2 designs can run it, 1 singular\n")
    singular, ours, wide = rows(folder / "a.csv")
    assert (singular["motion"], singular["motion_fails_s"]) == ("singular", "0.0")
    assert {singular[metric.column] for metric in MOTION_METRICS} == {""}
    assert (ours["motion"], ours["motion_fails_s"], wide["motion"]) == ("ok", "", "ok")

    assert main(["trajectory", "--preset", "circle", "--json"]) == 0
    motors = json.loads(capsys.readouterr().out)["actuators"]
    assert float(ours["motion_peak_torque_Nm"]) == max(abs(m["peak"]) for m in motors[:3])
    assert float(ours["motion_peak_force_N"]) == abs(motors[3]["peak"])

    code, out, _ = run(capsys, *MOTION, "--preset", "circle", "--json")
    told = json.loads(out)
    assert (told["found"], told["motion"]["status"]) == (3, {"singular": 1, "ok": 2})
    assert told["metrics"]["motion_energy_J"]["least_row"] in (1, 2)


def test_a_table_of_another_motion_is_refused_and_kept(capsys, folder) -> None:
    assert main(["trajectory", "--preset", "arch", "--out", "motion.csv"]) == 0
    capsys.readouterr()
    assert run(capsys, *MOTION, "--file", "motion.csv")[0] == 0
    whole = (folder / "a.csv").read_bytes()
    # a kill in the middle of the last row
    (folder / "a.csv").write_bytes(whole[:-9])
    left = (folder / "a.csv").read_bytes()
    text = (folder / "motion.csv").read_text().splitlines()
    columns = next(i for i, line in enumerate(text) if not line.startswith("#"))
    cells = text[columns + 5].split(",")
    cells[text[columns].split(",").index("z_m")] += "1"
    changed = [*text[: columns + 5], ",".join(cells), *text[columns + 6 :]]
    for motion, place in (
        (("--preset", "line"), 'motion is "motion, 1201 samples in 1.2 s", not "line, '),
        ((), 'not "none"'),
        (changed, "whose hash of the motion's samples is"),
    ):
        if motion is changed:
            (folder / "motion.csv").write_text("\n".join(changed) + "\n")
            motion = ("--file", "motion.csv")
        code, out, err = run(capsys, *MOTION, *motion)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert "a.csv: holds another study, whose " in err
        assert place in err
        assert (folder / "a.csv").read_bytes() == left
    (folder / "motion.csv").write_text("\n".join(text) + "\n")
    assert run(capsys, *MOTION, "--file", "motion.csv")[0] == 0
    assert (folder / "a.csv").read_bytes() == whole


def start(folder: Path) -> subprocess.Popen[str]:
    """Start a long sweep and return when its first rows are in the file."""
    process = subprocess.Popen(
        [sys.executable, "-m", "paminsa_viz", "sweep", *LONG],
        cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    path = folder / "a.csv"
    for _ in range(12_000):
        if path.exists() and b"\n7," in path.read_bytes():
            return process
        assert process.poll() is None, process.communicate()
        time.sleep(0.005)
    process.kill()
    raise AssertionError("no rows came")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> bytes:
    """The table of the same command without a stop, from a single process."""
    path = tmp_path_factory.mktemp("sweep") / "a.csv"
    varied = ("links.b3", "geometry.base_radius")
    flags = Sweep(out=path, vary=varied, random=120, seed=2, cells=100, preset="arch")
    command = " ".join(["paminsa-viz sweep", *LONG])
    run_study(study_of(flags, APPENDIX_4), path, command=command)
    return path.read_bytes()


def alive(number: int) -> bool:
    try:
        return "\nState:\tZ" not in Path(f"/proc/{number}/status").read_text()
    except FileNotFoundError:
        return False


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_after_a_kill_the_same_command_finishes_the_same_table(capsys, folder, whole) -> None:
    process = start(folder)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    process.send_signal(signal.SIGKILL)
    process.wait(10)
    for _ in range(1000):
        if not any(alive(int(child)) for child in children):
            break
        time.sleep(0.01)
    assert len(children) >= 2
    assert not any(alive(int(child)) for child in children), "workers outlive a killed sweep"
    left = (folder / "a.csv").read_bytes()
    # As if the kill had come in the middle of a row.
    (folder / "a.csv").write_bytes(left[:-5])

    # In this process alone, which makes the same rows.
    code, out, err = run(capsys, *LONG, "--jobs", "1", "--json")
    assert (code, err) == (0, "")
    assert (folder / "a.csv").read_bytes() == whole
    assert len(left) < len(whole)
    told = json.loads(out)
    assert told["rows"] == 120
    assert told["found"] == left.count(b"\n") - whole.count(b"\n") + 120 - 1


@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
def test_ctrl_c_leaves_a_table_to_go_on_with(folder, whole) -> None:
    process = start(folder)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (130, "")
    assert err.startswith("paminsa-viz: stopped after ")
    assert err.endswith(" of 120 rows; the same command resumes it\n")
    rows = int(err.split()[3])
    assert 8 <= rows < 120
    left = (folder / "a.csv").read_bytes()
    assert whole.startswith(left)
    # The signal may come between the writing of a part and the counting of it.
    assert 120 - rows - PART <= whole.count(b"\n") - left.count(b"\n") <= 120 - rows


def test_a_cluster_makes_the_same_table(capsys, folder) -> None:
    distributed = pytest.importorskip("distributed")
    assert run(capsys, *GRID, "--out", "a.csv")[0] == 0
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as local:
        assert run(capsys, *GRID, "--out", "b.csv", "--dask", local.scheduler_address)[0] == 0
    ours, theirs = (
        [line for line in (folder / name).read_text().splitlines() if "# command" not in line]
        for name in ("a.csv", "b.csv")
    )
    assert ours == theirs


def die(_: object) -> None:
    os._exit(3)


def test_a_worker_that_dies_is_exit_code_1(capsys, folder, monkeypatch) -> None:
    monkeypatch.setattr(Study, "rows", property(lambda self: die))
    code, out, err = run(capsys, *GRID, "--out", "a.csv", "--jobs", "2")
    assert (code, out) == (1, "")
    assert err.count("\n") == 1
    assert "a worker process died" in err
    assert "0 of 6 rows are written" in err
