"""The command line, run in this process."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from paminsa_viz import __version__
from paminsa_viz.cli import main
from paminsa_viz.files.columns import TRAJECTORY
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.trajectory import paper_like

SCREEN = 24 * 80
"""Characters on a screen of a terminal: more than that, and a refusal hides where it begins."""


def run(command: str, capsys, *words: str) -> tuple[int, str, str]:
    """Run a command; return its exit code, stdout and stderr."""
    code = main([command, *words])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def run_json(command: str, capsys, *words: str) -> Any:
    """Run a command with ``--json``; check that it succeeds silently, and return its result.

    Every result names the program first; a list of quantities is by their keys alone.
    """
    code, out, err = run(command, capsys, *words, "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    if "quantities" not in words:
        assert found.pop("made_by") == f"paminsa_viz {__version__}"
    return found


def check_refused(command: str, capsys, *words: str, place: str) -> None:
    """Check that a command fails with one line that names the place, and changes no file here."""
    before = {path: path.read_bytes() for path in Path().iterdir() if path.is_file()}
    code, out, err = run(command, capsys, *words)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert len(err) <= SCREEN
    assert place in err
    assert {path: path.read_bytes() for path in Path().iterdir() if path.is_file()} == before


def write_short_motion(path: Path, duration: float = 0.3) -> None:
    """Write a motion [s], 100 samples a second, as a table that commands read."""
    t = paper_like(APPENDIX_4.geometry).lasting(duration).sample(100)
    rows = np.column_stack([t.t, t.pose, t.velocity, t.acceleration]).tolist()
    lines = [TRAJECTORY.columns[: len(rows[0])], *(map(repr, row) for row in rows)]
    path.write_text("\n".join(map(",".join, lines)) + "\n")
