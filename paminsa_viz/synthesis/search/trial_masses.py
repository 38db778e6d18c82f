"""Trials of a search with the best masses and springs for their lengths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from paminsa_viz.model.lumped import lumped_coefficients, mass_vector
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.case import GOALS, InnerCase, linear_bounds
from paminsa_viz.synthesis.masses.program import InnerProgram, inner_program
from paminsa_viz.synthesis.search.trial import TrialRobot

SPARE = 2e-9
"""By how much of itself (or of 1) a bound is tightened, against the solver's rounding."""

ENOUGH = 1e-7
"""Gap to close, as a share of the goal: far below what a search tells apart."""


def trial_program(
    trial: TrialRobot, tighter: Sequence[float] = (), relaxed: int | None = None
) -> InnerProgram:
    """Return the program of masses and springs for a trial's lengths and workspace.

    Args:
        trial: A robot that reaches its workspace.
        tighter: By how much each bound of the requirements, and then each limit, is tightened
            [SI]; none if empty.
        relaxed: Index of a bound, or of a limit after the bounds, to minimize instead of keeping
            it, see `Evaluator`.

    Raises:
        InnerInfeasible: If a motion is out of reach.
        InvalidInput: If a mass is not one of the design's.
    """
    whole = trial.case
    assert whole.inner is not None
    bounds = whole.requirements.bounds
    tight = [_tightened(b, tighter[i] if tighter else 0.0) for i, b in enumerate(bounds)]
    rest = linear_bounds(tight)
    windows = {(whole.requirements.headings(bound), bound.z) for bound in rest}
    pose = [np.empty((0, 4))]
    pose += [trial.grid(theta, trial.heights(z)) for theta, z in sorted(windows, key=str)]
    goal = whole.objective if whole.objective in GOALS else whole.inner.goal
    most = []
    for index, item in enumerate(whole.limits, len(bounds)):
        if item.objective in GOALS and index == relaxed:
            goal = item.objective
        elif item.objective in GOALS and item.is_limit:
            by = tighter[index] if index < len(tighter) else 0.0
            most.append((item.objective, item.most - by - SPARE * max(1.0, abs(item.most))))
    center = np.array(trial.workspace.center, np.float64)
    case: InnerCase = whole.inner.placed(center)
    case = replace(case, goal=goal, bounds=rest, most=(*case.most, *most))
    program = inner_program(whole.design(trial.geometry), case, np.concatenate(pose))
    if relaxed is None or relaxed >= len(bounds):
        return program
    own = [item for item in program.limits if item.requirement is tight[relaxed]]
    if not own:
        return program
    kept = tuple(item for item in program.limits if item is not own[0])
    return replace(program, goal=own[0].term, limits=kept, key="")


def with_best_masses(
    trial: TrialRobot, tighter: Sequence[float] = (), relaxed: int | None = None
) -> TrialRobot:
    """Return a trial with the best masses and springs; arguments as in `trial_program`.

    Raises:
        InnerInfeasible: If a motion is out of reach, or no masses keep the bounds.
        InvalidInput: If a mass is not one of the design's.
        SolverFailed: If a solver fails.
    """
    found = trial_program(trial, tighter, relaxed).solve(tolerance=ENOUGH)
    return replace(
        trial,
        inner=found,
        masses=mass_vector(found.design),
        coefficients=lumped_coefficients(found.design),
    )


def _tightened(bound: Requirement, by: float) -> Requirement:
    low, high = bound.low, bound.high
    low = None if low is None else low + by + SPARE * max(1.0, abs(low))
    high = None if high is None else high - by - SPARE * max(1.0, abs(high))
    return replace(bound, low=low, high=high)
