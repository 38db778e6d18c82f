"""``evaluate``: numbers from first principles; a table is written whole or not at all."""

from __future__ import annotations

import csv
import errno
import math
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.cli.arguments import UsageError, parse
from paminsa_viz.cli.evaluate import evaluate_table
from paminsa_viz.cli.flags import DesignFlags
from paminsa_viz.files import table_reader
from paminsa_viz.files.columns import ACCELERATION, ACTUATORS, POSE, TORQUES, VELOCITY
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.statics import static_torques
from tests import oracle
from tests.support.commands import run
from tests.support.samples import random_design, random_states, with_knee

MOTION = (*POSE, *VELOCITY, *ACCELERATION)
RESULTS = (*ACTUATORS, *TORQUES)
GOOD = "x_m,y_m,theta_rad,z_m\n0.05,-0.03,0.4,-0.6\n0,0,0,-0.5\n"


def write(columns, rows) -> None:
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in np.asarray(rows).tolist())]
    Path("in.csv").write_text("\n".join(lines) + "\n")


def read(name: str = "out.csv") -> list[dict[str, str]]:
    with open(name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows, columns) -> np.ndarray:
    return np.array([[float(row[name]) for name in columns] for row in rows])


def evaluate(capsys, *words: str, out: str = "out.csv") -> str:
    """Evaluate ``in.csv``; return what is printed."""
    code, printed, err = run("evaluate", capsys, "in.csv", "--out", out, *words)
    assert (code, err) == (0, "")
    return printed


