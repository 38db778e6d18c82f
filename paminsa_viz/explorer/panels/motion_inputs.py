"""What motion is planned: a preset, or one that is built from poses, or a file's."""

from __future__ import annotations

import io
from collections.abc import Callable
from html import escape
from typing import Any

from viser import Icon

from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion import planning
from paminsa_viz.explorer.motion.description import Kind, Motion
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.panels.motion_words import pose_words
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.files.errors import TableFileError
from paminsa_viz.files.trajectory_table import parse_trajectory
from paminsa_viz.model import PaminsaError
from paminsa_viz.trajectory import PRESETS, Profile, Trajectory

PRESET_LABELS = {f"Preset: {preset.label}": preset.key for preset in PRESETS}
KIND_LABELS = {
    "Build: move from pose to pose": Kind.MOVE,
    "Build: straight line, θ held": Kind.LINE,
    "Build: pick-and-place arch": Kind.ARCH,
    "Build: through waypoints": Kind.WAYPOINTS,
    "Build: circle": Kind.CIRCLE,
    "From a CSV file": Kind.TABLE,
}
LAWS = {
    "quintic": Profile.QUINTIC,
    "trapezoid": Profile.TRAPEZOID,
    "S-curve": Profile.S_CURVE,
}

Intent = Callable[[State], State]


def kind_label(motion: Motion) -> str:
    """Return what the choice of a motion shows."""
    if motion.kind is Kind.PRESET:
        return next(label for label, key in PRESET_LABELS.items() if key == motion.preset)
    return next(label for label, kind in KIND_LABELS.items() if kind is motion.kind)


def choose(state: State, label: str) -> State:
    """Take over a choice."""
    if label in PRESET_LABELS:
        return motions.choose_preset(state, PRESET_LABELS[label])
    return motions.choose_kind(state, KIND_LABELS[label])


def uploaded_trajectory(name: str, content: bytes, rest: bool) -> Trajectory:
    """Return the trajectory in an uploaded CSV file.

    Raises:
        TableFileError: If there is none in it; row and column say where. The server hands on a
            file that is too large as an empty one.
    """
    if not content:
        raise TableFileError(name, "is empty, or larger than 10 MB")
    text = content.decode("utf-8-sig", errors="surrogateescape")
    return parse_trajectory(io.StringIO(text, newline=""), name, rest=rest)


