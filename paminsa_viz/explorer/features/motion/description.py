"""What the motion is: a preset, one that is built, or a file; its time law, duration and limits."""

from __future__ import annotations

from collections.abc import Mapping

from viser import Icon

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.motion.point_entries import POINTS
from paminsa_viz.explorer.kit.design_numbers import of_size
from paminsa_viz.explorer.kit.entries import Condition, Entry, Folder, Html, Upload
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, Number, attribute
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.motion import LARGEST_LIMIT, Kind, Motion, Timing
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.table_reader import UPLOAD_TIMEOUT, uploaded_table
from paminsa_viz.files.trajectory_table import parse_trajectory
from paminsa_viz.trajectory import PRESETS
from paminsa_viz.units import counted, display_unit

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
    "the preset’s": Timing.OWN,
    "given": Timing.GIVEN,
    "shortest within limits": Timing.SHORTEST,
    "shortest, law kept": Timing.STRETCHED,
}


def _kind(*kinds: Kind) -> Condition:
    return lambda state: state.document.motion.kind in kinds


def _planned(state: State) -> bool:
    return state.document.motion.kind is not Kind.TABLE


def _crosses(state: State) -> bool:
    return state.document.motion.crosses


def _chosen(state: State) -> str | Kind:
    motion = state.document.motion
    return motion.preset if motion.kind is Kind.PRESET else motion.kind


def _choose(state: State, choice: str | Kind) -> State:
    if isinstance(choice, Kind):
        return motions.choose_kind(state, choice)
    return motions.choose_preset(state, choice)


def file_html(frame: Frame) -> str:
    """Return what is known of a file's motion."""
    table = frame.state.document.motion.table
    lines = [] if table is None else [
        (table.name, f", {counted(table.size, 'row')}"),
        *(("", note) for note in table.notes),
        ("", "A file’s motion is not kept over a reload, nor in a share code."),
    ]  # fmt: skip
    return render("motion/file.j2", lines=lines)


def _open(session: Session, name: str, content: bytes) -> None:
    """Run the trajectory in an uploaded CSV file.

    Raises:
        TableFileError: If there is none in it; row and column say where.
    """
    rest, lines = session.state.table_at_rest, uploaded_table(name, content)
    table = parse_trajectory(lines, name, rest=rest, timeout=UPLOAD_TIMEOUT)
    session.dispatch(
        "motion.table", lambda state: motions.use_table(state, table),
        then=lambda: session.notify(
            "Motion opened", f"{table.name}, {counted(table.size, 'row')}", of_step=True
        ),
    )  # fmt: skip


def _not_crossing(state: State) -> bool:
    """Whether accelerations and jerks can be limited; the planner through singularities cannot."""
    return not _crosses(state)


def _limit(
    name: str, unit: str, step: float, hint: str, visible: Condition | None = None
) -> Number:
    """Return the input of a limit of the shortest duration; 0 is none."""
    return Number(
        f"motion.limits.{name}", LIMIT_LABELS[name], unit=display_unit(unit),
        step=of_size(step, unit), hint=hint,
        range=(0.0, LARGEST_LIMIT), visible=visible,
        read=lambda state: getattr(state.document.motion.limits, name) or 0.0,
        apply=lambda state, value: motions.limit(state, name, value),
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


def has_limits(state: State) -> bool:
    """Whether the motion keeps limits of speed, torque and force."""
    motion = state.document.motion
    return _planned(state) and (_crosses(state) or motion.timing.keeps_limits)


LIMIT_LABELS = {
    "speed": "Speed [m/s]", "turn_speed": "Speed [°/s]",
    "acceleration": "Accel. [m/s²]", "turn_acceleration": "Accel. [°/s²]",
    "jerk": "Jerk [m/s³]", "turn_jerk": "Jerk [°/s³]",
    "torque": "M1–M3 [N·m]", "force": "F₄ [N]",
}  # fmt: skip
"""Labels of the inputs of limits, by the field of `MotionLimits`."""

_MOVES, _TURNS = "Of the platform’s center, in any direction", "Of the platform’s heading θ"

_setting = SettingInputs("motion", "document.motion", Motion, motions.change)

DESCRIPTION: tuple[Entry, ...] = (
    Dropdown(
        "motion.kind", "Motion", options=MOTIONS, hint="A ready-made motion, or one of your own",
        read=_chosen, apply=_choose,
    ),
    Html("motion.file.about", content=file_html, visible=_kind(Kind.TABLE)),
    *POINTS,
    _setting("radius", visible=_kind(Kind.CIRCLE)),
    _setting("height", visible=_kind(Kind.ARCH)),
    Folder(
        "motion.file", "CSV file", visible=_kind(Kind.TABLE),
        entries=(
            Checkbox(
                "motion.file.rest", "Starts and ends at rest", **attribute("table_at_rest"),
                hint="For a few rows; without it, velocities at the ends are what the samples say",
            ),
            Upload(
                "motion.file.upload", "Open a CSV file…", receive=_open, icon=Icon.UPLOAD,
                mime_type=".csv,.txt",
                hint="Columns t_s, x_m, y_m, theta_rad, z_m (or _ms, _mm, _deg)",
            ),
        ),
    ),
    _setting(
        "profile",
        visible=lambda state: state.document.motion.kind.has_law and not _crosses(state),
    ),
    _setting("cross", visible=lambda state: state.document.motion.kind.can_cross),
    _setting("deviation", visible=_crosses),
    _setting("back", visible=_planned),
    Dropdown(
        "motion.timing", "Duration", options=timing_options, visible=_planned,
        hint="Given, or the shortest within limits, by the time-optimal law or the motion’s own",
        read=current_timing,
        apply=lambda state, timing: motions.change(state, timing=timing),
    ),
    _setting(
        "duration",
        visible=lambda state: _planned(state) and current_timing(state) is Timing.GIVEN,
    ),
    Folder(
        "motion.limits", "Limits",
        visible=has_limits,
        entries=(
            Html(
                "motion.limits.note",
                content=lambda frame: render("motion/limits.j2", crosses=_crosses(frame.state)),
            ),
            _limit("speed", "m/s", 0.1, _MOVES),
            _limit("turn_speed", "rad/s", 10.0, _TURNS),
            _limit("acceleration", "m/s^2", 0.5, _MOVES, _not_crossing),
            _limit("turn_acceleration", "rad/s^2", 100.0, _TURNS, _not_crossing),
            _limit("jerk", "m/s^3", 10.0, _MOVES, _not_crossing),
            _limit("turn_jerk", "rad/s^3", 1000.0, _TURNS, _not_crossing),
            _limit("torque", "N m", 0.5, "Of each of the three, to both sides"),
            _limit("force", "N", 10.0, "Of M4, to both sides"),
        ),
    ),
    _setting("rate"),
)  # fmt: skip
