"""What lies behind the 3D view: a soft gradient, which the page shows through the clear scene.

A background image of viser's is a square drawn into every picture of the scene. Without a graphics
card it takes as long as the whole robot, even when it shows nothing; the page's own background is
drawn once.
"""

from __future__ import annotations

import json
from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.palette import rgb

TOP: Final = "#fcfdfe"
BOTTOM: Final = "#d8dee5"
MIDDLE: Final = "#eef1f5"
"""Stands for both where a gradient costs too much."""

STYLE: Final = f"canvas[data-engine] {{ background: linear-gradient(to bottom, {TOP}, {BOTTOM}); }}"
"""Style of a page that shows the robot; three.js marks its canvas so."""

SCRIPT: Final = f"""
(() => {{
  const style = document.getElementById("paminsa-backdrop") || document.createElement("style");
  style.id = "paminsa-backdrop";
  style.textContent = {json.dumps(STYLE)};
  document.head.append(style);
  const hide = () => {{
    const viewer = window.__viserMutable;
    if (!viewer || !viewer.backgroundMaterial) {{ setTimeout(hide, 200); return; }}
    viewer.backgroundMaterial.visible = false;
  }};
  hide();
}})();
"""
"""Gives a live page the style, and takes away the square for a background image it has not."""


def before_backdrop(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Lay a picture of the scene (h, w, 4), clear where nothing is, over the gradient (h, w, 3)."""
    down = np.linspace(0.0, 1.0, pixels.shape[0])[:, None, None]
    top, bottom = (np.array(rgb(color), dtype=np.float64) for color in (TOP, BOTTOM))
    behind = top + (bottom - top) * down
    cover = pixels[..., 3:] / 255
    return np.rint(behind + (pixels[..., :3] - behind) * cover).astype(np.uint8)
