"""The mechanics of the PAMINSA: design, kinematics, singularities, statics, dynamics, grids.

Poses are (..., 4) arrays (x, y, theta, z), actuator positions (theta_1, theta_2, theta_3, Z),
torques (tau_1, tau_2, tau_3, F_4), in SI units in the base frame; z is up. See the modules for
the paper's equations behind each function, and `api` for the names that this package offers: they
are loaded when the first one is used, so that a command's help does not wait for NumPy.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from paminsa_viz.model.api import *

__all__ = [
    "APPENDIX_4",
    "BAR_ENDS",
    "COEFFICIENTS",
    "PARAMETER",
    "PARAMETERS",
    "AssemblyModes",
    "Configuration",
    "Counterweight",
    "Design",
    "Field",
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
    "Limit",
    "LinkMasses",
    "LoadCase",
    "LoadFrame",
    "Misprint",
    "PaminsaError",
    "Parameter",
    "Payload",
    "Platform",
    "Reach",
    "Singularity",
    "StaticBreakdown",
    "TorqueBreakdown",
    "UnreachablePose",
    "actuator_power",
    "actuator_velocity",
    "center_wrench",
    "check_reach",
    "closure",
    "closure_matrix",
    "forward_dynamics",
    "forward_kinematics",
    "friction_torque",
    "generalized_force",
    "inverse_dynamics",
    "inverse_jacobian",
    "inverse_jacobian_rate",
    "inverse_kinematics",
    "jacobian",
    "joint_rates",
    "kinetic_energy",
    "lift_constant",
    "load_torques",
    "lumped_coefficients",
    "lumped_matrix",
    "mass_matrix",
    "mass_vector",
    "measure_singularity",
    "nearest_solution",
    "potential_energy",
    "regressor_torques",
    "require_reachable",
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
    "xy_grid",
]


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module("paminsa_viz.model.api"), name)
