"""The page's style sheet, and the gradient that it shows behind the 3D view.

A background image of viser's is a square drawn into every picture of the scene. Without a graphics
card it takes as long as the whole robot, even when it shows nothing; the page's own background is
drawn once, or the canvas is cleared with its middle color, see ``drawing.js``.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.browser import asset
from paminsa_viz.palette import ACTUATOR_COLORS, DARK, LIGHT, Theme, rgb

_DARK_ROOT: Final = ':root[data-mantine-color-scheme="dark"]'


def _variables(theme: Theme) -> dict[str, str]:
    """Return the CSS variables of a theme; those of data colors are named by them."""
    top, bottom = theme.backdrop
    named = {
        name: getattr(theme, name)
        for name in ("paper", "ink", "muted", "faint", "reference", "good", "warn", "bad")
    }
    fills = {
        "good-fill": theme.good_fill, "warn-fill": theme.warn_fill, "bad-fill": theme.bad_fill
    }  # fmt: skip
    behind = {"backdrop-top": top, "backdrop-bottom": bottom}
    data = {
        f"color-m{number}": theme.shown(color)
        for number, color in enumerate(ACTUATOR_COLORS, start=1)
    }
    changes = {color[1:].lower(): shown for color, shown in theme.changes.items()}
    return named | fills | behind | data | changes


@cache
def style_html() -> str:
    """Return the style sheets with the colors of both themes, as an HTML element."""
    rules = "\n".join(
        f"{root}{{{''.join(f'--pv-{name}:{color};' for name, color in _variables(theme).items())}}}"
        for root, theme in ((":root", LIGHT), (_DARK_ROOT, DARK))
    )
    sheets = "\n".join(asset(name) for name in ("page.css", "parts.css", "view.css"))
    return f"<style data-paminsa>{rules}\n{sheets}</style>"


def over_backdrop(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Lay an image of the scene (h, w, 4), clear where nothing is, over the light gradient.

    Returns the picture (h, w, 3).
    """
    down = np.linspace(0.0, 1.0, pixels.shape[0])[:, None, None]
    top, bottom = (np.array(rgb(color), dtype=np.float64) for color in LIGHT.backdrop)
    behind = top + (bottom - top) * down
    cover = pixels[..., 3:] / 255
    return np.rint(behind + (pixels[..., :3] - behind) * cover).astype(np.uint8)


CONTROLS_WIDTH = 380
"""Width of the control panel [px]; fits labels and numbers at a laptop's 1280 px."""
FOLD_BELOW = 1200
"""Width of a window without room for the dock [px]; it is folded at the start."""
WIDEST, NARROWEST = 840, 380
"""Width of the dock at the start [px]."""
VIEW_SHARE = 0.46
"""Least share of the window's width that the 3D view has, with the docks' edges, in windows of
1400 px and more."""
PHONE = 576
"""Width of a window up to which viser has no docks but a sheet of controls at the bottom [px];
the style sheet of the view has it, too."""
SHEET_SHARE = 0.6
"""Largest share of the window's height that this sheet covers; it takes it as it is opened."""
SHARE = 0.34
"""Largest share of the window's width that the dock takes at the start."""


def dock_width(window_width: float, window_height: float) -> int:
    """Return the width of the dock for a window [px]: as large as leaves room for the robot.

    Its maps are two side by side, above a third, and have to fit into the window's height.
    """
    by_height = 2 * ((window_height - 130) / 2 - 40) + 82
    beside = (1 - VIEW_SHARE) * window_width - CONTROLS_WIDTH
    wanted = min(beside, SHARE * window_width, by_height)
    return int(min(max(wanted, NARROWEST), WIDEST)) if math.isfinite(wanted) else NARROWEST


def is_folded(window_width: float) -> bool:
    """Whether the dock is folded at the start, for want of width [px]."""
    return 0 < window_width < FOLD_BELOW


def has_sheet(window_width: float) -> bool:
    """Whether the controls are a sheet over the lower part of the 3D view, as on a phone [px]."""
    return 0 < window_width <= PHONE


def view_width(window_width: float, window_height: float) -> float:
    """Return the width of the 3D view between dock and controls at the start [px]."""
    if has_sheet(window_width):
        return window_width
    dock = 0 if is_folded(window_width) else dock_width(window_width, window_height)
    return max(window_width - CONTROLS_WIDTH - dock, 1.0)
