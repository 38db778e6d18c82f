"""Where the bodies of one leg lie across the leg plane, and the sizes their fittings share.

The leg frame has x along the horizontal direction of the leg plane (from the leg axis toward the
platform), y across it and z up. Shaft B2, guide link B10 and the slider lie in the middle (y = 0).
B8 runs on one side of them; B4 and B7, which are parallel, share the layer on the other side, and
B3 runs outside those. So bars that cross each other are never in one layer, whatever the pose and
the knee, and no bar is in the middle, where the shaft is. Pins bridge the layers at the
joints. All lengths in meters.
"""

from __future__ import annotations

from typing import Final

import numpy as np

BARREL: Final = 0.026  # length of a joint barrel across the plane
BARREL_RADIUS: Final = 0.0165
PIN_RADIUS: Final = 0.0065
PIN_HEAD: Final = 0.0045  # how far a pin's head protrudes from the outermost barrel on it
LAYER: Final[dict[str, float]] = {"b8": -0.036, "b4": 0.036, "b7": 0.036, "b3": 0.065}
"""Offset of the middle of each bar from the leg plane."""

TUBE_RADIUS: Final[dict[str, float]] = {"b3": 0.0105, "b4": 0.012, "b7": 0.0085, "b8": 0.0105}

CORE: Final = 0.0195
"""Half width of what lies in the middle: shaft end, guide link with its quill, slider."""

SHAFT_RADIUS: Final = 0.0095
QUILL_BORE: Final = 0.0115
QUILL_RADIUS: Final = 0.0185
SLIDER_HALF: Final = 0.023  # half length of the slider along the guide
MOUNT: Final = 0.096  # height of the base plate's guide side from the plane of the guides
PLATE: Final = 0.010  # thickness of the base plate
MOTOR_HEIGHT: Final = 0.036
QUILL_TOP: Final = MOUNT + PLATE + MOTOR_HEIGHT + 0.006
"""Height of the far end of the quill, the hollow shaft that M1..M3 turn, above the guides."""

ARM_BEARING_HALF: Final = 0.018  # half height of the bearing at joint 2
CARRIAGE_HALF: Final = 0.028  # half height of M4's carriage
PLATE_BELOW_5: Final = 0.0235
"""Depth of the platform plate's upper face below the pins of joints 5."""


def span(bar: str) -> tuple[float, float]:
    """Return the room that a bar takes across the leg plane, barrels included (low, high) [m]."""
    return LAYER[bar] - BARREL / 2, LAYER[bar] + BARREL / 2


ROD_ANGLES: Final = tuple(np.radians([30.0, 150.0, 270.0]))
"""Directions of M4's guide rods about the robot's axis, between the arms [rad]."""

ROD_CIRCLE: Final = 0.0285
ROD_RADIUS: Final = 0.0055
SCREW_RADIUS: Final = 0.0075

CYLINDER_RADIUS: Final = 0.034
"""Outside of M4's cylinder, which takes in the ram with the upper knee."""

RAM_RADIUS: Final = 0.016
PLATE_OF_BRIDGE: Final = 0.012  # thickness of the plate under M4's cylinder
LIFT_MOTOR_HEIGHT: Final = 0.104  # height of M4's head: end plate, coupling and motor
