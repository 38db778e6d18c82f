"""The program: its commands, exit codes and one-line errors."""

from __future__ import annotations

import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import paminsa_viz
from paminsa_viz import app
from paminsa_viz.app import AppOptions
from paminsa_viz.cli import COMMANDS, main
from paminsa_viz.cli.arguments import one_line
from paminsa_viz.errors import InvalidInput
from tests.support import commands


@pytest.fixture
def started(monkeypatch) -> list[AppOptions]:
    """Put an application in place that only notes what it was started with."""
    found: list[AppOptions] = []
    monkeypatch.setattr(app, "run", found.append)
    return found


def run(*words: str, **options) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "paminsa_viz", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def test_without_words_the_explorer_starts_as_the_options_say_by_default(started) -> None:
    assert main([]) == 0
    assert main(["start"]) == 0
    assert started == [AppOptions(), AppOptions()]


def test_flags_reach_the_explorer(started) -> None:
    words = "--host 0.0.0.0 --port 0 --no-browser --design d.toml --allow-host a --allow-host b"
    assert main(words.split()) == 0
    assert main(["start", *words.split()]) == 0
    wanted = AppOptions("0.0.0.0", 0, False, Path("d.toml"), ("a", "b"))
    assert started == [wanted, wanted]


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ("--port x", "Error parsing --port"),
        ("--port 65536", "--port: 65536 is not from 0 to 65535"),
        ("--port -1", "--port: -1 is not from 0 to 65535"),
        ("--prot 1", "--prot"),
        ("evaluat", "there is no command 'evaluat'; did you mean evaluate?"),
        ("xyz", "there is no command 'xyz'; there are start, evaluate, design"),
        ("start here", "Unrecognized options: here"),
        ("evaluate", "Missing from paminsa-viz evaluate"),
        ("evaluate a.csv", "--out"),
        ("evaluate a.csv --out b.csv --assembly other", "invalid choice 'other'"),
        ("evaluate a.csv --out b.csv --desing d", "Perhaps you meant: --design FILE"),
        ("design", "Expected one of"),
        ("design chek", "chek"),
        ("map --cells abc", "--cells: a whole number is needed, not 'abc'; see"),
        ("map --theta abc", "--theta: a number is needed, not 'abc'; see"),
    ],
)
def test_wrong_words_are_refused_in_one_line(started, capsys, words, complaint) -> None:
    assert main(words.split()) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("paminsa-viz: ")
    assert complaint in said.err
    assert said.err.count("\n") == 1
    assert not set("│╭─╰|") & set(said.err)
    assert not started


@pytest.mark.parametrize("words", [["--help"], ["-h"], *([name, "-h"] for name in COMMANDS)])
def test_help_goes_to_the_screen_and_starts_nothing(started, capsys, words) -> None:
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert not stop.value.code
    said = capsys.readouterr()
    assert "usage: paminsa-viz" in said.out
    assert said.err == ""
    assert not started


def test_the_programs_help_names_every_command(capsys) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    said = capsys.readouterr().out
    assert all(f"  {name} " in said and text in said for name, text in COMMANDS.items())


def test_ctrl_c_ends_with_130(monkeypatch, started) -> None:
    def stopped(_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(app, "run", stopped)
    assert main([]) == 130


def test_an_error_of_the_system_is_one_line(monkeypatch, started, capsys) -> None:
    def taken(_: object) -> None:
        raise OSError(98, "Address already in use")

    monkeypatch.setattr(app, "run", taken)
    assert main([]) == 2
    assert capsys.readouterr().err == "paminsa-viz: [Errno 98] Address already in use\n"


@pytest.mark.parametrize("values", [{"port": -1}, {"port": 65536}, {"host": " "}])
def test_options_that_can_not_be_are_refused(values) -> None:
    with pytest.raises(InvalidInput):
        AppOptions(**values)


@pytest.mark.parametrize(
    "complaint",
    [
        "╭─ Title ──╮\n│ wrong    │\n│     --a  │\n│         help │\n│ ──────── │\n│ more │\n╰───╯",
        " Title   \n ------- \n  wrong  \n      --a \n          help \n  -------\n  more \n",
        "\x1b[31m╭─\x1b[0m Title ──╮\n│ \x1b[1mwrong\x1b[0m │\n│     --a.  │\n╰──────╯",
    ],
)
def test_framed_complaints_become_one_line(complaint) -> None:
    assert one_line(complaint) == "wrong --a"
    assert one_line("") == "the arguments do not fit"


def test_the_module_is_the_program(tmp_path) -> None:
    (tmp_path / "in.csv").write_text("x_m,y_m,theta_rad,z_m\n0,0,0,x\n")
    refused = run("evaluate", str(tmp_path / "in.csv"), "--out", str(tmp_path / "out.csv"))
    assert refused.returncode == 2
    assert refused.stdout == ""
    assert refused.stderr == (
        f"paminsa-viz: {tmp_path / 'in.csv'}, row 2, column z_m: 'x' is not a number\n"
    )
    assert not (tmp_path / "out.csv").exists()
    version = run("--version")
    assert (version.returncode, version.stderr) == (0, "")
    assert version.stdout == f"paminsa-viz {paminsa_viz.__version__}\n"


def test_a_reader_that_goes_away_causes_no_traceback() -> None:
    command = [sys.executable, "-m", "paminsa_viz", "design", "default"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stderr
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 1


def test_small_commands_do_not_load_the_pages_libraries() -> None:
    code = (
        "import sys; from paminsa_viz.cli import main; main(['design', 'default']);"
        "print([name for name in ('viser', 'plotly', 'matplotlib', 'trimesh', 'numba')"
        " if name in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stderr == "[]\n"


@pytest.mark.parametrize(
    "words",
    [
        "trajectory --design {}", "trajectory --reference {}", "map --design {}",
        "map --reference {}", "evaluate in.csv --out out.csv --design {}", "balance --design {}",
        "sweep --vary links.b3=1:2:2 --out out.csv --design {}", "verify --design {}",
        "report --out out.html --design {}", "export --glb out.glb --design {}",
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    ("value", "place"),
    [
        ("[links]\nb3_kg = 1e308\n", "big.toml, line 3, [links] b3_kg = 1e+308"),
        ("[geometry]\nmagnification = 1.0\n", "big.toml, line 3, [geometry] magnification"),
    ],
)
def test_every_command_refuses_a_design_with_the_file_and_the_value(
    capsys, words, value, place
) -> None:
    Path("in.csv").write_text("x_m,y_m,theta_rad,z_m\n0,0,0,-0.5\n")
    Path("big.toml").write_text(f"schema_version = 1\n{value}")
    command, *others = words.format("big.toml").split()
    commands.check_refused(command, capsys, *others, place=place)


def test_overflow_is_not_numpy_s_to_tell(capsys) -> None:
    rows = "0,1e308,0,0,-0.5\n1,1e308,1e308,0,-0.5\n2,-1e308,0,0,1e308\n"
    Path("huge.csv").write_text("t_s,x_m,y_m,theta_rad,z_m\n" + rows)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        commands.check_refused("trajectory", capsys, "--file", "huge.csv", place="huge.csv: pose:")
    assert not told
