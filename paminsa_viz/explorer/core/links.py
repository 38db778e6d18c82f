"""What the page's address says: the document, and which section and map are open.

What follows the ``#`` is a share code and, after it, what is shown, as in
``PMZ1-…&section=Strength/Stiffness&beside=Single map&map=stiffness_z``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from urllib.parse import parse_qs

from paminsa_viz.explorer.core import actions, persistence
from paminsa_viz.explorer.core.docks import BESIDE
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.core.workspaces import switch
from paminsa_viz.explorer.state.state import State
from paminsa_viz.quantities import QUANTITIES

Layers = Mapping[str, frozenset[str]]
"""Layers of the scene that workspaces are first shown with, by the names of the workspaces."""


def shown(session: Session) -> dict[str, str]:
    """Return what is open: a section, a tab of the left dock, and the map's quantity."""
    tabs = session.open_tabs or frozenset()
    section = next((path for path in session.paths.values() if path in tabs), "")
    beside = next((name for name in BESIDE if name in tabs), "")
    found = {"section": section, "beside": beside, "map": session.state.map_view.quantity}
    return {key: value for key, value in found.items() if value}


def link_of(session: Session) -> str:
    """Return what an address says; nothing if the document is too large for a share code."""
    code = persistence.share_code(session.state.document)
    link = "&".join([code, *(f"{key}={value}" for key, value in shown(session).items())])
    return link if len(link) <= persistence.LONGEST_CODE else ""


def follow_link(session: Session) -> None:
    """Write what is shown to the address of the page, if it is not there yet."""
    now = (session.state.document, shown(session))
    if now != session.linked:
        session.linked = now
        session.bridge.call("followLink", link_of(session))


def opened(state: State, link: str, layers: Layers) -> State:
    """Return a state with what a link says; a section or a map that is not known is left out.

    Raises:
        PaminsaError: If its share code cannot be opened.
    """
    state = actions.restore(state, persistence.open_share_code(link))
    found = {key: values[0] for key, values in parse_qs(link.partition("&")[2]).items()}
    name = found.get("section", "").partition("/")[0]
    if name in layers:
        if not state.workspace:  # the page has not said yet which one it begins with
            state = replace(state, layers=state.layers | layers[name])
        state = switch(state, name, "", layers[name])
    quantity = found.get("map", "")
    return choose_quantity(state, quantity) if quantity in QUANTITIES else state


def open_link(session: Session, data: object, layers: Layers) -> None:
    """Open a link, or say in a line why not; the page opens the tabs, ``data`` comes from it."""
    if not isinstance(data, str):
        return
    session.dispatch(
        "link",
        lambda state: opened(state, data, layers),
        then=lambda: session.notify(
            "Link opened", session.state.document.design.name, of_step=True
        ),
    )

    def write() -> None:  # one that was refused does not stay
        session.linked = None
        follow_link(session)

    session.submit(write)
