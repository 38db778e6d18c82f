"""The tab of the motion: its status, playback, description, path in the scene, and simulation."""

from __future__ import annotations

from operator import methodcaller
from typing import Any

from viser import Icon

from paminsa_viz.blocks.trajectory import margin_text, samples_text, simulation_notes
from paminsa_viz.clearance import clearance_reason
from paminsa_viz.explorer.core import clearance
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.motion_results import MotionResults
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.motion import point_entries as motion_points
from paminsa_viz.explorer.features.motion.crossing import chart_html, crossing_html
from paminsa_viz.explorer.features.motion.description import DESCRIPTION, LIMIT_LABELS
from paminsa_viz.explorer.features.motion.layers import path_scale
from paminsa_viz.explorer.features.motion.simulation import SIMULATION, show_simulation, simulate
from paminsa_viz.explorer.kit.curves import motion_charts
from paminsa_viz.explorer.kit.design_numbers import of_size
from paminsa_viz.explorer.kit.entries import (
    Answer,
    Button,
    ButtonGroup,
    Entry,
    Folder,
    Html,
    Message,
    Then,
)
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, Slider, attribute
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs, layer_switch
from paminsa_viz.explorer.kit.text import note, render, status
from paminsa_viz.explorer.scene.hues import hue_gradient
from paminsa_viz.explorer.state.motion import SPEEDS
from paminsa_viz.explorer.state.simulation import SimulationSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.palette import COORDINATE_COLORS
from paminsa_viz.plots.series_builders import POSE_UNITS, build_series
from paminsa_viz.plots.series_uplot import Chart, charts
from paminsa_viz.trajectory import ControlMode, TrajectoryAnalysis
from paminsa_viz.units import as_sentence, number

TIME = "t  [s]"
ACTUATORS = {f"M{j + 1}": j for j in range(4)}


def status_line(state: State, analysis: TrajectoryAnalysis | None) -> tuple[bool, str]:
    """Return whether a motion can be run, and the line that says so or says why not."""
    found = motions.planned(state)
    if analysis is None or found.trajectory is None or found.problem:
        return False, as_sentence(found.problem)
    if analysis.failure is not None:
        return False, as_sentence(f"fails {analysis.failure.explanation}")
    return True, f"{samples_text(found.trajectory)}. {margin_text(analysis.check)}"


def status_html(frame: Frame) -> str:
    """Return whether the motion can be run."""
    state, analysis = frame.state, frame.analysis
    reachable, line = status_line(state, analysis)
    found = motions.planned(state)
    level, title = ("ok", "Reachable") if reachable else ("bad", "Not possible")
    if found.trajectory is None:
        level, title = "plain", "No motion yet"
    lines = [line, as_sentence(f"shortest: {found.bound}")] if found.bound else [line]
    near = None if analysis is None else clearance.along(state, analysis)
    if near is not None and reachable:
        why = clearance_reason(near.distance, near.names, state.clearance.settings.required)
        if why:
            level, words = clearance.headline(near.distance)
            title = f"{title}, {words}"
            lines.insert(0, as_sentence(f"{why}, at {number(near.t, 3)} s"))
    return render(
        "motion/status.j2",
        level=level,
        title=title,
        lines=list(filter(None, lines)),
        limited=bool(found.to_change),
    )


def _to_limits(session: Session, data: Any) -> None:
    """Put the focus into the limit that a motion breaks; nothing is looked at of ``data``."""
    del data
    to_change = motions.planned(session.state).to_change
    if to_change:
        session.bridge.call("focusInput", [LIMIT_LABELS[to_change]])


def playback_end(state: State) -> float:
    """Return the end of the time slider, the duration rounded to its step [s]."""
    return max(round(motions.duration(state), 3), 0.001)


def scrub(state: State, time: float) -> State:
    """Go to an instant that the slider shows [s]; its end is that of the motion."""
    return motions.scrub(state, motions.duration(state) if time >= playback_end(state) else time)


PLAYBACK = (
    Button(
        "playback.play", lambda state: "Pause" if state.playback.playing else "Play",
        icon=lambda state: Icon.PLAYER_PAUSE if state.playback.playing else Icon.PLAYER_PLAY,
        effect=motions.play_or_pause, undo=False, hint="Play the motion with the robot (key: M)",
    ),
    Dropdown(
        "playback.speed", "Speed", options={f"{speed:g} ×": speed for speed in SPEEDS},
        hint="1 × is true time", **attribute("playback.speed"),
    ),
    Checkbox(
        "playback.loop", "Repeat", hint="Start again at the end", **attribute("playback.loop")
    ),
    Slider(
        "playback.time", TIME, range=lambda state: (0.0, playback_end(state)), step=0.001,
        hint="The instant shown; drag it to go through", undo=False,
        read=lambda state: round(state.playback.time, 3), apply=scrub,
    ),
)  # fmt: skip


