"""Figures over time for print: PNG, SVG and PDF by matplotlib."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.plots import axes, ticks
from paminsa_viz.plots.curves_axes import Scale, time_marks, value_scale
from paminsa_viz.plots.curves_data import CurveData
from paminsa_viz.plots.curves_legend import Key, draw_keys, keys, rows_of
from paminsa_viz.plots.curves_panel import draw_panel
from paminsa_viz.plots.formats import Credits, check_size, drawing, figure_file
from paminsa_viz.plots.layout import Box
from paminsa_viz.plots.lettering import TextMetrics
from paminsa_viz.plots.page import Page

TWO_COLUMNS = 130.0  # mm; narrower figures have their panels below each other
LEAST_WIDTH = 60.0  # mm; below it headings would be cut

_RIGHT = 2.0  # at least; half a number stands beyond the end of the time axis
_BETWEEN = 5.0  # columns
_FOOT = 8.6  # below the lowest panels: numbers and axis label
_LABEL = 4.2  # left of the numbers of a value axis
_SHAPE = 0.42  # height over width of a panel
_HEIGHTS = (20.0, 60.0)  # mm
_TALLEST = 235.0  # mm; all panels together, so that a figure fits on a page


@dataclass(frozen=True)
class _Plan:
    """Where everything of a figure stands [mm]."""

    boxes: tuple[Box, ...]
    lowest: tuple[bool, ...]
    height: float


def render_curves(
    data: CurveData,
    kind: str = "png",
    *,
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
) -> bytes:
    """Draw a figure over time for print; the height follows from the width.

    Args:
        data: What to draw.
        kind: Name of a figure format.
        width_mm: Width on paper [mm]; 85 is a column, 170 a page.
        dpi: Pixels per inch of a PNG.
        title: Heading; None for the data's own, empty for none.
        caption: Whether what is shown, of which robot, stands below.

    Raises:
        InvalidInput: If kind, width or resolution is not possible.
    """
    check_size(kind, width_mm, dpi)
    if width_mm < LEAST_WIDTH:
        raise InvalidInput("width_mm", f"at least {LEAST_WIDTH:g} mm are needed")
    with drawing():
        page = _page(data, width_mm, dpi, data.title if title is None else title, caption)
        credits = Credits(data.title, data.summary, data.version)
        return figure_file(page.figure, kind, dpi, credits)


def _page(data: CurveData, width: float, dpi: float, title: str, caption: bool) -> Page:
    letters = TextMetrics(7.0 if width < TWO_COLUMNS else 8.0)
    large, small = TextMetrics(letters.size + 1.5, "bold"), TextMetrics(letters.size - 1.5)
    heading = large.wrapped(title, 0.96 * width - 2.0)
    above = (1.0 + len(heading) * large.line) if heading else 0.0
    scales = tuple(value_scale(panel) for panel in data.panels)
    columns = data.columns if width >= TWO_COLUMNS else 1
    plan = _arranged(data, scales, width, above, columns, letters, small)
    legend = rows_of(keys(data), width - 4.0, letters)
    foot = plan.height + len(legend) * letters.line + (2.0 if legend else 0.0)
    note = small.wrapped(" ".join(data.caption), 0.98 * width - 4.0) if caption else []
    page = Page(width, foot + (2.0 + len(note) * small.line if note else 1.0), dpi)
    for row, words in enumerate(heading):
        page.text(width / 2, 1.0 + row * large.line, words, size=large.size, ha="center",
                  va="top", weight="bold")  # fmt: skip
    marks = time_marks(data.time, plan.boxes[0].width, letters)
    for panel, scale, box, lowest in zip(data.panels, scales, plan.boxes, plan.lowest, strict=True):
        draw_panel(page, data, panel, scale, box, letters, small, marks, lowest)
    _legend(page, legend, plan.height + 1.0, letters)
    style: dict[str, Any] = {"size": small.size, "va": "top", "color": axes.GRID_TEXT}
    for row, words in enumerate(note):
        page.text(2.0, foot + 2.0 + row * small.line, words, **style)
    return page


def _legend(page: Page, legend: list[list[Key]], top: float, letters: TextMetrics) -> None:
    for row, entries in enumerate(legend):
        draw_keys(page, entries, top + (row + 0.5) * letters.line, letters)


def _arranged(
    data: CurveData,
    scales: tuple[Scale, ...],
    width: float,
    above: float,
    columns: int,
    letters: TextMetrics,
    small: TextMetrics,
) -> _Plan:
    """Place panels in reading order, as wide as numbers and labels at their left leave room."""
    count = len(data.panels)
    lefts = [
        1.0 + _LABEL + 2.2 + _widest(scales[column::columns], letters) for column in range(columns)
    ]
    last = ticks.number(float(data.time[-1]))
    right = max(_RIGHT, letters.width(last) / 2 + 0.7)
    each = (width - right - sum(lefts) - _BETWEEN * (columns - 1)) / columns
    rows = -(-count // columns)
    tall = min(max(min(each * _SHAPE, _TALLEST / rows - 8.0), _HEIGHTS[0]), _HEIGHTS[1])
    boxes: list[Box] = []
    top = above
    for row in range(rows):
        inside = data.panels[row * columns : (row + 1) * columns]
        lines = max(len(panel.readings) for panel in inside)
        # The name stands beside the first reading.
        top += 2.0 + letters.line + max(lines - 1, 0) * small.line
        left = 0.0
        for column in range(len(inside)):
            left += lefts[column]
            boxes.append(Box(left, top, each, tall))
            left += each + _BETWEEN
        top += tall
    lowest = tuple(index + columns >= count for index in range(count))
    return _Plan(tuple(boxes), lowest, top + _FOOT)


def _widest(scales: tuple[Scale, ...], letters: TextMetrics) -> float:
    """Return the width of the widest number on some value axes [mm]."""
    return max((letters.width(mark.words) for scale in scales for mark in scale.marks), default=0.0)
