"""Manufacture on the page: what is shown of tolerances, and the job that draws robots at random."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from paminsa_viz.explorer.motion.description import Pose
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.precision.manufacture import MonteCarlo, monte_carlo

MOST_ROBOTS = 200_000
"""Most robots of a job: some twenty seconds."""


@dataclass(frozen=True, eq=False)
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

    def serves(self, design: Design, pose: Pose) -> bool:
        """Whether its result is that of a design at a pose; only lengths and tolerances count."""
        return self.pose == pose and _lengths(self.design) == _lengths(design)


def _lengths(design: Design) -> tuple[object, ...]:
    return design.geometry, design.deviations, design.tolerances


@dataclass(frozen=True, eq=False)
class MonteCarloOutcome:
    """What came of a job.

    Attributes:
        job: The job.
        result: Errors of the robots, or None.
        problem: Why there are none.
    """

    job: MonteCarloJob
    result: MonteCarlo | None
    problem: str = ""


@dataclass(frozen=True)
class Manufacture:
    """What a session shows of manufacture.

    Attributes:
        robots, seed: Settings of the next job.
        coordinate: Index in `unequal_legs.COORDINATES` whose shares are shown.
        leg, length: Which deviation is shown, by their indices.
        running: The job that runs, or None.
        done: What part of it is done, 0 to 1.
        outcome: The last result, or None.
    """

    robots: int = 2000
    seed: int = 0
    coordinate: int = 0
    leg: int = 0
    length: int = 0
    running: MonteCarloJob | None = None
    done: float = 0.0
    outcome: MonteCarloOutcome | None = None

    def started(self, design: Design, pose: Pose) -> Manufacture:
        """Return it with a job for a design at a pose."""
        job = MonteCarloJob(design, pose, self.robots, self.seed)
        return replace(self, running=job, done=0.0)


def draw_robots(job: MonteCarloJob, report: Callable[[float], bool]) -> MonteCarloOutcome:
    """Draw the robots; what is the robot's fault is no error but the outcome's problem."""
    try:
        found = monte_carlo(
            job.design, job.pose, robots=job.robots, seed=job.seed, block=512,
            progress=lambda done, every: report(done / every),
        )  # fmt: skip
    except PaminsaError as error:
        return MonteCarloOutcome(job, None, str(error))
    return MonteCarloOutcome(job, found)
