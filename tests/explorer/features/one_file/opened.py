"""The page in one file, opened from a disk in a browser."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from paminsa_viz.explorer.core.persistence import open_share_code
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.model import APPENDIX_4, PaminsaError
from tests.support.chromium import UNDRAWN, until, watch_errors

START = Document(design=APPENDIX_4, pose=(0.08, 0.05, np.pi / 3, -0.55))
OTHER = Document(
    design=replace(
        APPENDIX_4.vary({"links.b3": 0.777, "payload.mass": 3.0, "geometry.body_scale": 0.9}),
        name="Light, 3 kg",
    ),
    pose=(0.05, -0.03, 0.4, -0.55),
    reference=APPENDIX_4,
)


class Opened:
    """The page in a browser, opened from a file, and what happened in it.

    Its robot is not drawn unless a test draws it: that takes most of the page's time.
    """

    def __init__(self, browser: Any, path: Path) -> None:
        self.context = browser.new_context(accept_downloads=True)
        self.page = self.context.new_page()
        self.requests: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.errors = watch_errors(self.page)
        self.page.add_init_script(UNDRAWN)
        self.address = path.as_uri()
        self.open("")

    def open(self, link: str) -> None:
        self.page.goto("about:blank")
        self.page.goto(f"{self.address}#{link}".rstrip("#"))
        self.wait_drawn()

    def wait_drawn(self) -> None:
        """Wait for the first picture."""
        drawn = "document.documentElement.dataset.drawn"
        until(lambda: self.page.evaluate(drawn), "the page is drawn")

    def code(self) -> str:
        return self.page.evaluate("location.hash").removeprefix("#")

    def document(self) -> Document | None:
        """Return what the address says, None while it is no code."""
        try:
            return open_share_code(self.code())
        except PaminsaError:
            return None

    def wait(self, true_of: Callable[[Document], Any]) -> Document:
        """Wait until something is true of what the address says, and return that."""
        return until(
            lambda: (found := self.document()) and true_of(found) and found, "the address follows"
        )

    def text(self, name: str) -> str:
        return self.page.get_by_test_id(name).inner_text()
