"""Drives: motors and gears that fit the motion, in their torque-speed envelopes, and the choice."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

from viser import Icon

from paminsa_viz.actuation.catalog import CatalogError, read_catalog
from paminsa_viz.actuation.duty import Duty
from paminsa_viz.actuation.selection import DriveFigures, size_design
from paminsa_viz.explorer.actions import renamed_if_changed, with_document
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.drives import MOST_MOTIONS, DriveJob, DriveOutcome, find_drives
from paminsa_viz.explorer.entries import Button, ButtonGroup, Custom, Effect, Folder, Html, Upload
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import Checkbox, Dropdown, Number, attribute
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.panels.balance_charts import BalanceChart
from paminsa_viz.explorer.panels.drives_chart import RPM, chart_figure, chart_key
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import NO_DRIVES, Drive, InvalidInput
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.units import NONE, number


def change_settings(state: State, **changes: Any) -> State:
    """Change the settings of the search."""
    settings = replace(state.driving.settings, **changes)
    return state.updated("driving", settings=settings)


def find(state: State) -> State:
    """Start a search on the current motion.

    Raises:
        InvalidInput: If there is no motion.
    """
    settings = state.driving.settings
    duties = settings.cycle or (_current(state)._replace(repeats=1.0),)
    bare = replace(state.document.design, drives=NO_DRIVES)
    return state.updated("driving", running=DriveJob(bare, duties, settings))


def _current(state: State) -> Duty:
    """Return the current motion as it would be added to the cycle."""
    found, settings = motions.planned(state), state.driving.settings
    if found.trajectory is None:
        raise InvalidInput("motion", found.problem or "there is none yet; see the tab “Motion”")
    return Duty(found.trajectory, settings.count, settings.dwell)


def add_motion(state: State) -> State:
    """Add the current motion to the cycle.

    Raises:
        InvalidInput: If there is no motion, or the cycle is full.
    """
    cycle = state.driving.settings.cycle
    if len(cycle) == MOST_MOTIONS:
        raise InvalidInput("cycle", f"at most {MOST_MOTIONS} motions are possible here")
    return change_settings(state, cycle=(*cycle, _current(state)))


def receive(state: State, outcome: DriveOutcome) -> State:
    """Take over a result."""
    return state.updated("driving", running=None, outcome=outcome, row=0)


def choose(state: State, row: int | None) -> State:
    """Make drives of the lists the design's: the first of each, or one of the listed actuator's.

    Raises:
        InvalidInput: If there is none.
    """
    driving, design = state.driving, state.document.design
    outcome = driving.outcome
    if outcome is None or outcome.selection is None:
        raise InvalidInput("drives", "none have been found yet")
    drives = list(design.drives)
    if row is None:
        drives = list(outcome.selection.design(design).drives)
    else:
        for j in driving.shared(driving.actuator):
            drives[j] = driving.listed[row].drive
    return _with_drives(state, drives)


def remove(state: State) -> State:
    """Take all drives off the design."""
    return _with_drives(state, list(NO_DRIVES))


def _with_drives(state: State, drives: list[Any]) -> State:
    design = renamed_if_changed(replace(state.document.design, drives=tuple(drives)))
    return with_document(state, replace(state.document, design=design))


def _open(session: Session, name: str, content: bytes) -> None:
    if not content:
        raise CatalogError(name, "is empty or too large")
    catalog = read_catalog(content, name)
    session.dispatch("drives.catalog", lambda state: change_settings(state, catalog=catalog))
    parts = len(catalog.motors), len(catalog.gears), len(catalog.transmissions)
    session.notify(
        "Catalog opened", "{}: {} motors, {} gears, {} screws and belts".format(name, *parts)
    )


class _Finder:
    """Runs the searches of a session."""

    def __init__(self, session: Session) -> None:
        self._job: BackgroundJob[DriveJob, DriveOutcome] = BackgroundJob(
            session, "drives", lambda job, _: find_drives(job), receive,
            failed=lambda job, problem: DriveOutcome(job, None, problem=problem), undo=False,
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start the search that is wanted."""
        self._job.request(frame.state.driving.running)


