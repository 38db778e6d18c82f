"""Drives: motors and gears that fit the motion, in their torque-speed envelopes, and the choice."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from operator import methodcaller
from typing import Any

from viser import Icon

from paminsa_viz.actuation.duty import Duty
from paminsa_viz.actuation.selection import DriveFigures, size_design
from paminsa_viz.blocks.drives import FIGURES_HEAD, facts_table, figures_table, own_table
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.drives.charts import chart_figure, shown_drive
from paminsa_viz.explorer.features.drives.solving import find_drives
from paminsa_viz.explorer.kit.chart import chart
from paminsa_viz.explorer.kit.entries import (
    Answer,
    Button,
    ButtonGroup,
    Effect,
    Folder,
    Html,
    Then,
    Upload,
)
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, attribute
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.kit.text import blocks_html, note, render
from paminsa_viz.explorer.state.drives import MOST_MOTIONS, DriveJob, DriveLists, DriveSettings
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.drive_catalog import read_catalog
from paminsa_viz.model import NO_DRIVES, InvalidInput
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.units import counted


def _job(state: State) -> DriveJob:
    settings = state.drives.settings
    duties = settings.cycle or (_current(state)._replace(repeats=1.0),)
    bare = replace(state.document.design, drives=NO_DRIVES)
    return DriveJob(bare, duties, settings)


def _current(state: State) -> Duty:
    """Return the current motion as it would be added to the cycle."""
    found, settings = motions.planned(state), state.drives.settings
    if found.trajectory is None:
        raise motions.no_motion(state)
    return Duty(found.trajectory, settings.count, settings.dwell)


def add_motion(state: State) -> State:
    """Add the current motion to the cycle.

    Raises:
        InvalidInput: If there is no motion, or the cycle is full.
    """
    cycle = state.drives.settings.cycle
    if len(cycle) == MOST_MOTIONS:
        raise InvalidInput("cycle", f"at most {MOST_MOTIONS} motions are possible here")
    return state.updated("drives.settings", cycle=(*cycle, _current(state)))


def receive(state: State, outcome: Outcome[DriveJob, DriveLists]) -> State:
    """Take over a result; the first of its drives is shown."""
    return state.updated("drives", outcome=outcome, row=0)


SEARCH = Task(Place(lambda state: state.drives), _job, find_drives, receive=receive)
"""Searches for drives for the cycle or, without one, the current motion."""


def choose(state: State, row: int | None) -> State:
    """Make drives of the lists the design's: the first of each, or one of the listed actuator's.

    Raises:
        InvalidInput: If there is none.
    """
    own, design = state.drives, state.document.design
    if own.result is None:
        raise InvalidInput("drives", "none have been found yet")
    if row is None:
        return actions.with_design(state, own.result.selection.design(design))
    drives: Any = list(design.drives)
    for j in own.shared(own.actuator):
        drives[j] = own.listed[row].drive
    return actions.change_design(state, drives=tuple(drives))


def _open(session: Session, name: str, content: bytes) -> None:
    catalog = read_catalog(content, name)
    action = methodcaller("updated", "drives.settings", catalog=catalog)
    parts = (
        counted(len(catalog.motors), "motor"),
        counted(len(catalog.gears), "gear"),
        counted(len(catalog.transmissions), "screw or belt", "screws and belts"),
    )
    opened = partial(session.notify, "Catalog opened", f"{name}: {', '.join(parts)}")
    session.dispatch("drives.catalog", action, then=opened)


def intro_html(frame: Frame) -> str:
    """Return what is searched: the motion and the catalog."""
    settings = frame.state.drives.settings
    found = motions.planned(frame.state)
    return render(
        "drives/intro.j2", motion=found.trajectory, catalog=settings.catalog, cycle=settings.cycle
    )


def list_html(frame: Frame) -> str:
    """Return the list of an actuator's drives, or why there is none."""
    drives = frame.state.drives
    outcome, found = drives.outcome, drives.result
    if outcome is None or found is None:
        return ""
    first = [(f"{i}", one) for i, one in enumerate(drives.listed, 1)]
    # The page is narrow: of mass and cost it shows what the list is in the order of.
    ranked = "Cost" if outcome.job.settings.order == "cost" else "Mass [kg]"
    return render(
        "drives/list.j2", chosen=drives.row, stale=SEARCH.stale_text(frame.state),
        table=figures_table("", first).columns(0, 1, 3, 4, FIGURES_HEAD.index(ranked)),
        name=_name(frame.state, drives.actuator), advice=found.advice[drives.actuator],
        count=len(found.selection.rows[drives.actuator]),
    )  # fmt: skip


def _name(state: State, actuator: int) -> str:
    return "M1 to M3" if len(state.drives.shared(actuator)) > 1 else ACTUATORS[actuator]


def facts_html(frame: Frame) -> str:
    """Return the figures of the drive in its envelope."""
    shown = frame.state.drives.shown
    if shown is None:
        return ""
    return blocks_html("drives-facts", facts_table(shown), bold=[1])


