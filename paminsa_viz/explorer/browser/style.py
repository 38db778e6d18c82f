"""The page's style sheet, and the gradient that it shows behind the 3D view.

A background image of viser's is a square drawn into every picture of the scene. Without a graphics
card it takes as long as the whole robot, even when it shows nothing; the page's own background is
drawn once.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.browser import asset
from paminsa_viz.palette import ACTUATOR_COLORS, BAD, INK, MUTED, OK, REFERENCE, WARN, rgb

TOP: Final = "#fcfdfe"
BOTTOM: Final = "#d8dee5"
MIDDLE: Final = "#eef1f5"
"""The gradient behind the 3D view; the middle stands for it where a gradient costs too much."""

_COLORS: Final = {
    "ink": INK,
    "muted": MUTED,
    "reference": REFERENCE,
    "good": OK,
    "warning": WARN,
    "wrong": BAD,
    "backdrop-top": TOP,
    "backdrop-bottom": BOTTOM,
    "backdrop-middle": MIDDLE,
} | {f"color-m{number}": color for number, color in enumerate(ACTUATOR_COLORS, start=1)}


@cache
def style_html() -> str:
    """Return page.css with the palette's colors, as an HTML element."""
    colors = "".join(f"--pv-{name}:{color};" for name, color in _COLORS.items())
    return f"<style>:root{{{colors}}}\n{asset('page.css')}</style>"


def over_backdrop(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Lay an image of the scene (h, w, 4), clear where nothing is, over the gradient (h, w, 3)."""
    down = np.linspace(0.0, 1.0, pixels.shape[0])[:, None, None]
    top, bottom = (np.array(rgb(color), dtype=np.float64) for color in (TOP, BOTTOM))
    behind = top + (bottom - top) * down
    cover = pixels[..., 3:] / 255
    return np.rint(behind + (pixels[..., :3] - behind) * cover).astype(np.uint8)
