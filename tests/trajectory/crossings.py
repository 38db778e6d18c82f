"""Paths across singularities, and what their plans have to keep."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack
from functools import cache
from unittest.mock import patch

import numpy as np

from paminsa_viz.balancing import balance
from paminsa_viz.model import APPENDIX_4, Design
from paminsa_viz.trajectory import MotionLimits, crossing_program
from paminsa_viz.trajectory.crossing import CrossingRefused, crossing_condition, crossings
from paminsa_viz.trajectory.paths import Path, spline_path, straight_path
from paminsa_viz.trajectory.time_optimal import TimeOptimalPlan, time_optimal

BALANCED = balance(APPENDIX_4).after
TURN = straight_path([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5])
"""A turn through 73.4 degrees, where every position is singular."""
LINE = straight_path([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5])
"""A line through the singular circle."""
TEN = MotionLimits(torque=10.0)
PLAIN = (0, crossing_program.INTERVALS)
"""Pieces of a program that is not refined."""

shortest = cache(time_optimal)
"""Plans that several tests look at, worked out once."""


def lines_across(rng: np.random.Generator) -> tuple[Design, Path, MotionLimits]:
    """A line through the singular circle at random, many almost at right angles to the twist."""
    first = rng.uniform(0.0, 2.0 * np.pi)
    ends = zip(
        rng.uniform([0.05, 0.3], [0.2, 0.4]), (first, first + rng.uniform(-0.6, 0.6)), strict=True
    )
    inner, outer = (radius * np.array([np.cos(at), np.sin(at)]) for radius, at in ends)
    theta = rng.uniform(-0.6, 0.6)
    turned = theta + rng.uniform(-0.3, 0.3)
    return BALANCED, straight_path([*inner, theta, -0.5], [*outer, turned, -0.5]), TEN


def any_path(rng: np.random.Generator) -> tuple[Design, Path, MotionLimits]:
    """A path through two or three poses at random, of a balanced robot or Appendix 4's."""
    design, torque = ((BALANCED, 10.0), (APPENDIX_4, 100.0))[int(rng.integers(2))]
    poses = rng.uniform(
        [-0.2, -0.2, -1.9, -0.58], [0.2, 0.2, 1.9, -0.42], (int(rng.integers(2, 4)), 4)
    )
    return design, spline_path(poses), MotionLimits(torque=torque)


def influences(design: Design, path: Path) -> list[float]:
    """The cosines between path and escape twist at the crossings of a path."""
    return [
        crossing_program.influence(design, path, item, crossing_condition(design, path, item.s))
        for item in crossings(design.geometry, path)
    ]


def duration(
    design: Design, path: Path, limits: MotionLimits, pieces: int, refinement: int
) -> float:
    """The shortest duration [s] with so many pieces, halved so often where they all cross."""
    module = sys.modules[time_optimal.__module__]
    with ExitStack() as changed:
        for kind in ("", "STEEP_"):
            changed.enter_context(patch.object(module, f"{kind}INTERVALS", pieces))
            changed.enter_context(patch.object(module, f"{kind}REFINEMENTS", (refinement,)))
        return time_optimal(design, path, limits).plan.duration


FINER = (160, 4)
"""Pieces, and how often they are halved, of programs to compare with."""


def random_crossing(
    make: Callable[[np.random.Generator], tuple[Design, Path, MotionLimits]], seed: int
) -> tuple[Design, Path, MotionLimits, TimeOptimalPlan]:
    """The first path of a seed that crosses singularities and can be run, with its plan."""
    rng = np.random.default_rng(seed)
    while True:
        design, path, limits = make(rng)
        if crossings(design.geometry, path):
            try:
                return design, path, limits, time_optimal(design, path, limits)
            except CrossingRefused:
                continue
