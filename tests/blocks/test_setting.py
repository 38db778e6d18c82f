"""Blocks as text and HTML: whole tables, every cell in both, and no number where there is none."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from html import unescape
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks.kinds import Block, Note, Table
from paminsa_viz.cli.output import ascii_numbers, print_blocks
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.report.page import COLORS, template
from paminsa_viz.report.request import Section
from paminsa_viz.units import NONE, symbols_html
from tests.blocks.test_units import SUBJECTS, robot

NO_NUMBER = re.compile(r"\b(nan|NaN|None|inf)\b")
HYPHEN = re.compile(r"(?<![\w.−])-(?=[\d.])| - |\)-")
"""One in the place of a minus sign."""


def blocks_of(subject: str, pose: Sequence[float], shift: float = 0.0) -> list[Block]:
    design, motion = robot()
    motion = replace(motion, pose=motion.pose + shift)
    return list(SUBJECTS[subject](design, motion, np.array(pose), 1.0))


def html_of(blocks: Sequence[Block]) -> str:
    text = template().render(
        kind="report", title="", design="", lines=[], opening=[], colors=COLORS, version="",
        sections=[(1, Section("one", "One", tuple(blocks)))], made=f"{datetime.now(UTC)}",
    )  # fmt: skip
    return unescape(re.sub(r"\s+", " ", text))


def check_set(blocks: Sequence[Block], capsys: Any) -> None:
    """Check that every cell is in the text and in the page, and none is a word for no number."""
    blocks = [block for block in blocks if isinstance(block, (Note, Table))]
    capsys.readouterr()
    print_blocks(blocks)
    printed, page = capsys.readouterr().out, html_of(blocks)
    assert not re.search(r'class="(| [^"]*)"', page)
    for block in blocks:
        if isinstance(block, Note):
            assert not NO_NUMBER.search(block.text), block.text
            assert not HYPHEN.search(block.text), block.text
            assert ascii_numbers(block.text) in printed
            continue
        assert ascii_numbers(block.caption) in printed
        for row in block.rows:
            assert len(row.cells) <= max(len(block.head), 1)
            for cell in row.cells:
                assert not NO_NUMBER.search(cell), (block.caption, row.cells)
                assert not HYPHEN.search(cell), (block.caption, row.cells)
                assert ascii_numbers(cell) in printed
                assert cell in page or unescape(symbols_html(cell)) in page, cell


@pytest.mark.parametrize("subject", [name for name in SUBJECTS if name != "simulation"])
def test_what_has_no_value_is_a_dash_or_a_reason(subject: str) -> None:
    """At a singular pose, with a motion that is out of reach from its start."""
    design, _ = robot()
    singular = (0.0, 0.0, singular_rotation(design.geometry), -0.5)
    for block in blocks_of(subject, singular, shift=3.0):
        texts = [block.text] if isinstance(block, Note) else []
        if isinstance(block, Table):
            texts = [cell for row in block.rows for cell in row.cells]
        for text in texts:
            assert not NO_NUMBER.search(text), text
            assert not re.search(rf"{NONE} ?(m|N|°|W|kg|%)", text), text