def _legend_html(frame: Frame) -> str:
    """Return the color bar of the path; empty without a motion."""
    if frame.analysis is None:
        return ""
    actuator = frame.state.plots.color
    scale = path_scale(frame.analysis, actuator)
    name = ("|τ₁| [N·m]", "|τ₂| [N·m]", "|τ₃| [N·m]", "|F₄| [N]")[actuator]
    return render("motion/path.j2", hues=hue_gradient(scale), name=name, scale=scale)


def _has_feedback(state: State) -> bool:
    return state.simulation.settings.control is not ControlMode.FEED_FORWARD


def simulation_html(frame: Frame) -> str:
    """Return what came of the last simulation."""
    own = frame.state.simulation
    level, title, lines = "plain", "Simulating …", []
    outcome = own.outcome
    if own.running is None and outcome is None:
        text = (
            "The controller does not know of a part of the payload. Errors and torques are plotted "
            "in “Motion plots”, and the robot moves as simulated in the scene."
        )
        return note("simulation", text, muted=True)
    if own.running is None and outcome is not None:
        level, title, lines = "bad", "Not simulated", [outcome.problem]
        simulation = outcome.result
        if simulation is not None:
            lines = [as_sentence(line.text) for line in simulation_notes(simulation)]
            level, title = "ok", f"Ran to the end, {simulation.t[-1]:.3f} s"
            if simulation.stopped is not None:
                level, title = "bad", "Stopped"
            stale = SIMULATION.stale_text(frame.state)
            if stale:
                level = "warn" if simulation.stopped is None else level
                lines.append(stale)
    return status("simulation", level, title, *lines)


def _simulated(frame: Frame) -> tuple[MotionResults] | None:
    """Return what the charts show, or None as long as nothing was simulated."""
    found = frame.motions.all(frame.state)
    return None if found is None or found.sources.simulation is None else (found,)


def _error_charts(found: MotionResults) -> tuple[Chart, ...]:
    """Return how far the robot is from where it should be, in position and heading, over time."""
    return charts(build_series("errors", found.sources))


def coordinates_html(frame: Frame) -> str:
    """Return which color is which coordinate in the charts; nothing without them."""
    if frame.state.simulation.result is None:
        return ""
    named = tuple(zip(POSE_UNITS, COORDINATE_COLORS, strict=True))
    return render("motion/coordinates.j2", coordinates=named)


_setting = SettingInputs("simulation", "simulation.settings", SimulationSettings)

SIMULATING: tuple[Entry, ...] = (
    _setting("control"),
    _setting("bandwidth", visible=_has_feedback),
    _setting("damping", visible=_has_feedback),
    _setting("payload_mismatch", step=of_size(0.1, "kg")),
    *map(_setting, ("initial_error", "knows_friction")),
    Button(
        "simulation", "Simulate", icon=Icon.PLAYER_TRACK_NEXT,
        effect=simulate, disabled=SIMULATION.runs,
        hint="Runs the motion under the controller: where the robot really goes, and with which "
        "torques",
    ),
    SIMULATION.worker,
    Html(
        "simulation.about", content=simulation_html,
        visible=lambda state: state.simulation.outcome is None,
    ),
    Checkbox(
        "simulation.shown", "Play it in the scene",
        hint="The robot moves as simulated, next to a translucent one where it should be; without "
        "it, it moves as planned",
        visible=lambda state: state.simulation.result is not None,
        read=lambda state: state.simulation.shown, apply=show_simulation,
    ),
    Answer(
        "simulation.answer", "Simulation", found=SIMULATION.outcome,
        entries=(
            Html("simulation.outcome", content=simulation_html),
            ButtonGroup(
                "simulation.plots", "Plot",
                visible=lambda state: state.simulation.result is not None,
                choices={
                    title: Then(methodcaller("updated", "plots", plot=plot), opens="Motion plots")
                    for title, plot in (("Errors", "errors"), ("Torques", "commands"))
                },
                hint="In “Motion plots”, with the instant and the numbers of each curve",
            ),
            Html("simulation.coordinates", content=coordinates_html, idle=True),
            motion_charts("simulation.charts", _simulated, _error_charts),
        ),
    ),
)  # fmt: skip


MOTION: tuple[Entry, ...] = (
    Message(motion_points.SELECT, receive=motion_points.receive_row),
    Html("playback.mark", content='<span class="paminsa-playback"></span>'),
    Message("motion limits", receive=_to_limits),
    Html("motion.status", content=status_html),
    *PLAYBACK,
    *DESCRIPTION,
    Folder(
        "motion.crossing", "Singularities passed",
        visible=lambda state: motions.planned(state).crossing is not None,
        entries=(
            Html("motion.crossing.text", content=crossing_html, idle=True),
            Html("motion.crossing.chart", content=chart_html, idle=True),
        ),
    ),
    Folder(
        "motion.path", "Path in the scene", open=False,
        entries=(
            layer_switch("layers.path", "path", "Show the path", "Drawn on the maps as well"),
            Dropdown(
                "plots.color", "Colored by", options=ACTUATORS,
                hint="Torque or force of this actuator; red where the motion fails",
                **attribute("plots.color"),
            ),
            Html("motion.legend", content=_legend_html),
        ),
    ),
)  # fmt: skip
"""Status and playback, the motion, its duration, and its path."""
