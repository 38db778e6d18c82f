"""What commands print: one writer of JSON, one of blocks."""

from __future__ import annotations

import io
import json
import logging
import os
import sys
from contextlib import nullcontext
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import Note, Row, Table
from paminsa_viz.blocks.data import UNITS, record
from paminsa_viz.cli import main, output
from paminsa_viz.cli.output import (
    announce_compilation,
    ascii_numbers,
    print_blocks,
    print_json,
)
from paminsa_viz.files.design_file import load_content, save_design
from paminsa_viz.model import APPENDIX_4, compiled
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)


class Kind(Enum):
    ONE = "the one"


@dataclass(frozen=True)
class Found:
    mass: float
    peak: float
    kg: str
    kind: Kind = Kind.ONE


@pytest.mark.parametrize("unit", UNITS)
def test_a_key_names_the_unit_of_an_attribute(unit: str) -> None:
    assert record(Found(2.0, 3.0, "text"), f"mass_{unit}", "peak") == {
        f"mass_{unit}": 2.0, "peak": 3.0,
    }  # fmt: skip


def test_an_attribute_that_is_none_is_refused() -> None:
    for key in ("weight_kg", "mass_lb", "mass_"):
        with pytest.raises(AttributeError):
            record(Found(2.0, 3.0, "text"), key)


@pytest.mark.slow
@pytest.mark.usefixtures("few_random_motions")
def test_a_negative_result_is_json_too(tmp_path: Path, capsys: Any) -> None:
    far = tmp_path / "far.csv"
    far.write_text("t_s,x_m,y_m,theta_rad,z_m\n0,2,0,0,-0.5\n1,2,0,0,-0.6\n")
    for command in (
        f"trajectory --file {far} --simulate pd", f"loads --file {far}", f"drives --file {far}",
        f"balance --goal peak --file {far}", "excite --max-force 50 --evaluations 5",
        "balance --change joints.j7 0 0.1 --exact",
    ):  # fmt: skip
        assert main([*command.split(), "--json"]) == 1, command
        printed = capsys.readouterr()
        found = json.loads(printed.out)
        assert found["ok"] is False
        assert printed.err == f"paminsa-viz: {found['problems'][0]}\n"


@pytest.mark.slow
def test_json_names_the_files_that_are_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    for command in (
        "balance --out a.toml", "loads --out a.csv", "loads --preset arch --out b.csv",
        "calibrate --propose 5 --out c.csv", "excite --seconds 0 --evaluations 0 --out d.csv",
        "requirements check --coarse --require condition<=10 --out e.csv",
        "sweep --vary links.b3=0.3:0.5:2 --cells 8 --workers 1 --out f.csv",
        "drives --out g.toml", "map --cells 10 --out h.csv", "trajectory --rate 50 --out i.csv",
    ):  # fmt: skip
        main([*command.split(), "--json"])
        *_, name = command.split()
        assert json.loads(capsys.readouterr().out)["files"] == [name], command
        assert Path(name).is_file()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "noted"),
    [
        ("loads", True), ("loads --preset line", True), ("stiffness", True), ("clearance", True),
        ("drives --rows 1", True), ("drives --ratios", True), ("map --cells 10", True),
        ("map --cells 10 --quantity deviation-x", False),
    ],
)  # fmt: skip
def test_numbers_of_equal_legs_say_so_for_a_design_with_deviations(
    tmp_path: Path, capsys: Any, command: str, noted: bool
) -> None:
    deviating = APPENDIX_4.vary({"leg2.bar_94": 1e-4})
    path = save_design(deviating, tmp_path / "d.toml")
    main([*command.split(), "--design", str(path)])
    assert (equal_legs_note(deviating.deviations) in capsys.readouterr().out) is noted


def test_json_has_lists_texts_and_null_for_what_results_hold(capsys: Any) -> None:
    values = np.array([[1.0, np.nan], [np.inf, -2.0]])
    facts = {
        "array": values, "scalar": np.float64(0.5), "whole": np.int64(3), "holds": np.bool_(True),
        "path": Path("a/b"), "found": (Found(1.0, float("nan"), "x"),), "nothing": None,
    }  # fmt: skip
    print_json(facts, signed=False)
    assert json.loads(capsys.readouterr().out) == {
        "array": [[1.0, None], [None, -2.0]], "scalar": 0.5, "whole": 3, "holds": True,
        "path": "a/b", "nothing": None,
        "found": [{"mass": 1.0, "peak": None, "kg": "x", "kind": "the one"}],
    }  # fmt: skip


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "ascii"])
def test_json_is_utf_8_whatever_the_encoding_of_the_output(monkeypatch, encoding: str) -> None:
    raw = io.BytesIO()
    output = io.TextIOWrapper(raw, encoding=encoding, errors="replace")
    monkeypatch.setattr(sys, "stdout", output)
    print_json({"name": "Größe θ 日本"})
    output.flush()
    assert json.loads(raw.getvalue().decode("utf-8"))["name"] == "Größe θ 日本"
    assert ("θ" in raw.getvalue().decode("utf-8")) == (encoding == "utf-8")


