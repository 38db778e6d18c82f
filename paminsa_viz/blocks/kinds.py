"""The kinds of blocks: tables, notes and figures before they become HTML or lines of a terminal."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeAlias

from paminsa_viz.palette import ACTUATOR_COLORS

if TYPE_CHECKING:
    from paminsa_viz.plots.series import FigureKind
    from paminsa_viz.trajectory import TrajectoryAnalysis


@dataclass(frozen=True)
class Fact:
    """A number or word with its label, set large.

    Attributes:
        label: What it is.
        value: Number with unit, or word.
        note: Text below it.
        kind: How it is: ``"ok"`` and ``"bad"`` are colored.
    """

    label: str
    value: str
    note: str = ""
    kind: Literal["plain", "ok", "bad"] = "plain"


@dataclass(frozen=True)
class Row:
    """A row of a table: its cells, and whether it is marked, a heading, or in an actuator's color.

    Attributes:
        cells: Texts; missing ones at the end stay empty.
        kind: ``"group"`` spans the table, ``"marked"`` is what differs, ``"total"`` sums up.
        color: ``#rrggbb`` of a mark at the first cell, or empty.
    """

    cells: tuple[str, ...]
    kind: Literal["plain", "group", "marked", "total"] = "plain"
    color: str = ""


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes:
        head: Headings of the columns.
        rows: Rows.
        caption: What it shows.
        words: How many columns from the left hold words; the others hold numbers.
        literal: Whether texts are set as they are, and not with symbols as in the paper.
        block: What a template tells the kind by, as of the others.
    """

    head: tuple[str, ...]
    rows: tuple[Row, ...]
    caption: str = ""
    words: int = 1
    literal: bool = False
    block: str = "table"


@dataclass(frozen=True, eq=False)
class Figure:
    """A figure as SVG, which is drawn when it is needed.

    Attributes:
        draw: Returns the image.
        alt: Alternative text.
        caption: Text below it; most figures contain their own caption.
        half: Whether it takes half the width.
        block: ``"figure"``.
    """

    draw: Callable[[], bytes]
    alt: str
    caption: str = ""
    half: bool = False
    block: str = "figure"

    @cached_property
    def svg(self) -> bytes:
        """The image."""
        return self.draw()

    @property
    def source(self) -> str:
        """The image as a data URL, so that names inside one SVG do not meet those of another."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.svg).decode()


@dataclass(frozen=True)
class Note:
    """A sentence or two.

    Attributes:
        text: The text.
        kind: ``"plain"`` is ordinary text, the others stand out.
        block: ``"note"``.
    """

    text: str
    kind: Literal["plain", "ok", "warn", "bad"] = "plain"
    block: str = "note"


@dataclass(frozen=True)
class Listing:
    """A text kept as it is, such as a file.

    Attributes:
        title: What it is.
        text: The text.
        block: ``"listing"``.
    """

    title: str
    text: str
    block: str = "listing"


Block: TypeAlias = Table | Figure | Note | Listing
"""What a subject is set as, from top to bottom."""


def series_figure(
    kind: FigureKind,
    analysis: TrajectoryAnalysis,
    alt: str,
    *,
    reference: TrajectoryAnalysis | None = None,
    title: str | None = None,
    caption: bool = False,
) -> Figure:
    """Return a figure over time; the arguments are those of `plots.series_figure`."""

    def draw() -> bytes:
        from paminsa_viz.plots.series_figure import figure_bytes  # late: matplotlib

        options = {"format": "svg", "title": title, "caption": caption}
        return figure_bytes(kind, analysis, reference=reference, **options)

    return Figure(draw, alt)


def rows(*cells: Sequence[str]) -> tuple[Row, ...]:
    """Return plain rows from sequences of cells."""
    return tuple(Row(tuple(each)) for each in cells)


def actuator_rows(*cells: Sequence[str]) -> tuple[Row, ...]:
    """Return the rows of M1 to M4, marked in their colors."""
    return tuple(
        Row(tuple(each), color=color) for each, color in zip(cells, ACTUATOR_COLORS, strict=True)
    )
