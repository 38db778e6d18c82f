"""From analyzed trajectories to the panels of each kind of series."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.clearance import ALL_PAIRS, PairGroup, group_clearance, nearest_points
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.drive import SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.palette import (
    ACTUATOR_COLORS,
    COORDINATE_COLORS,
    INK,
    LEG_COLORS,
    MUTED,
    OK,
    REFERENCE,
)
from paminsa_viz.plots.series import (
    FIGURES,
    TITLES,
    Dash,
    EngineTorques,
    SeriesData,
    SeriesKind,
    SeriesPanel,
    SeriesSources,
    Trace,
    Values,
)
from paminsa_viz.trajectory.analysis import ActuatorSummary, TrajectoryAnalysis
from paminsa_viz.units import format_value

# ----------------------------------------------------------------------- joint forces and bar loads

PERCENT = 100.0

PLOTTED = ("2", "4", "guide", "5")
"""Joints that are plotted, by their keys."""


def load_panels(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the forces at joints of every leg, and the largest bending moment and utilization."""
    analysis = sources.analysis
    found = motion_loads(analysis)
    time = analysis.trajectory.t

    def traces(values: Values | None) -> tuple[Trace, ...]:
        drawn = np.full((time.size, 3), np.nan)
        if found is not None and values is not None:
            drawn[np.searchsorted(time, found.trajectory.t)] = values
        made = []
        for leg, color in enumerate(LEG_COLORS):
            column = drawn[:, leg]
            peak = None
            if np.isfinite(column).any():
                top = int(np.nanargmax(column))
                peak = (float(time[top]), float(column[top]))
            made.append(Trace(f"leg {leg + 1}", column, color, peak=peak))
        return tuple(made)

    def panel(name: str, symbol: str, unit: str, values: Values | None) -> SeriesPanel:
        drawn = traces(values)
        notes = tuple(
            (f"peak {format_value(trace.peak[1], unit, 3)}", trace.color)
            for trace in drawn
            if trace.peak is not None
        )
        return SeriesPanel(name, name, symbol, unit, INK, drawn, notes)

    for key in PLOTTED:
        index = JOINT_INDEX[key]
        label = JOINTS[index].label
        name = f"Force at joint {label}" if key.isdigit() else f"Force at the {label}"
        values = None if found is None else found.magnitude[:, :, index]
        yield panel(name, f"F {label}", "N", values)
    bending = None if found is None else np.abs(found.bars[..., 2]).max(axis=-1)
    yield panel("Largest bending moment", "max M", "N m", bending)
    share = None if found is None else PERCENT * found.utilization.max(axis=-1)
    yield panel("Utilization of the bars", "σ/R_p", "%", share)


# ---------------------------------------------------------------------------------- least clearance

SAMPLES = 241
"""Samples of a motion that are looked at, in equal distance; then all next to the least."""

_COLORS = (INK, REFERENCE, *ACTUATOR_COLORS, OK)
"""Of the groups of pairs."""


@dataclass(frozen=True, eq=False)
class MotionClearance:
    """Least clearance along a motion.

    Attributes:
        samples: (k,) which samples of the motion were looked at.
        least: (k,) least distance of two bodies there [m]; NaN where the robot cannot be.
        groups: Groups of pairs that were checked and have pairs.
        by_group: (k, groups) least distance of each group [m].
        distance: The least of all; NaN where there is none [m].
        t: When that is [s].
        names: The two bodies.
    """

    samples: NDArray[np.intp]
    least: Values
    groups: tuple[PairGroup, ...]
    by_group: Values
    distance: float = np.nan
    t: float = np.nan
    names: tuple[str, str] = ("", "")


