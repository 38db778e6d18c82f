"""What blocks say, as plain texts."""

from __future__ import annotations

from typing import Any

from paminsa_viz.blocks.kinds import Block, Note, Table


def cells(block: Block) -> list[tuple[str, ...]]:
    """The cells of a table, row by row."""
    assert isinstance(block, Table)
    return [tuple(map(str, row.cells)) for row in block.rows]


def said(blocks: Any) -> list[tuple[str, str]]:
    """Texts and kinds of the notes among blocks."""
    return [(block.text, block.kind) for block in blocks if isinstance(block, Note)]
