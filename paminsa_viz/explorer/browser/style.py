"""The page's style sheet, and the gradient that it shows behind the 3D view.

A background image of viser's is a square drawn into every picture of the scene. Without a graphics
card it takes as long as the whole robot, even when it shows nothing; the page's own background is
drawn once.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.browser import asset
from paminsa_viz.palette import ACTUATOR_COLORS, BAD, INK, MUTED, OK, REFERENCE, WARN, rgb

TOP: Final = "#fcfdfe"
BOTTOM: Final = "#d8dee5"
MIDDLE: Final = "#eef1f5"
"""The gradient behind the 3D view; the middle replaces it where a gradient costs too much."""

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


MARGIN = 15
"""Room to the edges of the 3D view [px]."""
WIDEST, NARROWEST = 900, 640
"""Width of the panel at the start [px]."""
CONTROLS_WIDTH = 380 + 2 * MARGIN
"""What the control panel at the right takes, with margins [px]."""
SHARE = 0.40
"""Largest share of the window's height that the panel takes at the start."""


def start_width(window_width: float, window_height: float) -> int:
    """Return the width of the panel for a window [px]: as large as leaves room for the robot.

    Three panels side by side take a width of about three times their height, and everything else
    in the panel about 105 px of height.
    """
    fits = window_width - CONTROLS_WIDTH
    by_height = 3 * (SHARE * window_height - 105 - 55) + 149
    wanted = min(fits, by_height, WIDEST)
    return int(max(wanted, NARROWEST)) if math.isfinite(wanted) else NARROWEST


def covered_share(panel_width: float, window_height: float) -> float:
    """Return the share of the 3D view's height that a panel of a width covers [px]."""
    if not window_height:
        return 0.0
    height = (panel_width - 149) / 3 + 105 + 55 + MARGIN
    return min(height / window_height, 0.6)
