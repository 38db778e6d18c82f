"""Buttons that save what the page shows: figures, data, the robot and the 3D view."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Any

from paminsa_viz.explorer import exports
from paminsa_viz.explorer.controls import check_value
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.maps import FULL, MapStore, shows_difference
from paminsa_viz.explorer.motion import exporting
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.files.tables import TABLE_FORMATS
from paminsa_viz.model import PaminsaError
from paminsa_viz.palette import INK, MUTED
from paminsa_viz.plots.formats import FIGURE_FORMATS
from paminsa_viz.quantities import QUANTITIES

log = logging.getLogger(__name__)

FIGURE_LABELS = tuple(each.label for each in FIGURE_FORMATS.values())

THREE, ONE = "torque maps τ₁ τ₂ τ₃", "single map"

VIEW_SIZES: dict[str, tuple[int, int] | None] = {
    "as on the page": None,
    "1920 × 1080": (1920, 1080),
    "2560 × 1440": (2560, 1440),
    "3840 × 2160": (3840, 2160),
}


def heading(title: str, note: str) -> str:
    """Return the heading of a part of the tab."""
    return (
        f'<div class="paminsa-heading" style="font-size:12px;padding:2px 0 1px 0;color:{MUTED}">'
        f'<b style="color:{INK}">{title}</b> &nbsp;{note}</div>'
    )


class ExportPanel:
    """Makes files and has the browser download them, one at a time, beside the session's worker.

    Everything is made from the newest state, at full resolution, and says design and pose inside.
    It is built in the current container of the page.
    """

    def __init__(self, session: Session, store: MapStore) -> None:
        gui = session.client.gui
        self._session, self._store = session, store
        self._busy = threading.Lock()
        gui.add_html('<span class="paminsa-export"></span>')
        self._about = gui.add_html(heading("Maps", self._what(session.state)))
        self._maps = gui.add_dropdown(
            "maps", (THREE, ONE), hint="What to save, as its tab shows it"
        )
        self._width = gui.add_number(
            "width [mm]", 170.0, min=exports.WIDTHS[0], max=exports.WIDTHS[1], step=1.0,
            hint="Width of the figure on paper: 85 mm is a column, 170 mm a page",
        )  # fmt: skip
        self._dpi = gui.add_number(
            "dpi", 300.0, min=exports.RESOLUTIONS[0], max=exports.RESOLUTIONS[1], step=10.0,
            hint="Pixels per inch of a PNG, and of the colored cells in SVG and PDF",
        )  # fmt: skip
        figures = gui.add_button_group(
            "figure",
            tuple(each.label for each in FIGURE_FORMATS.values()),
            hint="Title, units, design and pose are in it",
        )
        tables = gui.add_button_group(
            "data",
            tuple(map(str.upper, TABLE_FORMATS)),
            hint="SI units, with every number of the design",
        )
        gui.add_html(heading("Robot", "as it stands now"))
        self._size = gui.add_dropdown(
            "view size", tuple(VIEW_SIZES), hint="Size of the picture of the 3D view [pixels]"
        )
        scene = gui.add_button_group(
            "save", ("View as PNG", "Robot as GLB"), hint="The 3D view as it is, or the posed robot"
        )
        models = gui.add_button_group(
            "MuJoCo", ("MJCF", "MJCF with meshes"),
            hint="All masses, loops and actuators for MuJoCo: one XML file, or a ZIP with the "
            "real shapes",
        )  # fmt: skip
        gui.add_html(
            f'<div style="font-size:12px;color:{MUTED}">held in this pose; in '
            "MuJoCo’s viewer, sliders move it</div>"
        )
        self._about_motion = gui.add_html(heading("Motion", _motion(session.state)))
        curves = gui.add_button_group(
            "figure",
            tuple(each.label for each in FIGURE_FORMATS.values()),
            hint="The curves of “Motion plots”, width as above",
        )
        series = gui.add_button_group(
            "data", (*map(str.upper, TABLE_FORMATS), "HTML page"),
            hint="All numbers over time in SI units, or a page that plays the motion by itself",
        )  # fmt: skip
        curves.on_click(self._curves)
        series.on_click(self._series)
        figures.on_click(self._figure)
        tables.on_click(self._table)
        scene.on_click(self._scene)
        models.on_click(self._model)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Say what would be saved."""
        del moving
        about = heading("Maps", self._what(frame.state))
        if self._about.content != about:
            self._about.content = about
        motion = heading("Motion", _motion(frame.state))
        if self._about_motion.content != motion:
            self._about_motion.content = motion

    @staticmethod
    def _what(state: State) -> str:
        quantity = QUANTITIES[state.map_view.quantity].label
        minus = ", minus the reference" if shows_difference(state) else ""
        return f"{FULL} × {FULL} cells, colors as shown{minus}; the single map is: {quantity}"

    def _single(self) -> bool:
        return self._maps.value == ONE

    def _figure(self, event: Any) -> None:
        kind, width, dpi = str(event.target.value), self._width.value, self._dpi.value

        def make(state: State) -> exports.File:
            check_value("export", (float(width), float(dpi)))
            return exports.figure(
                state, self._store, kind.lower(), self._single(), float(width), float(dpi)
            )

        self._save(f"a figure as {kind}", make)

    def _table(self, event: Any) -> None:
        kind = str(event.target.value)
        self._save(
            f"data as {kind}",
            lambda state: exports.table(state, self._store, kind.lower(), self._single()),
        )

    def _curves(self, event: Any) -> None:
        kind, width, dpi = str(event.target.value), self._width.value, self._dpi.value

        def make(state: State) -> exports.File:
            check_value("export", (float(width), float(dpi)))
            return exporting.figure(state, kind.lower(), float(width), float(dpi))

        self._save(f"a figure as {kind}", make)

    def _series(self, event: Any) -> None:
        kind = str(event.target.value)
        if kind == "HTML page":
            self._save("a page that plays the motion", exporting.page)
            return
        self._save(f"data as {kind}", lambda state: exporting.table(state, kind.lower()))

    def _scene(self, event: Any) -> None:
        if event.target.value == "Robot as GLB":
            self._save("the robot as GLB", exports.robot)
            return
        size = VIEW_SIZES.get(str(self._size.value))
        self._save(
            "the 3D view as PNG", lambda state: exports.view(state, self._session.client, size)
        )

    def _model(self, event: Any) -> None:
        meshes = event.target.value != "MJCF"
        what = "the MuJoCo model" + (" with meshes" if meshes else "")
        self._save(what, lambda state: exports.mujoco_model(state, meshes))

    def _save(self, what: str, make: Callable[[State], exports.File]) -> None:
        """Make a file and send it; runs on the thread of the click, not on the session's worker."""
        session = self._session
        if not self._busy.acquire(blocking=False):
            session.notify("One at a time", "The last export is still being made.")
            return
        try:
            notice = session.client.add_notification(
                f"Making {what} …", "", loading=True, with_close_button=False
            )
            try:
                file = make(session.state)
                session.client.send_file_download(file.name, file.content, save_immediately=True)
                session.notify("Saved", f"{file.name}, {_size_of(len(file.content))}")
            except PaminsaError as error:
                session.notify("Not exported", str(error), bad=True)
            except Exception:
                log.exception("an export failed")
                session.notify("Not exported", "Details are in the program's log.", bad=True)
            finally:
                notice.remove()
        finally:
            self._busy.release()


def _motion(state: State) -> str:
    kind = exporting.figure_kind(state)
    return f"as chosen in “Motion”; the figure is: {kind}, as in “Motion plots”"


def _size_of(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{max(count / 1e3, 0.1):.0f} kB"
