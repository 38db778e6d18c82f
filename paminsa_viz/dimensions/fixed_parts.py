"""Sizes of the parts of fixed shape, which their drawings and the clearance checks share [m].

A pair (low, high) is a range along the part's axis; a part's frame is that of its drawing, see
``assets/parts.py``.
"""

from __future__ import annotations

import math
from typing import Final

from paminsa_viz.dimensions import layers as at

# pins, barrels, and the sockets between barrel and tube
COLLAR_RADIUS: Final = 0.0105  # spacers on pins, and the heads of pins
PIN_REACH: Final = at.PIN_HEAD + 0.0002  # of a pin's head with its socket, beyond the pin's end
BARREL_CAP: Final = 0.0004  # how far a barrel's caps protrude on each side
SOCKET_RADIUS: Final = 0.0135
SOCKET: Final = (0.010, 0.029)  # from the joint along the bar
SOCKETS_FROM: Final = 0.062  # distance of two joints on a bar from which there are sockets

# M1 to M3
MOTOR_RADIUS: Final = 0.065  # of the housing
MOTOR_FACE: Final = 0.0012  # how far the ring on the upper face protrudes
CONNECTOR_WIDTH: Final = 0.026
CONNECTOR: Final = (0.053, 0.088)  # connector with its gland, from the motor's axis
CONNECTOR_HEIGHTS: Final = (0.008, 0.026)

# quill, guide link and slider
QUILL_LOW: Final = -0.0215
QUILL_COLLAR_RADIUS: Final = 0.026
QUILL_COLLAR: Final = 0.0045  # height of the collar at the quill's far end
QUILL_KEY: Final = 0.00075  # how far the key on that end protrudes
QUILL_BLOCK: Final = (-0.027, 0.019)  # what holds the guide link: along it, and half its height
RAIL_START: Final = 0.02
RAIL_HALF: Final = (0.0127, 0.0105)  # half width and half height, strips included
STOP: Final = (0.010, 0.034, 0.032)  # length, width and height of the block at the link's end
SLIDER_HEIGHTS: Final = (-0.018, 0.019)

# shaft B2 and the swivel at joint 5
SHAFT_BLOCK: Final = 0.032  # length of the block at joint 3 along the leg plane
SHAFT_BLOCK_HEIGHTS: Final = (-0.0175, 0.019)
SHAFT_NECK_RADIUS: Final = 0.0158
SHAFT_NECK_TOP: Final = 0.031
SHAFT_LOW: Final = 0.02
NUT_RADIUS: Final = 0.0138
NUT: Final = (-at.ARM_BEARING_HALF - 0.0072, at.ARM_BEARING_HALF + 0.0117)
"""Range of the collar and nut that hold the shaft, about joint 2."""

SWIVEL_DISC_RADIUS: Final = 0.0205
SWIVEL_DISC_HEIGHT: Final = 0.0068
SWIVEL_HALF: Final = 0.0125
SWIVEL_TOP: Final = 0.0115
CHEEK_GAP: Final = 0.004  # between the swivel's cheek and the layer of B4

# carriage, arms B1 and ram of M4
CARRIAGE_RADIUS: Final = 0.042
CARRIAGE_CAP: Final = 0.003
CARRIAGE_COLLAR_RADIUS: Final = 0.0165
CARRIAGE_COLLAR: Final = (0.002, 0.008)  # how far its collars protrude below and above
ARM_ROOT: Final = (0.034, 0.048)  # width and height
ARM_TIP: Final = (0.021, 0.026)
ARM_NECK: Final = (0.024, 0.026)  # of the neck that may lead to the arm
ARM_CHAMFER: Final = 0.002
ARM_OVERLAP: Final = 0.006
ARM_END: Final = 0.02  # distance of the arm's beam from joint 2, where the bearing is
NECK_START: Final = 0.03
ARM_BEARING_RADIUS: Final = 0.0265
ARM_BEARING_CAP: Final = 0.0012
RAM_COLLAR_RADIUS: Final = 0.026
RAM_COLLAR: Final = (0.004, 0.012)  # how far they protrude from the carriage, below and above
RAM_BEYOND: Final = 0.02

# platform and payload
PLATE_THICKNESS: Final = 0.010
PLATE_CORNER: Final = 0.025  # radius about its joints
PLATE_RING_RADIUS: Final = 0.030
PLATE_RING: Final = 0.0025
FLANGE_RADIUS: Final = 0.032
FLANGE_DEPTH: Final = 0.009
FLANGE_TIP_RADIUS: Final = 0.0215
FLANGE_TIP_DEPTH: Final = 0.0115
PAYLOAD_RATIO: Final = 1.25  # height of the payload's drum over its radius

# base plate: hub, spokes, seats of the motors, ring
HUB_RADIUS: Final = 0.064
SPOKE_END: Final = 0.05  # distance of its ends from the robot's axis and from the leg axis
SPOKE_WIDTHS: Final = (0.050, 0.034)
SPOKE_HEIGHT: Final = 0.016
SPOKE_CHAMFER: Final = 0.0015
SPOKE_MIDDLE: Final = 0.0085  # height of its middle above the plate's lower face
SEAT_RADIUS: Final = 0.073
RING_WIDTH: Final = 0.026
RING: Final = (0.0008, 0.0152)  # heights above the plate's lower face
RING_GAP: Final = 0.060
RING_STEP: Final = math.radians(7.5)  # largest angle of a straight piece of the drawn ring [rad]

# column and head of M4
FOOT_RADIUS: Final = 0.052
FOOT_HEIGHT: Final = 0.011
FOOT_NECK_RADIUS: Final = 0.0385
FOOT_NECK_HEIGHT: Final = 0.0195
COLUMN_INTO: Final = (0.010, 0.005)
"""How far screw and rods start above the base plate, and reach into the head."""

HEAD_RADIUS: Final = 0.042
HEAD_PLATE: Final = 0.0168
HEAD_WIDTH: Final = 0.0552
HEAD_CONNECTOR: Final = (0.018, 0.016, 0.016)
HEAD_CONNECTOR_AT: Final = (0.0, 0.033, 0.079)

# mast, its arms, plinth
BRIDGE_RADIUS: Final = 0.070
MAST_FOOT: Final = (0.170, 0.150, 0.0155)
MAST_SLEEVE: Final = (0.106, 0.082, 0.042)
MAST_CAP: Final = (0.003, 0.010)  # what the cap adds to the mast's sides in all, and its height
MAST_START: Final = 0.008
CANTILEVER_RISE: Final = 0.0012
CANTILEVER_INTO_MAST: Final = 0.004
CANTILEVER: Final = (0.045, (0.036, 0.020), (0.054, 0.092))
BRIDGE_CANTILEVER: Final = (0.052, (0.044, 0.020), (0.056, 0.078))
"""Start, and (width, height) at the axis and at the mast, of the arms from the mast."""

FLANGE_PLATE: Final = (0.014, 0.012, 0.006)
"""Flange of such an arm: thickness, what it adds to the width, and to each height."""

PLINTH_HEIGHT: Final = 0.020
