"""From an analyzed trajectory to the data of a figure over time, one builder for each kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.palette import ACTUATOR_COLORS, INK, MUTED, REFERENCE
from paminsa_viz.plots import curves_words as words
from paminsa_viz.plots.curves_data import CurveData, Level, Panel, Peak, Reading, Trace
from paminsa_viz.plots.curves_sources import Sources
from paminsa_viz.units import format_value

Values = NDArray[np.float64]

ACTUATORS = ("M1", "M2", "M3", "M4")
SYMBOLS = ("τ₁", "τ₂", "τ₃", "F₄")
UNITS = ("N m", "N m", "N m", "N")

COORDINATES = ("x", "y", "θ", "z")
COORDINATE_UNITS = ("m", "m", "rad", "m")

PRINTED_COLOR = "#b5121b"
"""The formulae as printed, where they stand beside the corrected ones."""

SIMULATED_COLOR = "#8aa4bf"
"""What a simulated robot does, below the wanted motion."""

PARTS: tuple[tuple[str, str, str], ...] = (
    ("gravity", "gravity", "#56B4E9"),
    ("inertial", "inertia", "#E69F00"),
    ("velocity", "centrifugal and Coriolis", "#CC79A7"),
    ("friction", "friction", "#6b6b6b"),
)
"""Parts of a torque: attribute of `TorqueBreakdown`, words, color."""


def torques(sources: Sources) -> tuple[Panel, ...]:
    """Return torques of M1..M3 and force of M4, as in Figs. 6 and 7, with peaks and RMS."""
    analysis = sources.analysis
    panels = []
    for j, panel in enumerate(_actuator_panels(SYMBOLS, UNITS)):
        traces = [*_besides(sources, lambda a: a.torque, j)]
        traces.append(Trace("design", analysis.torque[:, j], ACTUATOR_COLORS[j], width=1.3))
        peaks, levels, readings = [], [], []
        for source, said, color in _summaries(sources, j):
            peaks.append(Peak(source.peak_t, source.peak, color))
            levels.append(Level(float(np.copysign(source.rms, source.peak)), color))
            peak = format_value(source.peak, UNITS[j], 3)
            rms = format_value(source.rms, UNITS[j], 3)
            at = format_value(source.peak_t, "s", 3)
            readings.append(Reading(f"{said}peak {peak} at {at}, RMS {rms}", color))
        panels.append(
            replace(
                panel,
                traces=tuple(traces),
                peaks=tuple(peaks),
                levels=tuple(levels),
                readings=tuple(readings),
            )
        )
    return tuple(panels)


def breakdown(sources: Sources) -> tuple[Panel, ...]:
    """Return each actuator's torque by its causes."""
    analysis = sources.analysis
    parts = analysis.breakdown
    rubs = bool(np.nanmax(np.abs(parts.friction), initial=0.0) > 0)
    dashes = ("dashed", "solid", "dashdot", "dotted")
    panels = []
    for j, panel in enumerate(_actuator_panels(SYMBOLS, UNITS)):
        traces, readings = [], []
        for (name, said, color), dash in zip(PARTS, dashes, strict=True):
            if name == "friction" and not rubs:
                continue
            part = getattr(parts, name)[:, j]
            traces.append(Trace(said, part, color, dash))
        traces.append(Trace("all together", analysis.torque[:, j], ACTUATOR_COLORS[j], width=1.3))
        for row in (traces[:2], traces[2:-1]):
            said = [f"{t.label} up to {words.size(t.values, UNITS[j])}" for t in row]
            readings.append(Reading(", ".join(said), MUTED))
        panels.append(replace(panel, traces=tuple(traces), readings=tuple(readings)))
    return tuple(panels)


def pose(sources: Sources) -> tuple[Panel, ...]:
    """Return the platform's coordinates, the quantities of Figs. 8-11."""
    t = sources.analysis.trajectory
    panels = []
    for i, panel in enumerate(_coordinate_panels()):
        unit = COORDINATE_UNITS[i]
        rates = (
            f"speed up to {words.size(t.velocity[:, i], f'{unit}/s')}, "
            f"acceleration up to {words.size(t.acceleration[:, i], f'{unit}/s²')}"
        )
        traces = (Trace("motion", t.pose[:, i], INK, width=1.3),)
        panels.append(replace(panel, traces=traces, readings=(Reading(rates, MUTED),)))
    return tuple(panels)


