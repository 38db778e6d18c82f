"""The kinds of blocks: tables, notes and figures before they become HTML or lines of a terminal.

The report and commands set whole tables; the page, which is narrow, sets parts of them, see
`Table.columns` and `Table.turned`. What a number is stands in the headings of its column or its
row, with the unit in brackets, see `heading`.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, Self, SupportsFloat, TypeAlias

from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.units import display_unit, fixed, number

if TYPE_CHECKING:
    from paminsa_viz.plots.series import FigureKind
    from paminsa_viz.trajectory import TrajectoryAnalysis

CellKind: TypeAlias = Literal["plain", "ok", "bad", "muted"]


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


class Cell(str):
    """The text of a cell, with what the page makes of it besides; all others set the text alone.

    Attributes:
        quantity: Key of the quantity that it is the value of, by which it can be pinned.
        hint: What a tooltip says.
        kind: How it is, by its color.
        share: Length of a bar that stands for it, 0 to 1; NaN for none.
    """

    quantity: str
    hint: str
    kind: CellKind
    share: float

    def __new__(
        cls, text: str, *, quantity: str = "", hint: str = "", kind: CellKind = "plain",
        share: float = math.nan,
    ) -> Self:  # fmt: skip
        """Return the text with what is told of it."""
        made = super().__new__(cls, text)
        made.quantity, made.hint, made.kind, made.share = quantity, hint, kind, share
        return made


@dataclass(frozen=True)
class Row:
    """A row of a table: its cells, and whether it is marked, a heading, or in an actuator's color.

    Attributes:
        cells: Texts, some of them a `Cell`; missing ones at the end stay empty.
        kind: ``"group"`` spans the table, ``"marked"`` is what differs, ``"total"`` sums up,
            ``"muted"`` is what counts for little.
        color: ``#rrggbb`` of a mark at the first cell, or empty.
        hint: What a tooltip says of the row.
        level: Whether what it says holds, for a mark before it: ``"warn"`` is as far as is known,
            ``"none"`` is not known; empty without a mark.
    """

    cells: tuple[str, ...]
    kind: Literal["plain", "group", "marked", "total", "muted"] = "plain"
    color: str = ""
    hint: str = ""
    level: Literal["", "ok", "warn", "bad", "none"] = ""


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

    @property
    def marked(self) -> bool:
        """Whether its rows have marks before them."""
        return any(row.level for row in self.rows)

    def columns(self, *places: int, hint: int | None = None) -> Table:
        """Return the table with these columns alone, in this order.

        Args:
            places: Indices of the columns, those of words first.
            hint: Index of a column that becomes the rows' tooltip.
        """

        def chosen(row: Row) -> Row:
            cells = tuple(row.cells[i] for i in places if i < len(row.cells))
            if hint is None or hint >= len(row.cells):
                return replace(row, cells=cells)
            texts = filter(None, (row.cells[hint], row.hint))
            return replace(row, cells=cells, hint="; ".join(texts))

        words = sum(place < self.words for place in places)
        head, found = tuple(self.head[i] for i in places), tuple(map(chosen, self.rows))
        return replace(self, head=head, rows=found, words=words)

    def turned(self, *places: int) -> Table:
        """Return the table with its rows as columns, and these of its columns as rows."""
        head = (self.head[0], *(row.cells[0] for row in self.rows))
        found = tuple(
            Row((self.head[i], *(row.cells[i] if i < len(row.cells) else "" for row in self.rows)))
            for i in places
        )
        return replace(self, head=head, rows=found, words=1)


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
        kind: ``"plain"`` is ordinary text, ``"muted"`` small print, the others stand out.
        block: ``"note"``.
    """

    text: str
    kind: Literal["plain", "muted", "ok", "warn", "bad"] = "plain"
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

        return figure_bytes(
            kind, analysis, reference=reference, format="svg", title=title, caption=caption
        )

    return Figure(draw, alt)


def heading(name: str, unit: str) -> str:
    """Return the heading of numbers of an SI unit that are shown without it: ``x [mm]``."""
    shown = display_unit(unit).text
    return f"{name} [{shown}]" if shown else name


def shown(value: SupportsFloat, unit: str, digits: int = 3) -> str:
    """Return a number of an SI unit below or beside a `heading`, with zeros at its end.

    It has as many significant digits, and below a million all of those before the point.
    """
    scaled = float(value) * display_unit(unit).factor
    if 10**digits <= abs(scaled) < 1e6:
        return fixed(scaled, 0)
    return number(scaled, digits, padded=True)


def aligned(values: Iterable[SupportsFloat], unit: str, digits: int = 3) -> tuple[str, ...]:
    """Return numbers of an SI unit with the decimals that the largest of them has by `shown`.

    Numbers that would have more than two zeros behind the point are short, each by itself.
    """
    scaled = [float(value) * display_unit(unit).factor for value in values]
    size = max((abs(value) for value in scaled if math.isfinite(value)), default=0.0)
    decimals = digits - 1 - math.floor(math.log10(size)) if size else 0
    if decimals > digits + 2:
        return tuple(number(value, digits) for value in scaled)
    return tuple(fixed(value, max(decimals, 0)) for value in scaled)


def rows(*cells: Sequence[str]) -> tuple[Row, ...]:
    """Return plain rows from sequences of cells."""
    return tuple(Row(tuple(each)) for each in cells)


def actuator_rows(*cells: Sequence[str]) -> tuple[Row, ...]:
    """Return the rows of M1 to M4, marked in their colors."""
    return tuple(
        Row(tuple(each), color=color) for each, color in zip(cells, ACTUATOR_COLORS, strict=True)
    )
