"""Where the floating map panel starts, and what it leaves of the 3D view."""

from __future__ import annotations

import math

MARGIN = 15
"""Room to the edges of the 3D view [px]."""
WIDEST, NARROWEST = 900, 640
"""Width of the panel at the start [px]."""
BESIDE = 380 + 2 * MARGIN
"""What the control panel at the right takes, with margins [px]."""
SHARE = 0.40
"""Largest share of the window's height that the panel takes at the start."""


def start_width(window_width: float, window_height: float) -> int:
    """Return the width of the panel for a window [px]: as large as leaves room for the robot.

    Three panels side by side take a width of about three times their height, and everything else
    in the panel about 105 px of height.
    """
    fits = window_width - BESIDE
    by_height = 3 * (SHARE * window_height - 105 - 55) + 149
    wanted = min(fits, by_height, WIDEST)
    return int(max(wanted, NARROWEST)) if math.isfinite(wanted) else NARROWEST


def covered_share(panel_width: float, window_height: float) -> float:
    """Return the share of the 3D view's height that a panel of a width covers [px]."""
    if not window_height:
        return 0.0
    height = (panel_width - 149) / 3 + 105 + 55 + MARGIN
    return min(height / window_height, 0.6)
