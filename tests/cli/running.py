"""Commands as a person or a program runs them, in this process."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from paminsa_viz.cli import main


def run(command: str, capsys, *words: str) -> tuple[int, str, str]:
    """Run a command; return its exit code and what it says on stdout and stderr."""
    code = main([command, *words])
    said = capsys.readouterr()
    return code, said.out, said.err


def told(command: str, capsys, *words: str) -> Any:
    """Run a command that succeeds without a complaint; return its JSON."""
    code, out, err = run(command, capsys, *words, "--json")
    assert (code, err) == (0, "")
    return json.loads(out)


def check_refused(command: str, capsys, *words: str, place: str) -> None:
    """Check that a command complains in one line with the place, and leaves no file here."""
    before = {path: path.read_bytes() for path in Path().iterdir() if path.is_file()}
    code, out, err = run(command, capsys, *words)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert place in err
    assert {path: path.read_bytes() for path in Path().iterdir() if path.is_file()} == before
