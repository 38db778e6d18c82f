"""Identify: logs of the built robot, what they say, and the motion to record one with."""

from __future__ import annotations

from functools import partial

from viser import Icon

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.identification import actions
from paminsa_viz.explorer.features.identification import texts as text
from paminsa_viz.explorer.features.identification.files import excitation_csv, identification_table
from paminsa_viz.explorer.kit.curves import motion_charts
from paminsa_viz.explorer.kit.downloads import export, table_buttons
from paminsa_viz.explorer.kit.entries import (
    Answer,
    Button,
    ButtonGroup,
    Effect,
    Entry,
    Folder,
    Html,
    Then,
    Upload,
)
from paminsa_viz.explorer.kit.inputs import Dropdown, attribute
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import note
from paminsa_viz.explorer.state.identification import IdentifySettings, parse_gains
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.logs import parse_log
from paminsa_viz.files.table_reader import UPLOAD_TIMEOUT, uploaded_table
from paminsa_viz.identification import Identification
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.plots.identification_series import log_charts
from paminsa_viz.units import counted


def _open(place: str, session: Session, name: str, content: bytes) -> None:
    """Read an uploaded log, on the thread of the upload.

    Raises:
        TableFileError: If it is refused; row and column say where.
        InvalidInput: If the gains are not four numbers.
    """
    settings = session.state.identification.settings
    lines = uploaded_table(name, content)
    log = parse_log(
        lines, name, gains=parse_gains(settings.gains), split=settings.split, timeout=UPLOAD_TIMEOUT
    )
    session.dispatch(
        f"identify.{place}", lambda state: actions.use_log(state, place, log),
        then=lambda: session.notify("Log opened", f"{log.name}, {counted(len(log.t), 'row')}"),
    )  # fmt: skip


def _shown(frame: Frame) -> tuple[Identification, int] | None:
    """Return what the charts show: an identification, and one of the actuators; None for none."""
    own = frame.state.identification
    return None if own.result is None else (own.result.identification, own.actuator)


def _found(state: State) -> bool:
    return state.identification.result is not None


def _has_motion(state: State) -> bool:
    return state.identification.excitation.result is not None


def _log_choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {"Example": actions.use_examples}
    if state.identification.log is not None:
        found["Close logs"] = actions.close_logs
    return found


_setting = SettingInputs("identify", "identification.settings", IdentifySettings)


def _upload(place: str, label: str, hint: str) -> Upload:
    return Upload(
        f"identify.{place}.upload", label, receive=partial(_open, place), icon=Icon.UPLOAD,
        mime_type=".csv,.txt", color=None if place == "log" else "gray", hint=hint,
    )  # fmt: skip


FOUND: tuple[Entry, ...] = (
    ButtonGroup(
        "identify.use", "Use",
        choices={
            "Use as design": Then(
                actions.use_design,
                lambda state: f"“{state.document.design.name}” is the design now: its "
                "masses and friction are those nearest to the log. Undo goes back.",
            ),
            "Play the log": Then(
                actions.use_log_motion, "The robot runs the motion of the log.",
                opens="Path",
            ),
        },
        hint="The nearest masses and the friction; or the log’s motion in the scene",
    ),
    Dropdown(
        "identify.actuator", "Actuator", hint="Whose torque is drawn, and what is left of it",
        options={name: j for j, name in enumerate(ACTUATORS)},
        **attribute("identification.actuator"),
    ),
    motion_charts("identify.charts", _shown, log_charts),
    Html("identify.numbers", content=text.numbers_html, idle=True),
    Html("identify.checks", content=text.checks_html, idle=True),
    Html("identify.causes", content=text.causes_html, idle=True),
    table_buttons("identify.export", {
        "Numbers": partial(identification_table, kind="parameters"),
        "Residuals": partial(identification_table, kind="residuals"),
    }),
    Folder(
        "identify.masses", "Nearest masses", open=False,
        entries=(Html("identify.masses.list", content=text.masses_html, idle=True),),
    ),
)  # fmt: skip

LOGS: tuple[Entry, ...] = (
    Html("identify.logs", content=text.logs_html, idle=True),
    _upload("log", "Open a log…", "Positions and torques of the built robot over time"),
    ButtonGroup(
        "identify.examples", "Logs", choices=_log_choices,
        hint="Example: a log of a robot simulated in MuJoCo, to try it with",
    ),
    Folder(
        "identify.more", "More logs and settings", open=False,
        entries=(
            _upload("other", "Second log…", "On another motion: validates the first"),
            _upload("loaded", "Log with payload…", "Gives the payload, or a common gain"),
            *map(_setting, ("payload", "cut_off", "gains", "split")),
            *map(_setting, ("delay", "legs", "rotors", "constrain")),
        ),
    ),
    Button(
        "identify.run", "Identify", icon=Icon.ZOOM_CHECK, effect=actions.IDENTIFY.start, undo=False,
        visible=lambda state: state.identification.log is not None,
        disabled=actions.IDENTIFY.runs,
        hint="Fit the log again, with these settings and this design’s lengths",
    ),
    actions.IDENTIFY.worker,
    Html(
        "identify.about", content=text.status_html,
        visible=lambda state: state.identification.outcome is None,
    ),
    Answer(
        "identify.answer", "Identification", found=actions.IDENTIFY.outcome,
        entries=(
            Html("identify.status", content=text.status_html),
            Folder("identify.found", visible=_found, entries=FOUND),
        ),
    ),
)  # fmt: skip

WHAT_FOR = (
    "Masses and friction show in a log only as far as its motion moves them. This finds the motion "
    "that shows them best: run it on the built robot, and open its log in the section Logs."
)

EXCITE: tuple[Entry, ...] = (
    Html("identify.excite_about", content=note("excite-about", WHAT_FOR, muted=True)),
    *map(_setting, ("period", "harmonics", "seconds")),
    *actions.SEARCH.buttons(
        Button(
            "identify.search", "Find the best motion", icon=Icon.WAVE_SINE,
            effect=actions.SEARCH.start, undo=False,
            hint="A D-optimal multi-sine within the drives’ limits and κ ≤ 5",
        ),
    ),
    actions.SEARCH.worker,
    Answer(
        "identify.excited_answer", "Motion for a log", found=actions.SEARCH.outcome,
        entries=(
            Html("identify.excited", content=text.excitation_html, idle=True),
            ButtonGroup(
                "identify.motion", "Motion", visible=_has_motion,
                hint="Makes it the current motion, or writes it for the robot’s controller",
                choices={
                    "Use as motion": Then(
                        actions.use_excitation,
                        "The motion to record a log with is the current one.", opens="Path",
                    ),
                    "Export CSV": export("the motion", excitation_csv),
                },
            ),
        ),
    ),
)  # fmt: skip
