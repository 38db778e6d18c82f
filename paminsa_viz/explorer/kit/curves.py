"""Charts of the motion on the page: uPlots that are given new data, and the time cursor on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from paminsa_viz.explorer.browser.bridge import Bridge, finite
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.entries import Custom
from paminsa_viz.palette import Theme
from paminsa_viz.plots.series_uplot import (
    Chart,
    ChartShape,
    chart_shape,
    uplot_data,
    uplot_options,
)

LOWEST, HIGHEST = 158, 340
"""Height of a chart with its heading and axis [px]."""

OTHERS = 324
"""What else is in the dock with two charts [px]: tabs, caption, numbers, inputs."""

PLACE = "motion"
"""Name of the place (see `browser.bridge.Slots`) of the charts."""


class MotionChart:
    """A chart in a container of the page.

    Args:
        gui: The tab's GUI.
        container: What it is put into, a handle that can be entered.
        order: Its place there.

    Attributes:
        handle: viser's handle, or None before the first curve.
        shape: What the handle was made for, or None.
    """

    def __init__(self, gui: Any, container: Any, order: float) -> None:
        self._gui, self._container, self._order = gui, container, order
        self._height = LOWEST
        self.handle: Any = None
        self.shape: ChartShape | None = None

    def fit(self, window_height: float) -> None:
        """Take half of what is free of a window's height [px]."""
        self._height = int(min(max((window_height - OTHERS) / 2, LOWEST), HIGHEST))
        if self.handle is not None:
            self.handle.height = self._height

    def draw(self, chart: Chart | None, theme: Theme) -> None:
        """Show a chart, or nothing."""
        if chart is None:
            if self.handle is not None:
                self.handle.remove()
            self.handle = self.shape = None
            return
        # A chart that was made for more pieces is kept: in a drag, gaps come and go.
        shape = chart_shape(chart, self.shape.pieces if self.shape else 1, theme)
        series = uplot_data(chart, shape.pieces)
        if self.handle is not None and shape == self.shape:
            self.handle.data = series
            return
        if self.handle is not None:
            self.handle.remove()
        self.shape = shape
        with self._container:
            self.handle = self._gui.add_uplot(
                series, **uplot_options(shape), height=self._height, order=self._order
            )


def draw_charts(places: Sequence[MotionChart], charts: Sequence[Chart], theme: Theme) -> None:
    """Show charts in their places, of which some may be left over."""
    for index, place in enumerate(places):
        place.draw(charts[index] if index < len(charts) else None, theme)


class MotionCharts:
    """Two charts, drawn when there is something to show and nothing is dragged."""

    def __init__(
        self,
        session: Session,
        *,
        shown: Callable[[Frame], tuple[Any, ...] | None],
        charts: Callable[..., Sequence[Chart]],
    ) -> None:
        """Prepare the charts in the current container.

        Args:
            session: The session.
            shown: What they show, the arguments of ``charts``; None for nothing.
            charts: Makes them.
        """
        gui = session.client.gui
        place = gui.add_folder(None)
        self._places = tuple(MotionChart(gui, place, order) for order in (0.0, 1.0))
        self._shown, self._charts = shown, charts
        self._drawn: tuple[object, ...] = ()

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what has changed."""
        if dragging:
            return
        shown, theme = self._shown(frame), frame.state.theme
        if (shown, theme) == self._drawn:
            return
        self._drawn = (shown, theme)
        draw_charts(self._places, () if shown is None else self._charts(*shown), theme)


def motion_charts(
    key: str,
    shown: Callable[[Frame], tuple[Any, ...] | None],
    charts: Callable[..., Sequence[Chart]],
) -> Custom:
    """Return the entry of `MotionCharts`."""
    return Custom(key, make=partial(MotionCharts, shown=shown, charts=charts))


class TimeCursor:
    """A line through all charts, and clicks on them that move it.

    Moving a line in the page takes a short message; a line that is part of the data would take all
    of it thirty times a second.

    Args:
        bridge: Scripts to the tab and messages from it.
        chosen: Called with the time [s] that was clicked on a chart.
    """

    def __init__(self, bridge: Bridge, chosen: Callable[[float], None]) -> None:
        self._bridge, self._chosen = bridge, chosen
        self._shown: float | None = None
        bridge.on("time", self._receive)

    def show(self, time: float) -> None:
        """Move the cursor to a time [s]."""
        if time != self._shown:
            self._shown = time
            self._bridge.call("showTime", PLACE, round(time, 6))

    def _receive(self, data: Any) -> None:
        time = finite(data)
        if time is not None:
            self._chosen(time)