def intro_html(frame: Frame) -> str:
    """Return what is searched: the motion and the catalog."""
    settings = frame.state.driving.settings
    found = motions.planned(frame.state)
    return render(
        "drives_intro.j2", motion=found.trajectory, catalog=settings.catalog, cycle=settings.cycle
    )


def list_html(frame: Frame) -> str:
    """Return the list of an actuator's drives, or why there is none."""
    driving, outcome = frame.state.driving, frame.state.driving.outcome
    if outcome is None:
        return ""
    trajectory = motions.planned(frame.state).trajectory
    return render(
        "drives_list.j2", outcome=outcome, rows=driving.listed, chosen=driving.row,
        name=_name(frame.state, driving.actuator), advice=outcome.advice[driving.actuator],
        count=0 if outcome.selection is None else len(outcome.selection.rows[driving.actuator]),
        stale=not outcome.job.serves(frame.state.document.design, trajectory)
        or outcome.job.settings != driving.settings
        or outcome.job.settings.catalog is not driving.settings.catalog,
    )  # fmt: skip


def _name(state: State, actuator: int) -> str:
    return "M1 to M3" if len(state.driving.shared(actuator)) > 1 else ACTUATORS[actuator]


def facts_html(frame: Frame) -> str:
    """Return the figures of the drive in its envelope."""
    shown = frame.state.driving.shown
    if shown is None:
        return ""
    return render("drives_facts.j2", rows=fact_rows(shown))


def fact_rows(one: DriveFigures) -> list[tuple[str, str, str]]:
    """Return what a drive gives, its limit, and the share, as texts."""
    drive = one.drive

    def row(label: str, value: float, limit: float | None, unit: str) -> tuple[str, str, str]:
        if limit is None or not math.isfinite(limit):
            return label, f"{number(value, 3)} {unit}", ""
        share = f"{100 * value / limit:.0f} % of {number(limit, 4)}"
        return label, f"{number(value, 4 if unit == 'rpm' else 3)} {unit}", share

    return [
        row("RMS torque", one.rms, drive.rated_torque, "N·m"),
        row("peak torque", one.peak, drive.corners[0][1], "N·m"),
        ("envelope", f"{100 * one.envelope:.0f} %", ""),
        row("top speed", one.top_speed * RPM, drive.corners[-1][0] * RPM, "rpm"),
        ("peak power", f"{number(one.top_power, 3)} W", ""),
        ("inertia ratio", number(one.inertia_ratio, 3), "robot over motor"),
        ("winding", f"{100 * one.thermal:.0f} %" if math.isfinite(one.thermal) else "–",
         "temperature rise"),
        ("gear ratio", f"{drive.gear_ratio:g}", _ratios(one)),
        ("one count", NONE if drive.resolution is None else _count(drive), "of the encoder"),
    ]  # fmt: skip


def _ratios(one: DriveFigures) -> str:
    """Return with which gear ratios the motor could drive the load."""
    low, high = one.ratios
    if math.isnan(low):
        return "no ratio fits"
    return f"{number(low, 3)} to {number(high, 3)} fit"


def _count(drive: Drive) -> str:
    """Return the motion of the actuator for one count of the encoder."""
    resolution = drive.resolution or 0.0
    return f"{number(1e6 * resolution, 2)} {'µrad' if drive.lead is None else 'µm'}"


def own_html(frame: Frame) -> str:
    """Return the drives of the design and, on the motion of the search, their margins."""
    design, outcome = frame.state.document.design, frame.state.driving.outcome
    sized: tuple[DriveFigures | None, ...] = (None,) * 4
    trajectory = motions.planned(frame.state).trajectory
    if outcome is not None and outcome.selection and outcome.job.serves(design, trajectory):
        sized = size_design(outcome.selection.cycle, design)
    rows = [
        (f"m{j + 1}", name, drive, one)
        for j, (name, drive, one) in enumerate(zip(ACTUATORS, design.drives, sized, strict=True))
    ]
    return render("drives_own.j2", rows=rows, any=any(design.drives))