def power(sources: Sources) -> tuple[Panel, ...]:
    """Return the power of each actuator, positive where it drives."""
    analysis = sources.analysis
    panels = []
    for j, panel in enumerate(_actuator_panels(("P₁", "P₂", "P₃", "P₄"), ("W",) * 4)):
        traces = [*_besides(sources, lambda a: a.power, j)]
        traces.append(Trace("design", analysis.power[:, j], ACTUATOR_COLORS[j], width=1.3))
        peaks, readings = [], []
        for source, said, color in _summaries(sources, j):
            peaks.append(Peak(source.top_power_t, source.top_power, color))
            top = format_value(source.top_power, "W", 3)
            at = format_value(source.top_power_t, "s", 3)
            speed = format_value(source.top_speed, "rad/s" if j < 3 else "m/s", 3)
            more = "" if said else f", speed up to {speed}"  # the others' speeds are the same
            readings.append(Reading(f"{said}peak {top} at {at}{more}", color))
        panels.append(
            replace(panel, traces=tuple(traces), peaks=tuple(peaks), readings=tuple(readings))
        )
    return tuple(panels)


def energy(sources: Sources) -> tuple[Panel, ...]:
    """Return the work of each actuator, the robot's energy, and how well the two balance."""
    analysis = sources.analysis
    panels = []
    for j, panel in enumerate(_actuator_panels(("W₁", "W₂", "W₃", "W₄"), ("J",) * 4)):
        traces = [*_besides(sources, lambda a: a.work, j)]
        traces.append(Trace("design", analysis.work[:, j], ACTUATOR_COLORS[j], width=1.3))
        readings = []
        for source, said, color in _summaries(sources, j):
            driven, braked = (
                format_value(source.driven, "J", 3),
                format_value(source.braked, "J", 3),
            )
            readings.append(Reading(f"{said}drives {driven}, brakes {braked}", color))
        panels.append(replace(panel, traces=tuple(traces), readings=tuple(readings)))
    growth = analysis.energy - analysis.energy[0]
    work = analysis.work.sum(axis=1)
    residual = analysis.energy_residual
    robot = Panel(
        "Robot", "ΔE", "J", INK,
        (
            Trace("work of all four", work, MUTED, width=1.8),
            Trace("kinetic and potential energy gained", growth, INK, "dashed"),
        ),
        readings=(Reading(f"gains up to {words.size(growth, 'J')}", MUTED),),
    )  # fmt: skip
    balance = Panel(
        "Balance", "W − ΔE", "J", INK, (Trace("work − losses − gain", residual, INK, width=0.8),),
        readings=(Reading(f"up to {words.size(residual, 'J')}", MUTED),),
    )  # fmt: skip
    return (*panels, robot, balance)


def tracking(sources: Sources) -> tuple[Panel, ...]:
    """Return the simulated platform beside the wanted motion, and the error of each coordinate.

    Raises:
        InvalidInput: If there is no simulation.
    """
    simulation = sources.simulation
    if simulation is None:
        raise InvalidInput("simulation", "figures of tracking show one")
    time, t = sources.time, simulation.t
    wanted = sources.analysis.trajectory.at(time).pose
    left = time.size - t.size
    actual = np.concatenate([simulation.pose, np.full((left, 4), np.nan)])
    panels = []
    for i, panel in enumerate(_coordinate_panels()):
        traces = (
            Trace("simulated", actual[:, i], SIMULATED_COLOR, width=2.2),
            Trace("wanted", wanted[:, i], INK, "dashed", 0.9),
        )
        panels.append(replace(panel, traces=traces))
        error = actual[:, i] - wanted[:, i]
        panels.append(
            _difference(error, t, f"Error of {panel.name}", f"Δ{panel.symbol}", panel.unit, INK)
        )
    return tuple(panels)


