"""Reads tables out of texts of the page."""

from __future__ import annotations

import re
from collections.abc import Iterable
from html import unescape

from paminsa_viz.blocks.kinds import Block, Table
from paminsa_viz.explorer.state.pins import can_be_pinned
from paminsa_viz.units import symbols_html

Cells = list[list[str]]


def tables_in(text: str) -> list[Cells]:
    """Return the texts of the cells of each table in HTML, row by row."""
    return [_cells(table) for table in re.findall(r"<table.*?</table>", text, re.S)]


def plain(text: str) -> str:
    """Return the text of HTML without its elements."""
    return unescape(re.sub(r"<[^>]*>", "", text)).strip()


def _cells(table: str) -> Cells:
    rows = re.findall(r"<tr[^>]*>(.*?)</tr>", table, re.S)
    return [[plain(cell) for cell in re.findall(r"<t[hd].*?</t[hd]>", row, re.S)] for row in rows]


def value(text: str) -> float:
    """Return the number that a cell begins with, as the page writes it."""
    return float(text.split()[0].replace("−", "-"))


def assert_parts(text: str, blocks: Iterable[Block]) -> None:
    """Assert that all tables of a text of the page are parts of those of blocks.

    A table of the page has some of the columns, or some of the columns as rows, with the same
    texts. What can be pinned in it are numbers that can be.
    """
    whole = [as_set(block) for block in blocks if isinstance(block, Table)]
    shown = [[[cell for cell in row if cell] for row in table] for table in tables_in(text)]
    assert shown, "there is no table"
    for table in shown:
        found = any(_is_part(table, one) for known in whole for one in (known, _turned(known)))
        assert found, f"no block has {table}"
    for key in re.findall(r'data-paminsa-send="pin" data-paminsa-value="([^"]*)"', text):
        assert can_be_pinned(key), key


def as_set(table: Table) -> Cells:
    """Return the texts of a table as the page sets them."""

    def text(cell: str) -> str:
        return plain(cell if table.literal else symbols_html(cell))

    rows = [table.head, *(row.cells for row in table.rows)]
    return [[text(cell) for cell in row] + [""] * (len(table.head) - len(row)) for row in rows]


def _turned(cells: Cells) -> Cells:
    return [list(column) for column in zip(*cells, strict=True)]


def _is_part(part: Cells, whole: Cells) -> bool:
    """Whether each row of a table is, in order, some of the cells of a row of another."""
    rest = iter(whole)
    return all(any(_is_within(row, other) for other in rest) for row in part)


def _is_within(row: list[str], other: list[str]) -> bool:
    cells = iter(other)
    return all(any(cell == one for one in cells) for cell in row)
