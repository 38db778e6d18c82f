"""Manufacture on the page: what is shown of tolerances, and robots drawn at random."""

from __future__ import annotations

from dataclasses import dataclass, field

from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Pose
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.precision.manufacture import MonteCarlo
from paminsa_viz.precision.unequal_legs import ERRORS, ORDER
from paminsa_viz.units import symbol_text

MOST_ROBOTS = 200_000
"""Most robots of a job: some twenty seconds."""

NAMES = tuple(name for name, _, _ in ERRORS)
"""Names of `unequal_legs.SIX_COORDINATES`."""


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
class MonteCarloSettings(Settings):
    """What a person set.

    Attributes:
        robots, seed: Of the next job.
        coordinate: Index in `unequal_legs.SIX_COORDINATES` whose shares are shown.
        leg, length: Which deviation is shown, by their indices.
    """

    robots: int = setting(
        2000, "Robots", "How many are drawn; more make the shares more certain",
        range=(1.0, float(MOST_ROBOTS)), step=100.0,
    )  # fmt: skip
    seed: int = setting(0, "Seed", "The same seed draws the same robots", range=(0.0, 1e9))
    coordinate: int = setting(
        0, "Shares in", "Which lengths the error of a coordinate comes from",
        options={NAMES[i]: i for i in ORDER},
    )  # fmt: skip
    leg: int = setting(
        0, "Leg", "Whose deviation is set below", options={f"leg {i + 1}": i for i in range(3)}
    )
    length: int = setting(
        0, "Length", "Whose deviation is set below, of the chosen leg alone",
        options={f"{symbol_text(one.symbol)} {one.label}": i for i, one in enumerate(LENGTHS)},
    )  # fmt: skip


@dataclass(frozen=True)
class MonteCarloState(TaskState[MonteCarloJob, MonteCarlo]):
    """What a session shows of manufacture.

    Attributes:
        settings: What a person set.
    """

    settings: MonteCarloSettings = field(default_factory=MonteCarloSettings)
