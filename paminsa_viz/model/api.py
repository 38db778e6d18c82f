"""The names that `paminsa_viz.model` offers."""

from __future__ import annotations

from paminsa_viz.model.counterweight import BAR_ENDS, Counterweight
from paminsa_viz.model.design import (
    APPENDIX_4,
    Design,
    Friction,
    Geometry,
    Inertias,
    JointMasses,
    KneeBranch,
    LinkMasses,
    Payload,
    Platform,
)
from paminsa_viz.model.dynamics import (
    InverseDynamics,
    TorqueBreakdown,
    actuator_power,
    actuator_velocity,
    forward_dynamics,
    friction_torque,
    inverse_dynamics,
    kinetic_energy,
    mass_matrix,
    torque_breakdown,
)
from paminsa_viz.model.errors import InvalidDesign, InvalidInput, PaminsaError, UnreachablePose
from paminsa_viz.model.grids import (
    Field,
    Grid,
    rotary_torques,
    solve_field,
    xy_grid,
)
from paminsa_viz.model.jacobians import (
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
from paminsa_viz.model.parameters import PARAMETER, PARAMETERS, Parameter
from paminsa_viz.model.reach import Limit, Reach, check_reach, require_reachable
from paminsa_viz.model.regressor import regressor_torques, torque_regressor
from paminsa_viz.model.singularity import (
    Singularity,
    measure_singularity,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.statics import (
    StaticBreakdown,
    lift_constant,
    load_torques,
    potential_energy,
    static_breakdown,
    static_imbalance,
    static_torques,
    unit_torques,
)
