"""The load on the platform: what the actuators give against it, and what the bearings carry."""

from __future__ import annotations

from paminsa_viz.blocks.kinds import Note
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS
from paminsa_viz.model.load import center_wrench
from paminsa_viz.model.statics import load_torques
from paminsa_viz.units import format_value


def load_notes(design: Design, pose: Array) -> list[Note]:
    """Return the load at a pose (4,): what the actuators give against it, what bearings carry."""
    if not design.load.acts:
        return [Note("No external force or moment acts on the platform.")]
    names = ("F_x", "F_y", "F_z", "M_x", "M_y", "M_z")
    units = ("N",) * 3 + ("N m",) * 3
    wrench = [
        f"{name} = {format_value(value, unit)}"
        for name, value, unit in zip(names, center_wrench(design.load, pose[2]), units, strict=True)
    ]
    found = load_torques(design.geometry, design.load, pose)
    against = [
        f"{name} {format_value(value, unit)}"
        for name, value, unit in zip(ACTUATORS, found, TORQUE_UNITS, strict=True)
    ]
    x, y, z, about_x, about_y, about_z = wrench
    return [
        Note(
            f"At the platform’s center, in base axes: {x}, {y}, {z}, {about_z}. The actuators "
            f"give against it: {', '.join(against)}."
        ),
        Note(
            f"The bearings alone carry {about_x}, {about_y}: these moments do no work, so no "
            "actuator sees them."
        ),
    ]
