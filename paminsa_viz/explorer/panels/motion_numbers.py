"""Tables of the motion's curves: what they are at the time cursor, at most, and on average."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from paminsa_viz.explorer.motion.results import MotionResults
from paminsa_viz.palette import BAD, INK, MUTED, OK
from paminsa_viz.plots.series import Dash, Statistics, Trace
from paminsa_viz.plots.series_uplot import Chart
from paminsa_viz.units import number

NOTHING = '<div class="paminsa-numbers"></div>'


def numbers_html(drawn: tuple[Chart, ...], read: dict[Trace, Statistics], time: float) -> str:
    """Return the table of the curves: the value at the cursor, the largest one, the RMS.

    Args:
        drawn: The charts.
        read: Peak and RMS of every curve.
        time: Of the cursor [s].
    """
    if not drawn:
        return NOTHING
    rows = []
    for chart, trace in _rows(drawn):
        peak, peak_t, mean = read[trace]
        cells = (
            f"<b>{written(chart.value_at(trace, time))}</b>", written(peak),
            f"{peak_t:.3f} s" if np.isfinite(peak_t) else "–", written(mean), chart.unit,
        )  # fmt: skip
        rows.append((trace, cells))
    return _table((f"at {time:.3f} s", "largest", "at", "RMS", ""), rows)


def _rows(drawn: tuple[Chart, ...]) -> list[tuple[Chart, Trace]]:
    """Return the curves in the order of their rows: the design's of all charts before others."""
    rows = [(chart, trace) for chart in drawn for trace in chart.traces if not trace.marks]
    return sorted(
        rows, key=lambda row: ("", "reference", "as published").index(row[1].suffix or "")
    )


def difference_html(drawn: tuple[Chart, ...], found: MotionResults, time: float) -> str:
    """Return the table of differences to an engine, over the largest torque, with a verdict."""
    check = found.answer.found if found.answer else None
    shares: dict[str, list[float]] = {}
    if check is not None:
        for suffix, analysis in (("", found.analysis), ("as published", found.sources.published)):
            if analysis is not None:
                shares[suffix] = check.comparison(analysis).relative.tolist()
    rows = []
    for chart, trace in _rows(drawn):
        if check is None:
            rows.append((trace, ("<b>–</b>", "–", "–", "", "–", "")))
            continue
        values = trace.values[np.isfinite(trace.values)]
        share = shares[trace.suffix or ""].pop(0)
        cells = (
            f"<b>{written(chart.value_at(trace, time))}</b>",
            written(float(np.abs(values).max())),
            written(float(np.sqrt((values**2).mean()))),
            chart.unit,
            number(share, 2),
            verdict(share <= check.tolerance),
        )
        rows.append((trace, cells))
    heads = (f"at {time:.3f} s", "largest", "RMS", "", "relative", "")
    return _table(heads, rows)


def verdict(passed: bool) -> str:
    """Return whether a comparison is passed, in its color."""
    word, color = ("PASS", OK) if passed else ("FAIL", BAD)
    return f'<b style="color:{color}">{word}</b>'


def stroke(color: str, dash: Dash) -> str:
    """Return a short piece of a curve for a table."""
    style = "dashed" if dash == "dashdot" else dash
    return (
        f'<span style="display:inline-block;width:16px;border-top:2.5px {style} {color};'
        'vertical-align:middle;margin-right:6px"></span>'
    )


def written(value: float) -> str:
    """Write a value of a curve shortly; rounding of the arithmetic as 0."""
    if not np.isfinite(value):
        return "–"
    return number(value if abs(value) > 1e-12 else 0.0, 4)


def _table(heads: Sequence[str], rows: Iterable[tuple[Trace, Sequence[str]]]) -> str:
    """Return a table with a row for each curve."""
    cell = "padding:0 0 0 10px;text-align:right;white-space:nowrap"
    lines = [
        f'<tr style="color:{MUTED}"><th></th>'
        + "".join(f'<th style="{cell};font-weight:600">{head}</th>' for head in heads)
        + "</tr>"
    ]
    lines += [
        f'<tr><td style="white-space:nowrap">{stroke(trace.color, trace.dash)}'
        f"{escape(trace.label)}</td>"
        + "".join(f'<td style="{cell}">{text}</td>' for text in cells)
        + "</tr>"
        for trace, cells in rows
    ]
    return (
        '<div class="paminsa-numbers" data-testid="motion-numbers" style="max-height:118px;'
        'overflow-y:auto"><table style="width:100%;border-collapse:collapse;font-size:12px;'
        f'line-height:1.25;font-variant-numeric:tabular-nums;color:{INK}">'
        + "".join(lines)
        + "</table></div>"
    )
