"""Manufacture on the page: what is shown of tolerances, and robots drawn at random."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.explorer.state.motion import Pose
from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import setting
from paminsa_viz.model import Design
from paminsa_viz.precision.manufacture import MonteCarlo

MOST_ROBOTS = 200_000
"""Most robots of a job: some twenty seconds."""


@dataclass(frozen=True)
class MonteCarloJob:
    """Robots to be drawn, with all that they depend on.

    Attributes:
        design: Its lengths and tolerances.
        pose: The pose that the drives are set for [m, m, rad, m].
        robots: How many.
        seed: Of the random numbers.
    """

    design: Design
    pose: Pose
    robots: int
    seed: int


@dataclass(frozen=True)
class MonteCarloState(TaskState[MonteCarloJob, MonteCarlo]):
    """What a session shows of manufacture.

    Attributes:
        robots, seed: Settings of the next job.
        coordinate: Index in `unequal_legs.COORDINATES` whose shares are shown.
        leg, length: Which deviation is shown, by their indices.
    """

    robots: int = setting(2000, "Robots", range=(1.0, float(MOST_ROBOTS)), step=100.0)
    seed: int = setting(0, "Seed", "The same seed draws the same robots", range=(0.0, 1e9))
    coordinate: int = 0
    leg: int = 0
    length: int = 0