def comparison(sources: Sources) -> tuple[Panel, ...]:
    """Return each actuator's torque from two sources, and their difference.

    Raises:
        InvalidInput: If there is no second source.
    """
    analysis, (name, other) = sources.analysis, sources.other
    panels = []
    for j, panel in enumerate(_actuator_panels(SYMBOLS, UNITS)):
        own = Trace("this analysis", analysis.torque[:, j], ACTUATOR_COLORS[j], width=1.6)
        panels.append(replace(panel, traces=(own, Trace(name, other[:, j], INK, "dashed", 0.8))))
        panels.append(
            _difference(
                analysis.torque[:, j] - other[:, j],
                sources.time,
                f"Difference of {panel.name}",
                f"Δ{panel.symbol}",
                panel.unit,
                panel.color,
            )
        )
    return tuple(panels)


BUILDERS: dict[str, tuple[Callable[[Sources], tuple[Panel, ...]], str]] = {
    "torques": (torques, "Actuator torques and force"),
    "breakdown": (breakdown, "Actuator torques by cause"),
    "pose": (pose, "Motion of the platform"),
    "power": (power, "Power of the actuators"),
    "energy": (energy, "Work of the actuators and energy of the robot"),
    "tracking": (tracking, "Simulated motion"),
    "comparison": (comparison, "Torques and force from two sources"),
}
"""Builder and title by kind."""


def build(kind: str, sources: Sources, notes: Sequence[str] = ()) -> CurveData:
    """Return the data of a figure.

    Args:
        kind: A key of `BUILDERS`.
        sources: What it is made of.
        notes: Further sentences for the caption.

    Raises:
        InvalidInput: If there is no such kind, or it needs something that is not given.
    """
    if kind not in BUILDERS:
        raise InvalidInput("kind", f"one of {', '.join(BUILDERS)} is needed, not {kind!r}")
    builder, title = BUILDERS[kind]
    provenance = sources.provenance
    return CurveData(
        kind=kind,
        title=title,
        time=sources.time if kind == "tracking" else sources.analysis.trajectory.t,
        panels=builder(sources),
        columns=2,
        failures=words.failures(sources, simulated=kind == "tracking"),
        caption=words.caption(kind, sources, provenance, notes),
        summary=words.summary(title, sources, provenance),
        version=provenance.version,
    )


def _actuator_panels(symbols: Sequence[str], units: Sequence[str]) -> list[Panel]:
    return [
        Panel(name, symbol, unit, color, ())
        for name, symbol, unit, color in zip(
            ACTUATORS, symbols, units, ACTUATOR_COLORS, strict=True
        )
    ]


def _coordinate_panels() -> list[Panel]:
    return [
        Panel(name, name, unit, INK, ())
        for name, unit in zip(COORDINATES, COORDINATE_UNITS, strict=True)
    ]


def _besides(sources: Sources, values: Callable, j: int) -> list[Trace]:
    """Return the traces of reference and printed formulae for actuator ``j``."""
    found = []
    if sources.reference is not None:
        found.append(Trace("reference", values(sources.reference)[:, j], REFERENCE, "dashed"))
    if sources.printed is not None:
        curve = values(sources.printed)[:, j]
        found.append(Trace("formulae as printed", curve, PRINTED_COLOR, "dotted"))
    return found


def _summaries(sources: Sources, j: int) -> list:
    """Return summary, first words and color of each analysis that has one, for actuator ``j``."""
    of = [(sources.analysis, "", ACTUATOR_COLORS[j])]
    if sources.reference is not None:
        of.append((sources.reference, "reference: ", REFERENCE))
    if sources.printed is not None:
        of.append((sources.printed, "as printed: ", PRINTED_COLOR))
    return [(a.summary[j], said, color) for a, said, color in of if a.summary]


def _difference(values: Values, t: Values, name: str, symbol: str, unit: str, color: str) -> Panel:
    """Return a panel of a difference, with its largest value marked and in words."""
    panel = Panel(name, symbol, unit, color, (Trace("difference", values, color, width=0.9),))
    known = np.flatnonzero(np.isfinite(values))
    if known.size == 0:
        return panel
    top = known[np.abs(values[known]).argmax()]
    at = format_value(float(t[top]), "s", 3)
    said = f"largest {format_value(float(values[top]), unit, 3)} at {at}"
    return replace(
        panel, peaks=(Peak(float(t[top]), float(values[top]), color),),
        readings=(Reading(said, MUTED),),
    )  # fmt: skip
