"""Identify: logs of the built robot, what they say, and the motion to record one with."""

from __future__ import annotations

import io
from functools import partial
from typing import Any

from viser import Icon

from paminsa_viz.explorer import exports
from paminsa_viz.explorer import identify_actions as actions
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.entries import (
    Button,
    ButtonGroup,
    Custom,
    Effect,
    Entry,
    Folder,
    Html,
    Progress,
    Run,
    Upload,
)
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.identifying import (
    CUT_OFFS,
    HARMONICS,
    MOST_PAYLOAD,
    PERIODS,
    SEARCH_TIMES,
    ExcitationJob,
    ExcitationOutcome,
    IdentifyJob,
    IdentifyOutcome,
    identify_logs,
    search_excitation,
)
from paminsa_viz.explorer.inputs import Checkbox, Dropdown, Number, TextBox, attribute
from paminsa_viz.explorer.panels import identify_text as text
from paminsa_viz.explorer.panels.export_panel import Exporter
from paminsa_viz.explorer.panels.motion_chart import LOWEST, MotionChart
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.files.errors import TableFileError
from paminsa_viz.files.log_table import parse_log
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.plots.identification_series import log_charts

UPLOAD_TIMEOUT = 10.0
"""How long an uploaded log may take to read [s]."""


def _open(place: str, session: Session, name: str, content: bytes) -> None:
    """Read an uploaded log, on the thread of the upload.

    Raises:
        TableFileError: If it is refused; row and column say where.
        InvalidInput: If the gains are not four numbers.
    """
    if not content:
        raise TableFileError(name, "is empty, or larger than 10 MB")
    settings = session.state.identifying.settings
    lines = io.StringIO(content.decode("utf-8-sig", errors="surrogateescape"), newline="")
    log = parse_log(
        lines, name, gains=settings.gain_values, split=settings.split, timeout=UPLOAD_TIMEOUT
    )
    session.dispatch(f"identify.{place}", lambda state: actions.use_log(state, place, log))
    session.notify("Log opened", f"{log.name}, {len(log.t)} rows")


