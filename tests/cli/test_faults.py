"""Faults of the system while a command writes: one line that names the file, exit code 2."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.test_synthesize import CASE

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="sets limits of a process"),
]

LIMITED = """
import resource, sys
sys.dont_write_bytecode = True  # of a module's bytecode too only the first bytes would be kept
from paminsa_viz.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))
sys.exit(main({words!r}))
"""
"""A command whose files may not be longer than a size [bytes]."""

WRITERS = {
    "at.json": "synthesize small.toml --checkpoint at.json",
    "s.csv": "sweep --random 300 --vary links.b3 --cells 6 --workers 1 --out s.csv",
    "r.xml": "export --mjcf r.xml",
    "d.toml": "design default --out d.toml",
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_limit_on_the_size_of_files_names_the_file(name: str, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(CASE)
    # Of a table in parts the head may fit, and a part of the rows.
    for size in (40, 1000, 9000) if name == "s.csv" else (40,):
        code = LIMITED.format(size=size, words=WRITERS[name].split())
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True
        )
        assert done.returncode == 2, done.stderr
        assert done.stderr.splitlines()[-1].startswith(f"paminsa-viz: {name}"), done.stderr
        assert "too large" in done.stderr
        assert "Traceback" not in done.stderr
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


def test_no_folder_for_compiled_code_is_no_fault() -> None:
    done = subprocess.run([sys.executable, "-c", NOWHERE], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("4.0\n", "")
