"""What other systems lack: the package needs none of it."""

from __future__ import annotations

import errno
import io
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from threading import Event
from types import SimpleNamespace

import pytest

from paminsa_viz import cli, interrupts
from paminsa_viz.cli.letters import SPELLED
from paminsa_viz.cli.output import _print_rows
from paminsa_viz.files.design_file import write_design
from paminsa_viz.model import APPENDIX_4

LACKING = """
import os, posix, selectors, signal, socket, subprocess, sys, webbrowser

for name in ("fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "readline"):
    sys.modules[name] = None  # as if it were not there
for name in (
    "fork", "getuid", "geteuid", "getpgid", "sched_getaffinity", "fchmod", "chown", "fchown",
    "nice", "statvfs", "killpg", "setsid", "set_blocking", "get_blocking", "pread", "pwrite",
):
    delattr(os, name)
for name in ("SIGHUP", "SIGALRM", "SIGUSR1", "SIGKILL", "SIGPIPE", "pthread_sigmask", "setitimer"):
    delattr(signal, name)
asked = signal.set_wakeup_fd

def set_wakeup_fd(number, **options):
    posix.set_blocking(number, False)  # Windows alone does not ask for it
    return asked(number, **options)

signal.set_wakeup_fd = set_wakeup_fd
"""
"""A process that has nothing of what Python lacks on Windows, from 3.11 on."""

ALL = """
import importlib, pkgutil
import paminsa_viz
from paminsa_viz.__main__ import main

for module in pkgutil.walk_packages(paminsa_viz.__path__, "paminsa_viz."):
    importlib.import_module(module.name)
sys.argv[1:] = ["evaluate", "poses.csv", "--out", "torques.csv"]
sys.exit(main())
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="removes names of POSIX systems")
def test_every_module_and_a_command_work_without_what_windows_lacks(tmp_path: Path) -> None:
    (tmp_path / "poses.csv").write_text("x_m,y_m,theta_rad,z_m\n0,0,0.5,-0.6\n")
    done = subprocess.run(
        [sys.executable, "-c", LACKING + ALL], cwd=tmp_path, capture_output=True, text=True,
        timeout=120,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "torques.csv: 1 row\n"), done.stderr
    assert sorted(each.name for each in tmp_path.iterdir()) == ["poses.csv", "torques.csv"]


def test_a_stop_is_noticed_where_a_pipe_cannot_be_told_not_to_block(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Python 3.11 has no `os.set_blocking` on Windows."""
    pipes: list[int] = []
    read: list[bytes] = []
    ended = Event()

    def watch(reading: int, program: str) -> None:
        read.append(os.read(reading, 1))
        pipes.append(reading)
        ended.set()

    monkeypatch.delattr(os, "set_blocking", raising=False)
    monkeypatch.setattr(signal, "set_wakeup_fd", lambda number, **_: pipes.append(number))
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(interrupts, "_watch", watch)
    interrupts.exit_on_interrupt("program")
    os.write(pipes[0], b"\x02")
    assert ended.wait(10.0)
    assert read == [b"\x02"]
    for number in pipes:
        os.close(number)


def test_a_command_is_given_back_as_the_systems_shell_takes_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    words = ["paminsa-viz", "report", "--design", "C:\\my robots\\a.toml"]
    for system, line in (
        ("linux", r"paminsa-viz report --design 'C:\my robots\a.toml'"),
        ("win32", r'paminsa-viz report --design "C:\my robots\a.toml"'),
    ):
        monkeypatch.setattr(cli, "sys", SimpleNamespace(platform=system))
        assert cli._as_typed(words) == line


@pytest.mark.parametrize("late", [False, True])
def test_a_reader_that_has_gone_is_an_invalid_argument_on_windows(
    monkeypatch: pytest.MonkeyPatch, late: bool
) -> None:
    """While a text is printed, or only when what was gathered of it is written at the end."""

    class Output(io.StringIO):
        def write(self, text: str) -> int:
            return len(text) if late else self.flush()

        def flush(self) -> int:
            raise OSError(errno.EINVAL, "Invalid argument")

        def fileno(self) -> int:
            return os.open(os.devnull, os.O_WRONLY)

    said = io.StringIO()
    streams = {"stdout": Output(), "stderr": said}
    monkeypatch.setattr(sys, "stdout", streams["stdout"])
    for system, code in (("win32", 1), ("linux", 2)):
        monkeypatch.setattr(cli, "sys", SimpleNamespace(platform=system, **streams))
        monkeypatch.setattr(sys, "stderr", said)
        assert cli.main(["--version"]) == code
        assert bool(said.getvalue()) == (system == "linux")


def test_letters_that_a_code_page_lacks_are_spelled() -> None:
    """With a mark in their place, three columns of a table had one name."""
    for text, encoding, written in (
        ("peak₁ [N·m]", "cp1252", "peak_1 [N·m]"),
        ("1/κ, Δq, ψ", "cp1252", "1/kappa, Deltaq, psi"),
        ("κ, 10⁻³ … x–y ✓", "ascii", "kappa, 10^-3 ... x-y ?"),
        ("\udc80 Größe ω", "cp437", "? Größe omega"),
    ):
        assert text.encode(encoding, SPELLED).decode(encoding) == written
    with pytest.raises(UnicodeDecodeError):
        b"\xff".decode("utf-8", SPELLED)


def test_columns_are_in_line_where_letters_are_spelled(monkeypatch: pytest.MonkeyPatch) -> None:
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, "cp1252", SPELLED, newline=""))
    _print_rows([("", "N₁ [N]", "κ"), ("guide", "12.5", "4.266")], 1)
    sys.stdout.flush()
    assert raw.getvalue() == b"       N_1 [N]  kappa\nguide     12.5  4.266\n"


@pytest.mark.slow
def test_redirected_output_names_what_the_code_page_lacks(tmp_path: Path) -> None:
    """In a table and in a sentence."""
    text = write_design(replace(APPENDIX_4, name="robot ω₂"))
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    for encoding in ("cp1252", "cp437"):
        for words, part in (
            ("requirements quantities", "1/kappa"),
            ("design check a.toml", "ega_2"),
        ):
            done = subprocess.run(
                [sys.executable, "-m", "paminsa_viz", *words.split()], capture_output=True,
                env=os.environ | {"PYTHONIOENCODING": encoding}, cwd=tmp_path,
            )  # fmt: skip
            assert (done.returncode, done.stderr) == (0, b"")
            text = done.stdout.decode(encoding)
            assert part in text
            assert "?" not in text
