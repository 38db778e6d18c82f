"""Loads: forces at the joints and in the bars, at the pose shown and along the motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.elastostatics.bar_loads import BAR_NAMES
from paminsa_viz.elastostatics.joint_forces import JOINTS
from paminsa_viz.elastostatics.motion_loads import MotionLoads
from paminsa_viz.explorer import exports
from paminsa_viz.explorer.background import JobRunner
from paminsa_viz.explorer.entries import ButtonGroup, Custom, Effect, Entry, Html
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.loads import (
    LoadsOutcome,
    LoadsState,
    bars_at,
    find_loads,
    forces_at,
    sideways_at,
)
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels import note, render
from paminsa_viz.explorer.panels.export_panel import Exporter
from paminsa_viz.explorer.panels.loads_chart import motion_chart, section_chart, shown
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.setting_inputs import SettingInputs
from paminsa_viz.explorer.state import State
from paminsa_viz.files.loads_table import bar_table, bearing_table, joint_table, motion_loads_table
from paminsa_viz.files.tables import DataTable, table_bytes
from paminsa_viz.model import InvalidInput, Limit
from paminsa_viz.model.elastic import BARS
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, number


class LoadsEntries(NamedTuple):
    """The entries of the tab and the motions that they read."""

    motions: MotionStore

    def intro(self, frame: Frame) -> str:
        """Return what the numbers belong to, or why there are none."""
        state = frame.state
        at = shown(state, self.motions)
        reason = self.problem(frame)
        return render("loads_intro.j2", reason=reason, time=at.time, load=at.design.load.acts)

    def problem(self, frame: Frame) -> str:
        """Return why there are no numbers at the pose, or nothing."""
        if not frame.requested.ok.all():
            return frame.explanation
        status = int(forces_at(shown(frame.state, self.motions)).status)
        return "" if status == Limit.OK else Limit(status).explanation

    def joints(self, frame: Frame) -> str:
        """Return the table of the joints of the chosen leg."""
        if self.problem(frame):
            return ""
        at, leg = shown(frame.state, self.motions), frame.state.loads.leg
        forces, sideways = forces_at(at), sideways_at(at)
        rows = []
        for index, joint in enumerate(JOINTS):
            r, t, z = forces.force[leg, index].tolist()
            t = t if sideways is None else float(sideways[leg, index])
            moment = float(forces.moment[leg, index])
            rows.append(
                (
                    joint.label, joint.on, joint.by, _text(r), _text(t), _text(z),
                    _text(moment) if joint.key in ("m", "2") else "",
                )
            )  # fmt: skip
        return render("loads_joints.j2", rows=rows, leg=leg, axial=_text(float(forces.axial)))

    def bars(self, frame: Frame) -> str:
        """Return the table of the bars of the chosen leg."""
        if self.problem(frame):
            return ""
        view = frame.state.loads
        inner, use = bars_at(shown(frame.state, self.motions))
        rows = [
            (
                BAR_NAMES[bar], *map(_text, inner[view.leg, index]),
                _percent(float(use[view.leg, index])), bar == view.bar,
            )
            for index, bar in enumerate(BARS)
        ]  # fmt: skip
        return render("loads_bars.j2", rows=rows)

    def sections(self, frame: Frame) -> str:
        """Return N, V and M along the chosen bar."""
        if self.problem(frame):
            return ""
        view = frame.state.loads
        return section_chart(shown(frame.state, self.motions), view.bar, view.leg)

    def curves(self, frame: Frame) -> str:
        """Return the chosen joint's force along the motion."""
        found = self.found(frame.state)
        return "" if found is None else motion_chart(found, frame.state.loads.joint)

    def found(self, state: State) -> MotionLoads | None:
        """Return the loads of the current design along the current motion, if they are known."""
        outcome = state.loads.outcome
        if not state.loads.along or outcome is None:
            return None
        return outcome.result if outcome.job is self.motions.analysis(state) else None

    def motion(self, frame: Frame) -> str:
        """Return the motion table of the chosen leg, or why there is none."""
        view = frame.state.loads
        if not view.along:
            return ""
        analysis = self.motions.analysis(frame.state)
        if analysis is None:
            return note("loads-problem", "There is no motion; see the tab “Motion”.")
        outcome = view.outcome
        if outcome is None or outcome.job is not analysis:
            return note("loads-problem", "Computing …", muted=True)
        if outcome.result is None:
            return note("loads-problem", outcome.problem)
        loads, leg = outcome.result, view.leg
        rows = [
            (
                joint.label, _text(loads.peak[leg, i]), f"{loads.peak_time[leg, i]:.2f}",
                _text(loads.rms[leg, i]), _text(loads.equivalent[leg, i]),
            )
            for i, joint in enumerate(JOINTS)
        ]  # fmt: skip
        use = loads.utilization.max(axis=0)[leg]
        bars = [
            (BAR_NAMES[bar], *(_text(v) for v in loads.bar_peak[leg, i]), _percent(float(use[i])))
            for i, bar in enumerate(BARS)
        ]
        first = analysis.check.first
        return render(
            "loads_motion.j2", rows=rows, bars=bars, leg=leg, name=analysis.trajectory.name,
            failure=first.explanation if first is not None else "",
        )  # fmt: skip

    def files(self, exporter: Exporter, state: State) -> dict[str, Effect]:
        """Return the buttons of the tables."""
        names = ["Joints", "Bar"]
        if self.found(state) is not None:
            names += ["Bearings", "Samples"]

        def make(name: str, session: Session) -> exports.File:
            return self.file(session.state, name)

        return {name: exporter.run("loads", partial(make, name)) for name in names}

    def file(self, state: State, name: str) -> exports.File:
        """Return a table of what is shown as a CSV file.

        Raises:
            InvalidInput: If there are no numbers.
        """
        table = self._table(state, name)
        what = {"Joints": "joint-forces", "Bar": f"bar-{state.loads.bar}"}.get(
            name, {"Bearings": "bearing-loads"}.get(name, "loads")
        )
        at_pose = name in ("Joints", "Bar")
        content = table_bytes(table, "csv")
        return exports.File(exports.file_name(state, what, "csv", at_pose=at_pose), content)

    def _table(self, state: State, name: str) -> DataTable:
        if name in ("Bearings", "Samples"):
            outcome = state.loads.outcome
            if outcome is None or outcome.result is None:
                raise InvalidInput("motion", "there are no loads along a motion yet")
            make = bearing_table if name == "Bearings" else motion_loads_table
            return make(outcome.result)
        at = shown(state, self.motions)
        forces = forces_at(at)
        if forces.status != Limit.OK or state.document.pose != state.last_reachable.pose:
            raise InvalidInput("pose", "there are no joint forces at this pose")
        pose = np.array(at.pose)
        if name == "Joints":
            return joint_table(forces, pose, sideways_at(at))
        return bar_table(forces, pose, state.loads.bar)


