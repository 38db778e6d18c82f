"""The mechanics of the PAMINSA: design, kinematics, singularities, statics, dynamics, grids.

Poses are (..., 4) arrays (x, y, theta, z), actuator positions (theta_1, theta_2, theta_3, Z),
torques (tau_1, tau_2, tau_3, F_4), in SI units in the base frame; z is up. See the modules for
the paper's equations behind each function.
"""

from __future__ import annotations

from paminsa_viz.errors import InvalidDesign, InvalidInput, PaminsaError, UnreachablePose
from paminsa_viz.model.accuracy import DriveAccuracy, LegDeviations, Tolerances
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import APPENDIX_4, PARAMETER, PARAMETERS, Design, Geometry, KneeBranch
from paminsa_viz.model.drive import NO_DRIVES, Drive, OutputLimits
from paminsa_viz.model.dynamics import (
    InverseDynamics,
    TorqueBreakdown,
    forward_dynamics,
    friction_torque,
    inverse_dynamics,
    mass_matrix,
    platform_wrench,
    torque_breakdown,
)
from paminsa_viz.model.elastic import Elastic
from paminsa_viz.model.energy import actuator_power, kinetic_energy, potential_energy
from paminsa_viz.model.grids import Field, Grid, rotary_torques, solve_field, xy_grid
from paminsa_viz.model.jacobians import (
    actuator_acceleration,
    actuator_velocity,
    closure,
    closure_matrix,
    inverse_jacobian,
    inverse_jacobian_rate,
    jacobian,
)
from paminsa_viz.model.kinematics import (
    AssemblyModes,
    Configuration,
    JointMotion,
    forward_kinematics,
    inverse_kinematics,
    joint_rates,
    nearest_solution,
)
from paminsa_viz.model.load import LoadCase, LoadFrame, center_wrench, generalized_force
from paminsa_viz.model.lumped import (
    COEFFICIENTS,
    Misprint,
    lumped_coefficients,
    lumped_matrix,
    mass_vector,
)
from paminsa_viz.model.measures import least_margin
from paminsa_viz.model.parameters import (
    BAR_ENDS,
    ActuatorFriction,
    Counterweight,
    Friction,
    Inertias,
    JointMasses,
    LinkMasses,
    Parameter,
    Payload,
    Platform,
)
from paminsa_viz.model.reach import Limit, Reach, check_reach, home_pose, require_reachable
from paminsa_viz.model.regressor import drive_regressor, regressor_torques, torque_regressor
from paminsa_viz.model.resizing import BarLaw, resized
from paminsa_viz.model.robot import where
from paminsa_viz.model.singularity import (
    Singularity,
    escape_twist,
    measure_singularity,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.statics import (
    StaticBreakdown,
    lift_constant,
    load_torques,
    static_breakdown,
    static_imbalance,
    static_torques,
    unit_torques,
)
from paminsa_viz.model.status import Status, WithStatus

__all__ = [
    "APPENDIX_4",
    "BAR_ENDS",
    "COEFFICIENTS",
    "NO_DRIVES",
    "PARAMETER",
    "PARAMETERS",
    "ActuatorFriction",
    "AssemblyModes",
    "BarLaw",
    "Configuration",
    "Counterweight",
    "Design",
    "Drive",
    "DriveAccuracy",
    "Elastic",
    "Field",
    "Formula",
    "Friction",
    "Geometry",
    "Grid",
    "Inertias",
    "InvalidDesign",
    "InvalidInput",
    "InverseDynamics",
    "JointMasses",
    "JointMotion",
    "KneeBranch",
    "LegDeviations",
    "Limit",
    "LinkMasses",
    "LoadCase",
    "LoadFrame",
    "Misprint",
    "OutputLimits",
    "PaminsaError",
    "Parameter",
    "Payload",
    "Platform",
    "Reach",
    "Singularity",
    "StaticBreakdown",
    "Status",
    "Tolerances",
    "TorqueBreakdown",
    "UnreachablePose",
    "WithStatus",
    "actuator_acceleration",
    "actuator_power",
    "actuator_velocity",
    "center_wrench",
    "check_reach",
    "closure",
    "closure_matrix",
    "drive_regressor",
    "escape_twist",
    "forward_dynamics",
    "forward_kinematics",
    "friction_torque",
    "generalized_force",
    "home_pose",
    "inverse_dynamics",
    "inverse_jacobian",
    "inverse_jacobian_rate",
    "inverse_kinematics",
    "jacobian",
    "joint_rates",
    "kinetic_energy",
    "least_margin",
    "lift_constant",
    "load_torques",
    "lumped_coefficients",
    "lumped_matrix",
    "mass_matrix",
    "mass_vector",
    "measure_singularity",
    "nearest_solution",
    "platform_wrench",
    "potential_energy",
    "regressor_torques",
    "require_reachable",
    "resized",
    "rotary_torques",
    "singular_radius",
    "singular_rotation",
    "solve_field",
    "static_breakdown",
    "static_imbalance",
    "static_torques",
    "torque_breakdown",
    "torque_regressor",
    "unit_torques",
    "where",
    "xy_grid",
]
