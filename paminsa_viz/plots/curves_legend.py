"""The key below a figure over time: strokes, marks and shading with what they mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from paminsa_viz.palette import INK, MUTED
from paminsa_viz.plots.curves_data import CurveData, Dash
from paminsa_viz.plots.curves_panel import DASHES, FAILED, FAILED_EDGE
from paminsa_viz.plots.lettering import TextMetrics, in_rows
from paminsa_viz.plots.page import Page

_SAMPLE = 8.0  # mm
_AFTER_SAMPLE = 1.5
_BETWEEN = 6.0


@dataclass(frozen=True)
class Key:
    """One entry: what is drawn, and its meaning."""

    words: str
    form: Literal["stroke", "ring", "shade"] = "stroke"
    color: str = INK
    dash: Dash = "solid"
    width: float = 1.0


def keys(data: CurveData) -> list[Key]:
    """Return the entries that a figure needs; a single curve in every panel needs none."""
    found = [Key(t.label, "stroke", t.color, t.dash, t.width) for t in data.legend]
    if any(panel.peaks for panel in data.panels):
        found.append(Key("largest in size", "ring"))
    if any(panel.levels for panel in data.panels):
        found.append(Key("RMS", "stroke", MUTED, "dashdot", 0.6))
    if data.failures:
        reasons = list(dict.fromkeys(each.reason for each in data.failures))
        more = f" and {len(reasons) - 2} more" if len(reasons) > 2 else ""
        what = "stopped" if data.kind == "tracking" else "fails"
        found.append(Key(f"{what}: {', '.join(reasons[:2])}{more}", "shade"))
    return found


def rows_of(entries: list[Key], width: float, letters: TextMetrics) -> list[list[Key]]:
    """Break entries into rows no wider than ``width`` [mm]."""
    return in_rows(entries, [_width(entry, letters) for entry in entries], _BETWEEN, width)


def draw_keys(page: Page, entries: list[Key], y: float, letters: TextMetrics) -> None:
    """Draw one row in the middle of the page at a height [mm]."""
    total = sum(_width(entry, letters) for entry in entries) + _BETWEEN * (len(entries) - 1)
    left = (page.width - total) / 2
    for entry in entries:
        _draw_sample(page, entry, left, y)
        page.text(left + _SAMPLE + _AFTER_SAMPLE, y, letters.plain(entry.words),
                  size=letters.size, va="center_baseline")  # fmt: skip
        left += _width(entry, letters) + _BETWEEN


def _width(entry: Key, letters: TextMetrics) -> float:
    return _SAMPLE + _AFTER_SAMPLE + letters.width(letters.plain(entry.words))


def _draw_sample(page: Page, entry: Key, left: float, y: float) -> None:
    up = 1 - y / page.height
    ends = [left / page.width, (left + _SAMPLE) / page.width]
    if entry.form == "shade":
        tall = 2.4 / page.height
        page.figure.add_artist(
            Rectangle(
                (ends[0], up - tall / 2),
                ends[1] - ends[0],
                tall,
                fc=FAILED,
                ec=FAILED_EDGE,
                lw=0.5,
                transform=page.figure.transFigure,
            )
        )
    elif entry.form == "ring":
        page.figure.add_artist(
            Line2D(
                [sum(ends) / 2],
                [up],
                marker="o",
                ms=4.0,
                mfc="white",
                mec=entry.color,
                mew=0.9,
                ls="none",
            )
        )
    else:
        page.figure.add_artist(
            Line2D(ends, [up, up], color=entry.color, lw=entry.width, ls=DASHES[entry.dash])
        )
