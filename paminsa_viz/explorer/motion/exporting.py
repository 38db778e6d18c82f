"""What can be saved of a motion: its curves as figures, its numbers, and a page that plays it."""

from __future__ import annotations

from paminsa_viz.explorer.exports import RESOLUTIONS, WIDTHS, File, plain, require_range
from paminsa_viz.explorer.motion import requests
from paminsa_viz.explorer.motion.plots import Plot
from paminsa_viz.explorer.motion.store import Analyzed, MotionStore
from paminsa_viz.explorer.state import State
from paminsa_viz.files.tables import table_bytes
from paminsa_viz.files.trajectory_table import analysis_table, simulation_table
from paminsa_viz.model import InvalidInput, Misprint
from paminsa_viz.plots.curves import CurveKind, figure_bytes
from paminsa_viz.trajectory import analyze

FIGURES: dict[Plot, CurveKind] = {
    Plot.TORQUES: "torques",
    Plot.DIFFERENCE: "comparison",
    Plot.PARTS: "breakdown",
    Plot.POWER: "power",
    Plot.ENERGY: "energy",
    Plot.POSE: "pose",
    Plot.SPEED: "pose",
    Plot.ACCELERATION: "pose",
    Plot.TRACKING: "tracking",
    Plot.DRIVEN: "tracking",
}
"""The printed figure that belongs to what is plotted on the page."""

_SIMULATED = (Plot.TRACKING, Plot.DRIVEN)


def figure_kind(state: State) -> CurveKind:
    """Return which figure `figure` draws of a state."""
    return FIGURES[state.plots.plot]


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
    found, what = _analyzed(state), figure_kind(state)
    if state.plots.plot is Plot.DIFFERENCE:
        return _difference(state, found, kind, width_mm, dpi)
    simulation = found.simulation if what == "tracking" else None
    if what == "tracking" and not (simulation and requests.simulated_as_it_is(state)):
        raise InvalidInput("simulation", "simulate the present motion first")
    content = figure_bytes(
        what, found.present, reference=found.reference, printed=found.printed,
        simulation=simulation, format=kind, width_mm=width_mm, dpi=dpi,
    )  # fmt: skip
    return File(_name(state, found, what, kind), content)


def _difference(state: State, found: Analyzed, kind: str, width_mm: float, dpi: float) -> File:
    torques = found.answer.found if found.answer else None
    if torques is None:
        why = found.answer.problem if found.answer else ""
        raise InvalidInput("engine", why or "its torques are not there yet; see “Motion plots”")
    analysis, title = torques.thinned, f"Formulae and {torques.engine.name}"
    if found.printed is not None:
        analysis = analyze(analysis.design, analysis.trajectory, misprints=Misprint.ALL)
        title = f"Formulae as printed and {torques.engine.name}"
    content = figure_bytes(
        "comparison", analysis, engine=torques.engine, title=title,
        format=kind, width_mm=width_mm, dpi=dpi,
    )  # fmt: skip
    return File(_name(state, found, "comparison", kind), content)


def table(state: State, kind: str) -> File:
    """Write the motion and what it asks of the design, or the simulation if that is plotted.

    Args:
        state: What to save.
        kind: One of `TABLE_FORMATS`.

    Raises:
        InvalidInput: If there is no motion, or no such kind.
    """
    found = _analyzed(state)
    simulated = state.plots.plot in _SIMULATED and found.simulation is not None
    if simulated and found.simulation is not None:
        content = simulation_table(found.simulation)
    else:
        content = analysis_table(found.present)
    name = _name(state, found, "simulation" if simulated else "", kind)
    return File(name, table_bytes(content, kind))


def page(state: State) -> File:
    """Write a page that plays the motion without a server.

    Raises:
        PaminsaError: If there is no motion, or the robot cannot even start it.
    """
    from paminsa_viz.explorer.motion_page import motion_html  # late: it starts a server

    found = _analyzed(state)
    document = state.document
    content = motion_html(document.design, found.present.trajectory)
    return File(_name(state, found, "", "html"), content)


def _analyzed(state: State) -> Analyzed:
    # A store of its own: the session's belongs to its worker.
    found = MotionStore().all(state)
    if found is None:
        raise InvalidInput("motion", requests.planned(state).problem)
    return found


def _name(state: State, found: Analyzed, what: str, ending: str) -> str:
    parts = (state.document.design.name, found.present.trajectory.name, what)
    return "_".join(["paminsa", "motion", *filter(None, map(plain, parts))]) + f".{ending}"
