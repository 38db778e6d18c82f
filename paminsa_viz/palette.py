"""Colors used everywhere: 3D scene, plots, tables and files show a leg in the same color.

The hues are from the Okabe-Ito set, which stays distinct for color-blind eyes.
"""

from __future__ import annotations

LEG_COLORS: tuple[str, str, str] = ("#0072B2", "#D55E00", "#009E73")
"""Legs 1, 2, 3 and their rotating actuators M1, M2, M3."""

LIFT_COLOR = "#7A5195"
"""Linear actuator M4, its arms and shafts, and the force F_4."""

ACTUATOR_COLORS: tuple[str, str, str, str] = (*LEG_COLORS, LIFT_COLOR)

INK = "#1f2933"
MUTED = "#7b8794"
PLATFORM = "#c9ced6"
REFERENCE = "#555555"
OK = "#2e8540"
WARN = "#e0a100"
BAD = "#c3362b"


def rgb(color: str) -> tuple[int, int, int]:
    """Return ``#rrggbb`` as three integers from 0 to 255."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
