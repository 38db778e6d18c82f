"""Loads: forces at the joints and in the bars, at the pose shown and along the motion."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Final

import numpy as np

from paminsa_viz.blocks.kinds import Note, shown
from paminsa_viz.blocks.loads import (
    NO_FORCES,
    bars_table,
    joints_table,
    motion_blocks,
    of_leg,
    until_text,
)
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.loads.charts import (
    curves_figure,
    section_figure,
    shown_curves,
    shown_section,
)
from paminsa_viz.explorer.features.loads.solving import (
    ALONG_MOTION,
    bars_at,
    forces_at,
    found,
    instant,
    is_current,
    sideways_at,
)
from paminsa_viz.explorer.kit import downloads as exports
from paminsa_viz.explorer.kit.chart import chart
from paminsa_viz.explorer.kit.entries import Answer, ButtonGroup, Condition, Entry, Html
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import blocks_html, note, render
from paminsa_viz.explorer.state.loads import LoadsSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.loads_table import (
    MotionInstant,
    bar_table,
    bearing_table,
    joint_table,
    motion_loads_table,
)
from paminsa_viz.files.tables import DataTable, table_bytes
from paminsa_viz.model import InvalidInput, Limit
from paminsa_viz.model.elastic import BARS
from paminsa_viz.palette import ACTUATOR_COLORS


def intro(frame: Frame) -> str:
    """Return what the numbers belong to, or why there are none."""
    at, reason = instant(frame.state), problem(frame)
    if reason:
        return blocks_html("loads-intro", Note(f"{NO_FORCES}: {reason}.", "bad"))
    return render("loads/intro.j2", time=at.time, load=at.design.load.acts)


def problem(frame: Frame) -> str:
    """Return why there are no numbers at the pose, or nothing."""
    if not frame.requested.ok.all():
        return frame.explanation
    status = int(forces_at(instant(frame.state)).status)
    return "" if status == Limit.OK else Limit(status).explanation


ROOM = 8
"""Letters that a column of the table of joints has room for, as those of −0.0123."""


def joints(frame: Frame) -> str:
    """Return the table of the joints of the chosen leg."""
    if problem(frame):
        return ""
    at, leg = instant(frame.state), frame.state.loads.settings.leg
    forces = forces_at(at)
    table = of_leg(joints_table(forces, sideways_at(at)), leg)
    widest = max(len(cell) for row in table.rows for cell in row.cells)
    return render(
        "loads/joints.j2", table=table, color=ACTUATOR_COLORS[leg], axial=shown(forces.axial, "N"),
        look="pv-tight" if widest > ROOM else "",
    )  # fmt: skip


def bars(frame: Frame) -> str:
    """Return the table of the bars of the chosen leg."""
    if problem(frame):
        return ""
    view = frame.state.loads.settings
    table = of_leg(bars_table(*bars_at(instant(frame.state))), view.leg)
    return blocks_html("loads-bars", table, chosen=BARS.index(view.bar))


def motion(frame: Frame) -> str:
    """Return the motion table of the chosen leg, or why there is none."""
    view, outcome = frame.state.loads.settings, frame.state.loads.outcome
    if not view.along:
        return ""
    if frame.analysis is None:
        return note("loads-problem", "There is no motion; see the section Path.")
    if outcome is None or not is_current(frame.state):
        return note("loads-problem", "Computing …", muted=True)
    if outcome.result is None:
        return note("loads-problem", outcome.problem)
    until = until_text(outcome.job)
    return blocks_html(
        "loads-motion", *([Note(f"{until}.", "warn")] if until else []),
        Note(f"“{outcome.job.trajectory.name}”, leg {view.leg + 1}:"),
        *(of_leg(table, view.leg) for table in motion_blocks(outcome.result)), bold=[1],
    )  # fmt: skip


POSE_TABLES: Final = {"Joints": "joint-forces", "Bar": "bar-{}"}
MOTION_TABLES: Final = {"Bearings": "bearing-loads", "Samples": "loads"}
"""Names of the files of each answer by what the buttons say."""


def file(state: State, name: str) -> exports.File:
    """Return one of the tables of what is shown as a CSV file.

    Raises:
        InvalidInput: If there are no numbers.
    """
    at_pose = name in POSE_TABLES
    what = (POSE_TABLES | MOTION_TABLES)[name].format(state.loads.settings.bar)
    time = instant(state).time
    if at_pose and time is not None:
        what += f"_t{round(1e3 * time)}ms"
    file_name = exports.file_name(state, what, "csv", "pose" if at_pose else "")
    return exports.File(file_name, table_bytes(_table(state, name), "csv"))


def _table(state: State, name: str) -> DataTable:
    if name in MOTION_TABLES:
        outcome = state.loads.outcome
        if outcome is None or outcome.result is None:
            raise InvalidInput("motion", "there are no loads along a motion yet")
        make = bearing_table if name == "Bearings" else motion_loads_table
        return make(outcome.result)
    at = instant(state)
    forces, pose = forces_at(at), np.array(at.pose)
    if forces.status != Limit.OK or state.document.pose != at.pose:
        raise InvalidInput("pose", "there are no joint forces at this pose")
    moving = None
    if at.time is not None:
        moving = MotionInstant(at.motion, at.time, at.velocity, at.acceleration, at.load)
    if name == "Joints":
        return joint_table(forces, pose, sideways_at(at), moving)
    return bar_table(forces, pose, state.loads.settings.bar, moving)


_setting = SettingInputs("loads", "loads.settings", LoadsSettings)


def _has_motion(state: State) -> bool:
    return found(state) is not None


def _files(key: str, names: Mapping[str, str], visible: Condition | None = None) -> ButtonGroup:
    return exports.table_buttons(key, {name: partial(file, name=name) for name in names}, visible)


LOADS: tuple[Entry, ...] = (
    Answer(
        "loads.answer", "Forces at the pose", always=True,
        entries=(
            Html("loads.intro", content=intro, idle=True),
            Html("loads.joints", content=joints, idle=True),
            Html("loads.bars", content=bars, idle=True),
            chart("loads.sections", shown_section, section_figure, 0.85),
            _files("loads.export", POSE_TABLES),
        ),
    ),
    _setting("leg"),
    _setting("bar"),
    _setting("along"),
    _setting("joint", visible=_has_motion),
    ALONG_MOTION.worker,
    Answer(
        "loads.motion_answer", "Forces along the motion",
        found=lambda state: state.loads.settings.along or None,
        entries=(
            Html("loads.motion", content=motion, idle=True),
            chart("loads.curves", shown_curves, curves_figure, 0.55),
            _files("loads.motion_export", MOTION_TABLES, _has_motion),
        ),
    ),
)  # fmt: skip
