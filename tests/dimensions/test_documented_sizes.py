"""Sizes that are drawn are those that docs/drawn-sizes.md states, all of them in millimeters."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.dimensions import attached, needs
from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions import layout as rules
from tests.support.documentation import missing

LAYER, TUBE = at.LAYER, at.TUBE_RADIUS


def mm(*lengths: float) -> str:
    """Lengths in the words of the page."""
    return " × ".join(f"{1e3 * length:.10g}" for length in lengths)


def diameter(radius: float) -> str:
    return mm(2 * radius)


ROWS = {
    "tubes of B3, B4, B7, B8": "diameters "
    + ", ".join(diameter(TUBE[bar]) for bar in ("b3", "b4", "b7", "b8")),
    "their places across the leg plane": f"B8 {mm(-LAYER['b8'])} on one side; B4 and B7 "
    f"{mm(LAYER['b4'])}, B3 {mm(LAYER['b3'])} on the other",
    "barrels and pins at their joints": f"{mm(at.BARREL)} long, diameter "
    f"{diameter(at.BARREL_RADIUS)}; pins {diameter(at.PIN_RADIUS)}; sockets on both sides where "
    f"two joints are more than {mm(size.SOCKETS_FROM)} apart",
    "shaft B2": f"diameter {diameter(at.SHAFT_RADIUS)}, from {mm(size.SHAFT_LOW)} above joint 3",
    "quill": f"up to {mm(at.QUILL_TOP - at.MOUNT - at.PLATE - at.MOTOR_HEIGHT)} above the motor, "
    f"with a bore of {diameter(at.QUILL_BORE)}",
    "guide B10": f"{mm(*(2 * half for half in size.RAIL_HALF))}, from {mm(size.RAIL_START)} beside "
    f"the leg axis; block at its end {mm(*size.STOP)}",
    "slider": f"{mm(2 * at.SLIDER_HALF)} long",
    "swivel at joint 5": f"cheek {mm(size.CHEEK_GAP)} from the room of B4",
    "arms B1": f"{mm(*size.ARM_ROOT)} at the root, {mm(*size.ARM_TIP)} at the tip, chamfer "
    f"{mm(size.ARM_CHAMFER)}, {mm(size.ARM_OVERLAP)} into what carries them, ending "
    f"{mm(size.ARM_END)} before joint 2; where the root is farther out, on a neck of "
    f"{mm(*size.ARM_NECK)} from {mm(size.NECK_START)} on",
    "carriage of M4": f"{mm(2 * at.CARRIAGE_HALF)} high; with the upper knee on a ram of diameter "
    f"{diameter(at.RAM_RADIUS)} that goes on for {mm(size.RAM_BEYOND)}, with collars of diameter "
    f"{diameter(size.RAM_COLLAR_RADIUS)}, {mm(size.RAM_COLLAR[0])} below and "
    f"{mm(size.RAM_COLLAR[1])} above the carriage, in a cylinder of diameter "
    f"{diameter(at.CYLINDER_RADIUS)}",
    "column of M4": f"screw {diameter(at.SCREW_RADIUS)}; rods {diameter(at.ROD_RADIUS)} at "
    f"{mm(at.ROD_CIRCLE)} from the axis in the directions "
    + ", ".join(f"{angle:.10g}°" for angle in np.degrees(at.ROD_ANGLES))
    + f"; both start {mm(size.COLUMN_INTO[0])} above the base plate and reach "
    f"{mm(size.COLUMN_INTO[1])} into the head",
    "platform": f"plate {mm(size.PLATE_THICKNESS)}, {mm(at.PLATE_BELOW_5)} below joints 5, radius "
    f"{mm(size.PLATE_CORNER)} about them, with {rules.CUTS} edges each; ring of diameter "
    f"{diameter(size.PLATE_RING_RADIUS)}, {mm(size.PLATE_RING)} high",
    "base plate": f"{mm(at.PLATE)}, {mm(at.MOUNT)} from the guides; hub "
    f"{diameter(size.HUB_RADIUS)}, seats of the motors {diameter(size.SEAT_RADIUS)}",
    "its spokes": f"{mm(size.SPOKE_WIDTHS[0])} to {mm(size.SPOKE_WIDTHS[1])} wide, "
    f"{mm(size.SPOKE_HEIGHT)} high, chamfer {mm(size.SPOKE_CHAMFER)}, their middle "
    f"{mm(size.SPOKE_MIDDLE)} above its lower face, ending {mm(size.SPOKE_END)} from both axes",
    "its ring": f"{mm(size.RING_WIDTH)} wide, {mm(size.RING[0])} to {mm(size.RING[1])} above its "
    f"lower face, {mm(size.RING_GAP)} from the leg axes, in pieces of at most "
    f"{np.degrees(size.RING_STEP):.10g}°",
    "bridge (upper knee)": f"plate {mm(at.PLATE_OF_BRIDGE)}, diameter "
    f"{diameter(size.BRIDGE_RADIUS)}",
    "mast": f"{mm(*rules.MAST)} in the direction {np.degrees(rules.MAST_ANGLE):.10g}°, from "
    f"{mm(size.MAST_START)} above the ground; cap {mm(size.MAST_CAP[0])} wider and "
    f"{mm(size.MAST_CAP[1])} high",
    "its arm to the base plate": f"from {mm(size.CANTILEVER[0])}: {mm(*size.CANTILEVER[1])} to "
    f"{mm(*size.CANTILEVER[2])}",
    "its arm to the bridge": f"from {mm(size.BRIDGE_CANTILEVER[0])}: "
    f"{mm(*size.BRIDGE_CANTILEVER[1])} to {mm(*size.BRIDGE_CANTILEVER[2])}",
    "both arms": f"{mm(size.CANTILEVER_RISE)} above the plate, {mm(size.CANTILEVER_INTO_MAST)} "
    f"into the mast; flange {mm(size.FLANGE_PLATE[0])} thick, {mm(size.FLANGE_PLATE[1])} wider "
    f"and twice {mm(size.FLANGE_PLATE[2])} higher",
    "plinth": f"{mm(size.PLINTH_HEIGHT)} high, {mm(rules.PLINTH_EDGE)} beyond the workspace or "
    f"a radius of {mm(rules.LEAST_PLINTH)}; its tongue goes on for {mm(rules.TONGUE[0])} behind "
    f"the mast, half as wide as {diameter(rules.TONGUE[1])}",
    "ground (lower knee)": f"{mm(rules.HANG)} below the lowest platform, {mm(rules.STRETCHED)} "
    f"below the lowest joints, at pantographs stretched to no less than "
    f"{mm(rules.LEAST_DEEPEST**0.5)} and joints 5 no less than {mm(rules.LEAST_DEPTH)} deep",
    "ground (upper knee)": f"{mm(rules.TABLE)} below the guides, {mm(rules.STRETCHED)} below "
    "joints 9",
    "place of the mast": f"{mm(rules.MAST_GAP)} from guides, sliders and {rules.BAR_REACH:g} "
    f"times B8; {mm(rules.MAST_ROOM)} from the leg axes",
    "heights (lower knee)": f"joint 2 from "
    f"{mm(rules.LOWEST_ARM - at.QUILL_TOP - at.ARM_BEARING_HALF)} above the quill, for "
    f"{mm(rules.LEAST_LIFT)} at least; {mm(rules.ABOVE_LIFT)} above its stroke and "
    f"{mm(rules.ABOVE_CARRIAGE)} above the carriage there; mast {mm(rules.MAST_TOP - at.MOUNT)} "
    "above the base plate's lower face",
    "heights (upper knee)": f"{mm(rules.ABOVE_RAM)} above the stroke of M4, "
    f"{mm(rules.BELOW_BRIDGE)} below the bridge, mast {mm(rules.ABOVE_BRIDGE)} above it",
    "least depth of joints 5": f"joint 7 "
    f"{mm(at.MOUNT - at.BARREL_RADIUS - rules.ROOM_OF_7)} from the base plate; "
    f"{mm(rules.LEAST_NEAR)} at least",
    "payload": f"a drum of {attached.LOAD_DENSITY:g} kg/m³, {size.PAYLOAD_RATIO:g} times as high "
    "as its radius",
    "counterweights": f"discs of {attached.STEEL:g} kg/m³ as thick as a barrel, of a diameter of "
    f"at least {diameter(attached.SMALLEST)}",
    "length of B2 that is asked for": f"with the upper knee {mm(needs.SPARE)} between carriage "
    "and platform",
}


@pytest.mark.parametrize("part", ROWS)
def test_sizes_are_those_of_the_documentation(part: str) -> None:
    assert missing("drawn-sizes", [f"| {part} | {ROWS[part]} |"]) == []
