"""Data plotted over time, in SI units: sources, panels of traces, and their statistics.

`series_builders` makes it from analyzed trajectories, `series_figure` draws it with matplotlib,
`series_uplot` hands it to the page. None of it is a curve of the paper: the motion of its
Figs. 6-11 is not in its text.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.plots.caption import shown
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.integrals import rms
from paminsa_viz.trajectory.simulation import Simulation

FigureKind = Literal[
    "torques", "breakdown", "pose", "power", "energy", "loads", "clearance", "tracking",
    "comparison",
]  # fmt: skip
SeriesKind = FigureKind | Literal["speed", "acceleration", "errors", "commands", "differences"]
FIGURES: tuple[FigureKind, ...] = get_args(FigureKind)
"""Kinds of figures, in the order in which they are offered; the others are parts of them."""

TITLES: dict[SeriesKind, str] = {
    "torques": "Actuator torques and force",
    "breakdown": "Actuator torques by cause",
    "pose": "Motion of the platform",
    "speed": "Speed of the platform",
    "acceleration": "Acceleration of the platform",
    "power": "Power of the actuators",
    "energy": "Work of the actuators and energy of the robot",
    "loads": "Forces at the joints and in the bars",
    "clearance": "Clearance between the bodies",
    "tracking": "Simulated motion",
    "errors": "Errors of the simulated motion",
    "commands": "Commanded torques and force",
    "comparison": "Torques and force from two sources",
    "differences": "Differences of torques and force",
}
"""Titles by kind; `series_builders` has what is shown."""

Dash = Literal["solid", "dashed", "dotted", "dashdot"]
Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trace:
    """A curve.

    Attributes:
        label: What it is, for legends; the same in every panel that has it.
        values: (n,) in the panel's unit; NaN where there is none.
        color: ``#rrggbb``.
        dash: Its stroke.
        width: Its width, 1 for ordinary.
        suffix: What follows the panel's source where traces of several panels share axes:
            ``"reference"`` in ``"M1 reference"``; None if its own label does there as well.
        marks: Whether its values are drawn as marks; between them it has none.
        peak: Time [s] and value of a marked point, the largest in size, of a clearance the
            least; None for none.
        band: RMS, drawn as a band to both sides of zero; None for none.
    """

    label: str
    values: Values
    color: str
    dash: Dash = "solid"
    width: float = 1.0
    suffix: str | None = None
    marks: bool = False
    peak: tuple[float, float] | None = None
    band: float | None = None


@dataclass(frozen=True, eq=False)
class SeriesPanel:
    """One set of axes.

    Attributes:
        name: Heading, for example ``"Difference of M1"``.
        source: What the traces belong to, for example ``"M1"``.
        symbol: Symbol of the quantity, for the axis: ``"τ₁"``.
        unit: Unit of the values.
        color: Color of the heading.
        traces: The curves, later ones above earlier ones.
        notes: Key numbers as text, each in the color of the trace that it belongs to.
    """

    name: str
    source: str
    symbol: str
    unit: str
    color: str
    traces: tuple[Trace, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, eq=False)
class SeriesData:
    """Panels over one time axis.

    Attributes:
        kind: Which of the kinds.
        title: Title of the figure.
        sources: What it is made of.
        time: (n,) increasing [s].
        panels: In reading order.
        failing: (n,) where the motion fails.
        until: Samples before the first failure.
    """

    kind: SeriesKind
    title: str
    sources: SeriesSources
    time: Values
    panels: tuple[SeriesPanel, ...]
    failing: NDArray[np.bool_]
    until: int


@dataclass(frozen=True, eq=False)
class EngineTorques:
    """Torques from elsewhere, such as a physics engine, at samples of the trajectory.

    Attributes:
        name: Name of the source, for the legend.
        torque: (k, 4) [N m, N m, N m, N]; NaN where there is none.
        samples: (k,) which samples of the trajectory they belong to; None for all of them.
    """

    name: str
    torque: Values
    samples: NDArray[np.intp] | None = None

    def samples_of(self, size: int) -> NDArray[np.intp]:
        """Return the samples as indices (k,), also where they are all of a trajectory."""
        return np.arange(size) if self.samples is None else self.samples

    def pick(self, values: Values) -> Values:
        """Return values (n, ...) of the trajectory at the engine's samples (k, ...)."""
        return values if self.samples is None else values[self.samples]


