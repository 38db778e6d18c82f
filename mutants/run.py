"""Run the tests of a room on changed copies of it: ``python -m mutants.run identification``.

The checkout is never changed: a copy in a temporary folder is, one file at a time, and goes with
the folder. A mutant is killed if a test fails, or if the tests take several times as long as
without it. What survives and is listed in ``mutants/equivalent.toml`` is equivalent: no test can
tell it from the source, for the reason that stands there.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from mutants.draw import Mutant, drawn

ROOT = Path(__file__).resolve().parent.parent
_NEEDED = ("paminsa_viz", "tests", "assets", "docs", "examples", "benchmarks", "mutants")
_STEPS = ("not slow and not browser", "slow and not browser")
_NO_TESTS = 5
_PATIENCE = 3.0
"""A mutant may take so many times as long as the source, and five minutes: machines are busy."""


class Copy:
    """A copy of the checkout in which one file at a time is changed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in _NEEDED:
            ignored = shutil.ignore_patterns("__pycache__", ".hypothesis")
            shutil.copytree(ROOT / name, folder / name, ignore=ignored)
        for file in ROOT.glob("*.*"):
            if file.is_file():
                shutil.copy2(file, folder)
        self._changes = 0
        self._times: dict[tuple[str, str], float] = {}

    def check(self, room: str) -> None:
        """Run a room's tests on the source as it is, which also compiles and warms up.

        Raises:
            SystemExit: If a test fails, or the tests do not import the copy.
        """
        code = "import paminsa_viz; print(paminsa_viz.__file__)"
        place = subprocess.run(
            [sys.executable, "-c", code], cwd=self.folder, env=self._environment(), text=True,
            capture_output=True, check=True,
        ).stdout.strip()  # fmt: skip
        if not Path(place).is_relative_to(self.folder):
            raise SystemExit(f"the tests would import {place}, not the copy")
        output = ""
        for step in _STEPS:
            began = time.monotonic()
            code, output = self._tests(room, step, None, "")
            self._times[room, step] = time.monotonic() - began
            if code not in (0, _NO_TESTS):
                raise SystemExit(f"{room}: the tests fail without a change:\n{output}")

    def killer(self, room: str, mutant: Mutant) -> str | None:
        """Return the test that fails with a change, or ``timeout``; None if none does."""
        file = self.folder / mutant.path
        source, stat = file.read_bytes(), file.stat()
        self._changes += 1
        try:
            file.write_bytes(mutant.apply(source))
            # Compiled files are told apart by whole seconds and size.
            os.utime(file, (stat.st_atime, stat.st_mtime + 10.0 * self._changes))
            for step in _STEPS:
                limit = 300.0 + _PATIENCE * self._times[room, step]
                code, output = self._tests(room, step, limit, Path(mutant.path).stem)
                if code is None:
                    return "timeout"
                if code not in (0, _NO_TESTS):
                    failed = [
                        line for line in output.splitlines() if line[:6] in ("FAILED", "ERROR ")
                    ]
                    return failed[0].split(" - ")[0] if failed else f"exit code {code}"
            return None
        finally:
            file.write_bytes(source)
            os.utime(file, (stat.st_atime, stat.st_mtime))

    def _tests(
        self, room: str, step: str, limit: float | None, first: str
    ) -> tuple[int | None, str]:
        """Return exit code and output of a room's tests; no code if they took too long.

        The files that name the module ``first`` come first: they are the likeliest to fail.
        """
        files = sorted((self.folder / "tests" / room).rglob("test_*.py"))
        files.sort(key=lambda file: first not in file.name and first not in file.read_text())
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "--no-showlocals"]
        command += ["--tb=no", "-p", "no:cacheprovider", "-m", step, *map(str, files)]
        process = subprocess.Popen(
            command, cwd=self.folder, env=self._environment(writes=limit is None), text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            return _finished(process, limit)
        except subprocess.TimeoutExpired:
            return None, ""
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    def _environment(self, *, writes: bool = True) -> dict[str, str]:
        """Return the environment of the tests; Python leaves compiled files only if it may."""
        found = {**os.environ, "PYTHONPATH": str(self.folder)}
        return found if writes else {**found, "PYTHONDONTWRITEBYTECODE": "1"}


def _finished(process: subprocess.Popen[str], limit: float | None) -> tuple[int, str]:
    output = process.communicate(timeout=limit)[0]
    return process.returncode, output


def equivalent() -> dict[tuple[str, str, str, str], str]:
    """Return the reasons of mutants that are equivalent, by file, line of code, before, after."""
    table = tomllib.loads((ROOT / "mutants" / "equivalent.toml").read_text())
    return {
        (entry["path"], entry["code"], entry["before"], entry["after"]): entry["reason"]
        for entry in table.get("mutant", [])
    }


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw mutants of rooms, run their tests, print a table and, if asked for, write one."""
    parser = argparse.ArgumentParser(prog="mutants", description=__doc__)
    parser.add_argument("rooms", nargs="+", help="folders of paminsa_viz that have tests")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30, help="mutants of each room")
    parser.add_argument("--first", type=int, default=0, help="number of the first one to run")
    parser.add_argument("--list", action="store_true", help="only list what is drawn")
    parser.add_argument("--out", type=Path, help="CSV file for one row a mutant, appended to")
    given = parser.parse_args(arguments)
    for room in given.rooms:
        if not (ROOT / "paminsa_viz" / room).is_dir() or not (ROOT / "tests" / room).is_dir():
            parser.error(f"{room}: a folder of paminsa_viz and of tests is needed")
    reasons, counts = equivalent(), Counter[tuple[str, str]]()
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder, contextlib.ExitStack() as stack:
        file = writer = None
        if given.out is not None:
            file = stack.enter_context(given.out.open("a", newline=""))
            writer = csv.writer(file)
        copy = None if given.list else Copy(Path(folder))
        for room in given.rooms:
            if copy is not None:
                copy.check(room)
            for number, mutant in enumerate(drawn(ROOT, room, given.seed, given.count)):
                if number < given.first:
                    continue
                place = f"{mutant.path}:{mutant.line}:{mutant.column}"
                text = f"{room} {number} {place}  {mutant.before}  →  {mutant.after}"
                key = (mutant.path, mutant.code, mutant.before, mutant.after)
                if copy is None:
                    print(text)
                    continue
                if key in reasons:
                    verdict, detail = "equivalent", reasons[key]
                else:
                    killer = copy.killer(room, mutant)
                    verdict, detail = ("survived", "") if killer is None else ("killed", killer)
                counts[room, verdict] += 1
                print(f"{verdict:10} {text}  {detail}", flush=True)
                if writer is not None and file is not None:
                    row = (room, given.seed, number, place, mutant.before, mutant.after)
                    writer.writerow((*row, verdict, detail))
                    file.flush()
    if given.list:
        return
    print(f"\n{'room':16} mutants  killed  equivalent  survived  killed of the others")
    for room in given.rooms:
        killed, same, left = (counts[room, k] for k in ("killed", "equivalent", "survived"))
        share = 100.0 * killed / max(1, killed + left)
        print(f"{room:16} {killed + same + left:7} {killed:7} {same:11} {left:9} {share:8.1f} %")


if __name__ == "__main__":
    main()
