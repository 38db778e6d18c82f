"""Calibrate: poses to measure, measured poses, and the lengths of the legs that they show."""

from __future__ import annotations

from functools import partial

from viser import Icon

from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.calibration import actions, files
from paminsa_viz.explorer.features.calibration import texts as text
from paminsa_viz.explorer.features.calibration.charts import residual_figure, shown_residuals
from paminsa_viz.explorer.kit.chart import chart
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
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.state.calibration import CalibrationSettings, MeasuredPoses
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.measurements import parse_measurements
from paminsa_viz.files.table_reader import uploaded_table
from paminsa_viz.units import counted


def _open(session: Session, name: str, content: bytes) -> None:
    """Read uploaded measured poses, on the thread of the upload.

    Raises:
        TableFileError: If they are refused; row and column say where.
    """
    table = parse_measurements(uploaded_table(name, content), name)
    measured = MeasuredPoses(name, table.measurements, table.first_row)
    session.dispatch(
        "calibrate.measured", lambda state: actions.use_measured(state, measured),
        then=lambda: session.notify(
            "Measured poses opened", f"{name}, {counted(len(table.measurements), 'pose')}"
        ),
    )  # fmt: skip


def _has_plan(state: State) -> bool:
    return actions.PROPOSE.result(state) is not None


def _found(state: State) -> bool:
    return actions.CALIBRATE.result(state) is not None


def _measured_choices(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {"Example": actions.use_example}
    if state.calibration.measured is not None:
        found["Export CSV"] = export("the measured poses", files.measured_csv)
        found["Close"] = actions.close_measured
    return found


def _use_choices(state: State) -> dict[str, Effect]:
    found = actions.CALIBRATE.result(state)
    if found is None or not found.improved:
        return {}
    return {
        "Use as design": Then(
            actions.use_design,
            lambda state: f"“{state.document.design.name}” is the design now: each leg has its own "
            "lengths. Undo goes back.",
        ),
        "Design TOML": export("the design", files.design_toml),
    }  # fmt: skip


_setting = SettingInputs("calibrate", "calibration.settings", CalibrationSettings)

PROPOSED: tuple[Entry, ...] = (
    Html("calibrate.proposed", content=text.proposal_status_html),
    Folder(
        "calibrate.plan", visible=_has_plan,
        entries=(
            ButtonGroup(
                "calibrate.poses_file", "Poses",
                choices={"Export CSV": export("the poses to measure", files.poses_csv)},
                hint="Fill in what is measured, and open the table again",
            ),
            Html("calibrate.plan_lengths", content=text.plan_html, idle=True),
            Folder(
                "calibrate.poses_list", "Poses to measure",
                entries=(Html("calibrate.poses_table", content=text.poses_html, idle=True),),
            ),
        ),
    ),
)  # fmt: skip

FOUND: tuple[Entry, ...] = (
    ButtonGroup(
        "calibrate.use", "Use", choices=_use_choices,
        hint="Each leg with its own lengths, here or as a design file",
    ),
    chart("calibrate.residuals", shown_residuals, residual_figure, 1.0),
    Html("calibrate.errors", content=text.errors_html, idle=True),
    Html("calibrate.lengths", content=text.lengths_html, idle=True),
    table_buttons("calibrate.export", {
        kind.capitalize(): partial(files.calibration_csv, kind=kind)
        for kind in ("lengths", "residuals")
    }),
    Folder(
        "calibrate.sums", "Combinations", open=False,
        entries=(Html("calibrate.combinations", content=text.combinations_html, idle=True),),
    ),
)  # fmt: skip

CALIBRATION: tuple[Entry, ...] = (
    *map(_setting, ("poses", "coordinates", "noise", "seed")),
    *actions.PROPOSE.buttons(
        Button(
            "calibrate.propose", "Propose poses", icon=Icon.MAP_PIN, effect=actions.PROPOSE.start,
            undo=False, hint="Chooses poses to measure that together tell most of the lengths",
        ),
    ),
    actions.PROPOSE.worker,
    Answer(
        "calibrate.proposal_answer", "Poses to measure", found=actions.PROPOSE.outcome,
        entries=PROPOSED,
    ),
    Html("calibrate.measured", content=text.measured_html, idle=True),
    Upload(
        "calibrate.upload", "Open measured poses…", receive=_open, icon=Icon.UPLOAD,
        mime_type=".csv,.txt", color="gray",
        hint="Poses of the built robot with the actuators’ readings",
    ),
    ButtonGroup(
        "calibrate.source", "Measured poses", choices=_measured_choices,
        hint="Example: simulated measurements of a robot whose legs are off at random, to try "
        "it with",
    ),
    _setting("held"),
    *actions.CALIBRATE.buttons(
        Button(
            "calibrate.run", "Calibrate", icon=Icon.ZOOM_CHECK, effect=actions.CALIBRATE.start,
            undo=False, visible=lambda state: state.calibration.measured is not None,
            hint="Fit the lengths of each leg again, from this design’s lengths",
        ),
    ),
    actions.CALIBRATE.worker,
    Answer(
        "calibrate.answer", "Calibration", found=actions.CALIBRATE.outcome,
        entries=(
            Html("calibrate.status", content=text.status_html),
            Folder("calibrate.found", visible=_found, entries=FOUND),
        ),
    ),
)  # fmt: skip
