"""The list of all parts of fixed shape, which are kept as mesh files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from paminsa_viz.meshes import actuator_parts, joint_parts
from paminsa_viz.meshes.part import Part


@dataclass(frozen=True)
class Fitting:
    """A fixed part with its file name (without suffix) and what a reader needs to know of it."""

    name: str
    make: Callable[[], Part]
    purpose: str
    frame: str


CATALOGUE: Final[tuple[Fitting, ...]] = (
    Fitting(
        "rotary_actuator",
        actuator_parts.rotary_actuator,
        "housing of the rotating actuators M1 to M3, with a bore for the quill",
        "leg axis at the mounting face; +z away from the guides; connector toward +x",
    ),
    Fitting(
        "quill",
        actuator_parts.quill,
        "hollow shaft turned by M1 to M3, with the block that holds guide link B10",
        "leg axis at the height of the guides; guide link toward -x",
    ),
    Fitting(
        "slider",
        joint_parts.slider,
        "slider on the guide with the pin of joint 8 (B8 on one side, B7 on the other)",
        "joint 8; x along the guide, y across the leg plane",
    ),
    Fitting(
        "barrel", joint_parts.barrel, "bearing barrel at a joint of a bar", "middle; axis along y"
    ),
    Fitting(
        "bar_end",
        joint_parts.bar_end,
        "socket between a barrel and the tube of a bar",
        "middle of the barrel; tube toward +x",
    ),
    Fitting(
        "shaft_end",
        joint_parts.shaft_end,
        "head of shaft B2 with the pin of joint 3, which carries B3",
        "joint 3; +z up the shaft, y across the leg plane",
    ),
    Fitting(
        "arm_bearing", joint_parts.arm_bearing, "bearing of joint 2 at the tip of an arm", "joint 2"
    ),
    Fitting("shaft_nut", joint_parts.shaft_nut, "nut and collar of shaft B2 at joint 2", "joint 2"),
    Fitting(
        "lift_carriage",
        actuator_parts.lift_carriage,
        "carriage of the linear actuator M4, which carries the three arms B1",
        "robot axis at the height of the arms",
    ),
    Fitting(
        "lift_foot", actuator_parts.lift_foot, "flange under M4's column", "robot axis on the plate"
    ),
    Fitting(
        "lift_motor",
        actuator_parts.lift_motor,
        "head of M4: end plate and motor",
        "under the end plate",
    ),
    Fitting(
        "swivel",
        joint_parts.swivel,
        "head of joint 5, which turns on the platform, with the pin that carries B4",
        "joint 5; x along and y across the leg plane",
    ),
    Fitting(
        "tool_flange",
        joint_parts.tool_flange,
        "flange under the platform",
        "middle of the plate's lower face",
    ),
    Fitting(
        "payload",
        joint_parts.payload,
        f"load of 1 kg at {joint_parts.LOAD_DENSITY:.0f} kg/m^3, scaled to others",
        "middle of its upper face",
    ),
    Fitting(
        "mast_foot",
        actuator_parts.mast_foot,
        "foot of the mast",
        "on the ground; x away from the robot",
    ),
)
"""Every part that is kept as a mesh file."""
