"""Reads tables out of texts of the page."""

from __future__ import annotations

import re
from html import unescape

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