def _busy(state: State) -> bool:
    return state.driving.running is not None


def _found(state: State) -> bool:
    return state.driving.outcome is not None and state.driving.outcome.selection is not None


def _options(state: State) -> dict[str, int]:
    names = [
        f"{i + 1}: {one.drive.name or one.drive.summary}"
        for i, one in enumerate(state.driving.listed)
    ]
    return {name: row for row, name in enumerate(names)} or {"–": 0}


def _choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {}
    if state.driving.shown is not None:
        name = _name(state, state.driving.actuator)
        found[f"Use for {name}"] = partial(choose, row=state.driving.row)
    if _found(state):
        found["First of each list"] = partial(choose, row=None)
    if any(state.document.design.drives):
        found["Remove"] = remove
    return found


def _cycle_choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {"Add this motion": add_motion}
    if state.driving.settings.cycle:
        found["Clear"] = partial(change_settings, cycle=())
    return found


def _setting(name: str) -> dict[str, Any]:
    return attribute(f"driving.settings.{name}", change_settings)


DRIVES = (
    Html("drives.intro", content=intro_html, idle=True),
    Dropdown(
        "drives.order", "Order",
        options={"lightest first": "mass", "cheapest first": "cost", "most margin first": "margin"},
        hint="Of the feasible drives", **_setting("order"),
    ),
    Checkbox(
        "drives.same", "M1–M3 alike", hint="The three rotary actuators have the same drive",
        **_setting("same"),
    ),
    Number(
        "drives.inertia_ratio", "Inertia ratio ≤", range=(0.0, 1e6), step=1.0,
        hint="Largest inertia of the robot over that of the motor, at the motor's shaft; 0: any",
        **_setting("inertia_ratio"),
    ),
    Number(
        "drives.dwell", "Dwell [s]", range=(0.0, 1e6), step=0.1,
        hint="How long the robot waits after the motion; a brake or a self-locking screw holds it",
        **_setting("dwell"),
    ),
    Number(
        "drives.count", "Times", range=(1.0, 1e6), step=1.0,
        hint="How often the motion is made in a cycle of several motions", **_setting("count"),
    ),
    ButtonGroup("drives.cycle", "Cycle", choices=_cycle_choices),
    Upload(
        "drives.upload", "Open a catalog…", receive=_open, icon=Icon.UPLOAD, mime_type=".csv",
        color="gray", hint="A CSV file of motors, gears, screws and belts; see docs/drives.md",
    ),
    Button(
        "drives.find", "Find drives", icon=Icon.ENGINE, effect=find, undo=False, disabled=_busy,
        hint="Measures every pair of the catalog on the current motion",
    ),
    Custom("drives.job", make=_Finder),
    Folder(
        "drives.found", visible=_found,
        entries=(
            Dropdown(
                "drives.actuator", "Actuator",
                options={name: j for j, name in enumerate(ACTUATORS)},
                read=lambda state: state.driving.actuator,
                apply=lambda state, j: state.updated("driving", actuator=j, row=0),
            ),
            Html("drives.list", content=list_html, idle=True),
            Dropdown(
                "drives.row", "Drive", options=_options, hint="Shown in its envelope",
                **attribute("driving.row"),
            ),
            Custom(
                "drives.chart",
                make=partial(BalanceChart, key=chart_key, figure=chart_figure, aspect=1.0),
            ),
            Html("drives.facts", content=facts_html, idle=True),
        ),
    ),
    Html(
        "drives.problem",
        content=lambda frame: _problem_html(frame.state),
    ),
    ButtonGroup("drives.choice", "Design", choices=_choices),
    Html("drives.own", content=own_html, idle=True),
)  # fmt: skip


def _problem_html(state: State) -> str:
    outcome = state.driving.outcome
    if outcome is None or not outcome.problem:
        return ""
    return render("note.j2", testid="drives-problem", muted=False, text=outcome.problem)
