"""A folder of its own for each test of a command, and a shorter search for a motion."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch, parsers_made_once) -> Path:
    """The working folder, empty."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def few_random_motions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let ``excite`` start from 20 of them, as the first 300 would take longest."""
    from paminsa_viz.cli import excite

    few = partial(excite.ExcitationSettings, random=20)
    monkeypatch.setattr(excite, "ExcitationSettings", few)