@dataclass(frozen=True, eq=False)
class SeriesSources:
    """What series are made of.

    Attributes:
        analysis: The design on the trajectory.
        reference: Another design on the same trajectory, drawn dashed.
        published: The design by the formulas as published, drawn dotted.
        simulation: The robot driven by a controller.
        engine: Torques from elsewhere.
        clearance: A `MotionClearance`; found when it is plotted if None.

    Raises:
        InvalidInput: If they are not of the same trajectory.
    """

    analysis: TrajectoryAnalysis
    reference: TrajectoryAnalysis | None = None
    published: TrajectoryAnalysis | None = None
    simulation: Simulation | None = None
    engine: EngineTorques | None = None
    clearance: object | None = None

    def __post_init__(self) -> None:
        motion = self.analysis.trajectory
        for name in ("reference", "published"):
            other = getattr(self, name)
            if other is None or other.trajectory is motion:
                continue
            same = np.array_equal(other.trajectory.t, motion.t) and np.array_equal(
                other.trajectory.pose, motion.pose
            )
            if not same:
                raise InvalidInput(name, "it has to be an analysis of the same trajectory")
        if self.engine is not None:
            count = self.engine.samples_of(motion.size).size
            if self.engine.torque.shape != (count, 4):
                shape = self.engine.torque.shape
                raise InvalidInput("engine", f"torques ({count}, 4) are needed, not {shape}")

    @property
    def other(self) -> EngineTorques:
        """Torques for comparison: the engine's, else the published formulas', else the
        reference.

        Raises:
            InvalidInput: If there is nothing.
        """
        if self.engine is not None:
            return self.engine
        if self.published is not None:
            return EngineTorques("formulas as published", self.published.torque)
        if self.reference is not None:
            name = f"reference {shown(self.reference.design.name)}"
            return EngineTorques(name, self.reference.torque)
        raise InvalidInput(
            "engine", "a comparison needs an engine's torques, published formulas or a reference"
        )

    @property
    def simulated(self) -> Simulation:
        """The simulation.

        Raises:
            InvalidInput: If there is none.
        """
        if self.simulation is None:
            raise InvalidInput("simulation", "these curves show one")
        return self.simulation

    @cached_property
    def simulated_time(self) -> Values:
        """Instants of the simulation, and of the trajectory after it stopped (n,) [s].

        Raises:
            InvalidInput: If the simulation is not one of the same trajectory.
        """
        t, simulated = self.analysis.trajectory.t, self.simulated.t
        if simulated[0] != t[0] or simulated[-1] > t[-1]:
            raise InvalidInput("simulation", "it has to be one of the same trajectory")
        return np.concatenate([simulated, t[t > simulated[-1]]])


class Statistics(NamedTuple):
    """Numbers of a trace before the motion fails; NaN if it fails at once.

    Attributes:
        peak: Its value of largest size.
        peak_t: When [s].
        rms: Root mean square over time.
    """

    peak: float
    peak_t: float
    rms: float


def statistics(t: Values, trace: Trace) -> Statistics:
    """Return peak and RMS of a trace over time (n,) [s], as far as it is drawn.

    A motion that fails leaves gaps; what is drawn beyond them counts, by the time it takes.
    """
    values = trace.values
    pieces = runs(values)
    if not pieces:
        return Statistics(math.nan, math.nan, math.nan)
    top = int(np.nanargmax(np.abs(values)))
    spans = np.array([t[piece][-1] - t[piece][0] for piece in pieces])
    means = np.array([float(rms(t[piece], values[piece, None])[0]) for piece in pieces])
    weights = spans if spans.any() else np.ones(len(pieces))
    mean = math.sqrt(float(np.average(means**2, weights=weights)))
    return Statistics(float(values[top]), float(t[top]), mean)


def largest_size(traces: Sequence[Trace]) -> float:
    """Return the largest size of all values; 0 if there is none."""
    known = [np.abs(trace.values[np.isfinite(trace.values)]) for trace in traces]
    return max((float(values.max()) for values in known if values.size), default=0.0)


def runs(values: Values) -> list[slice]:
    """Return where values (n,) are without a NaN, as slices."""
    known = np.concatenate([[False], ~np.isnan(values), [False]])
    edges = np.flatnonzero(np.diff(known))
    return [slice(int(first), int(stop)) for first, stop in edges.reshape(-1, 2)]


def thinned(curves: Sequence[Values], most: int) -> NDArray[np.intp]:
    """Return the indices of about ``most`` samples that draw the same curves.

    They are evenly spread; peaks and gaps are drawn as they are, since the ends of each run of
    values, its least and its largest value, and a sample of the gap behind it are among them.

    Args:
        curves: Arrays over the same samples (n,), NaN where there is no value.
        most: Samples, but for the ends and extremes of runs.
    """
    n = curves[0].size
    if n <= most:
        return np.arange(n)
    kept = [np.linspace(0, n - 1, most).round().astype(np.intp)]
    for values in curves:
        for run in runs(values):
            part = values[run]
            ends = (0, part.size - 1, int(part.argmin()), int(part.argmax()))
            kept.append(run.start + np.array(ends, dtype=np.intp))
            kept.append(np.array([min(run.stop, n - 1)]))
    return np.unique(np.concatenate(kept))
