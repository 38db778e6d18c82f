"""``code``: the robot as C code."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from paminsa_viz.codegen import controller_kit
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.accuracy import equal_legs_note
from tests.support.commands import check_refused, run


@pytest.mark.slow
def test_a_design_is_written_as_a_folder(capsys) -> None:
    design = APPENDIX_4.vary({"payload.mass": 2.5})
    save_design(design, "d.toml")
    code, out, err = run("code", capsys, "--out", "robot/controller", "--design", "d.toml")
    kit = controller_kit(design)
    assert (code, err) == (0, "")
    assert out.splitlines() == [f"robot/controller/{name}: written" for name in kit]
    for name in ("paminsa.h", "design.h", "vectors.csv", "test.c"):
        assert (Path("robot/controller") / name).read_text() == kit[name]


def test_float_writes_no_double(capsys) -> None:
    assert run("code", capsys, "--out", "c", "--float")[0] == 0
    assert "double " not in Path("c/design.h").read_text()
    assert "float px;" in Path("c/paminsa.h").read_text()


def test_deviations_that_the_code_leaves_out_are_named(capsys) -> None:
    deviating = APPENDIX_4.vary({"leg2.bar_94": 1e-4})
    save_design(deviating, "d.toml")
    code, out, err = run("code", capsys, "--out", "c", "--design", "d.toml")
    assert (code, err) == (0, "")
    assert out.splitlines()[-1] == equal_legs_note(deviating.deviations)
    for name in ("README.md", "design.h"):
        assert "deviations of single legs" in Path("c", name).read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "nothing to write; give --out FOLDER"),
        (["--out", "taken"], "taken: cannot be written"),
        (["--out", "c", "--design", "missing.toml"], "missing.toml"),
        (["--out", "c", "--fmu", "robot"], "--fmu"),
        (["--out", "c", "--fmu", "plant", "--float"], "leave --float out"),
    ],
)
def test_what_cannot_be_written_is_one_line(words: list[str], message: str, capsys) -> None:
    Path("taken").write_text("")
    code, out, err = run("code", capsys, *words)
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1
    assert not Path("c").exists()


def test_nothing_is_written_where_one_file_cannot_be(capsys) -> None:
    os.makedirs("c/vectors.csv")
    code, _, err = run("code", capsys, "--out", "c")
    assert (code, len(err.splitlines())) == (2, 1)
    assert os.listdir("c") == ["vectors.csv"]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler here")
def test_fmus_are_added_to_the_folder(capsys) -> None:
    code, out, err = run("code", capsys, "--out", "c", "--fmu", "plant", "--fmu", "inverse")
    assert (code, err) == (0, "")
    assert sorted(os.listdir("c/fmu")) == [
        "add_platform.py", "paminsa_inverse.fmu", "paminsa_plant.fmu",
    ]  # fmt: skip
    assert "c/fmu/paminsa_plant.fmu: written" in out.splitlines()


def test_no_compiler_leaves_nothing(capsys, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    check_refused("code", capsys, "--out", "c", "--fmu", "plant", place="no-such-compiler")
    assert not Path("c").exists()
