"""``evaluate``: its numbers are the robot's, and what it cannot use it refuses without a trace."""

from __future__ import annotations

import csv
import errno
import math

import numpy as np
import pytest

from paminsa_viz.cli import main
from paminsa_viz.cli.evaluate import evaluate_table
from paminsa_viz.files import table_reader
from paminsa_viz.files.columns import ACTUATORS, POSE, POSES, TORQUES
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from tests import oracle
from tests.support.samples import random_design, random_states, with_knee

RESULTS = (*ACTUATORS, *TORQUES)

GOOD = "x_m,y_m,theta_rad,z_m\n0.05,-0.03,0.4,-0.6\n0,0,0,-0.5\n"


def write(path, columns, rows) -> None:
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in np.asarray(rows).tolist())]
    path.write_text("\n".join(lines) + "\n")


def read(path) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows, columns):
    return np.array([[float(row[name]) for name in columns] for row in rows])


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_numbers_are_those_of_first_principles(folder, knee) -> None:
    rng = np.random.default_rng(7)
    design = random_design(rng)
    pose, velocity, acceleration = random_states(rng, with_knee(design, knee), 40)
    order = rng.permutation(len(POSES.columns))
    columns = [POSES.columns[i] for i in order]
    rows = np.concatenate([pose, velocity, acceleration], axis=-1)[:, order]
    write(folder / "in.csv", columns, rows)
    save_design(design, folder / "d.toml")
    words = ["evaluate", "in.csv", "--out", "out.csv", "--design", "d.toml"]
    assert main([*words, "--assembly", knee.value]) == 0

    got = read(folder / "out.csv")
    assert list(got[0]) == [*columns, *RESULTS, "status"]
    assert numbers(got, columns).tolist() == rows.tolist()
    assert {row["status"] for row in got} == {"ok"}
    torques = oracle.inverse_dynamics(with_knee(design, knee), pose, velocity, acceleration)
    scale = np.abs(torques).max(axis=-1, keepdims=True)
    np.testing.assert_allclose(numbers(got, TORQUES) / scale, torques / scale, atol=1e-9)
    positions = numbers(got, ACTUATORS) - oracle.actuators(design, pose)
    positions[:, :3] = (positions[:, :3] + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(positions, 0, atol=1e-12)


def test_without_motion_the_torques_are_static(folder) -> None:
    pose = random_states(np.random.default_rng(1), APPENDIX_4, 5)[0]
    write(folder / "in.csv", POSE, pose)
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 0
    static = oracle.static_torques(APPENDIX_4, pose)
    np.testing.assert_allclose(numbers(read(folder / "out.csv"), TORQUES), static, atol=1e-9)


def test_an_acceleration_may_stand_without_a_velocity(folder) -> None:
    pose, _, acceleration = random_states(np.random.default_rng(2), APPENDIX_4, 5)
    write(folder / "in.csv", [*POSE, *POSES.columns[8:]], np.hstack([pose, acceleration]))
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 0
    expected = oracle.inverse_dynamics(APPENDIX_4, pose, np.zeros(4), acceleration)
    np.testing.assert_allclose(numbers(read(folder / "out.csv"), TORQUES), expected, atol=1e-9)


def test_rows_that_can_not_be_computed_say_why_and_stay_empty(folder, capsys) -> None:
    rows = {
        "0,0,0,-0.5": "ok",
        "0,0,0,-5": "stretched:leg1",
        "0,0.3,0,-0.9": "stretched:leg1",
        "0.2,0,0,0": "folded:leg2",
        "0,0.25,0,-0.0275": "folded:leg3",
        "1e200,0,0,0": "not-finite",
    }
    (folder / "in.csv").write_text("\n".join([",".join(POSE), *rows]))
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 0
    got = read(folder / "out.csv")
    for row, word in zip(got, rows.values(), strict=True):
        assert row["status"] == word
        filled = [row[name] != "" for name in RESULTS]
        assert all(filled) if word == "ok" else not any(filled)
    assert capsys.readouterr().out == (
        "out.csv: 6 rows, 5 without numbers "
        "(2 stretched:leg1, 1 folded:leg2, 1 folded:leg3, 1 not-finite)\n"
    )


def test_a_singular_pose_and_a_motion_beyond_all_numbers(folder) -> None:
    head = ",".join(POSES.columns)
    (folder / "in.csv").write_text(
        f"{head}\n0.05,0.03,{math.acos(0.1 / 0.35)!r},-0.6,0,0,0,0,0,0,0,0\n"
        "0.05,-0.03,0.4,-0.6,0,0,0,0,1e308,1e308,1e308,1e308\n"
        "0.05,-0.03,0.4,-0.6,0,0,0,0,0,0,0,0\n"
    )
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 0
    got = read(folder / "out.csv")
    for row in got:
        assert (row["status"] == "ok") == all(row[name] for name in RESULTS)
        if row["status"] == "ok":
            assert np.isfinite([float(row[name]) for name in RESULTS]).all()
    assert got[1]["status"] != "ok"
    assert got[2]["status"] == "ok"


def test_a_table_may_be_replaced_by_its_result(folder) -> None:
    (folder / "a.csv").write_text(GOOD)
    assert main(["evaluate", "a.csv", "--out", "b.csv"]) == 0
    assert main(["evaluate", "a.csv", "--out", "a.csv"]) == 0
    assert (folder / "a.csv").read_text() == (folder / "b.csv").read_text()
    assert sorted(path.name for path in folder.iterdir()) == ["a.csv", "b.csv"]


def test_the_length_of_the_pieces_changes_nothing(folder, monkeypatch) -> None:
    pose = random_states(np.random.default_rng(3), APPENDIX_4, 23)[0]
    write(folder / "in.csv", POSE, pose)
    evaluate_table(folder / "in.csv", folder / "whole.csv")
    monkeypatch.setattr(table_reader.TableReader.blocks, "__defaults__", (5,))
    tally = evaluate_table(folder / "in.csv", folder / "pieces.csv")
    assert tally.total() == 23
    whole, pieces = read(folder / "whole.csv"), read(folder / "pieces.csv")
    np.testing.assert_allclose(
        numbers(pieces, RESULTS),
        numbers(whole, RESULTS),
        rtol=1e-13,
        atol=1e-13,
    )


def test_a_header_alone_gives_a_header(folder, capsys) -> None:
    (folder / "in.csv").write_text(",".join(POSE) + "\r\n")
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 0
    assert (folder / "out.csv").read_text() == ",".join([*POSE, *RESULTS, "status"]) + "\n"
    assert capsys.readouterr().out == "out.csv: 0 rows\n"


@pytest.mark.parametrize("before", [None, "old"])
@pytest.mark.parametrize(
    ("text", "place"),
    [
        (GOOD + "0,0,zero,-0.5\n", "in.csv, row 4, column theta_rad: 'zero' is not a number"),
        (GOOD + "0,0,,-0.5\n", "in.csv, row 4, column theta_rad: the value is missing"),
        (GOOD.replace("z_m", "height"), "in.csv, row 1, column height: there is no such column"),
        ("", "in.csv: is empty"),
        (None, "in.csv: cannot be read: no such file"),
    ],
)
def test_a_refused_table_leaves_no_output(folder, capsys, monkeypatch, before, text, place) -> None:
    monkeypatch.setattr(table_reader.TableReader.blocks, "__defaults__", (1,))
    if text is not None:
        (folder / "in.csv").write_text(text)
    if before is not None:
        (folder / "out.csv").write_text(before)
    present = sorted(folder.iterdir())
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"paminsa-viz: {place}")
    assert said.err.count("\n") == 1
    assert sorted(folder.iterdir()) == present
    assert before is None or (folder / "out.csv").read_text() == before