def motion_clearance(
    analysis: TrajectoryAnalysis, pairs: Iterable[PairGroup] = ALL_PAIRS
) -> MotionClearance:
    """Return the least clearance of a design along its motion.

    Args:
        analysis: The design on the motion.
        pairs: Groups of pairs that are checked.
    """
    motion = analysis.trajectory
    wanted = frozenset(pairs)
    chosen = tuple(group for group in PairGroup if group in wanted)
    count = min(motion.size, SAMPLES)
    samples = np.linspace(0, motion.size - 1, count).round().astype(np.intp)
    pose = np.where(analysis.check.ok[:, None], motion.pose, np.nan)

    def least_at(where: NDArray[np.intp]) -> tuple[Values, Values]:
        by_group = group_clearance(analysis.design, pose[where], chosen)
        return np.fmin.reduce(by_group, axis=1, initial=np.nan), by_group

    least, by_group = least_at(samples)
    if not np.isfinite(least).any():
        return MotionClearance(samples, least, (), by_group[:, :0])
    low = int(np.nanargmin(least))
    near = np.arange(samples[max(low - 1, 0)], samples[min(low + 1, count - 1)] + 1)
    more = np.setdiff1d(near, samples)
    samples = np.concatenate([samples, more])
    order = np.argsort(samples)
    least, by_group = (
        np.concatenate(both)[order] for both in zip((least, by_group), least_at(more), strict=True)
    )
    samples = samples[order]
    low = int(np.nanargmin(least))
    lowest = nearest_points(analysis.design, pose[samples[low]], chosen)
    assert lowest is not None  # it has a clearance
    known = [i for i in range(len(chosen)) if np.isfinite(by_group[:, i]).any()]
    return MotionClearance(
        samples, least, tuple(chosen[i] for i in known), by_group[:, known],
        float(least[low]), float(motion.t[samples[low]]), lowest.names,
    )  # fmt: skip


def unknown_clearance(analysis: TrajectoryAnalysis) -> MotionClearance:
    """Return what stands for a clearance that is not computed yet: no values."""
    none = np.array([0, analysis.trajectory.size - 1], dtype=np.intp)
    return MotionClearance(none, np.full(2, np.nan), (), np.zeros((2, 0)))