@pytest.mark.slow
def test_numbers_of_equal_legs_say_so_for_a_design_with_deviations(capsys) -> None:
    deviating = APPENDIX_4.vary({"leg2.bar_94": 1e-4})
    note = equal_legs_note(deviating.deviations)
    save_design(deviating, "d.toml")
    Path("in.csv").write_text(GOOD)
    assert evaluate(capsys, "--design", "d.toml").splitlines()[1:] == [note]
    assert note not in evaluate(capsys)
    words = ("--design", "d.toml", "--rate", "50", "--out", "motion.csv")
    _, out, _ = run("trajectory", capsys, *words)
    assert out.splitlines()[-2:] == [note, "motion.csv: written"]
    words = ("--design", "d.toml", "--vary", "links.b3=0.3,0.4", "--cells", "4", "--out", "s.csv")
    assert run("sweep", capsys, *words)[1].splitlines()[-1] == note
    words = ("--propose", "5", "--design", "d.toml", "--out", "poses.csv")
    assert run("calibrate", capsys, *words)[1].splitlines() == [note, "poses.csv: written"]
    assert f"# legs: {note}\n" in Path("motion.csv").read_text(encoding="utf-8")


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_numbers_are_those_of_first_principles(capsys, knee) -> None:
    rng = np.random.default_rng(7)
    design = random_design(rng)
    pose, velocity, acceleration = random_states(rng, with_knee(design, knee), 40)
    order = rng.permutation(len(MOTION))
    columns = [MOTION[i] for i in order]
    rows = np.concatenate([pose, velocity, acceleration], axis=-1)[:, order]
    write(columns, rows)
    save_design(design, "d.toml")
    evaluate(capsys, "--design", "d.toml", "--knee", knee.value)

    got = read()
    assert list(got[0]) == [*columns, *RESULTS, "status"]
    assert numbers(got, columns).tolist() == rows.tolist()
    assert {row["status"] for row in got} == {"ok"}
    torques = oracle.inverse_dynamics(with_knee(design, knee), pose, velocity, acceleration)
    scale = np.abs(torques).max(axis=-1, keepdims=True)
    np.testing.assert_allclose(numbers(got, TORQUES) / scale, torques / scale, atol=1e-9)
    positions = numbers(got, ACTUATORS) - oracle.actuators(design, pose)
    positions[:, :3] = (positions[:, :3] + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(positions, 0, atol=1e-12)


def test_columns_may_have_any_unit(capsys) -> None:
    pose, velocity, acceleration = random_states(np.random.default_rng(8), APPENDIX_4, 5)
    write(MOTION, np.concatenate([pose, velocity, acceleration], axis=-1))
    evaluate(capsys)
    expected = numbers(read(), RESULTS)
    header = [
        *["x_mm", "y [mm]", "theta_deg", "z_m", "vx_mm_s", "vy_m_s", "omega [deg/s]", "vz_m_s"]
    ]
    scale = [1e3, 1e3, np.degrees(1), 1, 1e3, 1, np.degrees(1), 1, 1, 1, 1, 1]
    write([*header, *ACCELERATION], scale * np.concatenate([pose, velocity, acceleration], -1))
    evaluate(capsys)
    np.testing.assert_allclose(numbers(read(), RESULTS), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("moving", [False, True])
def test_rates_that_are_left_out_are_zero(capsys, moving) -> None:
    pose, _, acceleration = random_states(np.random.default_rng(2), APPENDIX_4, 5)
    acceleration = acceleration * moving
    write([*POSE, *ACCELERATION * moving], np.hstack([pose, acceleration])[:, : 4 + 4 * moving])
    evaluate(capsys)
    expected = oracle.inverse_dynamics(APPENDIX_4, pose, np.zeros(4), acceleration)
    np.testing.assert_allclose(numbers(read(), TORQUES), expected, atol=1e-9)


def test_rows_without_numbers_name_the_reason_and_stay_empty(capsys) -> None:
    rows = {
        "0,0,0,-0.5": "ok",
        "0,0,0,-5": "stretched:leg1",
        "0,0.3,0,-0.9": "stretched:leg1",
        "0.2,0,0,0": "folded:leg2",
        "0,0.25,0,-0.0275": "folded:leg3",
        "1e200,0,0,0": "not-finite",
        f"0.05,0.03,{math.acos(0.1 / 0.35)!r},-0.6": "singular",
    }
    Path("in.csv").write_text("\n".join([",".join(POSE), *rows]))
    assert evaluate(capsys) == (
        "out.csv: 7 rows, 6 without numbers "
        "(2 stretched:leg1, 1 folded:leg2, 1 folded:leg3, 1 not-finite, 1 singular)\n"
    )
    for row, word in zip(read(), rows.values(), strict=True):
        assert row["status"] == word
        assert {row[name] != "" for name in RESULTS} == {word == "ok"}


def test_a_motion_beyond_all_numbers_has_none(capsys) -> None:
    pose = "0.05,-0.03,0.4,-0.6"
    rows = [f"{pose},0,0,0,0,{','.join([size] * 4)}" for size in ("1e308", "0")]
    Path("in.csv").write_text("\n".join([",".join(MOTION), *rows]))
    evaluate(capsys)
    assert [row["status"] == "ok" for row in read()] == [False, True]
    assert not any(read()[0][name] for name in RESULTS)


def test_a_table_may_be_replaced_by_its_result(folder, capsys) -> None:
    Path("in.csv").write_text(GOOD)
    evaluate(capsys)
    evaluate(capsys, out="in.csv")
    assert Path("in.csv").read_text() == Path("out.csv").read_text()
    assert sorted(path.name for path in folder.iterdir()) == ["in.csv", "out.csv"]


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_lines_before_the_header_are_kept(capsys, end: str) -> None:
    Path("in.csv").write_text(GOOD)
    evaluate(capsys)
    notes = "# rig 2: measured by hand", "#", "# 60\u00b0"
    Path("in.csv").write_bytes(end.join(["# 60\xb0", ""]).encode("latin-1"))
    with Path("in.csv").open("ab") as file:
        file.write(end.join([*notes, *GOOD.splitlines()]).encode())
    evaluate(capsys, out="in.csv")
    kept = Path("in.csv").read_bytes().decode()
    assert kept == "\n".join(["# 60?", *notes, Path("out.csv").read_text()])


def test_the_length_of_the_blocks_changes_nothing(monkeypatch) -> None:
    write(POSE, random_states(np.random.default_rng(3), APPENDIX_4, 23)[0])
    evaluate_table("in.csv", "whole.csv")
    monkeypatch.setattr(table_reader.TableReader.blocks, "__defaults__", (5,))
    assert evaluate_table("in.csv", "blocks.csv")[0].total() == 23
    whole, blocks = (numbers(read(name), RESULTS) for name in ("whole.csv", "blocks.csv"))
    np.testing.assert_allclose(blocks, whole, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize(
    ("columns", "theta", "said"),
    [
        (POSE, 60.0, "; theta_rad is up to 60 rad: write degrees as theta_deg"),
        (POSE, -1e200, "; theta_rad is up to 1e200 rad: write degrees as theta_deg"),
        (POSE, 6.2, ""),
        (("x_m", "y_m", "theta_deg", "z_m"), 720.0, ""),
    ],
)
def test_more_than_a_turn_in_radians_is_pointed_out(capsys, columns, theta, said) -> None:
    write(columns, [[0.0, 0.0, theta, -0.5], [0.0, 0.0, 0.0, -0.5]])
    assert evaluate(capsys).partition("2 rows")[2] == f"{said}\n"


def test_a_header_alone_gives_a_header(capsys) -> None:
    Path("in.csv").write_text(",".join(POSE) + "\r\n")
    assert evaluate(capsys) == "out.csv: 0 rows\n"
    assert Path("out.csv").read_text() == ",".join([*POSE, *RESULTS, "status"]) + "\n"


@pytest.mark.parametrize("before", [None, "old"])
@pytest.mark.parametrize(
    ("text", "out", "place"),
    [
        (GOOD + "0,0,zero,-0.5\n", "out.csv", "in.csv, row 4, column theta_rad: 'zero' is not"),
        (GOOD + "0,0,,-0.5\n", "out.csv", "in.csv, row 4, column theta_rad: the value is missing"),
        (GOOD.replace("z_m", "height"), "out.csv", "in.csv, row 1, column height: there is no"),
        ("", "out.csv", "in.csv: is empty"),
        (None, "out.csv", "in.csv: cannot be read: no such file"),
        (GOOD, "no/out.csv", "no/out.csv: cannot be written"),
        (GOOD, "folder.csv", "folder.csv: cannot be written: it is a folder"),
    ],
    ids=["word", "blank", "unknown column", "empty", "none", "no folder", "a folder"],
)
def test_a_refusal_leaves_no_output(folder, capsys, monkeypatch, before, text, out, place) -> None:
    monkeypatch.setattr(table_reader.TableReader.blocks, "__defaults__", (1,))
    Path("folder.csv").mkdir()
    for name, content in (("in.csv", text), ("out.csv", before)):
        if content is not None:
            Path(name).write_text(content)
    present = sorted(folder.iterdir())
    code, printed, err = run("evaluate", capsys, "in.csv", "--out", out)
    assert (code, printed, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"paminsa-viz: {place}")
    assert sorted(folder.iterdir()) == present
    assert before is None or Path("out.csv").read_text() == before


def test_a_full_disk_leaves_no_output(folder, capsys, monkeypatch) -> None:
    Path("in.csv").write_text(GOOD)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("paminsa_viz.cli.evaluate.csv_rows", full)
    _, _, err = run("evaluate", capsys, "in.csv", "--out", "out.csv")
    assert err == "paminsa-viz: out.csv: cannot be written: no space left on device\n"
    assert [path.name for path in folder.iterdir()] == ["in.csv"]


def test_columns_of_a_load_come_on_top_of_the_designs(tmp_path: Path) -> None:
    pose, source, target = (0.02, 0.0, 0.1, -0.5), tmp_path / "in.csv", tmp_path / "out.csv"
    rows = "".join(f"{','.join(map(str, pose))},{end}\n" for end in ("10,1", "0,0"))
    source.write_text(f"{','.join(POSE)},Fx_N,Mz_Nm\n{rows}")
    evaluate_table(source, target, APPENDIX_4.vary({"load.force_x": 5.0}))
    found = numbers(read(str(target)), TORQUES)
    for torque, force, moment in zip(found, (15.0, 5.0), (1.0, 0.0), strict=True):
        loaded = APPENDIX_4.vary({"load.force_x": force, "load.moment_z": moment})
        np.testing.assert_allclose(torque, static_torques(loaded, pose), rtol=1e-12)


@pytest.mark.parametrize(
    "words", ["--knee upper", "--knee=upper", "--assembly mirror", "--assembly=mirror"]
)
def test_the_knee_by_its_old_flag_and_word(words: str) -> None:
    given = parse(DesignFlags, words.split(), "paminsa-viz", "").given_design()
    assert given == APPENDIX_4.with_knee(KneeBranch.UPPER)
    with pytest.raises(UsageError, match=r"--knee: invalid choice 'left'"):
        parse(DesignFlags, ["--assembly", "left"], "paminsa-viz", "")
