"""Inner forces and elasticity: joint forces, bar loads, stiffness, deflection, natural frequencies.

Forces in the legs' planes follow from equilibrium (`joint_forces`), those across them from
elasticity (`sideways_forces`). `structure` assembles beam elements and joints; `leg_compliance`
finds the same by the force method, quick enough for maps, and `platform_stiffness` puts three legs
together at the platform. `drive_stiffness` has rigid bars.
"""

from __future__ import annotations

from paminsa_viz.elastostatics.bar_loads import all_bar_loads, bar_loads, utilization
from paminsa_viz.elastostatics.beams import TubeFit, tube_fits
from paminsa_viz.elastostatics.drive_stiffness import drive_modes, drive_stiffness
from paminsa_viz.elastostatics.joint_forces import JointForces, joint_forces
from paminsa_viz.elastostatics.leg_frame import Contacts, contacts
from paminsa_viz.elastostatics.leg_matrices import Structure, structure
from paminsa_viz.elastostatics.modes import Modes
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.elastostatics.sideways import SidewaysForces, sideways_forces
from paminsa_viz.elastostatics.stiffness import (
    Compensation,
    PlatformStiffness,
    StrainShares,
    compensate,
    field_stiffness,
    load_wrench,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.elastostatics.vibration import first_frequencies, robot_modes

__all__ = [
    "Compensation",
    "Contacts",
    "JointForces",
    "Modes",
    "MotionLoads",
    "PlatformStiffness",
    "SidewaysForces",
    "StrainShares",
    "Structure",
    "TubeFit",
    "all_bar_loads",
    "bar_loads",
    "compensate",
    "contacts",
    "drive_modes",
    "drive_stiffness",
    "field_stiffness",
    "first_frequencies",
    "joint_forces",
    "load_wrench",
    "motion_loads",
    "platform_stiffness",
    "robot_modes",
    "sideways_forces",
    "strain_shares",
    "structure",
    "tube_fits",
    "utilization",
]
