"""Tasks of the balance and their outcomes: plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from paminsa_viz.balancing import Optimum, ParetoFront, Tornado
from paminsa_viz.explorer.balancing.settings import BalanceSettings
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.trajectory import Trajectory


class Task(Enum):
    """What is computed."""

    PAPER = "the paper's balance"
    OPTIMUM = "the optimal masses"
    FRONT = "the Pareto front"
    SENSITIVITY = "the sensitivity"


@dataclass(frozen=True, eq=False)
class Job:
    """A task with everything it depends on.

    Attributes:
        task: What is computed.
        design: The robot as it is.
                theta, z: The plane of poses of the static torques, that of the maps
                [rad, m].
        trajectory: The current motion, or None.
        problem: Why there is no motion.
        settings: What a person set.
    """

    task: Task
    design: Design
    theta: float
    z: float
    trajectory: Trajectory | None
    problem: str
    settings: BalanceSettings


@dataclass(frozen=True)
class Effect:
    """A number before and after; NaN where it has no value."""

    label: str
    unit: str
    before: float
    after: float


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of a job: an optimum, a front or a tornado, or why there is none.

    Attributes:
        job: The job.
        after: The best design, or None.
        optimum: It, with its proof.
        effects: What it does to torques and masses.
        front: The front, if that was asked for.
        designs: The designs of its points.
        tornado: The sensitivity, if that was asked for.
        problem: Why there is nothing.
    """

    job: Job
    after: Design | None = None
    optimum: Optimum | None = None
    effects: tuple[Effect, ...] = ()
    front: ParetoFront | None = None
    designs: tuple[Design, ...] = ()
    tornado: Tornado | None = None
    problem: PaminsaError | None = None


@dataclass(frozen=True)
class Balancing:
    """The balancing of a session.

    Attributes:
        settings: What a person set.
        running: The job that runs, or None.
        done: What part of it is done, 0 to 1.
        outcome: The last optimum, or why there is none, or None.
        front: The last front, likewise.
        tornado: The last sensitivity, likewise.
        output: Which of `paminsa_viz.balancing.OUTPUTS` the tornado chart shows.
    """

    settings: BalanceSettings = field(default_factory=BalanceSettings)
    running: Job | None = None
    done: float = 0.0
    outcome: Outcome | None = None
    front: Outcome | None = None
    tornado: Outcome | None = None
    output: int = 0
