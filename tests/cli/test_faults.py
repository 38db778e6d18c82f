"""Faults of the system while a command writes: one line that names the file, exit code 2."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.test_synthesize import CASE

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="sets limits of a process"),
]

LIMITED = """
import io, json, resource, sys
from contextlib import redirect_stderr, redirect_stdout
sys.dont_write_bytecode = True  # of a module's bytecode too only the first bytes would be kept
from paminsa_viz.cli import main
_, most = resource.getrlimit(resource.RLIMIT_FSIZE)
found = []
for words, size in json.loads(sys.argv[1]):
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, most))
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as said:
        code = main(words.split())
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    found.append((code, said.getvalue()))
print(json.dumps(found))
"""
"""Commands whose files may not be longer than a size [bytes], one after the other."""

WRITERS = {
    "at.json": "synthesize small.toml --checkpoint at.json",
    "s.csv": "sweep --random 300 --vary links.b3 --cells 6 --workers 1 --out s.csv",
    "r.xml": "export --mjcf r.xml",
    "d.toml": "design default --out d.toml",
}


def test_a_limit_on_the_size_of_files_names_the_file(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(CASE)
    # Of a table in parts the head may fit, and a part of the rows.
    tried = [*((name, 40) for name in WRITERS), ("s.csv", 1000), ("s.csv", 9000)]
    given = json.dumps([(WRITERS[name], size) for name, size in tried])
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, given],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stderr == ""
    for (name, size), (code, said) in zip(tried, json.loads(done.stdout), strict=True):
        assert code == 2, (name, size, said)
        assert said.splitlines()[-1].startswith(f"paminsa-viz: {name}"), said
        assert "too large" in said
        if name != "s.csv":  # which is continued
            assert not (tmp_path / name).exists()


NOWHERE = """
from paminsa_viz.model.compiled import kernel

@kernel(nogil=True)
def double(x):
    return 2.0 * x

print(double(2.0))
"""
"""A kernel of no file, for which there is no folder, as without any that can be written to."""

EXCITE = "excite --evaluations 0 --seconds 0 --out e.csv"
"""The random motions that a search begins with."""


def test_no_folder_for_compiled_code_is_no_fault(capfd: pytest.CaptureFixture[str]) -> None:
    exec(compile(NOWHERE, "<string>", "exec"), {})
    assert capfd.readouterr() == ("4.0\n", "")


def test_no_output_to_print_on_is_no_fault(tmp_path: Path) -> None:
    """As where there is no console; `excite` tells on the error stream what it begins."""
    for closed, words in ((">&-", "--help"), ("<&- >&- 2>&-", EXCITE)):
        line = f"exec {closed}; exec {sys.executable} -m paminsa_viz {words}"
        done = subprocess.run(["sh", "-c", line], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, (words, done.stderr)
        assert "Error" not in done.stderr
    assert (tmp_path / "e.csv").read_text().endswith("\n")


def run_into(output: int, errors: int, words: str, folder: Path) -> tuple[int, str]:
    """Run a command with these streams; return its exit code, and what it says on a pipe."""
    # as a person's shell has it, where what is printed waits for the end
    environment = {name: of for name, of in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run(
        [sys.executable, "-m", "paminsa_viz", *words.split()],
        stdout=output, stderr=errors, text=True, cwd=folder, env=environment,
    )  # fmt: skip
    return done.returncode, done.stderr or ""


@pytest.fixture
def gone() -> Iterator[int]:
    """A pipe whose reader has gone."""
    reading, writing = os.pipe()
    os.close(reading)
    yield writing
    os.close(writing)


@pytest.mark.parametrize("words", ["--version", "design --help", "design default", "loads --json"])
def test_a_reader_that_has_gone_and_a_full_disk_end_a_command_in_one_way(
    gone: int, words: str, tmp_path: Path
) -> None:
    """Python itself would report either once more at its exit, and end with 120.

    All but the last are shorter than what Python gathers before it writes.
    """
    assert run_into(gone, subprocess.PIPE, words, tmp_path) == (1, "")
    if Path("/dev/full").exists():
        with open("/dev/full", "w") as full:
            said = "paminsa-viz: the output: cannot be written: no space left on device\n"
            assert run_into(full.fileno(), subprocess.PIPE, words, tmp_path) == (2, said)


def test_work_goes_on_though_nobody_reads_how_far_it_is(gone: int, tmp_path: Path) -> None:
    assert run_into(subprocess.DEVNULL, gone, EXCITE, tmp_path) == (0, "")
    assert (tmp_path / "e.csv").read_text().endswith("\n")
    assert run_into(subprocess.DEVNULL, gone, "evaluate nothing.csv", tmp_path) == (2, "")
