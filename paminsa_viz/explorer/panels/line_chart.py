"""Small line charts as SVG in the page: light enough for a tab that nobody looks at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from paminsa_viz.explorer.panels import render
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots.ticks import multiples, nice_step
from paminsa_viz.units import number

WIDTH = 340.0
LEFT, RIGHT, TOP, BOTTOM = 46.0, 8.0, 8.0, 30.0
GAP = 12.0
"""Sizes of a chart [px]."""

ROUNDING = 1e-9
"""Values up to this size are drawn as zero."""


@dataclass(frozen=True, eq=False)
class Line:
    """One curve: its values (n,), its color ``#rrggbb``, and its name for the legend."""

    values: Array
    color: str
    name: str = ""


@dataclass(frozen=True, eq=False)
class Axes:
    """One set of axes: what it shows, its curves, and whether the area to zero is filled."""

    label: str
    lines: Sequence[Line]
    fill: bool = False


def line_chart(
    testid: str, x: Array, axes: Sequence[Axes], x_label: str, *, height: float = 90.0
) -> str:
    """Return axes over one another with a common x axis, as HTML.

    Args:
        testid: Name for tests.
        x: (n,) increasing.
        axes: From top to bottom.
        x_label: Label of the x axis, with its unit.
        height: Of each set of axes [px].
    """
    low, high = float(x[0]), float(x[-1])
    span = max(high - low, 1e-12)
    right = WIDTH - RIGHT

    def across(value: Any) -> Any:
        return LEFT + (value - low) / span * (right - LEFT)

    drawn = []
    for index, one in enumerate(axes):
        top = TOP + index * (height + GAP)
        values = np.concatenate([line.values for line in one.lines])
        values = np.where(np.abs(values) < ROUNDING, 0.0, values)
        least, most = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
        if most == least:
            most = least + 1.0
        scale = height / (most - least)

        def up(value: Any, top: float = top, most: float = most, scale: float = scale) -> Any:
            return top + (most - value) * scale

        ticks = multiples(least, most, nice_step(most - least, 4))
        drawn.append(
            {
                "label": one.label, "top": top, "bottom": top + height, "zero": float(up(0.0)),
                "ticks": [(float(up(tick)), number(tick, 3)) for tick in ticks],
                "fill": one.fill,
                "lines": [
                    (_path(across(x), up(np.where(np.abs(line.values) < ROUNDING, 0, line.values))),
                     line.color, line.name)
                    for line in one.lines
                ],
            }
        )  # fmt: skip
    bottom = TOP + len(axes) * (height + GAP) - GAP
    marks = multiples(low, high, nice_step(span, 5))
    return render(
        "line_chart.j2", testid=testid, axes=drawn, width=WIDTH, height=bottom + BOTTOM,
        left=LEFT, right=right, bottom=bottom, x_label=x_label,
        marks=[(float(across(mark)), number(mark, 3)) for mark in marks],
        legend=[(line.color, line.name) for line in axes[0].lines if line.name],
    )  # fmt: skip


def _path(x: Array, y: Array) -> Markup:
    return Markup(" ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)))
