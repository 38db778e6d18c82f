"""Motions that show the parameters: multi-sines of largest information within the robot's limits.

D-optimal (Swevers et al. 1997): the largest determinant of the information of base parameters,
friction and offsets, that is the smallest volume of their joint confidence region.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from paminsa_viz.identification.excitation_search import (
    CHUNK,
    RANDOM_SHARE,
    ExcitationSettings,
    Search,
    in_chunks,
    random_motions,
    shrunk,
)
from paminsa_viz.identification.information import (
    LIMITED,
    ExcitationLimits,
    Information,
    natural_height,
)
from paminsa_viz.identification.multi_sine import MultiSineFamily
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import WorkClock
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.jacobians import actuator_velocity
from paminsa_viz.model.reach import check_reach, workspace_height
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.trajectory import Plan, preset_center

FINE = 4
"""Samples of the final check over those of the search."""

NOISE_SHARE = 0.02
"""Noise of the torques over their RMS, which weighs the actuators against each other."""


class KeptLimit(NamedTuple):
    """A limit and what a motion takes of it.

    Attributes:
        name: What is limited.
        value: The largest value of the motion; of reach the smallest.
        limit: What it has to keep.
        unit: SI.
        t: When, within a period [s].
        least: Whether the limit is one from below.
    """

    name: str
    value: float
    limit: float
    unit: str
    t: float
    least: bool = False

    @property
    def kept(self) -> bool:
        """Whether the motion keeps it."""
        return self.value >= self.limit if self.least else self.value <= self.limit


@dataclass(frozen=True, eq=False)
class Excitation:
    """A motion with the information that it gives.

    Attributes:
        plan: The motion, all its periods.
        settings: How it was searched.
        limits: What it keeps, at `FINE` times the samples of the search.
        parameters: Number of parameters that the information is about.
        log_det: log det of their information of a sample.
        random_log_det: That of the best of the random motions.
        random: Number of random motions.
        evaluations: How many motions were evaluated with derivatives.
        seconds: How long it took, without compiling [s].
    """

    plan: Plan
    settings: ExcitationSettings
    limits: tuple[KeptLimit, ...]
    parameters: int
    log_det: float
    random_log_det: float
    random: int
    evaluations: int
    seconds: float

    @property
    def gain(self) -> float:
        """How much better log det is than that of the best random motion."""
        return self.log_det - self.random_log_det

    @property
    def narrowing(self) -> float:
        """By what factor intervals are narrower than with the best random motion, on average."""
        return float(np.exp(0.5 * self.gain / self.parameters))


@of_design
def optimize_excitation(
    design: Design,
    limits: ExcitationLimits,
    settings: ExcitationSettings | None = None,
    *,
    progress: Progress = go_on,
) -> Excitation:
    """Return the motion that shows a design's parameters best.

    Args:
        design: The robot as it is supposed to be; its masses matter for the torque limits alone.
        limits: What the motion has to keep.
        settings: What is searched.
        progress: Called with the share of the budget that is spent; where it returns True, the best
            motion so far is returned.

    Raises:
        NoExcitation: If no random motion keeps the limits.
        InvalidInput: If a setting is not possible.
    """
    settings = settings or ExcitationSettings()
    clock = WorkClock()
    center = preset_center(design.geometry)
    family = MultiSineFamily(settings.harmonics, center, amplitudes(design))
    info = Information(design, limits, family, settings.period, settings.samples)
    stopped = False

    def more() -> bool:
        nonlocal stopped
        done = clock.elapsed / max(settings.seconds, 1e-9)
        stopped = stopped or bool(progress(min(done, 1.0)))
        return not stopped and done < RANDOM_SHARE

    starts = random_motions(info, settings.random, settings.seed, more)
    info.noise = NOISE_SHARE * np.mean(info.torque_rms(starts[:CHUNK]), axis=0)
    worth = in_chunks(info.log_det, starts)
    search = Search(info, settings, clock, progress)
    search.over = search.over or stopped
    first = int(np.argmax(worth))
    search.best, search.best_value = starts[first], float(worth[first])
    search.run(starts[np.argsort(-worth, kind="stable")])
    fine = Information(design, limits, family, settings.period, FINE * settings.samples)
    fine.noise, fine.sharp = info.noise, True
    variables = shrunk(fine, search.best)
    plan = Plan(
        family.curve(variables, settings.periods), settings.period * settings.periods,
        "excitation", f"multi-sine, {settings.harmonics} harmonics of {settings.period:g} s",
    )  # fmt: skip
    return Excitation(
        plan=plan, settings=settings, limits=kept_limits(design, limits, plan, settings),
        parameters=info.rank, log_det=float(fine.log_det(variables)),
        random_log_det=float(fine.log_det(shrunk(fine, starts[first]))), random=len(starts),
        evaluations=search.evaluations, seconds=clock.elapsed,
    )  # fmt: skip


def amplitudes(design: Design) -> Array:
    """Return amplitudes [m, m, rad, m] that the variables of a search are multiples of."""
    g = design.geometry
    across = 0.3 * g.base_radius
    return np.array([across, across, 0.4, 0.1 * workspace_height(g)])


def kept_limits(
    design: Design, limits: ExcitationLimits, plan: Plan, settings: ExcitationSettings
) -> tuple[KeptLimit, ...]:
    """Return what a motion takes of its limits, with the whole design: friction, load, drives."""
    count = FINE * settings.samples
    t = np.arange(count) * settings.period / count
    pose, velocity, acceleration = plan.at(t)
    speed = np.abs(actuator_velocity(design, pose, velocity))
    torque = np.abs(inverse_dynamics(design, pose, velocity, acceleration).torque)
    condition = measure_singularity(design.geometry, pose).condition
    margin = check_reach(design.geometry, pose).margins.min(axis=(-1, -2))

    def row(name: str, values: Array, limit: float, unit: str, least: bool = False) -> KeptLimit:
        at = int(np.argmin(values) if least else np.argmax(values))
        return KeptLimit(name, float(values[at]), float(limit), unit, float(t[at]), least)

    columns, values = [*speed.T, *torque.T], [*limits.speed, *limits.torque]
    units = SPEED_UNITS + TORQUE_UNITS
    rows = [row(*item) for item in zip(LIMITED[:8], columns, values, units, strict=True)]
    rows.append(row("condition number", condition, limits.condition, ""))
    height = natural_height(design.geometry, pose)
    rows.append(row("distance from the guides", height, limits.clearance, "m", True))
    rows.append(row("distance to the limits of reach", margin, limits.clearance, "m", True))
    return tuple(rows)
