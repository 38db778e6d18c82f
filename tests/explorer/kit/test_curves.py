"""Charts over time in the panels: when they are drawn, and their looks."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast
from unittest.mock import MagicMock

import numpy as np

from paminsa_viz.explorer.kit.curves import HIGHEST, LOWEST, MotionChart, MotionCharts
from paminsa_viz.palette import DARK, LIGHT
from paminsa_viz.plots.series import Trace
from paminsa_viz.plots.series_uplot import Chart

T = np.array([0.0, 1.0])
CHART = Chart(
    "τ", "N·m", T, (Trace("predicted", T, LIGHT.ink, "dashed", 0.9),), np.zeros(2, dtype=bool)
)  # fmt: skip


def test_charts_have_the_letters_and_lines_of_the_theme() -> None:
    gui = MagicMock()
    charts = MotionCharts(
        cast(Any, SimpleNamespace(client=SimpleNamespace(gui=gui))),
        shown=lambda frame: cast(Any, frame).state.shown, charts=lambda count: (CHART,) * count,
    )  # fmt: skip

    def draw(theme: Any, shown: Any, *, dragging: bool = False) -> None:
        state = SimpleNamespace(shown=shown, theme=theme)
        charts.draw(cast(Any, SimpleNamespace(state=state)), dragging)

    draw(LIGHT, (2,), dragging=True)
    assert gui.add_uplot.call_count == 0
    for count, theme in enumerate((LIGHT, DARK, LIGHT), start=1):
        for _ in range(2):  # the second time, nothing has changed
            draw(theme, (2,))
        assert gui.add_uplot.call_count == 2 * count
        made = gui.add_uplot.call_args.kwargs
        assert made["axes"][0]["stroke"] == theme.muted
        assert theme.ink in [one.get("stroke") for one in made["series"]]
    removed = gui.add_uplot.return_value.remove
    for shown, gone in (((1,), 1), (None, 1)):  # each takes one more of the two off the page
        before = removed.call_count
        draw(LIGHT, shown)
        assert removed.call_count == before + gone
    assert gui.add_uplot.call_count == 6


def test_charts_follow_the_height_of_the_window() -> None:
    gui = MagicMock()
    chart = MotionChart(gui, MagicMock(), 0.0)
    chart.fit(720.0)  # before there is one
    chart.draw(CHART, LIGHT)
    first = gui.add_uplot.call_args.kwargs["height"]
    assert LOWEST < first < HIGHEST
    for window, height in ((820.0, first + 50), (300.0, LOWEST), (2000.0, HIGHEST)):
        chart.fit(window)
        assert gui.add_uplot.return_value.height == height
    assert gui.add_uplot.call_count == 1  # which would drop the piece of time that is looked at
