"""``identify``: numbers with intervals from a log, files, and one line for what is wrong."""

from __future__ import annotations

import io
from contextlib import redirect_stderr
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest

from paminsa_viz.cli import identify, main, output
from paminsa_viz.files.design_file import load_design
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.files.logs import log_table
from paminsa_viz.files.tables import table_csv
from paminsa_viz.identification import InvalidLog, MultiSine, make_log
from paminsa_viz.identification.findings import STEPS
from paminsa_viz.model import (
    APPENDIX_4,
    inverse_dynamics,
    inverse_kinematics,
    static_imbalance,
)
from paminsa_viz.progress import Progress
from paminsa_viz.trajectory import Plan, preset_center
from tests.support.commands import check_refused, run, run_json


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def text_of(kind: ExampleLog = ExampleLog.BEST, rows: int | None = 1000) -> list[str]:
    """The first rows of an example log as lines, without its comments."""
    import paminsa_viz.files

    lines = (Path(paminsa_viz.files.__file__).parent / kind.value).read_text().splitlines()
    lines = [line for line in lines if not line.startswith("#")]
    return lines if rows is None else lines[: rows + 1]


def write(lines: list[str], name: str = "log.csv") -> None:
    Path(name).write_text("\n".join(lines) + "\n")


@pytest.mark.slow
def test_example_log_tells_the_robot_that_made_it(capsys) -> None:
    words = ("example", "--validate", "example-other", "--payload", "example-payload", "2")
    found = run_json("identify", capsys, *words, "--out", "found")
    values = {item["symbol"]: item for item in found["parameters"]}
    # examples/record_logs.py: B4 heavier by a fifth, joint 9 of 0.25 kg
    built = APPENDIX_4.vary({"links.b4": 1.2 * 0.672, "joints.j9": 0.25})
    weight = values["M_p2"]
    assert abs(weight["value"] - static_imbalance(built)) < weight["half_width_95"]
    assert not values["b_9"]["known"]
    assert "interval is wider" in values["b_9"]["reason"]
    assert found["identity"]["holds"]
    assert found["named"] == []
    assert max(found["validation"]["ratio"]) < 1.1
    assert found["payload"]["mass_kg"] == pytest.approx(2.0, abs=0.06)
    names = {"parameters.csv", "residuals.csv", "identified.toml", "torques.svg"}
    assert {Path(path).name for path in found["files"]} == names
    found_design = load_design("found/identified.toml")
    assert found_design.name == "identified"
    written = static_imbalance(found_design)
    assert abs(written - weight["value"]) < weight["half_width_95"]


class Terminal(io.StringIO):
    """An error stream that a person reads."""

    def isatty(self) -> bool:
        return True


def test_a_terminal_shows_what_is_worked_out(monkeypatch) -> None:
    def investigated(*_: object, progress: Progress, **__: object) -> NoReturn:
        progress(0.4, step=STEPS[2])
        raise InvalidLog("no more in this test")

    monkeypatch.setattr(identify, "investigate", investigated)
    # It would wait for the first formula that is compiled, in a later test.
    monkeypatch.setattr(output, "announce_compilation", lambda: None)
    terminal = Terminal()
    with redirect_stderr(terminal):
        assert main(["identify", "example"]) == 2
    shown = terminal.getvalue()
    assert "identification: causes" in shown
    assert shown.endswith("no more in this test\n")


@pytest.mark.slow
def test_text_calls_what_is_not_told_unknown(capsys) -> None:
    code, out, err = run("identify", capsys, "example")
    assert (code, err) == (0, "")
    assert "Unknown parameters" in out
    assert "the interval is wider than" in out
    assert "Identity of the masses: holds" in out
    assert "as designed: not in the log" in out


@pytest.mark.slow
def test_wrong_encoder_is_named_and_ends_with_1(capsys) -> None:
    log = example_log()
    zero = np.radians([0.5, 0.0, 0.0, 0.0])
    wrong = make_log(log.t, log.position + zero, log.torque)
    Path("log.csv").write_bytes(table_csv(log_table(wrong)))
    code, out, _ = run("identify", capsys, "log.csv", "--split")
    assert code == 1
    named = next(line for line in out.splitlines() if "What may be wrong: " in line)
    assert "M1" in named or "leg 1" in named


