"""Buttons that export what the page shows: figures, data, the robot and the 3D view."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import FULL, MapStore, shows_difference
from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.export import exports, pictures
from paminsa_viz.explorer.features.export.copying import COPIED, copy_run
from paminsa_viz.explorer.features.export.recording import Recorder
from paminsa_viz.explorer.kit.downloads import File, export, session_export
from paminsa_viz.explorer.kit.entries import Button, ButtonGroup, Entry, Html, ProgressBar, Run
from paminsa_viz.explorer.kit.inputs import Dropdown, Number, attribute
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.scene.legend import NO_LEGEND, Legend, SceneLegend
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.exports import CODE, TARGETS, Target
from paminsa_viz.files.tables import TABLE_FORMATS
from paminsa_viz.model.accuracy import noting_equal_legs
from paminsa_viz.plots.animations import ANIMATION_FORMATS
from paminsa_viz.plots.formats import FIGURE_FORMATS
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.synthesis.volume.surface import VOLUME_FORMATS

Make = Callable[..., File]

_MODELS = {name: each for name, each in TARGETS.items() if name != "glb"}


def _recording(state: State) -> bool:
    return state.recording.running is not None


VIEW_SIZES: dict[str, tuple[int, int] | None] = {
    "as on the page": None,
    "1920 × 1080": (1920, 1080),
    "2560 × 1440": (2560, 1440),
    "3840 × 2160": (3840, 2160),
}


def light_view(session: Session, legend: Legend) -> File:
    """Return a picture of the 3D view with the colors of the light theme."""
    state = session.state
    with session.holding_scene():
        if state.theme.dark:
            session.show_scene(replace(state, appearance=Appearance.LIGHT))
        return pictures.view(state, session.client, legend)


def _figures() -> dict[str, str]:
    """Return the labels of the figure formats by their names."""
    return {name: each.label for name, each in FIGURE_FORMATS.items()}


LINE_TABLE = "csv"
"""The table format that is offered below a figure."""


def _line(key: str, what: str, figure: Make, table: Make) -> ButtonGroup:
    """Return the line below a figure on the page: it as a figure, and its numbers."""
    choices = {
        label: export(f"{what} as {label}", partial(figure, kind=kind))
        for kind, label in _figures().items()
    }
    numbers = export(f"{what} as {LINE_TABLE.upper()}", partial(table, kind=LINE_TABLE))
    return ButtonGroup(
        key, "Export", choices={**choices, LINE_TABLE.upper(): numbers},
        hint=f"The {what} as shown, with design and pose; width and resolution are set in the "
        "folder File",
    )  # fmt: skip


def maps_line(name: str, what: str, store: MapStore, *, single: bool) -> ButtonGroup:
    """Return the line below the torque maps, or below the single map."""

    def of(make: Make) -> Make:
        return lambda state, kind: make(
            state.updated("export", single=single), store=store, kind=kind
        )

    return _line(f"{name}.export", what, of(exports.figure), of(exports.table))


def curves_line() -> ButtonGroup:
    """Return the line below the curves of the motion."""
    line = _line("plots.export", "curves", exports.motion_figure, exports.curves_table)
    hint = (
        "PNG, SVG and PDF: the curves as shown, width and resolution are set in the folder File; "
        "CSV: the motion with torques and power, whatever is shown of it, or the simulation"
    )
    return replace(line, order=8, hint=hint)


def volume_choices() -> dict[str, Run]:
    """Return the exports of the volume where all requirements hold."""
    return {
        kind.upper(): export(
            f"the volume as {kind.upper()}", partial(exports.volume_file, kind=kind)
        )
        for kind in VOLUME_FORMATS
    }


def export_entries(store: MapStore, legend: SceneLegend | None = None) -> Sequence[Entry]:
    """Return the entries of the tab; maps come from the store, and pictures have the legend.

    Everything is made of the newest state, at full resolution, and says design and pose inside.
    """
    recorder = Recorder(legend.of) if legend else Recorder()

    def choices(what: str, labels: Mapping[str, str], make: Make) -> dict[str, Run]:
        return {
            label: export(f"{what} as {label}", partial(make, kind=kind))
            for kind, label in labels.items()
        }

    def programs(targets: Mapping[str, Target]) -> dict[str, Run]:
        return {
            each.label: export(
                f"the robot as {each.label}", partial(exports.program, target=each, what=name)
            )
            for name, each in targets.items()
        }

    tables = {name: name.upper() for name in TABLE_FORMATS}
    return (
        COPIED,
        Html("export.maps_heading", content=_maps_heading),
        Dropdown(
            "export.single", "Maps",
            options={"torque maps τ₁ τ₂ τ₃": False, "single map": True},
            hint="What to export, as its tab shows it",
            **attribute("export.single"),
        ),
        Number(
            "export.width", "Width [mm]", range=(80.0, 400.0), step=1.0,
            hint="Width of the figure on paper: 85 mm is a column, 170 mm a page",
            **attribute("export.width"),
        ),
        Number(
            "export.dpi", "Resolution [dpi]", range=(50.0, 600.0), step=10.0,
            hint="Pixels per inch of a PNG, and of the colored cells in SVG and PDF",
            **attribute("export.dpi"),
        ),
        ButtonGroup(
            "export.figure", "Figure",
            choices=choices("a figure", _figures(), partial(exports.figure, store=store)),
            hint="Title, units, design and pose are in it",
        ),
        ButtonGroup(
            "export.table", "Data",
            choices=choices("data", tables, partial(exports.table, store=store))
            | {"Copy": copy_run("Maps", partial(exports.maps_table, store=store))},
            hint="SI units, with every number of the design; Copy: for a spreadsheet",
        ),
        Html("export.robot_heading", content=_robot_heading),
        Dropdown(
            "export.view_size", "View size", options=VIEW_SIZES,
            hint="Size of the picture of the 3D view [pixels]",
            **attribute("export.view_size"),
        ),
        ButtonGroup(
            "export.scene", "Save",
            choices={
                "View as PNG": session_export(
                    "the 3D view as PNG",
                    lambda session: light_view(session, legend.shown if legend else NO_LEGEND),
                ),
                "Robot as GLB": export("the robot as GLB", lambda state: exports.robot(state)),
            },
            hint="The 3D view as it is, or the posed robot",
        ),
        Html(
            "export.programs",
            content=render("export/programs.j2", programs=[*CODE.values(), *_MODELS.values()]),
        ),
        ButtonGroup(
            "export.code", "Code", choices=programs(CODE),
            hint="The design’s formulas: C in a ZIP, or FMI 2.0 units for co-simulation, which "
            "need a C compiler on the server",
        ),
        ButtonGroup(
            "export.models", "Models",
            choices=programs({name: each for name, each in _MODELS.items() if name != "mjcf"}),
            hint="The bodies with their joints; a URDF comes in a ZIP with a table of its loops",
        ),
        ButtonGroup(
            "export.mujoco", "MuJoCo",
            choices={
                "MJCF": export(
                    "the MuJoCo model", partial(exports.mujoco_model, meshes=False)
                ),
                "MJCF with meshes": export(
                    "the MuJoCo model", partial(exports.mujoco_model, meshes=True)
                ),
            },
            hint="One XML file, or a ZIP with the real shapes; in MuJoCo’s viewer sliders move it",
        ),
        Html("export.volume_heading", content=_volume_heading),
        ButtonGroup(
            "export.volume", "Volume",
            choices=lambda state: (
                volume_choices() if asked(state.document.requirements) else {}
            ),
            hint="Its surface in mm (STL) or in m with colors (GLB), or all nodes with their "
            "causes and margins",
        ),
        Html("export.motion_heading", content=_motion_heading),
        ButtonGroup(
            "export.curves", "Figure",
            choices=choices("a figure", _figures(), exports.motion_figure),
            hint="The curves of “Motion plots”, width as above",
        ),
        ButtonGroup(
            "export.series", "Data",
            choices=choices("data", tables, exports.motion_table)
            | {"Copy": copy_run("Motion", lambda state: exports.motion_series(state)[1])}
            | {"HTML page": export("a page that plays the motion", exports.motion_page)},
            hint="All numbers over time in SI units, or a page that plays the motion by itself",
        ),
        ButtonGroup(
            "export.record", "Picture",
            choices={
                each.label: session_export(
                    f"the motion as {each.label}", partial(recorder.record, kind=kind)
                )
                for kind, each in ANIMATION_FORMATS.items()
                if not each.missing
            },
            visible=lambda state: not _recording(state),
            hint="The motion in the 3D view as an animated picture or a video, in true time; this "
            "tab of the browser has to stay in front",
        ),
        *(
            Button(
                f"export.{kind}", f"{each.label}: needs {each.package}", color="gray",
                effect=Run(lambda session: None), hint=each.missing, disabled=lambda state: True,
                visible=lambda state: not _recording(state),
            )
            for kind, each in ANIMATION_FORMATS.items()
            if each.missing
        ),
        ProgressBar(
            "export.recorded", read=lambda state: state.recording.done,
            visible=_recording,
        ),
        Button(
            "export.cancel", "Cancel", color="gray", effect=Run(recorder.cancel),
            visible=_recording,
            hint="The robot is recorded as it was at the start; the 3D view shows what has been "
            "changed since once the recording has ended",
        ),
    )  # fmt: skip


SUBJECTS = {
    "export.figure": "maps, figure", "export.table": "maps, data", "export.scene": "picture",
    "export.code": "code", "export.models": "model", "export.mujoco": "model",
    "export.volume": "volume", "export.curves": "motion, figure", "export.series": "motion, data",
    "export.record": "motion, picture",
}  # fmt: skip
"""What groups of exports are called in the command palette, by their keys;
every group of `export_entries` is there."""


def _maps_heading(frame: Frame) -> str:
    state = frame.state
    quantity = QUANTITIES[state.map_view.quantity].label
    minus = ", minus the reference" if shows_difference(state) else ""
    text = f"{FULL} × {FULL} cells, colors as shown{minus}; the single map is: {quantity}"
    return render("export/heading.j2", title="Maps", text=text)


def _robot_heading(frame: Frame) -> str:
    deviations = frame.state.document.design.deviations
    text = noting_equal_legs("in its current pose", deviations)
    return render("export/heading.j2", title="Robot", text=text)


def _volume_heading(frame: Frame) -> str:
    if not asked(frame.state.document.requirements):
        return ""
    text = "where all requirements hold; the surface, or a table"
    return render("export/heading.j2", title="Volume", text=text)


def _motion_heading(frame: Frame) -> str:
    kind = exports.motion_figure_kind(frame.state)
    text = f"as chosen in “Motion”; the figure is: {kind}, as in “Motion plots”"
    return render("export/heading.j2", title="Motion", text=text)
