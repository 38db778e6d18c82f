"""Ctrl-C at any moment of any command: exit code 130, one line, at once, no half-written file."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="sends a signal"),
]

BEGIN = (
    "import sys; from paminsa_viz.__main__ import main; sys.stdout.write('.'); sys.stdout.flush();"
    "sys.exit(main())"
)
"""The program as its start script runs it; the dot comes right before its first line."""

COMMANDS = {
    "help": "--help",
    "balance": "balance --goal energy --preset arch --rail b8 8 0 150 4 --out new.toml",
    "report": "report --out new.html --no-verify",
    "sweep": "sweep --random 4000 --vary links.b3 --vary joints.j7 --workers 2 --out new.csv",
    "start": "start --no-browser --port 0",
}
HIDDEN = b"\x1b[?25l"
"""What hides the cursor of a terminal."""

STOP_TIMEOUT = 2.0
"""How long a stop may take [s]; measured on a busy machine it is a tenth of that."""


def begin(words: str, folder: Path) -> subprocess.Popen[bytes]:
    """Start the program, and return when its first line, which starts a thread, has run."""
    process = subprocess.Popen(
        [sys.executable, "-c", BEGIN, *words.split()],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    assert process.stdout
    assert process.stdout.read(1) == b"."
    status = Path(f"/proc/{process.pid}/status")  # not on every system
    while status.exists() and "Threads:\t1\n" in status.read_text() and process.poll() is None:
        time.sleep(0.001)  # on a busy machine even the first line may take long
    return process


@pytest.mark.parametrize(
    ("command", "delay"),
    [
        ("help", 0.02), ("help", 0.15), ("balance", 0.3), ("balance", 0.6), ("report", 0.3),
        ("report", 1.5), ("sweep", 0.5), ("start", 0.5), ("start", 1.0),
    ],
)  # fmt: skip
def test_ctrl_c_stops_any_command_at_any_moment(command, delay, tmp_path) -> None:
    """As it starts, which is alike for all, as its modules are imported, and as it works."""
    process = begin(COMMANDS[command], tmp_path)
    with suppress(subprocess.TimeoutExpired):
        process.communicate(timeout=delay)
        return  # it was faster
    sent = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to workers too
    _, err = process.communicate(timeout=60)
    assert time.monotonic() - sent < STOP_TIMEOUT
    left = [path.name for path in tmp_path.iterdir()]
    if process.returncode == 0 and command not in ("start", "sweep"):
        return  # its work was done
    assert process.returncode == 130, err
    last = err.decode().splitlines()[-1]
    assert last.startswith("paminsa-viz: stopped")
    assert b"Traceback" not in err
    assert b"Error" not in err
    # A sweep's table holds whole rows; any other file is there completely or not at all.
    for name in left:
        assert name.startswith("new."), left
        assert (tmp_path / name).read_bytes().endswith(b"\n")


@pytest.mark.parametrize("command", ["synthesize cylinder", COMMANDS["sweep"]])
def test_a_terminal_has_its_cursor_again(command: str, tmp_path: Path) -> None:
    terminal, side = os.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", BEGIN, *command.split()],
        cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=side, start_new_session=True,
        env={**os.environ, "TERM": "xterm"},
    )  # fmt: skip
    os.close(side)
    shown = b""
    with suppress(OSError):  # the end of a terminal
        while text := os.read(terminal, 4096):
            if HIDDEN in text and HIDDEN not in shown:
                os.killpg(process.pid, signal.SIGINT)
            shown += text
    os.close(terminal)
    assert process.wait() == 130
    assert shown.count(HIDDEN) == 1
    _, _, after = shown.partition(HIDDEN)
    assert b"\x1b[?25h" in after
    line = after.splitlines()[-1]
    assert re.sub(rb"\x1b\[[?0-9]+[A-Za-z]", b"", line).startswith(b"paminsa-viz: stopped"), line


STOPPED_AT_IMPORT = """
import os, signal, sys
count = {count}
def stop(event, what):
    global count
    if event == "import":
        count -= 1
        if count == 0:
            os.kill(os.getpid(), signal.SIGINT)
from paminsa_viz.__main__ import main
sys.argv = ["paminsa-viz", "--version"]
sys.addaudithook(stop)
sys.exit(main())
"""
"""The program, which gets a stop at one of its imports."""


def test_the_program_imports_nothing_before_its_handler() -> None:
    code = (
        "import sys, _signal; before = set(sys.modules)\n"
        "from paminsa_viz.__main__ import main\n"
        "def handled(*_): print(*sorted(set(sys.modules) - before)); sys.exit()\n"
        "_signal.signal = handled; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["paminsa_viz", "paminsa_viz.__main__"], done.stderr


def test_ctrl_c_at_any_import_is_a_stop() -> None:
    for count in [*range(2, 12), 15, 20, 30, 45, 70]:  # the first one is that of the handler
        code = STOPPED_AT_IMPORT.format(count=count)
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        if done.stdout:
            assert count > 20, "the program has more imports than that"
            break
        assert (done.returncode, done.stderr) == (130, "paminsa-viz: stopped\n"), count


PLACES = {
    "half a file": "with open_atomically('new.txt') as file: print('half', file=file), wait()",
    "what catches everything": """
while True:
    try:
        wait()
    except BaseException:
        pass
""",
    "a callback of C": """
import ctypes
call = ctypes.CFUNCTYPE(None)
call(wait)()
wait()
""",
    "a native solver": """
import numpy as np
from scipy.optimize import linprog
draw = np.random.default_rng(1)
A = draw.uniform(size=(1500, 1500))
linprog(draw.uniform(size=1500), A_ub=-A, b_ub=-np.ones(1500))
wait()
""",
    "a step that hangs": "with interrupts.indivisible(): wait()",
}


@pytest.mark.parametrize("place", PLACES)
def test_no_place_swallows_a_stop_or_leaves_half_a_file(place, tmp_path) -> None:
    code = f"""
import os, signal, threading, time
from paminsa_viz import interrupts
from paminsa_viz.files.atomic import open_atomically
def wait(): time.sleep(30)
interrupts.exit_on_interrupt("test")
threading.Timer({1.0 if place == "a native solver" else 0.1}, os.kill,
    [os.getpid(), signal.SIGINT]).start()
{PLACES[place]}
"""
    start = time.monotonic()
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True)
    assert time.monotonic() - start < 15
    assert done.returncode == 130, done.stderr
    assert done.stderr == b"test: stopped\n"
    assert not list(tmp_path.iterdir())


def test_the_first_process_of_a_container_is_ended_by_sigterm(tmp_path) -> None:
    code = """
import os, signal, threading, time
from paminsa_viz import interrupts
from paminsa_viz.files.atomic import open_atomically
number = os.getpid()
os.getpid = lambda: 1
interrupts.exit_on_interrupt("test")
threading.Timer(0.1, os.kill, [number, signal.SIGTERM]).start()
with open_atomically("new.txt") as file:
    time.sleep(30)
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True)
    assert (done.returncode, done.stderr) == (143, b"test: stopped\n")  # as of any killed program
    assert not list(tmp_path.iterdir())
