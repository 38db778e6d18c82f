"""The program: its commands, exit codes, help, and errors in one line."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
import typing
from dataclasses import fields
from pathlib import Path

import pytest

import paminsa_viz
from paminsa_viz import app, interrupts
from paminsa_viz.app import AppOptions
from paminsa_viz.cli import COMMANDS, command_module, main
from paminsa_viz.cli.arguments import one_line
from paminsa_viz.cli.help import flag_texts
from paminsa_viz.errors import InvalidInput

FLAGS = "--host 0.0.0.0 --port 0 --no-browser --design d.toml --allow-host a --allow-host b"
OPTIONS = AppOptions("0.0.0.0", 0, False, Path("d.toml"), ("a", "b"))


@pytest.fixture
def started(monkeypatch) -> list[AppOptions]:
    """What the application was started with; it does nothing."""
    found: list[AppOptions] = []
    monkeypatch.setattr(app, "run", found.append)
    return found


@pytest.mark.parametrize("command", ["", "start "])
@pytest.mark.parametrize(
    ("words", "options"), [("", AppOptions()), (FLAGS, OPTIONS)], ids=["default", "flags"]
)
def test_flags_reach_the_explorer_with_and_without_its_command(
    started, command, words, options
) -> None:
    assert main((command + words).split()) == 0
    assert started == [options]


@pytest.mark.slow
@pytest.mark.parametrize("words", [["--help"], ["-h"], ["design", "-h"]])
def test_help_goes_to_the_screen_and_starts_nothing(started, capsys, words) -> None:
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert not stop.value.code
    printed = capsys.readouterr()
    assert "usage: paminsa-viz" in printed.out
    assert printed.err == ""
    assert not started
    if len(words) == 1:
        rows = dict(re.findall(r"(?m)^  (\w+)( +.*)$", printed.out))
        assert {name: row.strip() for name, row in rows.items()} == COMMANDS
        columns = {len(name) + len(row) - len(row.strip()) for name, row in rows.items()}
        assert len(columns) == 1


@pytest.mark.slow
def test_help_runs_a_text_on_and_lists_only_what_can_be_chosen(
    started, capsys, monkeypatch
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    parts = (["requirements", "check"], ["requirements", "largest"], ["requirements", "prove"])
    for words in (*([name] for name in COMMANDS), *parts, ["design", "diff"]):
        with pytest.raises(SystemExit) as stop:
            main([*words, "--help"])
        printed, said = capsys.readouterr()
        assert (stop.value.code, said, started) == (0, "", []), words
        assert f"usage: paminsa-viz {words[0]}".removesuffix(" start") in printed
        assert not re.search(r"\{None\}|\(default: None\)|\b(INT|FLOAT|STR)\b", printed), words
        assert "(repeatable)" not in printed, words  # its own text says so
        assert not re.search(r"\[deg|degrees\]|given several times", printed), words  # [°]
        if "--knee" in printed:
            assert "{lower,upper}" in printed, words
            assert "its mirror image; by default the design's own." in printed, words


def test_flags_that_can_be_repeated_say_so() -> None:
    for name in COMMANDS:
        kind = command_module(name).FLAGS
        kinds = [kind]
        if not inspect.isclass(kind):
            kinds = [typing.get_args(each)[0] for each in typing.get_args(kind)]
        for one in kinds:
            said = flag_texts(one)
            for item in fields(one):
                told = re.search("[Cc]an be repeated|repeated at least once", said[item.name])
                assert bool(told) == (item.default == ()), (name, item.name)


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (KeyboardInterrupt(), 130, ""),
        (OSError(98, "Address in use"), 2, "paminsa-viz: [Errno 98] Address in use\n"),
        (MemoryError(), 2, "paminsa-viz: there is not enough memory; "),
        (RuntimeError("can't start new thread"), 2, "paminsa-viz: the system starts no more "),
        (BlockingIOError(11, "of a fork"), 2, "paminsa-viz: the system starts no more "),
        (BlockingIOError(11, "of a pipe", 0), 2, "paminsa-viz: [Errno 11] of a pipe\n"),
    ],
)
def test_an_error_of_the_system_has_its_exit_code(monkeypatch, capsys, error, code, line) -> None:
    def fail(_: object) -> None:
        raise error

    monkeypatch.setattr(app, "run", fail)
    assert main([]) == code
    said = capsys.readouterr().err
    assert said.startswith(line)
    assert len(said.splitlines()) == bool(line)


def test_a_program_that_can_start_no_thread_says_so(monkeypatch, capsys) -> None:
    def fail(_: object) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(interrupts, "exit_on_interrupt", fail)
    assert main() == 2
    assert "ulimit -u" in capsys.readouterr().err


@pytest.mark.parametrize(
    "values",
    [{"port": -1}, {"port": 65536}, {"host": " "}, {"pages": 0}],
    ids=["low port", "high port", "no host", "no pages"],
)
def test_impossible_options_are_refused(values) -> None:
    with pytest.raises(InvalidInput):
        AppOptions(**values)


@pytest.mark.parametrize(
    "complaint",
    [
        "╭─ Title ──╮\n│ wrong    │\n│     --a  │\n│         help │\n│ ──────── │\n│ more │\n╰───╯",
        " Title   \n ------- \n  wrong  \n      --a \n          help \n  -------\n  more \n",
        "\x1b[31m╭─\x1b[0m Title ──╮\n│ \x1b[1mwrong\x1b[0m │\n│     --a.  │\n╰──────╯",
    ],
    ids=["framed", "ruled", "colored"],
)
def test_framed_complaints_become_one_line(complaint) -> None:
    assert one_line(complaint) == "wrong --a"
    assert one_line("") == "the arguments do not fit"


def run_process(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


@pytest.mark.slow
def test_the_module_is_the_program() -> None:
    Path("in.csv").write_text("x_m,y_m,theta_rad,z_m\n0,0,0,x\n")
    refused = run_process("-m", "paminsa_viz", "evaluate", "in.csv", "--out", "out.csv")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == "paminsa-viz: in.csv, row 2, column z_m: 'x' is not a number\n"
    assert not Path("out.csv").exists()
    version = run_process("-m", "paminsa_viz", "--version")
    assert (version.returncode, version.stderr) == (0, "")
    assert version.stdout == f"paminsa-viz {paminsa_viz.__version__}\n"


@pytest.mark.slow
def test_words_are_the_same_without_docstrings() -> None:
    """As of ``PYTHONOPTIMIZE=2``; only what stands beside a table's name is left out."""
    results: list[dict[str, str]] = []
    for optimized in ((), ("-OO",)):
        code = "from paminsa_viz.cli import main; main('code --out c'.split());"
        code += "main('design default --out d.toml'.split()); main(['design', '--help'])"
        printed = run_process(*optimized, "-c", code).stdout
        files = {str(path): path.read_text("utf-8") for path in Path("c").rglob("*.*")}
        toml = re.sub(r"(?m)^(\[\w+\])  #.*", r"\1", Path("d.toml").read_text("utf-8"))
        results.append({"printed": printed, "d.toml": toml, **files})
    usual, without = results
    assert "Print every value of a design" in usual["printed"]
    assert len(usual) > 5
    for name, text in usual.items():
        assert without[name] == text, name


@pytest.mark.slow
def test_a_reader_that_goes_away_causes_no_traceback() -> None:
    command = [sys.executable, "-m", "paminsa_viz", "design", "default"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stderr
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 1


@pytest.mark.slow
def test_small_commands_and_a_page_that_starts_do_not_load_what_takes_a_while() -> None:
    at = "'--pose', '50', '-30', '20', '-550'"
    code = (
        "import sys; from paminsa_viz.cli import main; main(['design', 'default']);"
        f"main(['stiffness', {at}]); assert 'typeguard' not in sys.modules;"
        f"[main([word, {at}]) for word in ('accuracy', 'loads')];"
        "print([name for name in ('viser', 'plotly', 'matplotlib', 'trimesh', 'numba', 'scipy')"
        " if name in sys.modules], file=sys.stderr); import paminsa_viz.explorer.page;"
        "print([name for name in ('plotly', 'matplotlib', 'trimesh', 'numba', 'scipy')"
        " if name in sys.modules], file=sys.stderr)"
    )
    assert run_process("-c", code).stderr == "[]\n[]\n"