class _Jobs:
    """Runs the identifications and searches of a session."""

    def __init__(self, session: Session) -> None:
        self._logs: BackgroundJob[IdentifyJob, IdentifyOutcome] = BackgroundJob(
            session, "identify", identify_logs, actions.receive,
            failed=lambda job, problem: IdentifyOutcome(job, None, problem), undo=False,
        )  # fmt: skip
        self._motions: BackgroundJob[ExcitationJob, ExcitationOutcome] = BackgroundJob(
            session, "excitation", search_excitation, actions.receive_excitation,
            failed=lambda job, problem: ExcitationOutcome(job, None, problem),
            progress=actions.search_progress, undo=False,
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start what is wanted."""
        own = frame.state.identifying
        self._logs.request(own.running)
        self._motions.request(own.searching)


class _Charts:
    """Measured and predicted torque of an actuator, and the residual."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        place = gui.add_folder(None)
        self._charts = tuple(MotionChart(gui, place, order, LOWEST) for order in (0.0, 1.0))
        self._drawn: tuple[object, int] | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what has changed."""
        own = frame.state.identifying
        key = (own.findings, own.actuator)
        if dragging or key == self._drawn:
            return
        self._drawn = key
        found = own.findings
        charts = (None, None) if found is None else log_charts(found.identification, own.actuator)
        for chart, data in zip(self._charts, charts, strict=True):
            chart.draw(data)


def _found(state: State) -> bool:
    return state.identifying.findings is not None


def _searching(state: State) -> bool:
    return state.identifying.searching is not None


def _has_motion(state: State) -> bool:
    outcome = state.identifying.excited
    return outcome is not None and outcome.excitation is not None


def _log_choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {"Example": actions.use_examples}
    if state.identifying.log is not None:
        found["Close logs"] = actions.close_logs
    return found


def _setting(name: str) -> dict[str, Any]:
    return attribute(f"identifying.settings.{name}", actions.change_settings)


def _upload(place: str, label: str, hint: str) -> Upload:
    return Upload(
        f"identify.{place}.upload", label, receive=partial(_open, place), icon=Icon.UPLOAD,
        mime_type=".csv,.txt", color=None if place == "log" else "gray", hint=hint,
    )  # fmt: skip


def identify_entries() -> tuple[Entry, ...]:
    """Return the entries of the tab."""
    exporter, table = Exporter(), exports.identification_table

    def export(what: str, make: Any, **options: str) -> Run:
        return exporter.run(what, lambda session: make(session.state, **options))

    return (
        Html("identify.logs", content=text.logs_html, idle=True),
        _upload("log", "Open a log…", "Positions and torques of the built robot over time"),
        ButtonGroup("identify.examples", "Logs", choices=_log_choices),
        Folder(
            "identify.more", "More logs and settings", open=False,
            entries=(
                _upload("other", "Second log…", "On another motion: validates the first"),
                _upload("loaded", "Log with payload…", "Gives the payload, or a common gain"),
                Number(
                    "identify.payload", "Payload [kg]", range=(0.0, MOST_PAYLOAD), step=0.1,
                    hint="Of the third log; 0: not weighed", **_setting("payload"),
                ),
                Number(
                    "identify.cut_off", "Cut-off [Hz]", range=CUT_OFFS, step=0.5,
                    hint="Where the filter halves; 8 to 12 Hz suits most logs",
                    **_setting("cut_off"),
                ),
                TextBox(
                    "identify.gains", "Gains",
                    hint="For logs of currents: N·m/A of M1 to M3 and N/A of M4; type them before "
                    "the log is opened",
                    **_setting("gains"),
                ),
                Checkbox(
                    "identify.split", "Split at gaps",
                    hint="Instead of refusing a log with gaps or rows out of reach",
                    **_setting("split"),
                ),
                Checkbox(
                    "identify.delay", "Fit a delay",
                    hint="Of the torques after the positions", **_setting("delay"),
                ),
                Checkbox(
                    "identify.legs", "Legs of their own",
                    hint="Fit how the legs’ masses differ", **_setting("legs"),
                ),
                Checkbox(
                    "identify.rotors", "Rotors differ",
                    hint="Fit how the rotors’ inertias of M1 to M3 differ", **_setting("rotors"),
                ),
                Checkbox(
                    "identify.constrain", "Hold the identity",
                    hint="Of the masses, which only springs break", **_setting("constrain"),
                ),
            ),
        ),
        Button(
            "identify.run", "Identify", icon=Icon.ZOOM_CHECK, effect=actions.identify, undo=False,
            visible=lambda state: state.identifying.log is not None,
            disabled=lambda state: state.identifying.running is not None,
            hint="Fit the log again, with these settings and this design’s lengths",
        ),
        Custom("identify.jobs", make=_Jobs),
        Html("identify.status", content=text.status_html),
        Folder(
            "identify.found", visible=_found,
            entries=(
                Dropdown(
                    "identify.actuator", "Actuator",
                    options={name: j for j, name in enumerate(ACTUATORS)},
                    **attribute("identifying.actuator"),
                ),
                Custom("identify.charts", make=_Charts),
                Html("identify.numbers", content=text.numbers_html, idle=True),
                Html("identify.checks", content=text.checks_html, idle=True),
                Html("identify.causes", content=text.causes_html, idle=True),
                ButtonGroup(
                    "identify.use", "Use",
                    choices={
                        "Use as design": actions.use_design,
                        "Play the log": actions.use_log_motion,
                    },
                    hint="The nearest masses and the friction; or the log’s motion in the scene",
                ),
                ButtonGroup(
                    "identify.export", "Export",
                    choices={
                        "Numbers": export("the numbers", table, kind="parameters"),
                        "Residuals": export("the residuals", table, kind="residuals"),
                    },
                    hint="CSV files",
                ),
                Folder(
                    "identify.masses", "Nearest masses", open=False,
                    entries=(Html("identify.masses.list", content=text.masses_html, idle=True),),
                ),
            ),
        ),
        Folder(
            "identify.excitation", "Motion for a log",
            entries=(
                Number(
                    "identify.period", "Period [s]", range=PERIODS, step=1.0, **_setting("period")
                ),
                Number(
                    "identify.harmonics", "Harmonics", range=HARMONICS, step=1.0,
                    read=lambda state: float(state.identifying.settings.harmonics),
                    apply=lambda state, count: actions.change_settings(
                        state, harmonics=round(count)
                    ),
                ),
                Number(
                    "identify.seconds", "Search for [s]", range=SEARCH_TIMES, step=5.0,
                    **_setting("seconds"),
                ),
                Button(
                    "identify.search", "Find the best motion", icon=Icon.WAVE_SINE,
                    effect=actions.search, undo=False, visible=lambda state: not _searching(state),
                    hint="A D-optimal multi-sine within the drives’ limits and κ ≤ 5",
                ),
                Progress(
                    "identify.progress", read=lambda state: state.identifying.done,
                    visible=_searching,
                ),
                Button("identify.stop", "Stop", color="gray", effect=actions.stop, undo=False,
                       visible=_searching),
                Html("identify.excited", content=text.excitation_html, idle=True),
                ButtonGroup(
                    "identify.motion", "Motion", visible=_has_motion,
                    choices={
                        "Use as motion": actions.use_excitation,
                        "Export CSV": export("the motion", exports.excitation_csv),
                    },
                ),
            ),
        ),
    )  # fmt: skip
