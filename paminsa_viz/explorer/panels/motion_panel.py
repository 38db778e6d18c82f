"""The tab in which a motion is chosen or built, played, and simulated."""

from __future__ import annotations

import math
from collections.abc import Mapping

from viser import Icon

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.entries import Button, ButtonGroup, Condition, Custom, Entry, Folder, Html
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import (
    MILLIMETERS,
    PLAIN,
    Checkbox,
    Dropdown,
    Number,
    Slider,
    attribute,
)
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import (
    DURATIONS,
    LARGEST_LIMIT,
    LENGTHS,
    RATES,
    Kind,
    Timing,
)
from paminsa_viz.explorer.motion.playback import SPEEDS
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.motion.simulation import (
    SimulationJob,
    SimulationOutcome,
    run,
)
from paminsa_viz.explorer.panels import motion_text as text
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.panels.motion_file import MotionFile
from paminsa_viz.explorer.panels.motion_simulation import SIMULATION
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.trajectory import PRESETS, Profile
from paminsa_viz.units import DisplayUnit, display_unit

TIME = "t  [s]"
ACTUATORS = {f"M{j + 1}": j for j in range(4)}

MOTIONS: dict[str, str | Kind] = {
    **{f"Preset: {preset.label}": preset.key for preset in PRESETS},
    "Build: move from pose to pose": Kind.MOVE,
    "Build: straight line, θ held": Kind.LINE,
    "Build: pick-and-place arch": Kind.ARCH,
    "Build: through waypoints": Kind.WAYPOINTS,
    "Build: circle": Kind.CIRCLE,
    "From a CSV file": Kind.TABLE,
}
"""The key of a preset or the kind of a motion that is built, by its text."""

TIMINGS = {
    "the preset's": Timing.OWN,
    "given": Timing.GIVEN,
    "shortest within limits": Timing.SHORTEST,
}


def _kind(*kinds: Kind) -> Condition:
    return lambda state: state.document.motion.kind in kinds


def _planned(state: State) -> bool:
    return state.document.motion.kind is not Kind.TABLE


def playback_end(state: State) -> float:
    """Return the end of the time slider, the duration rounded up to its step [s]."""
    return max(math.ceil(1e3 * motions.duration(state) - 1e-6) / 1e3, 0.001)


PLAYBACK = (
    Button(
        "playback.play", lambda state: "Pause" if state.playback.playing else "Play",
        icon=lambda state: Icon.PLAYER_PAUSE if state.playback.playing else Icon.PLAYER_PLAY,
        effect=motions.play_or_pause, undo=False, hint="Play the motion with the robot (key: M)",
    ),
    Dropdown(
        "playback.speed", "speed", options={f"{speed:g} ×": speed for speed in SPEEDS},
        hint="1 × is true time", **attribute("playback.speed"),
    ),
    Checkbox(
        "playback.loop", "repeat", hint="Start again at the end",
        **attribute("playback.loop"),
    ),
    Slider(
        "playback.time", TIME, range=lambda state: (0.0, playback_end(state)), step=0.001,
        hint="The instant shown; drag it to go through", undo=False,
        read=lambda state: round(state.playback.time, 3), apply=motions.scrub,
    ),
)  # fmt: skip


def _chosen(state: State) -> str | Kind:
    motion = state.document.motion
    return motion.preset if motion.kind is Kind.PRESET else motion.kind


def _choose(state: State, choice: str | Kind) -> State:
    if isinstance(choice, Kind):
        return motions.choose_kind(state, choice)
    return motions.choose_preset(state, choice)


def _number(
    name: str, label: str, limits: tuple[float, float], step: float, hint: str,
    visible: Condition | None = None, unit: DisplayUnit = PLAIN,
) -> Number:  # fmt: skip
    """Return the input of one number of the motion, with limits in SI."""
    low, high = (unit.from_si(limit) for limit in limits)
    return Number(
        f"motion.{name}", label, range=(low, high), step=step, unit=unit, hint=hint,
        visible=visible, read=lambda state: getattr(state.document.motion, name),
        apply=lambda state, value: motions.change(state, **{name: value}),
    )  # fmt: skip


DESCRIPTION: tuple[Entry, ...] = (
    Dropdown(
        "motion.kind", "Motion", options=MOTIONS, hint="A ready-made motion, or one of your own",
        read=_chosen, apply=_choose,
    ),
    Html(
        "motion.poses", content=lambda frame: text.poses_html(frame.state),
        visible=lambda state: state.document.motion.kind is not Kind.PRESET,
    ),
    ButtonGroup(
        "motion.ends", "Ends",
        choices={
            "From here": motions.start_here,
            "To here": motions.goal_here,
            "Swap": motions.swap_ends,
        },
        visible=lambda state: state.document.motion.kind.has_ends,
        hint="Let the motion start or end at the current pose of the robot",
    ),
    ButtonGroup(
        "motion.waypoints", "Waypoints",
        choices={
            "Add current": motions.add_waypoint,
            "Remove last": motions.remove_waypoint,
            "Clear": motions.clear_waypoints,
        },
        visible=_kind(Kind.WAYPOINTS), hint="Move the robot, add its pose, move it on",
    ),
    Button(
        "motion.center", "Center here", effect=motions.center_here, color="gray",
        visible=_kind(Kind.CIRCLE), hint="Put the center at the current pose of the robot",
    ),
    _number(
        "radius", "Radius [mm]", LENGTHS, 1.0, "In the plane of x and y", _kind(Kind.CIRCLE),
        MILLIMETERS,
    ),
    _number(
        "height", "Height [mm]", (0.0, LENGTHS[1]), 1.0,
        "How far the platform rises above the higher end", _kind(Kind.ARCH), MILLIMETERS,
    ),
    Custom("motion.file", make=MotionFile),
    Dropdown(
        "motion.profile", "Time law",
        options={
            "quintic": Profile.QUINTIC,
            "trapezoid": Profile.TRAPEZOID,
            "S-curve": Profile.S_CURVE,
        },
        hint="How the motion runs in time",
        visible=lambda state: state.document.motion.kind.has_law,
        **attribute("document.motion.profile", motions.change),
    ),
    Checkbox(
        "motion.back", "Return to start", visible=_planned, hint="A closed motion",
        **attribute("document.motion.back", motions.change),
    ),
)  # fmt: skip


