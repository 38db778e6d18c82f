"""What a study measures of a design: one entry a metric.

Over a region of the workspace: static loads and distances to every limit. On a motion: dynamic
loads, or where it fails and why.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from paminsa_viz.balancing.changes import whole_mass
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import wrap
from paminsa_viz.model.reach import Limit, status_words
from paminsa_viz.model.singularity import singular_radius, singular_rotation
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.quantities import Quantity, find
from paminsa_viz.studies.region import Region, RegionResults
from paminsa_viz.trajectory import Trajectory, TrajectoryAnalysis, analyze
from paminsa_viz.units import si_unit

Results = TypeVar("Results")


@dataclass(frozen=True)
class Metric(Generic[Results]):
    """One number of a design.

    Attributes:
        name: Its name.
        unit: SI unit, empty for pure numbers.
        meaning: What it is.
        value: Makes it from results [SI]; NaN where there is none.
    """

    name: str
    unit: str
    meaning: str
    value: Callable[[Results], float]

    @property
    def column(self) -> str:
        """Name of its column in tables, with its unit."""
        return f"{self.name}_{self.unit.replace(' ', '')}" if self.unit else self.name


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if values.size else np.nan


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else np.nan


METRICS: tuple[Metric[RegionResults], ...] = (
    Metric("Mp2", "N", "M_p2, 0 for a robot that is balanced statically (Eq. 8)",
           lambda found: static_imbalance(found.design)),
    Metric("mass", "kg", "mass of all that moves, with the payload",
           lambda found: whole_mass(found.design)),
    Metric("added_mass", "kg", "mass beyond that of the design that the others are made from",
           lambda found: whole_mass(found.design) - found.base_mass),
    Metric("reached_share", "", "share of the region that can be reached",
           lambda found: found.share(found.reached)),
    Metric("usable_share", "",
           "share of the region that can be reached, not too close to a singularity",
           lambda found: found.share(found.usable)),
    Metric("peak_torque", "N m", "largest static torque of M1 to M3 over the usable poses",
           lambda found: _largest(found.torques[:3])),
    Metric("rms_torque", "N m", "RMS of the static torques of M1 to M3 over the usable poses",
           lambda found: _rms(found.torques[:3])),
    Metric("peak_force", "N", "largest static force of M4 over the usable poses",
           lambda found: _largest(found.torques[3])),
    Metric("worst_condition", "", "largest condition number over the poses that can be reached",
           lambda found: _largest(found.conditions)),
    Metric("median_condition", "", "median condition number over the poses that can be reached",
           lambda found: float(np.median(found.conditions)) if found.conditions.size else np.nan),
    Metric("reach_margin", "m",
           "least distance of the region to a limit of reach, negative beyond",
           lambda found: float(found.field.margin[found.inside].min())),
    Metric("singular_distance", "m",
           "from the region to the singular circle, negative if it crosses",
           lambda found: float(singular_radius(found.design.geometry, found.region.theta).min())
           - found.region.radius),
    Metric("singular_turn", "rad",
           "from the region to the singular angle; none if R_pl > R_b",
           lambda found: singular_rotation(found.design.geometry)
           - float(np.abs(wrap(found.region.theta)).max())),
)  # fmt: skip
"""Everything that is measured over a region, in the order of a table's columns."""


def global_indices(keys: Sequence[str]) -> tuple[Metric[RegionResults], ...]:
    """Return the global indices of quantities over a region: mean, minimum and spread of each.

    After Gosselin and Angeles (J. Mech. Des. 113 (1991) 220): the mean is the integral over the
    workspace divided by its volume, here over the poses of the region that can be reached; the
    spread is the standard deviation.

    Args:
        keys: Keys of `paminsa_viz.quantities`.

    Raises:
        InvalidInput: If there is none of a key.
    """
    kinds: tuple[tuple[str, str, Callable[[Array], Any]], ...] = (
        ("mean", "mean of", np.mean),
        ("min", "minimum of", np.min),
        ("spread", "standard deviation of", _deviation),
    )

    def metric(quantity: Quantity, kind: str, words: str, of: Callable[[Array], Any]) -> Metric:
        def value(found: RegionResults) -> float:
            values = found.values(quantity)
            return float(of(values)) if values.size else np.nan

        meaning = f"{words} {quantity.label} over the poses that can be reached"
        unit = "" if quantity.unit == "1" else si_unit(quantity.unit)
        return Metric(f"{kind}_{quantity.key}", unit, meaning, value)

    return tuple(metric(quantity, *kind) for quantity in find(keys) for kind in kinds)


def _deviation(values: Array) -> Any:
    """Return the standard deviation of values (n,), exactly 0 where all are the same."""
    return np.std(values - values.flat[0])  # a mean of equal values may differ from them


@of_design
def measure_design(
    design: Design,
    region: Region,
    *,
    base_mass: float = 0.0,
    metrics: tuple[Metric[RegionResults], ...] = METRICS,
) -> tuple[float, ...]:
    """Return metrics of a design [SI]; NaN where there is none, as without a usable pose.

    Args:
        design: The robot.
        region: The poses.
        base_mass: What the added mass is counted from [kg].
        metrics: What to measure.
    """
    found = RegionResults(design, region, base_mass)
    return tuple(metric.value(found) for metric in metrics)


MOTION_METRICS: tuple[Metric[TrajectoryAnalysis], ...] = (
    Metric("motion_peak_torque", "N m", "largest torque of M1 to M3 on the motion",
           lambda found: max(abs(motor.peak) for motor in found.summary[:3])),
    Metric("motion_rms_torque", "N m", "RMS torque of M1 to M3 over the motion’s time",
           lambda found: _rms(np.array([motor.rms for motor in found.summary[:3]]))),
    Metric("motion_peak_force", "N", "largest force of M4 on the motion",
           lambda found: abs(found.summary[3].peak)),
    Metric("motion_energy", "J",
           "energy that M1 to M4 put in on the motion; braking gives none back",
           lambda found: sum(motor.driven for motor in found.summary)),
)  # fmt: skip
"""Everything that is measured on a motion, in the order of a table's columns."""

RUNS = str(status_words(Limit.OK))  # word for a motion that a design can run


@of_design
def measure_motion(design: Design, trajectory: Trajectory) -> tuple[str, float, tuple[float, ...]]:
    """Return a word, a time [s] and the `MOTION_METRICS` [SI] of a design on a motion.

    The numbers are those of `analyze`, friction included. A design that cannot run the whole
    motion has none: they are NaN, the word is what it fails at, such as ``guide:leg2`` or
    ``singular``, and the time is when. Otherwise the word is `RUNS` and the time NaN.
    """
    analysis = analyze(design, trajectory)
    failure = analysis.failure
    if failure is not None:
        nothing = (np.nan,) * len(MOTION_METRICS)
        return str(status_words(failure.limit, failure.leg)), failure.t, nothing
    return RUNS, np.nan, tuple(metric.value(analysis) for metric in MOTION_METRICS)


def samples_hash(trajectory: Trajectory) -> str:
    """Return a hash of a motion's samples; its name does not count."""
    found = hashlib.sha256()
    arrays = [trajectory.t, trajectory.pose, trajectory.velocity, trajectory.acceleration]
    if trajectory.load is not None:
        arrays.append(trajectory.load)
    for array in arrays:
        found.update(array.astype("<f8").tobytes())
    if trajectory.passages:
        found.update(repr([(item.t, item.locus.name) for item in trajectory.passages]).encode())
    return found.hexdigest()[:32]
