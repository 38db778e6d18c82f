"""The curves of a simulation in its answer: how far the robot is from where it should be."""

from __future__ import annotations

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.curves import LOWEST, MotionChart
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_uplot import Chart, charts


class SimulationCharts:
    """Errors of the position and of the heading over time, in the current container."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        place = gui.add_folder(None)
        self._charts = tuple(MotionChart(gui, place, order, LOWEST) for order in (0.0, 1.0))
        self._drawn: tuple[object, ...] = ()

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what has changed."""
        found = frame.motions.all(frame.state)
        key = (found, frame.state.theme)
        if dragging or key == self._drawn:
            return
        self._drawn = key
        shown: tuple[Chart, ...] = ()
        if found is not None and found.sources.simulation is not None:
            shown = charts(build_series("errors", found.sources), 0)
        for index, chart in enumerate(self._charts):
            chart.draw(shown[index] if index < len(shown) else None, frame.state.theme)
