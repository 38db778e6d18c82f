"""Files that the browser downloads: their names, and the buttons that make them."""

from __future__ import annotations

import logging
import math
import unicodedata
from collections.abc import Callable, Mapping
from functools import partial
from typing import Literal, NamedTuple

from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.entries import ButtonGroup, Condition, Run
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PaminsaError
from paminsa_viz.progress import Canceled
from paminsa_viz.units import as_sentence

log = logging.getLogger(__name__)

LONGEST_NAME = 40


class File(NamedTuple):
    """A file to download."""

    name: str
    content: bytes


Place = Literal["pose", "map", ""]
"""What of the pose a file is of: all of the last reachable one, theta and z of maps, or nothing."""


def file_name(state: State, what: str, ending: str, place: Place) -> str:
    """Return a file name that says what, of which design, and where; plain letters only.

    Args:
        state: What is saved.
        what: Kind of content, such as ``torque-maps``.
        ending: Ending of the name, without the dot.
        place: As above.
    """
    document = state.document
    x, y, theta, z = state.last_reachable.pose if place == "pose" else document.pose
    where = [f"x{round(1e3 * x)}", f"y{round(1e3 * y)}"] if place == "pose" else []
    if place:
        where += [f"theta{round(math.degrees(theta))}", f"z{round(1e3 * z)}"]
    parts = ["paminsa", plain(document.design.name), what, *where]
    return "_".join(part for part in parts if part) + f".{ending}"


def plain(name: str) -> str:
    """Return a name as letters, digits and hyphens that any file system takes."""
    ascii_only = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
    words = "".join(c if c.isalnum() else " " for c in ascii_only).split()
    return "-".join(words)[:LONGEST_NAME].strip("-")


Make = Callable[[Session], File]
"""Makes a file of what a session shows."""


def session_export(what: str, make: Make) -> Run:
    """Return the effect of a button that exports something: one at a time, on the click's thread.

    The browser downloads what is made.
    """
    return Run(partial(_export, what, make))


def export(what: str, make: Callable[[State], File]) -> Run:
    """Return the effect of a button that exports something of the newest state."""
    return session_export(what, lambda session: make(session.state))


def table_buttons(
    key: str, tables: Mapping[str, Callable[[State], File]], visible: Condition | None = None
) -> ButtonGroup:
    """Return the buttons that export tables, by what they are called."""
    choices = {label: export(f"the {label.lower()}", make) for label, make in tables.items()}
    return ButtonGroup(key, "Export", choices=choices, hint="CSV files", visible=visible)


def _export(what: str, make: Make, session: Session) -> None:
    if not session.exporting.acquire(blocking=False):
        session.notify("One at a time", "The last export is still being made.")
        return
    try:
        notice = session.client.add_notification(
            f"Exporting {what} …", "", loading=True, with_close_button=False
        )
        try:
            file = make(session)
        finally:
            notice.remove()
    except Canceled:  # whoever has canceled it knows
        return
    except PaminsaError as error:
        session.notify("Not exported", as_sentence(str(error)), bad=True)
        return
    except Exception:
        log.exception("an export failed")
        session.notify("Not exported", "Details are in the program’s log.", bad=True)
        return
    finally:
        session.exporting.release()  # before the file comes down: the next may follow
    # The page itself says that the file has come down, with its name and size.
    session.client.send_file_download(file.name, file.content, save_immediately=True)