@pytest.mark.slow
def test_poor_motion_leaves_unknowns_and_accuses_nobody(capsys) -> None:
    """A motion along x alone: no verdict on the masses, and what motion would tell them."""
    sine = np.zeros((3, 4))
    sine[[0, 2], 0] = 0.06, -0.02
    curve = MultiSine(preset_center(APPENDIX_4.geometry), sine, np.zeros((3, 4)), 10)
    motion = Plan(curve, 20.0).sample(200.0)
    torque = inverse_dynamics(APPENDIX_4, *motion.at(motion.t)).torque
    torque += 0.02 * torque.std(axis=0) * np.random.default_rng(1).standard_normal(torque.shape)
    position = inverse_kinematics(APPENDIX_4.geometry, motion.pose).actuators
    log = make_log(motion.t, position.round(5), torque)
    Path("log.csv").write_bytes(table_csv(log_table(log)))
    found = run_json("identify", capsys, "log.csv")
    unknown = {item["symbol"]: item["reason"] for item in found["parameters"] if not item["known"]}
    assert {"b_7", "b_v4", "c_4", "b_9"} <= set(unknown)
    assert all("would tell it" in reason for reason in unknown.values())
    assert "vertical accelerations" in unknown["b_7"]
    assert found["identity"]["holds"] is None
    assert found["named"] == []


@pytest.mark.slow
def test_currents_come_with_gains(capsys) -> None:
    lines = text_of(rows=None)
    head = lines[0].replace("torque1_Nm,torque2_Nm,torque3_Nm,force4_N",
                            "current1_A,current2_A,current3_A,current4_A")  # fmt: skip
    write([head, *lines[1:]])
    check_refused("identify", capsys, "log.csv", place="gains")
    found = run_json("identify", capsys, "log.csv", "--gains", "1", "1", "1", "1")
    plain = run_json("identify", capsys, "example")
    assert found["parameters"] == plain["parameters"]


def changed(row: int, column: str, text: str) -> list[str]:
    lines = text_of()
    cells = lines[row].split(",")
    cells[lines[0].split(",").index(column)] = text
    return [*lines[:row], ",".join(cells), *lines[row + 1 :]]


BAD: dict[str, tuple[list[str], str]] = {
    "empty": ([""], "t_s"),
    "missing column": ([line.rpartition(",")[0] for line in text_of()], "force4_N"),
    "degrees as radians": (
        [text_of()[0].replace("_deg", "_rad"), *text_of()[1:]], "a column in degrees is theta1_deg",
    ),
    "not a number": (changed(7, "torque1_Nm", "nan"), "row 8, column torque1_Nm"),
    "reversed time": (changed(7, "t_s", "0.001"), "row 8, column t_s: times have to increase"),
    "time there twice": (changed(7, "t_s", "0.02"), "row 8"),
    "gap": ([*text_of()[:100], *text_of()[140:]], "cut the log there"),
    "nothing moves": (
        [text_of()[0], *(f"{0.004 * i:.3f},0,0,0,284.77,0,0,0,230" for i in range(900))],
        "paminsa-viz excite",
    ),
    "too short": (text_of(rows=60), "a piece without gaps of at least"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_logs_are_refused_in_one_line(capsys, case) -> None:
    lines, place = BAD[case]
    write(lines)
    check_refused("identify", capsys, "log.csv", place=place)


@pytest.mark.slow
def test_impossible_words_are_refused(capsys) -> None:
    Path("file").write_text("")
    check_refused("identify", capsys, "nothing.csv", place="nothing.csv")
    check_refused("identify", capsys, "example", "--cut-off", "0", place="viz: --cut-off: ")
    check_refused("identify", capsys, "example", "--payload", "example", "-1", place="--payload")
    check_refused("identify", capsys, "example", "--out", "file", place="file")
