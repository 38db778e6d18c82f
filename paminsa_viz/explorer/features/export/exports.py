"""What a session can export: maps, the robot and the motion, as file and name."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.maps import FULL, MapStore, shows_difference
from paminsa_viz.explorer.core.motion_results import MotionResults, MotionStore
from paminsa_viz.explorer.features.motion.simulation import SIMULATION
from paminsa_viz.explorer.kit.downloads import File, file_name, plain
from paminsa_viz.explorer.state.motion import FIGURE_OF, SIMULATED
from paminsa_viz.explorer.state.state import State
from paminsa_viz.exports import TARGETS, Target
from paminsa_viz.files.archives import zipped
from paminsa_viz.files.tables import DataTable, table_bytes
from paminsa_viz.files.trajectory_table import analysis_table, simulation_table
from paminsa_viz.model import Configuration, Design, InvalidInput, inverse_kinematics
from paminsa_viz.plots.map_table import map_table
from paminsa_viz.plots.series import FIGURES, FigureKind, SeriesSources
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_figure import render_series
from paminsa_viz.quantities import TORQUES
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.synthesis.volume.surface import volume_bytes


def figure(state: State, store: MapStore, kind: str) -> File:
    """Draw maps for print, with the colors of the page.

    Args:
        state: What to show; its ``export`` says which maps, and how large.
        store: Where maps come from.
        kind: Name of a figure format.

    Raises:
        InvalidInput: If kind, width or resolution is not possible.
    """
    # Late: matplotlib takes a second to load, and most sessions never print.
    from paminsa_viz.plots.map_figure import render_maps

    data = store.data(state, FULL, _quantities(state), hatched=True)
    scales = store.scales(state, data, _quantities(state))
    export = state.export
    content = render_maps(data, scales, kind, width_mm=export.width, dpi=export.dpi)
    return File(_maps_name(state, kind), content)


def table(state: State, store: MapStore, kind: str) -> File:
    """Write the numbers of maps, with where they come from; arguments as of `figure`.

    Raises:
        InvalidInput: If there is no such kind.
    """
    return File(_maps_name(state, kind), table_bytes(maps_table(state, store), kind))


def maps_table(state: State, store: MapStore) -> DataTable:
    """Return the numbers of maps, with where they come from."""
    return map_table(store.data(state, FULL, _quantities(state)))


def _quantities(state: State) -> tuple[str, ...]:
    return (state.map_view.quantity,) if state.export.single else TORQUES


def _maps_name(state: State, kind: str) -> str:
    single = state.export.single
    what = state.map_view.quantity.replace("_", "-") if single else "torque-maps"
    return file_name(state, f"{what}-difference" if shows_difference(state) else what, kind, "map")


def robot(state: State) -> File:
    """Write the robot at its pose as a GLB."""
    return program(state, TARGETS["glb"], "robot")


def program(state: State, target: Target, what: str) -> File:
    """Write the robot at its pose for another program: one file, or several in a zip archive.

    Args:
        state: What to write.
        target: The kind of file.
        what: What the file's name says of it.

    Raises:
        PaminsaError: If the format cannot hold the design, nothing could hold the pose, or a
            compiler is missing.
    """
    design, configuration = _posed(state)
    (ending, content), *beside = target.files(design, configuration.pose).items()
    place = "pose" if target.posed else ""
    name = file_name(state, what, "zip" if beside else ending[1:], place)
    if not beside:
        return File(name, content)
    stem = name.removesuffix(".zip")
    files = {ending: content, **dict(beside)}
    return File(name, zipped({stem + each: files[each] for each in files}, stem))


def mujoco_model(state: State, meshes: bool) -> File:
    """Write the robot at its pose for MuJoCo, held by position servos.

    Args:
        state: What to write.
        meshes: A zip archive with the robot's shapes, instead of one XML file with capsules.

    Raises:
        InvalidInput: If nothing could hold the pose, or a link has too little mass to be moved.
        InvalidDesign: If a bar's inertias belong to no rigid body.
    """
    if not meshes:
        return program(state, TARGETS["mjcf"], "mujoco")
    # Late, as the shapes are: they bring large libraries.
    from paminsa_viz.engines.exported import exported_mjcf
    from paminsa_viz.meshes.robot_files import robot_files

    design, configuration = _posed(state)
    text = exported_mjcf(design, pose=configuration.pose.tolist())
    name = file_name(state, "mujoco", "zip", "pose")
    files = robot_files(text, design, configuration)
    return File(name, zipped(files, name.removesuffix(".zip")))


def _posed(state: State) -> tuple[Design, Configuration]:
    """Return the current masses on the last reachable geometry, and its configuration."""
    last = state.last_reachable
    return state.shown_design, inverse_kinematics(last.geometry, last.pose)


def volume_file(state: State, kind: str) -> File:
    """Write the volume where all requirements hold, finely sampled.

    Args:
        state: What to save.
        kind: One of `VOLUME_FORMATS`.

    Raises:
        InvalidInput: If there is no such kind, or the volume is empty and has no surface to write.
    """
    document, known = state.document, state.requirements.fine
    if known is not None and known.result is not None and known.job.serves(document):
        volume = known.result.volume
    else:
        volume = solve_volume(document.design, document.requirements)
    return File(file_name(state, "volume", kind, ""), volume_bytes(volume, kind))


def motion_figure_kind(state: State) -> FigureKind:
    """Return which figure `motion_figure` draws of a state."""
    plot = state.plots.plot
    return FIGURE_OF.get(plot) or next(kind for kind in FIGURES if kind == plot)


def motion_figure(state: State, kind: str) -> File:
    """Draw the curves of the motion for print.

    Args:
        state: What to show; its ``export`` says how large.
        kind: Name of a figure format.

    Raises:
        InvalidInput: If there is no motion, no simulation or no engine's torques of it, or kind,
            width or resolution is not possible.
    """
    found, what = _motion_results(state), motion_figure_kind(state)
    sources, title = found.sources, None
    if what == "tracking":
        _require_simulation(state)
    if what == "clearance":  # what the page has may not be there yet
        sources = replace(sources, clearance=None)
    if what == "comparison":
        check = found.answer.result if found.answer else None
        if check is None:
            why = found.answer.error if found.answer else ""
            waits = "its torques are not there yet; see “Motion plots”"
            raise InvalidInput("engine", str(why) or waits)
        published = sources.published
        title = f"Formulas{' as published' if published else ''} and {check.engine.name}"
        sources = SeriesSources(published or sources.analysis, engine=check.engine)
    export, data = state.export, build_series(what, sources)
    content = render_series(data, kind, width_mm=export.width, dpi=export.dpi, title=title)
    return File(motion_name(state, found, what, kind), content)


def _require_simulation(state: State) -> None:
    if SIMULATION.result(state) is None or SIMULATION.is_stale(state):
        raise InvalidInput("simulation", "simulate the current motion first")


def curves_table(state: State, kind: str) -> File:
    """Write `motion_table` next to the curves: a simulation that is plotted has to be there.

    Raises:
        InvalidInput: If there is no motion, no simulation of it, or no such kind.
    """
    if state.plots.plot in SIMULATED:
        _require_simulation(state)
    return motion_table(state, kind)


def motion_table(state: State, kind: str) -> File:
    """Write the motion and its actuator torques, or the simulation if that is plotted.

    Args:
        state: What to save.
        kind: One of `TABLE_FORMATS`.

    Raises:
        InvalidInput: If there is no motion, or no such kind.
    """
    found, series = motion_series(state)
    what = "simulation" if state.plots.plot in SIMULATED and found.sources.simulation else ""
    return File(motion_name(state, found, what, kind), table_bytes(series, kind))


def motion_series(state: State) -> tuple[MotionResults, DataTable]:
    """Return the motion, and the numbers over time that `motion_table` writes.

    Raises:
        InvalidInput: If there is no motion.
    """
    found = _motion_results(state)
    simulation = found.sources.simulation if state.plots.plot in SIMULATED else None
    if simulation is not None:
        return found, simulation_table(simulation)
    return found, analysis_table(found.analysis)


def motion_page(state: State) -> File:
    """Write a page that plays the motion without a server.

    Raises:
        PaminsaError: If there is no motion, or the robot cannot even start it.
    """
    from paminsa_viz.explorer.scene.html_pages import motion_html  # late: it starts a server

    found = _motion_results(state)
    document = state.document
    content = motion_html(document.design, found.analysis.trajectory)
    return File(motion_name(state, found, "", "html"), content)


def _motion_results(state: State) -> MotionResults:
    # A store of its own: the session's belongs to its worker.
    found = MotionStore().all(state)
    if found is None:
        raise motions.no_motion(state)
    return found


def motion_name(state: State, found: MotionResults, what: str, ending: str) -> str:
    """Return the name of a file of a motion: of which design, which motion, and what of it."""
    parts = (state.document.design.name, found.analysis.trajectory.name, what)
    return "_".join(["paminsa", "motion", *filter(None, map(plain, parts))]) + f".{ending}"
