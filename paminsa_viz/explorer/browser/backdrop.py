"""The gradient behind the 3D view: for the page's style, and behind images of the scene.

A background image of viser's is a square drawn into every picture of the scene. Without a graphics
card it takes as long as the whole robot, even when it shows nothing; the page's own background is
drawn once.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.browser import asset
from paminsa_viz.palette import rgb

TOP: Final = "#fcfdfe"
BOTTOM: Final = "#d8dee5"
MIDDLE: Final = "#eef1f5"
"""Stands for both where a gradient costs too much."""


def page_style() -> str:
    """Return the style of a page that shows the robot, as an HTML element."""
    return f"<style>{asset('page.css', TOP=TOP, BOTTOM=BOTTOM, MIDDLE=MIDDLE)}</style>"


def over_backdrop(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Lay an image of the scene (h, w, 4), clear where nothing is, over the gradient (h, w, 3)."""
    down = np.linspace(0.0, 1.0, pixels.shape[0])[:, None, None]
    top, bottom = (np.array(rgb(color), dtype=np.float64) for color in (TOP, BOTTOM))
    behind = top + (bottom - top) * down
    cover = pixels[..., 3:] / 255
    return np.rint(behind + (pixels[..., :3] - behind) * cover).astype(np.uint8)
