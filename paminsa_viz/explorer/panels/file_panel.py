"""The design's name, design files, and share codes."""

from __future__ import annotations

import re
from typing import Any

from viser import Icon

from paminsa_viz import __version__
from paminsa_viz.explorer import actions, sharing
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.files.design_file import LARGEST_FILE, read_design, write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import APPENDIX_4, Design, InvalidDesign
from paminsa_viz.model.bounds import validate_limits


def file_name(design: Design) -> str:
    """Return a name for a design's file that every system takes."""
    stem = re.sub(r"[^\w.-]+", "-", design.name, flags=re.ASCII).strip("-.")[:60]
    return f"{stem or 'design'}.toml"


def uploaded_design(name: str, content: bytes) -> Design:
    """Return the design in an uploaded file.

    Raises:
        DesignFileError: If there is none in it. The server hands on a file that is too large as
            an empty one.
    """
    if not content:
        raise DesignFileError(name, f"is empty, or larger than {LARGEST_FILE // 1000} kB")
    try:
        return validate_limits(read_design(content, name))
    except InvalidDesign as error:
        raise DesignFileError(name, str(error)) from error


def _open_code(state: State, code: str) -> State:
    return actions.restore(state, sharing.decode(code))


class FilePanel:
    """Name, download, upload, Appendix 4, share code."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        document = session.state.document
        self.name = gui.add_text(
            "Design name", document.design.name, hint="Stands in files, figures and tables"
        )
        self._name = Control(
            session,
            self.name,
            "file.name",
            actions.rename,
            lambda state: state.document.design.name,
        )
        with gui.add_folder("Design file"):
            self.download = gui.add_button(
                "Download as TOML", icon=Icon.DOWNLOAD, hint="A readable text file, in SI units"
            )
            self.upload = gui.add_upload_button(
                "Open a file…",
                icon=Icon.UPLOAD,
                mime_type=".toml,.txt",
                hint="A design file in TOML",
                color="gray",
            )
            self.default = gui.add_button(
                "Appendix 4 (prototype)",
                icon=Icon.BOOK,
                hint="Open the paper's design; undo brings the present one back",
                color="gray",
            )
        with gui.add_folder("Share code"):
            gui.add_html(
                note(
                    "Design, pose, motion and reference in one line. Copy it to hand it on; paste "
                    "another one over it to open that.",
                    muted=True,
                )
            )
            self.code = gui.add_text("Code", sharing.encode(document))
        self._code = DebouncedInput(
            session,
            self.code,
            "file.code",
            _open_code,
            lambda state: sharing.encode(state.document),
        )
        self.download.on_click(lambda _: session.submit(self._download))
        self.upload.on_upload(lambda event: self._on_upload(event.target.value))
        self.default.on_click(
            lambda _: session.dispatch("file.open", lambda s: actions.load_design(s, APPENDIX_4))
        )

    def _download(self) -> None:
        design = self._session.state.document.design
        text = write_design(design, comment=f"Written by paminsa_viz {__version__}.")
        self._session.client.send_file_download(
            file_name(design), text.encode(), save_immediately=True
        )

    def _on_upload(self, file: Any) -> None:
        def open_file() -> None:
            design = uploaded_design(file.name, file.content)
            self._session.dispatch("file.open", lambda state: actions.load_design(state, design))
            self._session.notify("Design opened", design.name or file.name)

        self._session.submit(open_file)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state; the code once the hand rests."""
        self._name.draw(frame, moving)
        if not moving:
            self._code.draw(frame, moving)
