"""The design's name, design files, and share codes."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from typing import Any

from viser import Icon

from paminsa_viz.errors import FileError
from paminsa_viz.explorer.browser.tour import START
from paminsa_viz.explorer.core import actions, persistence
from paminsa_viz.explorer.core.links import link_of
from paminsa_viz.explorer.core.saved_requirements import asked, of_file, require_possible
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.files.examples import EXAMPLES, example_named, open_example
from paminsa_viz.explorer.kit.entries import Button, Entry, Folder, Html, Message, Run, Upload
from paminsa_viz.explorer.kit.inputs import TextBox
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.server.limits import Limits
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.design_file import DesignContent, read_content, write_design
from paminsa_viz.model import Design, InvalidInput
from paminsa_viz.units import as_sentence
from paminsa_viz.version import MADE_BY


def file_name(design: Design) -> str:
    """Return a name for a design's file that every system takes."""
    stem = re.sub(r"[^\w.-]+", "-", design.name, flags=re.ASCII).strip("-.")[:60]
    return f"{stem or 'design'}.toml"


def open_content(state: State, content: DesignContent) -> State:
    """Work on a design of a file, and on its requirements if it has any."""
    opened = actions.load_design(state, content.design)
    if content.requirements is None:
        return opened
    require_possible(content.requirements)
    return actions.change_document(opened, requirements=content.requirements)


def _download(session: Session) -> None:
    document = session.state.document
    text = write_design(
        document.design,
        comment=f"Written by {MADE_BY}.",
        requirements=of_file(document.requirements),
    )
    name = file_name(document.design)
    session.client.send_file_download(name, text.encode(), save_immediately=True)


_STAY = "those of before stay"
"""Said of requirements where a design is opened that has none."""


def _open(session: Session, name: str, content: bytes) -> None:
    found = read_content(content, name)

    def say() -> None:
        text = found.design.name or name
        if found.requirements is None and asked(session.state.document.requirements):
            text += f"; the file has no requirements, {_STAY}"
        session.notify("Design opened", text, of_step=True)

    session.dispatch("file.open", lambda state: open_content(state, found), then=say)


REFUSALS = {
    "large": f"is larger than {Limits.upload_bytes // 2**20} MB; leave out what is not needed",
    "dropped": "drop no files on the page; open a design with “Open a file…” in the folder File, "
    "a table with the button of its section",
}
"""Why the page does not send a file, and what to do."""


def receive_refused(session: Session, data: Any) -> None:
    """Say why a file is not opened; ``data`` comes from the page."""
    match data:
        case [str(name), "large" | "dropped" as why]:
            session.notify("Not opened", as_sentence(str(FileError(name, REFUSALS[why]))), bad=True)


def _save_page(session: Session) -> None:
    from paminsa_viz.explorer.features.one_file import one_file

    document = session.state.document
    name = f"{Path(file_name(document.design)).stem}.html"
    session.client.send_file_download(name, one_file(document).encode(), save_immediately=True)


def _copy_link(session: Session) -> None:
    link = link_of(session)
    if not link:
        raise InvalidInput("link", "the design is too large for one; save it as a file")
    session.bridge.call("copyLink", link)


EXAMPLE = "open-example"
"""Message of the page: an example was pressed."""


def gallery_html() -> str:
    """Return the examples, each a button."""
    return render("files/gallery.j2", examples=EXAMPLES, message=EXAMPLE, tour=START)


def receive_example(session: Session, data: Any) -> None:
    """Open the example that was pressed; ``data`` comes from the page."""
    key, before = str(data)[:40], session.state.document.requirements

    def show() -> None:
        found, text = example_named(key), ""
        if asked(before) and session.state.document.requirements == before:
            text = f" It has no requirements, {_STAY}."
        session.open_tab(found.opens)
        session.notify(f"Example opened: {found.label}", found.note + text, of_step=True)

    session.dispatch("file.open", lambda state: open_example(state, key), then=show)


FILE: tuple[Entry, ...] = (
    TextBox(
        "file.name", "Design name", hint="Is part of files, figures and tables",
        read=lambda state: state.document.design.name, apply=actions.rename,
    ),
    Message(EXAMPLE, receive=receive_example),
    Message("refused file", receive=receive_refused),
    Folder(
        "file.design", "Design file",
        entries=(
            Button(
                "file.download", "Download as TOML", icon=Icon.DOWNLOAD,
                keys=("S", "cmd/ctrl"), hint="A readable text file, in SI units",
                effect=Run(
                    lambda session: session.submit(partial(_download, session)), at_once=True
                ),
            ),
            Button(
                "file.page", "Save as a page", icon=Icon.HTML, color="gray", undo=False,
                hint="One HTML file with the essential part of this page; it needs no server",
                effect=Run(lambda session: session.guard(lambda: _save_page(session))),
            ),
            Upload(
                "file.upload", "Open a file…", receive=_open, icon=Icon.UPLOAD,
                mime_type=".toml,.txt", color="gray",
                hint="A design file in TOML; without the key knee, the lower knee",
            ),
        ),
    ),
    Folder(
        "file.share", "Link and share code",
        entries=(
            Button(
                "file.link", "Copy link", icon=Icon.LINK, undo=False,
                keys=("L", "cmd/ctrl+shift"),
                hint="The address of this page with the share code; the address follows your work",
                effect=Run(
                    lambda session: session.submit(partial(_copy_link, session)), at_once=True
                ),
            ),
            Html(
                "file.about_code",
                content=render(
                    "note.j2", testid="", muted=True,
                    text="Design, pose, motion, reference and requirements in one line. Copy it to "
                    "hand it on; paste another one over it to open that.",
                ),
            ),
            TextBox(
                "file.code", "Code", idle=True,
                hint="Copy it to share what is set; one that is put in here opens what it holds",
                read=lambda state: persistence.share_code(state.document),
                apply=lambda state, code: actions.restore(state, persistence.open_share_code(code)),
            ),
        ),
    ),
    Folder("file.examples", "Examples", entries=(Html("file.gallery", content=gallery_html()),)),
)  # fmt: skip
