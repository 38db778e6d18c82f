"""Trajectories: planned, timed within limits, checked, analysed, and simulated with a controller.

The way through it: a planner (or a preset) makes a `Plan`; `shortest` may give it its shortest
duration within limits; `Plan.sample` makes a `Trajectory`, as `from_samples` does of a file's rows;
`analyse` says what it asks of a design, and where it fails; `simulate` lets a controller drive it.
"""

from __future__ import annotations

from paminsa_viz.model.trajectory.analysis import ActuatorSummary, TrajectoryAnalysis, analyse
from paminsa_viz.model.trajectory.check import (
    SINGULAR_CLEARANCE,
    ImpossibleTrajectory,
    PathCheck,
    PathEvent,
    check_path,
)
from paminsa_viz.model.trajectory.comparison import ActuatorChange, compare
from paminsa_viz.model.trajectory.control import Control, Controller, actuator_inertia
from paminsa_viz.model.trajectory.equations import load_kernel
from paminsa_viz.model.trajectory.imported import from_samples
from paminsa_viz.model.trajectory.laws import Law, Profile, fit_law
from paminsa_viz.model.trajectory.limits import MotionLimits
from paminsa_viz.model.trajectory.plan import Plan
from paminsa_viz.model.trajectory.planners import (
    arch,
    chain,
    circle,
    line,
    move,
    there_and_back,
    through,
)
from paminsa_viz.model.trajectory.presets import PRESET, PRESETS, Preset, home, paper_like
from paminsa_viz.model.trajectory.sampled import States, Trajectory
from paminsa_viz.model.trajectory.simulation import (
    Simulation,
    SimulationFailed,
    simulate,
)
from paminsa_viz.model.trajectory.solved import SolvedTrajectory, solve_trajectory
from paminsa_viz.model.trajectory.timing import InfeasibleMotion, Shortest, shortest

__all__ = [
    "PRESET",
    "PRESETS",
    "SINGULAR_CLEARANCE",
    "ActuatorChange",
    "ActuatorSummary",
    "Control",
    "Controller",
    "ImpossibleTrajectory",
    "InfeasibleMotion",
    "Law",
    "MotionLimits",
    "PathCheck",
    "PathEvent",
    "Plan",
    "Preset",
    "Profile",
    "Shortest",
    "Simulation",
    "SimulationFailed",
    "SolvedTrajectory",
    "States",
    "Trajectory",
    "TrajectoryAnalysis",
    "actuator_inertia",
    "analyse",
    "arch",
    "chain",
    "check_path",
    "circle",
    "compare",
    "fit_law",
    "from_samples",
    "home",
    "line",
    "load_kernel",
    "move",
    "paper_like",
    "shortest",
    "simulate",
    "solve_trajectory",
    "there_and_back",
    "through",
]