class LoadsRunner(JobRunner[TrajectoryAnalysis, MotionLoads]):
    """Computes the loads along the motion while they are wanted, once nothing is dragged."""

    def __init__(self, session: Session, motions: MotionStore) -> None:
        super().__init__(session, "loads", find_loads, receive)
        self._motions = motions

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Ask for what is wanted."""
        if not dragging:
            state = frame.state
            self.request(self._motions.analysis(state) if state.loads.along else None)


def receive(state: State, outcome: LoadsOutcome) -> State:
    """Take over a result."""
    return state.updated("loads", outcome=outcome)


def _text(value: Any) -> str:
    value = float(value)
    if math.isnan(value):
        return NONE
    return number(0.0 if abs(value) < 1e-9 else value, 3)


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %"


def loads_entries(motions: MotionStore) -> Sequence[Entry]:
    """Return the entries of the tab; analyzed motions come from the store."""
    tab, exporter = LoadsEntries(motions), Exporter()
    setting = SettingInputs("loads", "loads", LoadsState)

    return (
        Html("loads.intro", content=tab.intro, idle=True),
        setting("leg"),
        Html("loads.joints", content=tab.joints, idle=True),
        Html("loads.bars", content=tab.bars, idle=True),
        setting("bar"),
        Html("loads.sections", content=tab.sections, idle=True),
        setting("along"),
        Custom("loads.job", make=partial(LoadsRunner, motions=motions)),
        Html("loads.motion", content=tab.motion, idle=True),
        setting("joint", visible=lambda state: tab.found(state) is not None),
        Html("loads.curves", content=tab.curves, idle=True),
        ButtonGroup(
            "loads.files", "CSV", choices=partial(tab.files, exporter),
            hint="Tables: joints and the bar at this pose; bearings and all samples of the motion",
        ),
    )  # fmt: skip
