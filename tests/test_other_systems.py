"""What other systems lack: the package needs none of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from threading import Event

import pytest

from paminsa_viz import interrupts

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
@pytest.mark.skipif(os.name != "posix", reason="takes away what only such a system has")
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