def test_a_bad_design_or_output_is_refused_in_one_line(folder, capsys) -> None:
    (folder / "in.csv").write_text(GOOD)
    (folder / "d.toml").write_text("schema_version = 1\n[links]\nb3_kg = -1\n")
    assert main(["evaluate", "in.csv", "--out", "out.csv", "--design", "d.toml"]) == 2
    assert "d.toml, line 3, [links] b3_kg = -1.0:" in capsys.readouterr().err
    assert main(["evaluate", "in.csv", "--out", "no/out.csv"]) == 2
    assert "no/out.csv: cannot be written" in capsys.readouterr().err
    (folder / "a.csv").mkdir()
    assert main(["evaluate", "in.csv", "--out", "a.csv"]) == 2
    assert "it is a folder" in capsys.readouterr().err


def test_a_full_disk_leaves_no_output(folder, capsys, monkeypatch) -> None:
    (folder / "in.csv").write_text(GOOD)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("paminsa_viz.cli.evaluate.csv_rows", full)
    assert main(["evaluate", "in.csv", "--out", "out.csv"]) == 2
    assert capsys.readouterr().err == (
        "paminsa-viz: out.csv: cannot be written: no space left on device\n"
    )
    assert [path.name for path in folder.iterdir()] == ["in.csv"]
