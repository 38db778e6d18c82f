"""What the page says of the places for pictures: whether they are seen, and how wide they are.

A picture in a tab that is not open, or in a minimized panel, is not drawn; one that a person made
wider is drawn wider. viser does not tell either, so ``browser/page.js`` looks and reports.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.entries import finite
from paminsa_viz.explorer.session import Session

NARROWEST, WIDEST = 300, 2400
"""Widths that a picture can have [page pixels]."""
FINEST = 2.0
"""Most device pixels for one page pixel that pictures are made for."""


def marker(name: str, share: float = 1.0, inputs: str = "") -> str:
    """Return the HTML that marks the container it lies in as a place of this name.

    Args:
        name: Name of the place.
        share: What the picture takes of the container's width.
        inputs: Where the container's inputs stand, for ``browser/page.css``.
    """
    arranged = f' data-paminsa-inputs="{inputs}"' if inputs else ""
    return f'<span data-paminsa-slot="{name}" data-share="{share:g}"{arranged}></span>'


class Slots:
    """Widths of the named places, as last reported.

    Attributes:
        ratio: Device pixels for one page pixel.
    """

    def __init__(self, session: Session, bridge: Bridge, widths: dict[str, int]) -> None:
        """Start with assumed widths [page pixels], 0 for a place that is not seen."""
        self._session = session
        self._widths = dict(widths)
        self.ratio = 1.0
        bridge.on("slots", self._hear)

    def width(self, name: str) -> int:
        """Return how wide a place is [page pixels], 0 if it is not seen."""
        return self._widths.get(name, 0)

    def _hear(self, data: Any) -> None:
        if not isinstance(data, dict):
            return
        widths = {name: _width(data.get(name)) for name in self._widths}
        fine = min(max(finite(data.get("ratio")) or 1.0, 1.0), FINEST)
        if widths == self._widths and fine == self.ratio:
            return
        self._widths, self.ratio = widths, fine
        # A new object, so that what has become visible is drawn.
        self._session.dispatch("slots", lambda state: replace(state))


def _width(value: Any) -> int:
    width = finite(value)
    return int(min(max(width, NARROWEST), WIDEST)) if width is not None and width > 0 else 0