def test_no_line_of_a_terminal_ends_in_a_word_or_between_a_number_and_its_unit(
    capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocks = [
        Note("It comes nearest to a limit at −1.236 mm, z −20.5 mm off; " * 4 + "that is all.")
    ]
    print_blocks(blocks)
    whole = capsys.readouterr().out
    assert whole.count("\n") == 1, "programs get one line"
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    for width in range(20, 60):
        monkeypatch.setenv("COLUMNS", str(width))
        print_blocks(blocks)
        lines = capsys.readouterr().out.splitlines()
        assert " ".join(lines) == whole.strip()
        assert max(map(len, lines)) <= width
        assert not any(line.startswith(("mm", "-20.5")) for line in lines)


def test_blocks_are_lines_with_columns_and_marks(capsys: Any) -> None:
    rows = (Row(("one", "−1.5·10⁻⁷"), "marked"), Row(("another", "2")))
    print_blocks([Note("“first”"), Note("one’s"), Table(("", "θ [″]"), rows, "Values ≤ 3.")])
    assert capsys.readouterr().out.splitlines() == [
        '"first"', "one's", "", "Values <= 3.",
        '            theta ["]',
        "*  one        -1.5e-7",
        "   another          2",
    ]  # fmt: skip


HEADED = "balance|balance --goal peak|clearance|drives|drives --ratios|excite --evaluations 1"


@pytest.mark.slow
@pytest.mark.usefixtures("few_random_motions")
@pytest.mark.parametrize("words", HEADED.split("|"))
def test_numbers_are_below_the_name_of_their_design(words: str, capsys: Any) -> None:
    assert main(words.split()) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert first.startswith('design "Appendix 4"')
    assert ("four coordinates" in first) == (words.startswith("drives") or "peak" in words)


@pytest.mark.parametrize(("text", "printed"), [("θ = 3°", "theta = 3°"), ("θ̇² ≥ θ̇ₖ²", "θ̇² >= θ̇ₖ²")])
def test_a_letter_with_a_dot_above_stays_a_letter(text, printed) -> None:
    assert ascii_numbers(text) == printed


class Gone(io.StringIO):
    """An output whose reader has gone away."""

    def write(self, text: str) -> int:
        raise BrokenPipeError

    def fileno(self) -> int:
        return os.open(os.devnull, os.O_WRONLY)


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "loads --bar b4 --out",
        "loads --preset arch --out",
        "calibrate poses.csv --out",
        "drives --out",
        "balance --out",
        "trajectory --out",
        "requirements check --volume --coarse --out",
        "synthesize cylinder --generations 2 --out",
    ],
)
def test_files_are_written_though_nobody_reads_what_is_printed(
    monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    if words.startswith("calibrate"):
        assert main(["calibrate", "--propose", "40", "--out", "poses.csv"]) == 0
    table = words.startswith(("loads", "trajectory", "requirements"))
    monkeypatch.setattr(sys, "stdout", Gone())
    assert main([*words.split(), "out.csv" if table else "out.toml"]) == 1
    assert list(Path().glob("out*"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "balance --out",
        "calibrate poses.csv --out",
        "drives --out",
        "identify example --out",
    ],
)
def test_a_design_that_is_changed_keeps_its_requirements(words: str) -> None:
    workspace = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.2))
    needed = Requirements((Requirement("condition", high=8.0),), (-0.3, 0.3), workspace)
    save_design(APPENDIX_4, "robot.toml", requirements=needed)
    if words.startswith("calibrate"):
        assert main(["calibrate", "--propose", "40", "--out", "poses.csv"]) == 0
    folder = words.startswith("identify")
    out = "found" if folder else "out.toml"
    assert main([*words.split(), out, "--design", "robot.toml"]) == 0
    written = load_content("found/identified.toml" if folder else out)
    assert written.requirements == needed


@pytest.mark.slow
def test_long_work_says_how_far_it_is(capsys, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(output, "status_line", lambda _: nullcontext(told.append))
    proof = "--require f_4<=450 --cylinder 300 400 --center 0 0 -600 --time 1e-6"
    for words, line in (
        (f"requirements prove {proof}", "proving: 100% of at most 1e-06 s"),
        (f"requirements largest {proof}", "proving: 100% of at most 1e-06 s"),
        ("clearance --poses 2", "computing the clearances: 0%"),
        ("accuracy --manufacture --robots 2 --cells 5", "drawing robots: 100%"),
    ):
        told.clear()
        main(words.split())
        assert set(told) == {line}, words


def test_compiling_is_announced_once(capsys, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled.log, "level", logging.NOTSET)
    announce_compilation()
    for name in ("one", "another"):
        compiled.log.info("%s is compiled", name)
    assert capsys.readouterr().err == "compiling, once after installing ...\n"


def test_compiling_without_a_folder_is_announced_as_such(
    capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_folder(function: object) -> None:
        raise RuntimeError("no locator available")  # as Numba says

    monkeypatch.setattr(compiled.log, "level", logging.NOTSET)
    monkeypatch.setattr(compiled, "_Cache", no_folder)
    announce_compilation()
    compiled.kernel()(lambda x: x)
    line = "compiling at each start: no folder keeps it; NUMBA_CACHE_DIR can name one ...\n"
    assert capsys.readouterr().err == line
