"""Trajectories: planned, timed within limits, checked, analyzed, and simulated with a controller.

A planner (or a preset) makes a `Plan`; `shortest_motion` gives it the time-optimal law within
limits, `shortest_stretch` stretches its own; `Plan.sample` makes a `Trajectory`, as `from_samples`
does of a file's rows; `analyze` returns the required torques, and where it fails; `simulate` drives
it by a controller.
"""

from __future__ import annotations

from paminsa_viz.trajectory.analysis import (
    ActuatorChange,
    ActuatorSummary,
    TrajectoryAnalysis,
    analyze,
    compare,
)
from paminsa_viz.trajectory.check import (
    SINGULAR_CLEARANCE,
    ImpossibleTrajectory,
    PathCheck,
    PathEvent,
    check_path,
    singular_clearance,
)
from paminsa_viz.trajectory.crossing import (
    Crossing,
    CrossingCondition,
    CrossingKind,
    CrossingRefused,
    PathOnLocus,
    crossing_condition,
    crossings,
)
from paminsa_viz.trajectory.crossing_measures import (
    CrossingDrift,
    CrossingLoad,
    crossing_loads,
    escape_inertia,
    payload_drift,
    unplanned_torque,
)
from paminsa_viz.trajectory.equations import load_kernel
from paminsa_viz.trajectory.imported import from_samples
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import Path, spline_path, straight_path
from paminsa_viz.trajectory.plan import Plan
from paminsa_viz.trajectory.planners import (
    arch,
    chain,
    circle,
    line,
    point_to_point,
    round_trip,
    via_points,
)
from paminsa_viz.trajectory.presets import PRESET, PRESETS, Preset, paper_like, preset_center
from paminsa_viz.trajectory.sampled import Locus, Passage, States, Trajectory
from paminsa_viz.trajectory.shortest import ShortestMotion, shortest_motion
from paminsa_viz.trajectory.simulation import (
    Controller,
    ControlMode,
    Simulation,
    SimulationFailed,
    actuator_inertia,
    simulate,
)
from paminsa_viz.trajectory.solved import SolvedTrajectory, solve_trajectory
from paminsa_viz.trajectory.time_laws import Profile, TimeLaw, fit_law
from paminsa_viz.trajectory.time_optimal import (
    DeformedPlan,
    PlannedCrossing,
    TimeOptimalPlan,
    plan_deformed,
    time_optimal,
)
from paminsa_viz.trajectory.timing import InfeasibleMotion, ShortestStretch, shortest_stretch

__all__ = [
    "PRESET",
    "PRESETS",
    "SINGULAR_CLEARANCE",
    "ActuatorChange",
    "ActuatorSummary",
    "ControlMode",
    "Controller",
    "Crossing",
    "CrossingCondition",
    "CrossingDrift",
    "CrossingKind",
    "CrossingLoad",
    "CrossingRefused",
    "DeformedPlan",
    "ImpossibleTrajectory",
    "InfeasibleMotion",
    "Locus",
    "MotionLimits",
    "Passage",
    "Path",
    "PathCheck",
    "PathEvent",
    "PathOnLocus",
    "Plan",
    "PlannedCrossing",
    "Preset",
    "Profile",
    "ShortestMotion",
    "ShortestStretch",
    "Simulation",
    "SimulationFailed",
    "SolvedTrajectory",
    "States",
    "TimeLaw",
    "TimeOptimalPlan",
    "Trajectory",
    "TrajectoryAnalysis",
    "actuator_inertia",
    "analyze",
    "arch",
    "chain",
    "check_path",
    "circle",
    "compare",
    "crossing_condition",
    "crossing_loads",
    "crossings",
    "escape_inertia",
    "fit_law",
    "from_samples",
    "line",
    "load_kernel",
    "paper_like",
    "payload_drift",
    "plan_deformed",
    "point_to_point",
    "preset_center",
    "round_trip",
    "shortest_motion",
    "shortest_stretch",
    "simulate",
    "singular_clearance",
    "solve_trajectory",
    "spline_path",
    "straight_path",
    "time_optimal",
    "unplanned_torque",
    "via_points",
]
