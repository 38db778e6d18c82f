"""Optimal redistribution of masses, and what goes with it.

`balance` is the paper's own (Eqs. 7-8). `optimize` minimizes any weighted sum of terms within the
bounds of `Changes`, with a certificate; `pareto_front` trades two terms off.
`fit_springs` balances with springs instead. `tornado`, `mass_tolerance` and `length_tolerance`
measure sensitivity; `synthesis.synthesize` optimizes lengths.
"""

from __future__ import annotations

from paminsa_viz.balancing.changes import (
    Changes,
    CounterweightRange,
    MassRange,
    along,
    beyond,
    whole_mass,
)
from paminsa_viz.balancing.optimum import (
    ActiveConstraint,
    InfeasibleBounds,
    Optimum,
    Relaxation,
    Shortfall,
    TermValue,
    optimize,
)
from paminsa_viz.balancing.paper_balance import balance, paper_changes
from paminsa_viz.balancing.pareto import ParetoFront, ParetoPoint, pareto_front
from paminsa_viz.balancing.program import SolverFailed
from paminsa_viz.balancing.sensitivity import OUTPUTS, Tornado, TornadoBar, tornado
from paminsa_viz.balancing.springs import (
    Anchor,
    Spring,
    SpringFit,
    SpringPlace,
    at_joint,
    fit_springs,
    on_bar,
    on_guide,
    on_slider,
    spring_energy,
    spring_lengths,
    spring_torques,
)
from paminsa_viz.balancing.terms import (
    LIFT,
    MOTION_GOALS,
    ROTARY,
    AddedMass,
    Imbalance,
    MassChange,
    StaticLift,
    StaticPeak,
    StaticRms,
    Term,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
)
from paminsa_viz.balancing.tolerance import (
    LengthTolerance,
    MassTolerance,
    length_tolerance,
    mass_tolerance,
)

__all__ = [
    "LIFT",
    "MOTION_GOALS",
    "OUTPUTS",
    "ROTARY",
    "ActiveConstraint",
    "AddedMass",
    "Anchor",
    "Changes",
    "CounterweightRange",
    "Imbalance",
    "InfeasibleBounds",
    "LengthTolerance",
    "MassChange",
    "MassRange",
    "MassTolerance",
    "Optimum",
    "ParetoFront",
    "ParetoPoint",
    "Relaxation",
    "Shortfall",
    "SolverFailed",
    "Spring",
    "SpringFit",
    "SpringPlace",
    "StaticLift",
    "StaticPeak",
    "StaticRms",
    "Term",
    "TermValue",
    "Tornado",
    "TornadoBar",
    "TrajectoryEnergy",
    "TrajectoryPeak",
    "TrajectoryRms",
    "along",
    "at_joint",
    "balance",
    "beyond",
    "fit_springs",
    "length_tolerance",
    "mass_tolerance",
    "on_bar",
    "on_guide",
    "on_slider",
    "optimize",
    "paper_changes",
    "pareto_front",
    "spring_energy",
    "spring_lengths",
    "spring_torques",
    "tornado",
    "whole_mass",
]
