"""Tolerances of a design: by how much each leg's lengths may be off, and the play of its joints."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.model.parameters import Group, parameter


@dataclass(frozen=True)
class Tolerances(Group, path="tolerances"):
    """Tolerances of the lengths, to either side, and clearances; not in the paper.

    The defaults of lengths are those of ISO 2768-1, class f, at the prototype's sizes; of angles,
    the same at their radius, as holes have that are placed by coordinates. A clearance is the
    difference of the diameters; the default is a middling H7/g6 fit of some 10 mm. All three legs
    have the same tolerances.
    """

    bar: float = parameter(2e-4, "t_b", "m", "bars of the pantograph, joint to joint, ±")
    shaft: float = parameter(3e-4, "t_B2", "m", "shaft B2, ±")
    joint_height: float = parameter(1e-4, "t_B5", "m", "joint 5 above the platform, ±")
    guide_height: float = parameter(2e-4, "t_h", "m", "guide above the base plane, ±")
    axis_radius: float = parameter(2e-4, "t_Rb", "m", "leg axis from the base center, ±")
    axis_angle: float = parameter(6e-4, "t_ab", "rad", "direction of the leg axis, ±")
    joint_radius: float = parameter(1.5e-4, "t_Rpl", "m", "joint 5 from the center, ±")
    joint_angle: float = parameter(1.5e-3, "t_apl", "rad", "direction of joint 5, ±")
    actuator_zero: float = parameter(4e-4, "t_M", "rad", "zero of M1..M3, ±")
    pin_clearance: float = parameter(2e-5, "c_p", "m", "clearance of the pins")
    guide_clearance: float = parameter(2e-5, "c_g", "m", "clearance of the guide")


NO_TOLERANCES = Tolerances(*(0.0,) * 11)
"""Exact lengths without clearance."""
