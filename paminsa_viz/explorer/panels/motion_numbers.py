"""Tables of the motion's curves: what they are at the time cursor, at most, and on average."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from paminsa_viz.explorer.motion.readings import Reading, value_at
from paminsa_viz.explorer.motion.store import Analyzed
from paminsa_viz.explorer.motion.traces import DASHED, DOTTED, SOLID, Chart, Trace
from paminsa_viz.palette import BAD, INK, MUTED, OK
from paminsa_viz.units import number

NOTHING = '<div class="paminsa-numbers"></div>'


def numbers_html(
    drawn: tuple[Chart, ...], read: tuple[tuple[Reading, ...], ...], time: float
) -> str:
    """Return the table of the curves: the value at the cursor, the largest one, the RMS."""
    if not drawn:
        return NOTHING
    lines = [(chart, line) for chart, found in zip(drawn, read, strict=True) for line in found]
    rows = [
        (
            line.trace,
            (
                f"<b>{written(value_at(chart, line.trace, time))}</b>", written(line.peak),
                f"{line.peak_t:.3f} s" if np.isfinite(line.peak_t) else "–", written(line.rms),
                line.unit,
            ),
        )
        for dash in (SOLID, DASHED, DOTTED)
        for chart, line in lines
        if line.trace.dash == dash
    ]  # fmt: skip
    return _table((f"at {time:.3f} s", "largest", "at", "RMS", ""), rows)


def difference_html(drawn: tuple[Chart, ...], found: Analyzed, time: float) -> str:
    """Return the table of differences to an engine, over the largest torque, with a verdict."""
    torques = found.answer.found if found.answer else None
    rows: list[tuple[Trace, Sequence[str]]] = []
    for dash, analysis in ((SOLID, found.present), (DOTTED, found.printed)):
        if analysis is None:
            continue
        lines = [(c, trace) for c in drawn for trace in c.traces if trace.dash == dash]
        if torques is None:
            unknown = ("<b>–</b>", "–", "–", "", "–", "")
            rows += [(trace, unknown) for _, trace in lines]
            continue
        shares = torques.comparison(analysis).relative.tolist()
        for (chart, trace), share in zip(lines, shares, strict=True):
            values = trace.values[np.isfinite(trace.values)]
            cells = (
                f"<b>{written(value_at(chart, trace, time))}</b>",
                written(float(np.abs(values).max())),
                written(float(np.sqrt((values**2).mean()))),
                chart.unit,
                number(share, 2),
                verdict(share <= torques.tolerance),
            )
            rows.append((trace, cells))
    heads = (f"at {time:.3f} s", "largest", "RMS", "", "relative", "")
    return _table(heads, rows)


def verdict(passed: bool) -> str:
    """Return whether a comparison is passed, in its color."""
    word, color = ("PASS", OK) if passed else ("FAIL", BAD)
    return f'<b style="color:{color}">{word}</b>'


def stroke(color: str, dash: tuple[int, ...]) -> str:
    """Return a short piece of a curve for a table."""
    style = "solid" if not dash else "dashed" if dash[0] > 3 else "dotted"
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
