"""What can be saved of a motion: its curves as figures, its numbers, and a page that plays it."""

from __future__ import annotations

from paminsa_viz.explorer.exports import RESOLUTIONS, WIDTHS, File, plain, require_range
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.playback import FIGURES, SIMULATED
from paminsa_viz.explorer.motion.results import MotionResults, MotionStore
from paminsa_viz.explorer.state import State
from paminsa_viz.files.tables import table_bytes
from paminsa_viz.files.trajectory_table import analysis_table, simulation_table
from paminsa_viz.model import InvalidInput
from paminsa_viz.plots.series import FIGURES as FIGURE_KINDS
from paminsa_viz.plots.series import FigureKind, SeriesSources
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_figure import render_series


def figure_kind(state: State) -> FigureKind:
    """Return which figure `figure` draws of a state."""
    plot = state.plots.plot
    return FIGURES.get(plot) or next(kind for kind in FIGURE_KINDS if kind == plot)


def figure(state: State, kind: str, width_mm: float, dpi: float) -> File:
    """Draw the curves of the motion for print.

    Args:
        state: What to show.
        kind: Name of a figure format.
        width_mm: Width [mm].
        dpi: Pixels per inch.

    Raises:
        InvalidInput: If there is no motion, no simulation or no engine's torques of it, or a
            number is out of its range.
    """
    require_range("width", width_mm, WIDTHS)
    require_range("dpi", dpi, RESOLUTIONS)
    found, what = _results(state), figure_kind(state)
    sources, title = found.sources, None
    if what == "tracking" and not motions.simulation_is_current(state):
        raise InvalidInput("simulation", "simulate the present motion first")
    if what == "comparison":
        check = found.answer.found if found.answer else None
        if check is None:
            why = found.answer.problem if found.answer else ""
            raise InvalidInput("engine", why or "its torques are not there yet; see “Motion plots”")
        published = sources.published
        title = f"Formulas{' as published' if published else ''} and {check.engine.name}"
        sources = SeriesSources(published or sources.analysis, engine=check.engine)
    content = render_series(
        build_series(what, sources), kind, width_mm=width_mm, dpi=dpi, title=title
    )
    return File(_name(state, found, what, kind), content)


def table(state: State, kind: str) -> File:
    """Write the motion and what it asks of the design, or the simulation if that is plotted.

    Args:
        state: What to save.
        kind: One of `TABLE_FORMATS`.

    Raises:
        InvalidInput: If there is no motion, or no such kind.
    """
    found = _results(state)
    simulation = found.sources.simulation if state.plots.plot in SIMULATED else None
    what = "" if simulation is None else "simulation"
    series = analysis_table(found.analysis) if simulation is None else simulation_table(simulation)
    return File(_name(state, found, what, kind), table_bytes(series, kind))


def page(state: State) -> File:
    """Write a page that plays the motion without a server.

    Raises:
        PaminsaError: If there is no motion, or the robot cannot even start it.
    """
    from paminsa_viz.explorer.motion_page import motion_html  # late: it starts a server

    found = _results(state)
    document = state.document
    content = motion_html(document.design, found.analysis.trajectory)
    return File(_name(state, found, "", "html"), content)


def _results(state: State) -> MotionResults:
    # A store of its own: the session's belongs to its worker.
    found = MotionStore().all(state)
    if found is None:
        raise InvalidInput("motion", motions.planned(state).problem)
    return found


def _name(state: State, found: MotionResults, what: str, ending: str) -> str:
    parts = (state.document.design.name, found.analysis.trajectory.name, what)
    return "_".join(["paminsa", "motion", *filter(None, map(plain, parts))]) + f".{ending}"
