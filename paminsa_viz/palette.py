"""Colours used everywhere: 3D scene, plots, tables and files show a leg in the same colour.

The hues are from the Okabe-Ito set, which stays distinct for colour-blind eyes.
"""

from __future__ import annotations

LEG_COLOURS: tuple[str, str, str] = ("#0072B2", "#D55E00", "#009E73")
"""Legs 1, 2, 3 and their rotating actuators M1, M2, M3."""

LIFT_COLOUR = "#7A5195"
"""Linear actuator M4, its arms and shafts, and the force F_4."""

ACTUATOR_COLOURS: tuple[str, str, str, str] = (*LEG_COLOURS, LIFT_COLOUR)

INK = "#1f2933"
MUTED = "#7b8794"
PLATFORM = "#c9ced6"
REFERENCE = "#555555"
OK = "#2e8540"
WARN = "#e0a100"
BAD = "#c3362b"


def rgb(colour: str) -> tuple[int, int, int]:
    """Return ``#rrggbb`` as three integers from 0 to 255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
