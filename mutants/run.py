"""Run the tests of a subpackage on changed copies of it: ``python -m mutants.run identification``.

The checkout is never changed: a copy in a temporary folder is, one file at a time, and goes with
the folder. A mutant is killed if a test fails, or if the tests take several times as long as
without it. What survives and is listed in ``mutants/equivalent.toml`` is equivalent: no test can
tell it from the source, for the reason that stands there.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import importlib
import math
import os
import pickle
import shutil
import signal
import sys
import tempfile
import time
import tomllib
import traceback
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import pytest

from mutants.draw import Key, Mutant, candidates, drawn
from mutants.record import Order, Record, Recorder, function_at, imported_of_others

ROOT = Path(__file__).resolve().parent.parent
_NEEDED = ("paminsa_viz", "tests", "assets", "docs", "examples", "benchmarks", "mutants")
_TESTS = "not browser"
_NO_TESTS, _BROKEN = 5, 99
_NOTED = "noted.pickle"
_PATIENCE = 10.0
"""A mutant may take so many times as long as the source, and ten minutes: machines are busy.

Processor time is limited test by test; this ends what waits for ever.
"""


class Copy:
    """A copy of the checkout in which one file at a time is changed.

    Each run of the tests is a fork of this process, which has imported what the tests need of
    other packages, but nothing of this one.
    """

    def __init__(self, folder: Path, tests: str = _TESTS, *, calling: bool = False) -> None:
        self.folder = folder
        self._calling = calling
        self._tests = tests
        for name in _NEEDED:
            ignored = shutil.ignore_patterns("__pycache__", ".hypothesis")
            shutil.copytree(ROOT / name, folder / name, ignore=ignored)
        for file in ROOT.glob("*.*"):
            if file.is_file():
                shutil.copy2(file, folder)
        self._changes = 0
        self._time = 0.0
        self._record = Record()

    def check(self, subpackage: str) -> None:
        """Run a subpackage's tests on the source as it is, which also compiles and warms up.

        Raises:
            SystemExit: If a test fails, or the tests do not import the copy.
        """
        self._record = Record()
        began = time.monotonic()
        code, output = self._run(subpackage, None)
        self._time = time.monotonic() - began
        noted = self.folder / _NOTED
        if code == _BROKEN or not noted.exists():
            raise SystemExit(f"the tests could not be run:\n{output}")
        self._record, imported = pickle.loads(noted.read_bytes())
        noted.unlink()
        if code not in (0, _NO_TESTS):  # noting takes time, which a test may have too little of
            code, output = self._run(subpackage, Order(self._record, None, "", only=False))
        if code not in (0, _NO_TESTS):
            raise SystemExit(f"{subpackage}: the tests fail without a change:\n{output}")
        for name in imported:
            with contextlib.suppress(Exception):
                importlib.import_module(name)

    def killer(self, subpackage: str, mutant: Mutant) -> str | None:
        """Return the test that fails with a change, or ``timeout``; None if none does."""
        file = self.folder / mutant.path
        source, stat = file.read_bytes(), file.stat()
        self._changes += 1
        place = function_at(mutant.path, source, mutant.line)
        order = Order(self._record, place, Path(mutant.path).stem, self._calling)
        try:
            file.write_bytes(mutant.apply(source))
            # Compiled files are told apart by whole seconds and size.
            os.utime(file, (stat.st_atime, stat.st_mtime + 10.0 * self._changes))
            code, output = self._run(subpackage, order)
            if code in (None, signal.SIGXCPU):
                return "timeout"
            if code == _BROKEN:
                raise SystemExit(f"the tests could not be run:\n{output}")
            if code in (0, _NO_TESTS):
                return None
            failed = [line for line in output.splitlines() if line[:6] in ("FAILED", "ERROR ")]
            return failed[0].split(" - ")[0] if failed else f"exit code {code}"
        finally:
            file.write_bytes(source)
            os.utime(file, (stat.st_atime, stat.st_mtime))

    def _run(self, subpackage: str, order: Order | None) -> tuple[int | None, str]:
        """Return exit code and output of a subpackage's tests; no code if they took too long.

        Without an order, what the tests do is noted.
        """
        output = self.folder / "output.txt"
        child = os.fork()
        if child == 0:
            self._become_tests(subpackage, order, output)
        limit = math.inf if order is None else time.monotonic() + 600.0 + _PATIENCE * self._time
        status = None
        try:
            while status is None and time.monotonic() < limit:
                ended, found = os.waitpid(child, os.WNOHANG)
                status = found if ended else None
                time.sleep(0.02)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
            if status is None:
                os.waitpid(child, 0)
        code = None if status is None else abs(os.waitstatus_to_exitcode(status))
        return code, output.read_text()

    def _become_tests(self, subpackage: str, order: Order | None, output: Path) -> NoReturn:
        """Run the tests in this process and end it."""
        os.setsid()
        os.chdir(self.folder)
        file = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, 1)
        os.dup2(file, 2)
        os.environ["PYTHONPATH"] = str(self.folder)
        sys.path[:] = [str(self.folder), *(one for one in sys.path if Path(one) != ROOT)]
        if order is not None:  # what is compiled of a changed file is of no use later
            os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
            sys.dont_write_bytecode = True
        first = [] if order is None else ["-x"]
        plugin = Recorder(self.folder, self._record) if order is None else order
        command = ["-q", "-n", "0", "--no-showlocals", "--tb=no", "-p", "no:cacheprovider"]
        code = _BROKEN
        try:
            code = int(
                pytest.main([*command, *first, "-m", self._tests, f"tests/{subpackage}"], [plugin])
            )
            if order is None:
                import paminsa_viz

                if not Path(str(paminsa_viz.__file__)).is_relative_to(self.folder):
                    print(f"the tests import {paminsa_viz.__file__}, not the copy")
                    code = _BROKEN
                imported = imported_of_others(self.folder)
                (self.folder / _NOTED).write_bytes(pickle.dumps((self._record, imported)))
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)


def equivalent() -> tuple[dict[Key, str], list[str]]:
    """Return the reasons of mutants that are equivalent, and what is wrong with the list.

    An entry is one mutant; where several of a file read the same, its ``numbers`` say which. What
    is no mutant of the source any more, or does not say which, counts for none.
    """
    table = tomllib.loads((ROOT / "mutants" / "equivalent.toml").read_text()).get("mutant", [])
    files = {path: ROOT / path for path in sorted({entry["path"] for entry in table})}
    known = {
        mutant.key
        for path, file in files.items()
        if file.exists()
        for mutant in candidates(path, file.read_bytes())
    }
    found: dict[Key, str] = {}
    wrong = []
    for entry in table:
        text = entry["path"], entry["code"], entry["before"], entry["after"]
        keys = [(*text, number) for number in entry.get("numbers", [0])]
        if not known.issuperset(keys):
            wrong.append(f"no mutant of the source any more: {' | '.join(text)}")
        elif "numbers" not in entry and (*text, 1) in known:
            wrong.append(f"one of several, `numbers` have to say which: {' | '.join(text)}")
        else:
            found |= dict.fromkeys(keys, entry["reason"])
    return found, wrong


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw mutants of subpackages, run their tests, print a table and, if asked for, write one."""
    parser = argparse.ArgumentParser(prog="mutants", description=__doc__)
    parser.add_argument("subpackages", nargs="+", help="folders of paminsa_viz that have tests")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30, help="mutants of each subpackage")
    parser.add_argument("--first", type=int, default=0, help="number of the first one to run")
    parser.add_argument("--only", type=int, nargs="+", help="numbers of those to run")
    parser.add_argument("--tests", default=_TESTS, help="which tests, as pytest's -m says it")
    parser.add_argument("--list", action="store_true", help="only list what is drawn")
    parser.add_argument("--out", type=Path, help="CSV file for one row a mutant, appended to")
    parser.add_argument(
        "--calling", action="store_true",
        help="only the tests that call the changed function, where any is seen to: quicker, but "
        "what lies in a cache is not called again, so that survivors have to be looked at",
    )  # fmt: skip
    given = parser.parse_args(arguments)
    for subpackage in given.subpackages:
        if not all((ROOT / place / subpackage).is_dir() for place in ("paminsa_viz", "tests")):
            parser.error(f"{subpackage}: a folder of paminsa_viz and of tests is needed")
    counts = Counter[tuple[str, str]]()
    reasons, wrong = equivalent()
    for problem in wrong:
        print(f"mutants/equivalent.toml: {problem}", file=sys.stderr)
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder, contextlib.ExitStack() as stack:
        file = writer = None
        if given.out is not None:
            file = stack.enter_context(given.out.open("a", newline=""))
            writer = csv.writer(file)
        copy = None
        if not given.list:
            copy = Copy(Path(folder).resolve(), given.tests, calling=given.calling)
        for subpackage in given.subpackages:
            if copy is not None:
                copy.check(subpackage)
            for number, mutant in enumerate(drawn(ROOT, subpackage, given.seed, given.count)):
                if number < given.first or (given.only and number not in given.only):
                    continue
                place = f"{mutant.path}:{mutant.line}:{mutant.column}"
                text = f"{subpackage} {number} {place}  {mutant.before}  →  {mutant.after}"
                if copy is None:
                    print(text)
                    continue
                if mutant.key in reasons:
                    verdict, detail = "equivalent", reasons[mutant.key]
                else:
                    killer = copy.killer(subpackage, mutant)
                    verdict, detail = ("survived", "") if killer is None else ("killed", killer)
                counts[subpackage, verdict] += 1
                print(f"{verdict:10} {text}  {detail}", flush=True)
                if writer is not None and file is not None:
                    row = (subpackage, given.seed, number, place, mutant.before, mutant.after)
                    writer.writerow((*row, verdict, detail))
                    file.flush()
    if given.list:
        return
    print(f"\n{'subpackage':16} mutants  killed  equivalent  survived  killed of the others")
    for subpackage in given.subpackages:
        killed, same, left = (counts[subpackage, k] for k in ("killed", "equivalent", "survived"))
        share = 100.0 * killed / max(1, killed + left)
        drawn_here = killed + same + left
        print(f"{subpackage:16} {drawn_here:7} {killed:7} {same:11} {left:9} {share:8.1f} %")


if __name__ == "__main__":
    main()