class MotionInputs:
    """The choice of a motion and the inputs of the chosen one, in the current container."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        motion = session.state.document.motion
        choice = gui.add_dropdown(
            "Motion", (*PRESET_LABELS, *KIND_LABELS), initial_value=kind_label(motion),
            hint="A ready-made motion, or one of your own",
        )  # fmt: skip
        self.poses = gui.add_html("")
        ends = self._buttons(
            "Ends", {"From here": motions.start_here, "To here": motions.goal_here,
                     "Swap": motions.swap_ends},
            "Let the motion begin or end at the pose where the robot stands now",
        )  # fmt: skip
        way = self._buttons(
            "Waypoints", {"Add present": motions.add_waypoint,
                          "Remove last": motions.remove_waypoint,
                          "Clear": motions.clear_waypoints},
            "Move the robot, add its pose, move it on",
        )  # fmt: skip
        center = gui.add_button(
            "Center here", color="gray", hint="Put the center where the robot stands now"
        )
        center.on_click(lambda _: session.dispatch("motion.center", motions.center_here))
        radius = gui.add_number(
            "Radius [mm]", 1e3 * motion.radius, min=1.0, step=1.0, hint="In the plane of x and y"
        )
        height = gui.add_number(
            "Height [mm]", 1e3 * motion.height, min=0.0, step=1.0,
            hint="How far the platform rises above the higher end",
        )  # fmt: skip
        file = gui.add_folder("CSV file")  # viser does not hide an upload button by itself
        with file:
            self.rest = gui.add_checkbox(
                "Begins and ends at rest", False,
                hint="For a few rows; without it, velocities at the ends are what the samples say",
            )  # fmt: skip
            self.upload = gui.add_upload_button(
                "Open a CSV file…", icon=Icon.UPLOAD, mime_type=".csv,.txt",
                hint="Columns t_s, x_m, y_m, theta_rad, z_m (or _ms, _mm, _deg)",
            )  # fmt: skip
        self.upload.on_upload(lambda event: self._on_upload(event.target.value))
        law = gui.add_dropdown(
            "TimeLaw", tuple(LAWS), initial_value=_law(motion), hint="How the motion runs in time"
        )
        back = gui.add_checkbox("and back again", motion.back, hint="A closed motion")
        self._controls = [
            Control(
                session, choice, "motion.kind", choose, lambda s: kind_label(s.document.motion)
            ),
            Control(
                session, law, "motion.profile",
                lambda s, label: motions.change(s, profile=LAWS[label]),
                lambda s: _law(s.document.motion),
            ),
            Control(
                session, back, "motion.back",
                lambda s, value: motions.change(s, back=bool(value)),
                lambda s: s.document.motion.back,
            ),
            self._length(radius, "radius"),
            self._length(height, "height"),
        ]  # fmt: skip
        self._shown: tuple[tuple[Any, Callable[[Kind], bool]], ...] = (
            (self.poses, lambda kind: kind is not Kind.PRESET),
            (ends, lambda kind: kind.has_ends),
            (way, lambda kind: kind is Kind.WAYPOINTS),
            (center, lambda kind: kind is Kind.CIRCLE),
            (radius, lambda kind: kind is Kind.CIRCLE),
            (height, lambda kind: kind is Kind.ARCH),
            (file, lambda kind: kind is Kind.TABLE),
            (law, lambda kind: kind.has_law),
            (back, lambda kind: kind is not Kind.TABLE),
        )

    def _buttons(self, label: str, intents: dict[str, Intent], hint: str) -> Any:
        group = self._session.client.gui.add_button_group(label, tuple(intents), hint=hint)

        def press(event: Any) -> None:
            intent = intents.get(event.target.value)
            if intent is not None:
                self._session.dispatch(f"motion.{label}", intent)

        group.on_click(press)
        return group

    def _length(self, handle: Any, name: str) -> Control:
        return DebouncedInput(
            self._session, handle, f"motion.{name}",
            lambda s, value: motions.change(s, **{name: round(1e-3 * float(value), 9)}),
            lambda s: round(1e3 * getattr(s.document.motion, name), 6),
        )  # fmt: skip

    def _on_upload(self, file: Any) -> None:
        """Read a file on the thread of its upload: a long table would hold up the worker."""
        try:
            table = uploaded_trajectory(file.name, file.content, bool(self.rest.value))
        except PaminsaError as error:
            self._session.notify("Not opened", str(error), bad=True)
            return
        self._session.dispatch("motion.table", lambda state: motions.use_table(state, table))
        self._session.notify("Motion opened", f"{table.name}, {table.size} rows")

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state; show what the chosen motion needs."""
        motion = frame.state.document.motion
        for handle, needed in self._shown:
            if handle.visible != needed(motion.kind):
                handle.visible = needed(motion.kind)
        for control in self._controls:
            control.draw(frame, moving)
        html = poses_html(frame.state)
        if self.poses.content != html:
            self.poses.content = html


def _law(motion: Motion) -> str:
    return next(label for label, profile in LAWS.items() if profile is motion.profile)


def poses_html(state: State) -> str:
    """Return the poses of a motion that is built, or what is known of a file's."""
    document = state.document
    motion, geometry = document.motion, document.design.geometry
    lines: list[str] = []
    if motion.kind.has_ends:
        start, goal = planning.ends(motion, geometry)
        if motion.kind is Kind.LINE:
            goal = (goal[0], goal[1], start[2], goal[3])
        lines = [f"<b>from</b> {pose_words(start)}", f"<b>to</b> {pose_words(goal)}"]
    elif motion.kind is Kind.CIRCLE:
        lines = [f"<b>center</b> {pose_words(planning.center(motion, geometry))}"]
    elif motion.kind is Kind.WAYPOINTS:
        lines = [f"<b>{i}</b> {pose_words(p)}" for i, p in enumerate(motion.waypoints, 1)]
        lines = lines or ["none yet: move the robot, then add its pose"]
    elif motion.kind is Kind.TABLE and motion.table is not None:
        lines = [f"<b>{escape(motion.table.name)}</b>, {motion.table.size} rows"]
        lines += [escape(said) for said in motion.table.notes]
        lines.append("A file's motion is not kept over a reload, nor in a share code.")
    body = '<div style="max-height:110px;overflow-y:auto">' + "<br>".join(lines) + "</div>"
    return note(body, "motion-poses")