def current_timing(state: State) -> Timing:
    """Return what decides on the duration; only a preset has one of its own."""
    motion = state.document.motion
    own = motion.timing is Timing.OWN and motion.kind is not Kind.PRESET
    return Timing.GIVEN if own else motion.timing


def timing_options(state: State) -> Mapping[str, Timing]:
    """Return what can decide on the duration."""
    preset = state.document.motion.kind is Kind.PRESET
    return {label: t for label, t in TIMINGS.items() if preset or t is not Timing.OWN}


def _limit(name: str, label: str, unit: str, step: float) -> Number:
    """Return the input of a limit of the shortest duration; 0 is none."""
    return Number(
        f"motion.limits.{name}", label, unit=display_unit(unit), step=step,
        range=(0.0, display_unit(unit).from_si(LARGEST_LIMIT)),
        read=lambda state: getattr(state.document.motion.limits, name) or 0.0,
        apply=lambda state, value: motions.limit(state, name, value),
    )  # fmt: skip


TIMING: tuple[Entry, ...] = (
    Dropdown(
        "motion.timing", "Duration", options=timing_options, visible=_planned,
        hint="Given, or the shortest in which the robot keeps its limits", read=current_timing,
        apply=lambda state, timing: motions.change(state, timing=timing),
    ),
    _number(
        "duration", "T [s]", DURATIONS, 0.05, "One way, if the motion returns to its start",
        lambda state: _planned(state) and current_timing(state) is Timing.GIVEN,
    ),
    Folder(
        "motion.limits", "Limits",
        visible=lambda state: _planned(state) and state.document.motion.timing is Timing.SHORTEST,
        entries=(
            Html("motion.limits.note", content=render("motion_limits.j2")),
            _limit("speed", "m/s", "m/s", 0.1),
            _limit("turn_speed", "°/s", "rad/s", 10.0),
            _limit("acceleration", "m/s²", "m/s^2", 0.5),
            _limit("turn_acceleration", "°/s²", "rad/s^2", 100.0),
            _limit("jerk", "m/s³", "m/s^3", 10.0),
            _limit("turn_jerk", "°/s³", "rad/s^3", 1000.0),
            _limit("torque", "M1–3 N·m", "N m", 0.5),
            _limit("force", "F₄ N", "N", 10.0),
        ),
    ),
    _number("rate", "Samples [1/s]", RATES, 50.0, "A motion has at most 20,000 samples here"),
)  # fmt: skip


def motion_entries(store: MotionStore) -> tuple[Entry, ...]:
    """Return status and playback, the motion, its duration, its path, and its simulation."""
    return (
        Html("playback.mark", content=lambda _: render("mark.j2", name="paminsa-playback")),
        Html(
            "motion.status",
            content=lambda frame: text.status_html(frame.state, store.analysis(frame.state)),
        ),
        *PLAYBACK,
        *DESCRIPTION,
        *TIMING,
        Folder(
            "motion.path", "Path in the scene", open=False,
            entries=(
                Checkbox(
                    "layers.path", "Show the path", hint="Drawn on the maps as well",
                    read=lambda state: "path" in state.layers,
                    apply=lambda state, shown: actions.set_layers(state, path=shown),
                ),
                Dropdown(
                    "plots.color", "Colored by", options=ACTUATORS,
                    hint="Torque or force of this actuator; red where the motion fails",
                    **attribute("plots.color"),
                ),
                Html(
                    "motion.legend",
                    content=lambda frame: text.path_legend_html(
                        frame.state.plots.color, store.analysis(frame.state)
                    ),
                ),
            ),
        ),
        Folder("motion.simulation", "Simulation", open=False, entries=SIMULATION),
    )  # fmt: skip


class MotionPanel:
    """The entries of the tab, in the current container of the page, and what simulates.

    Attributes:
        entries: The entries on the page.
    """

    def __init__(self, session: Session, store: MotionStore) -> None:
        self.entries = Panel(session, motion_entries(store))
        self._job: BackgroundJob[SimulationJob, SimulationOutcome] = BackgroundJob(
            session, "simulation", lambda job, _: run(job), motions.receive_simulation,
            failed=lambda job, problem: SimulationOutcome(job, None, problem),
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the state, and simulate what is requested."""
        self._job.request(frame.state.simulating.running)
        self.entries.draw(frame, dragging)