def own_html(frame: Frame) -> str:
    """Return the drives of the design and, on the motion of the search, their margins."""
    design, outcome = frame.state.document.design, frame.state.drives.outcome
    sized: tuple[DriveFigures | None, ...] = (None,) * 4
    now = SEARCH.now(frame.state)
    same = now is not None and outcome is not None and now.same_robot(outcome.job)
    if same and outcome is not None and outcome.result is not None:
        sized = size_design(outcome.result.selection.cycle, design)
    table = own_table(design, sized).columns(0, 1, 3, 4)
    some = any(design.drives)
    return render("drives/own.j2", table=table, any=some, is_measured=any(sized))


def _found(state: State) -> bool:
    return state.drives.result is not None


def _options(state: State) -> dict[str, int]:
    names = [
        f"{i + 1}: {one.drive.name or one.drive.summary}"
        for i, one in enumerate(state.drives.listed)
    ]
    return {name: row for row, name in enumerate(names)} or {"–": 0}


def _choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {}
    if state.drives.shown is not None:
        name = _name(state, state.drives.actuator)
        found[f"Use for {name}"] = Then(partial(choose, row=state.drives.row), _used)
    if _found(state):
        found["First of each list"] = Then(partial(choose, row=None), _used)
    if any(state.document.design.drives):
        found["Remove"] = Then(partial(actions.change_design, drives=NO_DRIVES), _used)
    return found


def _cycle_choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {"Add this motion": add_motion}
    if state.drives.settings.cycle:
        found["Clear"] = methodcaller("updated", "drives.settings", cycle=())
    return found


def problem_html(frame: Frame) -> str:
    """Return why there are no drives."""
    outcome = frame.state.drives.outcome
    problem = "" if outcome is None else outcome.problem
    return note("drives-problem", problem) if problem else ""


USUAL_RATIO = 10.0
"""Limit of the ratio of inertias that is offered first; many drives' makers advise it."""


def _limits_ratio(state: State) -> bool:
    return state.drives.settings.inertia_ratio > 0


def _used(state: State) -> str:
    """Return which drives the design has."""
    pairs = zip(ACTUATORS, state.document.design.drives, strict=True)
    chosen = ", ".join(
        f"{name} {drive.name or drive.summary}" for name, drive in pairs if drive is not None
    )
    return f"Drives of the design: {chosen or 'none'}. Undo goes back."


_setting = SettingInputs("drives", "drives.settings", DriveSettings)

DRIVES = (
    Html("drives.intro", content=intro_html, idle=True),
    *map(_setting, ("order", "same")),
    Checkbox(
        "drives.any_ratio", "Any inertia ratio",
        hint="Of the robot over the motor, at the motor’s shaft; otherwise it is limited",
        read=lambda state: not _limits_ratio(state),
        apply=lambda state, any_ratio: state.updated(
            "drives.settings", inertia_ratio=0.0 if any_ratio else USUAL_RATIO
        ),
    ),
    _setting("inertia_ratio", visible=_limits_ratio),
    *map(_setting, ("dwell", "count")),
    ButtonGroup(
        "drives.cycle", "Cycle", choices=_cycle_choices,
        hint="Motions that drives are sized for together, each with its dwell and times; without "
        "any, the current motion alone",
    ),
    Upload(
        "drives.upload", "Open a catalog…", receive=_open, icon=Icon.UPLOAD, mime_type=".csv",
        color="gray", hint="A CSV file of motors, gears, screws and belts; see docs/drives.md",
    ),
    *SEARCH.buttons(
        Button(
            "drives.find", "Find drives", icon=Icon.ENGINE, effect=SEARCH.start, undo=False,
            hint="Measures every pair of the catalog on the motion, or on the cycle",
        ),
    ),
    SEARCH.worker,
    Answer(
        "drives.answer", "Drives", found=SEARCH.outcome, always=True,
        entries=(
            Folder(
                "drives.found", visible=_found,
                entries=(
                    Dropdown(
                        "drives.actuator", "Actuator",
                        options={name: j for j, name in enumerate(ACTUATORS)},
                        hint="Whose drives are listed, and whose curve is drawn",
                        read=lambda state: state.drives.actuator,
                        apply=lambda state, j: state.updated("drives", actuator=j, row=0),
                    ),
                    Html("drives.list", content=list_html, idle=True),
                    Dropdown(
                        "drives.row", "Drive", options=_options, hint="Shown in its envelope",
                        **attribute("drives.row"),
                    ),
                ),
            ),
            Html("drives.problem", content=problem_html),
            ButtonGroup(
                "drives.choice", "Design", choices=_choices,
                hint="Puts the drive shown, or the first one of each actuator, into the design",
            ),
            chart("drives.chart", shown_drive, chart_figure, 0.8),
            Html("drives.facts", content=facts_html, idle=True),
            Html("drives.own", content=own_html, idle=True),
        ),
    ),
)  # fmt: skip
