"""A motion from an uploaded CSV file."""

from __future__ import annotations

import io
from typing import Any

from viser import Icon

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import (
    Kind,
)
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.files.errors import TableFileError
from paminsa_viz.files.trajectory_table import parse_trajectory
from paminsa_viz.model import PaminsaError
from paminsa_viz.trajectory import Trajectory

UPLOAD_TIMEOUT = 10.0
"""How long an uploaded table may take to read [s]; the largest possible one takes some seconds."""


def uploaded_trajectory(name: str, content: bytes, rest: bool) -> Trajectory:
    """Return the trajectory in an uploaded CSV file.

    Raises:
        TableFileError: If there is none in it; row and column say where. The server hands on a
            file that is too large as an empty one.
    """
    if not content:
        raise TableFileError(name, "is empty, or larger than 10 MB")
    decoded = content.decode("utf-8-sig", errors="surrogateescape")
    lines = io.StringIO(decoded, newline="")
    return parse_trajectory(lines, name, rest=rest, timeout=UPLOAD_TIMEOUT)


class MotionFile:
    """The folder in which a motion is opened from a file."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        self.folder = gui.add_folder("CSV file", visible=self._shown(session.state))
        with self.folder:
            self.rest = gui.add_checkbox(
                "Starts and ends at rest", False,
                hint="For a few rows; without it, velocities at the ends are what the samples say",
            )  # fmt: skip
            self.upload = gui.add_upload_button(
                "Open a CSV file…", icon=Icon.UPLOAD, mime_type=".csv,.txt",
                hint="Columns t_s, x_m, y_m, theta_rad, z_m (or _ms, _mm, _deg)",
            )  # fmt: skip
        self.upload.on_upload(lambda event: self._receive(event.target.value))

    @staticmethod
    def _shown(state: State) -> bool:
        return state.document.motion.kind is Kind.TABLE

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the state."""
        del dragging
        self.folder.visible = self._shown(frame.state)

    def _receive(self, file: Any) -> None:
        """Read a file on the thread of its upload: a long table would block the worker."""
        try:
            table = uploaded_trajectory(file.name, file.content, bool(self.rest.value))
        except PaminsaError as error:
            self._session.notify("Not opened", str(error), bad=True)
            return
        self._session.dispatch("motion.table", lambda state: motions.use_table(state, table))
        self._session.notify("Motion opened", f"{table.name}, {table.size} rows")
