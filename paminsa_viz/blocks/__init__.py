"""The words of results: a subject's tables, sentences and figures, written once.

A subject is a file, which turns its results into blocks (`kinds`): tables with headings, symbols
and units, notes, and figures that are drawn when they are needed. The report sets blocks as HTML
and commands print them as text. Nothing is imported here, since the results of some subjects are
slow to import.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.blocks.kinds import Block, Cell, Fact, Figure, Listing, Note, Row, Table

__all__ = ["Block", "Cell", "Fact", "Figure", "Listing", "Note", "Row", "Table"]

__getattr__ = late_names(__name__)