def clearance_panels(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the least clearance of all bodies, and that of each group of pairs."""
    analysis = sources.analysis
    found = sources.clearance
    if not isinstance(found, MotionClearance):
        found = motion_clearance(analysis)
    time = analysis.trajectory.t

    def spread(values: Values) -> Values:
        known = np.isfinite(values)
        if not known.any():
            return np.full(time.size, np.nan)
        between = np.interp(time, time[found.samples], values)
        between[~analysis.check.ok] = np.nan
        return between

    peak = (found.t, found.distance) if np.isfinite(found.distance) else None
    notes = ()
    if peak is not None:
        text = f"{format_value(found.distance, 'm', 3)} at {format_value(found.t, 's', 3)}"
        notes = ((text, MUTED), (f"{found.names[0]} and {found.names[1]}", MUTED))
    least = Trace("least", spread(found.least), INK, width=1.3, peak=peak)
    yield SeriesPanel("Least clearance", "all", "d", "m", INK, (least,), notes)
    traces = tuple(
        Trace(group.value, spread(found.by_group[:, i]), _COLORS[list(PairGroup).index(group)])
        for i, group in enumerate(found.groups)
    )
    none = Trace("no pairs", np.full(time.size, np.nan), INK)
    yield SeriesPanel("Clearance by pairs", "pairs", "d", "m", INK, traces or (none,))


# ------------------------------------------------------------------------------ the panels in order

SYMBOLS = ("τ₁", "τ₂", "τ₃", "F₄")
POSE_UNITS = {"x": "m", "y": "m", "θ": "rad", "z": "m"}

CAUSES: tuple[tuple[str, str, str, Dash], ...] = (
    ("gravity", "gravity", "#56B4E9", "dashed"),
    ("inertial", "inertia", "#E69F00", "solid"),
    ("velocity", "centrifugal and Coriolis", "#CC79A7", "dashdot"),
    ("friction", "friction", "#6b6b6b", "dotted"),
    ("load", "load", "#009E73", "dashed"),
)
"""Parts of a torque: attribute of `TorqueBreakdown`, label, color, stroke."""

_COMPARED: tuple[tuple[str, str, str, str | None, Dash, float], ...] = (
    ("analysis", "design", "", None, "solid", 1.3),
    ("reference", "reference", "reference", REFERENCE, "dashed", 1.0),
    ("published", "formulas as published", "as published", "#b5121b", "dotted", 1.0),
)
"""Curves of an actuator: source, label, suffix, color (None for its own), stroke, width."""


def build_series(kind: SeriesKind, sources: SeriesSources) -> SeriesData:
    """Return the panels of a kind.

    Raises:
        InvalidInput: If there is no such kind, or it needs something that is not given.
    """
    if kind not in _BUILDERS:
        raise InvalidInput("kind", f"one of {', '.join(FIGURES)} is needed, not {kind!r}")
    panels = tuple(_BUILDERS[kind](sources))
    check, time = sources.analysis.check, sources.analysis.trajectory.t
    failing, until = ~check.ok, check.until
    if kind in ("comparison", "differences"):
        samples = sources.other.samples_of(time.size)
        time, failing, until = time[samples], failing[samples], int((samples < until).sum())
    elif kind in ("tracking", "errors", "commands"):
        time = sources.simulated_time if kind == "tracking" else sources.simulated.t
        failing, until = np.zeros(time.size, dtype=bool), time.size
    return SeriesData(kind, TITLES[kind], sources, time, panels, failing, until)


def _compared(
    panel: SeriesPanel,
    j: int,
    sources: SeriesSources,
    values: Callable[[TrajectoryAnalysis], Values],
    annotate: Callable[[ActuatorSummary, Trace], tuple[Trace, str]] | None = None,
) -> SeriesPanel:
    """Return a panel with curves of design, reference and published formulas, the design's last.

    ``values`` returns the curves of an analysis (n, 4); ``annotate`` marks a trace and returns
    its note.
    """
    traces, notes = [], []
    for source, label, suffix, fixed, dash, width in _COMPARED:
        analysis: TrajectoryAnalysis | None = getattr(sources, source)
        if analysis is None:
            continue
        color = fixed or panel.color
        trace = Trace(label, values(analysis)[:, j], color, dash, width, suffix)
        if annotate is not None and analysis.summary:
            trace, note = annotate(analysis.summary[j], trace)
            notes.append((f"{suffix}: {note}" if suffix else note, color))
        traces.append(trace)
    return replace(panel, traces=(*traces[1:], traces[0]), notes=tuple(notes))


def _actuators(symbols: Sequence[str], units: Sequence[str]) -> Iterator[tuple[int, SeriesPanel]]:
    for j in range(4):
        yield j, SeriesPanel(f"M{j + 1}", f"M{j + 1}", symbols[j], units[j], ACTUATOR_COLORS[j])


def _coordinates(suffix: str = "") -> Iterator[tuple[int, SeriesPanel]]:
    for i, (name, unit) in enumerate(POSE_UNITS.items()):
        yield i, SeriesPanel(name, name, name, unit + suffix, COORDINATE_COLORS[i])


def _torques(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield torques of M1..M3 and force of M4, as in Figs. 6 and 7, with peaks and RMS."""
    for j, panel in _actuators(SYMBOLS, TORQUE_UNITS):
        drawn = _compared(panel, j, sources, lambda a: a.torque, partial(_with_torque, panel.unit))
        if sources.engine is not None:
            marks = _marks(sources.engine, sources.analysis.trajectory.size, j)
            drawn = replace(drawn, traces=(*drawn.traces, marks))
        yield drawn


def _with_torque(unit: str, summary: ActuatorSummary, trace: Trace) -> tuple[Trace, str]:
    peak, peak_t, mean = summary.peak, summary.peak_t, summary.rms
    marked = replace(trace, peak=(peak_t, peak), band=mean)
    return marked, f"{_peak_text(peak, peak_t, unit)}, RMS {_text(mean, unit)}"


def _marks(engine: EngineTorques, size: int, j: int) -> Trace:
    """Return about 50 of an engine's torques of actuator ``j`` as marks."""
    samples = engine.samples_of(size)
    step = max(math.ceil(samples.size / 50), 1)
    values = np.full(size, np.nan)
    values[samples[::step]] = engine.torque[::step, j]
    return Trace(engine.name, values, INK, suffix=engine.name, marks=True)


def _power(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the power of each actuator, positive where it drives."""
    for j, panel in _actuators(("P₁", "P₂", "P₃", "P₄"), ("W",) * 4):
        annotate = partial(_with_power, SPEED_UNITS[j])
        yield _compared(panel, j, sources, lambda a: a.power, annotate)


def _with_power(speed_unit: str, summary: ActuatorSummary, trace: Trace) -> tuple[Trace, str]:
    text = _peak_text(summary.top_power, summary.top_power_t, "W")
    if not trace.suffix:  # the speeds of the others are the same
        text = f"{text}, speed up to {_text(summary.top_speed, speed_unit)}"
    return replace(trace, peak=(summary.top_power_t, summary.top_power)), text


def _with_work(summary: ActuatorSummary, trace: Trace) -> tuple[Trace, str]:
    return trace, f"drives {_text(summary.driven, 'J')}, brakes {_text(summary.braked, 'J')}"


def _energy(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the work of each actuator, the robot's energy, and how well the two balance."""
    analysis = sources.analysis
    for j, panel in _actuators(("W₁", "W₂", "W₃", "W₄"), ("J",) * 4):
        yield _compared(panel, j, sources, lambda a: a.work, _with_work)
    work = Trace("work of all four", analysis.work.sum(axis=1), MUTED, width=1.8)
    gain = Trace("energy gained", analysis.energy - analysis.energy[0], INK, "dashed")
    residual = Trace("work − losses − gain", analysis.energy_residual, INK, width=0.8)
    gains = f"gains up to {_size_text(gain.values, 'J')}"
    balance = f"up to {_size_text(residual.values, 'J')}"
    yield SeriesPanel("Robot", "Robot", "ΔE", "J", INK, (work, gain), ((gains, MUTED),))
    yield SeriesPanel("Balance", "Balance", "W − ΔE", "J", INK, (residual,), ((balance, MUTED),))


def _breakdown(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield each actuator's torque by its causes; friction and load only where there is any."""
    analysis = sources.analysis
    parts = analysis.breakdown
    absent = {
        name
        for name in ("friction", "load")
        if not np.nanmax(np.abs(getattr(parts, name)), initial=0.0) > 0
    }
    for j, panel in _actuators(SYMBOLS, TORQUE_UNITS):
        causes = [
            Trace(label, getattr(parts, name)[:, j], color, dash)
            for name, label, color, dash in CAUSES
            if name not in absent
        ]
        notes = [
            ", ".join(f"{t.label} up to {_size_text(t.values, panel.unit)}" for t in row)
            for row in (causes[:2], causes[2:])
        ]
        total = Trace("total", analysis.torque[:, j], panel.color, width=1.3)
        yield replace(panel, traces=(*causes, total), notes=tuple((text, MUTED) for text in notes))


def _pose(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the platform's coordinates, the quantities of Figs. 8-11."""
    t = sources.analysis.trajectory
    for i, panel in _coordinates():
        speed = _size_text(t.velocity[:, i], f"{panel.unit}/s")
        acceleration = _size_text(t.acceleration[:, i], f"{panel.unit}/s²")
        note = f"speed up to {speed}, acceleration up to {acceleration}"
        yield replace(_of_platform(panel, t.pose[:, i]), notes=((note, MUTED),))


def _rates(attribute: str, per: str, sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield speeds or accelerations of the platform."""
    rates: Values = getattr(sources.analysis.trajectory, attribute)
    for i, panel in _coordinates(per):
        yield _of_platform(panel, rates[:, i])


def _of_platform(panel: SeriesPanel, values: Values) -> SeriesPanel:
    return replace(panel, traces=(Trace("motion", values, panel.color, width=1.3, suffix=""),))


def _tracking(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the simulated platform next to the wanted motion, and the error of each coordinate."""
    time, simulation = sources.simulated_time, sources.simulated
    wanted = sources.analysis.trajectory.at(time).pose
    actual = np.full((time.size, 4), np.nan)
    actual[: simulation.t.size] = simulation.pose
    for i, panel in _coordinates():
        simulated = Trace("simulated", actual[:, i], "#8aa4bf", width=2.2)
        traces = (simulated, Trace("wanted", wanted[:, i], INK, "dashed", 0.9))
        yield replace(panel, traces=traces)
        yield _difference(panel, "Error", time, actual[:, i] - wanted[:, i])


def _errors(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the error of each simulated coordinate alone."""
    simulation = sources.simulated
    for i, panel in _coordinates():
        yield _difference(panel, "Error", simulation.t, simulation.error[:, i])


def _commands(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the torques that the controller of a simulation commands."""
    for j, panel in _actuators(SYMBOLS, TORQUE_UNITS):
        torque = sources.simulated.torque[:, j]
        yield replace(panel, traces=(Trace("commanded", torque, panel.color, "solid", 1.3, ""),))


def _comparison(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield each actuator's torque from two sources, and their difference."""
    other = sources.other
    time, torque = other.pick(sources.analysis.trajectory.t), other.pick(sources.analysis.torque)
    known = [bool(np.isfinite(column).any()) for column in other.torque.T]
    for j, panel in _actuators(SYMBOLS, TORQUE_UNITS):
        if any(known) and not known[j] and np.isfinite(torque[:, j]).any():
            continue  # a table from elsewhere may lack an actuator; a reference that fails, all
        own = Trace("this analysis", torque[:, j], panel.color, width=1.6)
        compared = Trace(other.name, other.torque[:, j], INK, "dashed", 0.8)
        yield replace(panel, traces=(own, compared))
        yield _difference(panel, "Difference", time, torque[:, j] - other.torque[:, j])


def _differences(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the formulas' torques minus an engine's, with those of the formulas as published."""
    other, formulas = sources.other, replace(sources, reference=None)
    for j, panel in _actuators(SYMBOLS, TORQUE_UNITS):
        yield _compared(panel, j, formulas, lambda a: other.pick(a.torque) - other.torque)


def _difference(panel: SeriesPanel, what: str, t: Values, values: Values) -> SeriesPanel:
    """Return the panel of a difference, with its largest value marked and in a note."""
    trace = Trace("difference", values, panel.color, width=0.9, suffix="")
    notes = ()
    known = np.flatnonzero(np.isfinite(values))
    if known.size:
        top = known[np.abs(values[known]).argmax()]
        peak_t, peak = float(t[top]), float(values[top])
        trace = replace(trace, peak=(peak_t, peak))
        notes = ((f"largest {_text(peak, panel.unit)} at {_text(peak_t, 's')}", MUTED),)
    name, symbol = f"{what} of {panel.name}", f"Δ{panel.symbol}"
    return replace(panel, name=name, symbol=symbol, traces=(trace,), notes=notes)


def _text(value: float, unit: str) -> str:
    return format_value(value, unit, 3)


def _peak_text(value: float, t: float, unit: str) -> str:
    return f"peak {_text(value, unit)} at {_text(t, 's')}"


def _size_text(values: Values, unit: str) -> str:
    """Return the largest size among values (n,), with its unit; a dash if there is none."""
    known = np.abs(values[np.isfinite(values)])
    return _text(float(known.max()) if known.size else math.nan, unit)


_BUILDERS: dict[SeriesKind, Callable[[SeriesSources], Iterator[SeriesPanel]]] = {
    "torques": _torques,
    "breakdown": _breakdown,
    "pose": _pose,
    "speed": partial(_rates, "velocity", "/s"),
    "acceleration": partial(_rates, "acceleration", "/s²"),
    "power": _power,
    "energy": _energy,
    "loads": load_panels,
    "clearance": clearance_panels,
    "tracking": _tracking,
    "errors": _errors,
    "commands": _commands,
    "comparison": _comparison,
    "differences": _differences,
}
"""What makes the panels, by kind."""
