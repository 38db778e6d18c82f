"""The page's theme, as the browser asks or as chosen; the title of the tab in the browser."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import viser

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.state.state import State
from paminsa_viz.palette import Theme, rgb

BRAND = {False: "#04293c", True: "#4dabdb"}
"""What viser mixes ten shades of, by whether the ground is dark: it writes in the seventh on light
ground and in the ninth on dark."""


class ThemeView:
    """Gives the page the theme of the state."""

    def __init__(self, session: Session) -> None:
        """Set the theme, and follow the browser from now on."""
        self._client, self._bridge = session.client, session.bridge
        self._theme = session.state.theme
        self._asked: Any = None
        configure(session.client, self._theme)

        def listen(dark: Any) -> None:
            self._asked = dark
            session.dispatch("scheme", lambda state: as_browser(state, dark), step=False)

        session.bridge.on("scheme", listen)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Change the theme if the state has another."""
        del dragging
        if frame.state.theme != self._theme:
            self._theme = frame.state.theme
            configure(self._client, self._theme)
        if self._asked is not None and frame.state.browser_dark == self._asked:
            self._asked = None
            self._bridge.call("releaseTheme")


class TitleView:
    """Names the browser's tab after the design."""

    def __init__(self, session: Session) -> None:
        self._bridge = session.bridge
        self._name = ""

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the design's name."""
        del dragging
        name = frame.state.document.design.name
        if name != self._name:
            self._name = name
            self._bridge.call("setTitle", name)


def configure(client: viser.ClientHandle, theme: Theme) -> None:
    """Set what viser draws of the page."""
    client.gui.configure_theme(
        control_width="large", show_logo=False, show_share_button=False,
        brand_color=rgb(BRAND[theme.dark]), dark_mode=theme.dark,
    )  # fmt: skip


def as_browser(state: State, dark: Any) -> State:
    """Return the state with what the browser asks for; a page may send anything."""
    return replace(state, browser_dark=dark) if isinstance(dark, bool) else state
