"""``report``: one command, one file."""

from __future__ import annotations

from pathlib import Path

import pytest

from paminsa_viz.cli import main

pytestmark = pytest.mark.slow


def test_one_command_makes_it(folder, capsys) -> None:
    words = "--out r.html --no-verify --preset arch --assembly mirror --pose 30 0 10 520 --seed 4"
    assert main(["report", *words.split()]) == 0
    printed = capsys.readouterr()
    assert printed.out == "r.html: written\n"
    assert "torque maps ..." in printed.err
    text = Path("r.html").read_text(encoding="utf-8")
    assert f"paminsa-viz report {words}" in text
    assert "Upper knee, pose x 30 mm" in text
    assert "pick-and-place arch" in text
    assert [path.name for path in folder.iterdir()] == ["r.html"]
