"""What ``paminsa-viz trajectory`` prints: a table for people, the same as data for programs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from paminsa_viz import __version__
from paminsa_viz.cli.output import print_table, print_written
from paminsa_viz.errors import PaminsaError
from paminsa_viz.trajectory import MinimumTime, PathEvent, Simulation, TrajectoryAnalysis
from paminsa_viz.trajectory.limits import ACTUATOR_NAMES
from paminsa_viz.units import format_ascii

TORQUE_UNITS = ("N m", "N m", "N m", "N")
SPEED_UNITS = ("rad/s", "rad/s", "rad/s", "m/s")

LOADS = (
    ("peak", "peak", "peak", TORQUE_UNITS),
    ("peak_t", "peak_t_s", "  at", ("s",) * 4),
    ("rms", "rms", "RMS", TORQUE_UNITS),
    ("top_speed", "top_speed", "largest speed", SPEED_UNITS),
    ("top_power", "top_power_W", "peak power", ("W",) * 4),
    ("top_power_t", "top_power_t_s", "  at", ("s",) * 4),
    ("driven", "driven_J", "energy, driving", ("J",) * 4),
    ("braked", "braked_J", "energy, braking", ("J",) * 4),
)
"""Loads of an actuator: field of `ActuatorSummary`, JSON key, text, units of the actuators."""

COMPARED = ("peak", "rms", "top_power")
"""Loads that are repeated for a reference and for the formulas as published."""


@dataclass(frozen=True, eq=False)
class Results:
    """What the command worked out.

    Attributes:
        analysis: The design on the motion.
        quickest: What the duration follows from, if it is the shortest one.
        reference: Another design on the same motion.
        printed: The design by the formulas as published.
        simulation: The robot driven along the motion.
        problems: Why the motion, or its simulation, fails.
    """

    analysis: TrajectoryAnalysis
    quickest: MinimumTime | None = None
    reference: TrajectoryAnalysis | None = None
    printed: TrajectoryAnalysis | None = None
    simulation: Simulation | None = None
    problems: tuple[PaminsaError, ...] = ()


class SimulationStopped(PaminsaError):
    """A simulated robot that came to a limit.

    Attributes:
        event: The limit, and when.
    """

    def __init__(self, event: PathEvent) -> None:
        self.event = event
        super().__init__(f"the simulation stopped {event.explanation}")


def report(results: Results, written: Sequence[Path]) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    analysis, check = results.analysis, results.analysis.check
    t = analysis.trajectory
    quickest = results.quickest
    return {
        "made_by": f"paminsa_viz {__version__}",
        "design": analysis.design.name,
        "assembly": analysis.solved.geometry.knee.value,
        "trajectory": {
            "name": t.name,
            "kind": t.kind,
            "duration_s": t.duration,
            "samples": t.size,
            "notes": list(t.notes),
        },
        "ok": not results.problems,
        "problems": [str(problem) for problem in results.problems],
        "failure": _failure(check.first),
        "closest": _event(check.closest),
        "shortest": quickest
        and {
            "quantity": quickest.quantity,
            "limit": quickest.limit,
            "unit": quickest.unit,
            "t_s": quickest.t,
        },
        "actuators": _actuators(analysis),
        "reference": results.reference and _other(results.reference),
        "printed": results.printed and _other(results.printed),
        "simulation": results.simulation and _simulation(results.simulation),
        "files": [os.fspath(path) for path in written],
    }


def print_report(results: Results, written: Sequence[Path]) -> None:
    """Print the same for people, lengths in mm and angles in degrees."""
    analysis, check = results.analysis, results.analysis.check
    t = analysis.trajectory
    kind = f" ({t.kind})" if t.kind else ""
    print(f"{t.name}{kind}: {t.duration:.4g} s, {t.size} samples")
    print(f'design "{analysis.design.name}", {analysis.solved.geometry.knee.label}')
    for note in t.notes:
        print(note)
    if results.quickest is not None:
        print(f"shortest duration, {results.quickest.explanation}")
    print()
    if analysis.summary:
        rows = [("", *ACTUATOR_NAMES), *_rows(analysis)]
        for title, other in (("reference", results.reference), ("as published", results.printed)):
            if other is not None and other.summary:
                rows += _rows(other, COMPARED, f"{title}: ")
        print_table(rows, words=1)
        print()
    if check.first is not None:
        print(f"fails {check.first.explanation}")
        if analysis.summary:
            print("the numbers are of the time before")
    else:
        near = check.closest
        leg = f" of leg {near.leg + 1}" if near.leg >= 0 else ""
        where = f"{format_ascii(near.margin, 'm', 3)} from {near.limit.word}{leg} at {near.t:.4g} s"
        print(f"can be run; closest to a limit: {where}")
    if results.reference is not None:
        first = results.reference.check.first
        verdict = "can run it too" if first is None else f"fails {first.explanation}"
        print(f'reference "{results.reference.design.name}": {verdict}')
    if results.simulation is not None:
        _print_simulation(results.simulation)
    print_written(written)


def _rows(
    analysis: TrajectoryAnalysis, kept: Sequence[str] = (), prefix: str = ""
) -> list[tuple[str, ...]]:
    """Return rows of loads, all of them or those that are kept."""
    return [
        (
            prefix + text,
            *(
                format_ascii(getattr(summary, load), unit, 3)
                for summary, unit in zip(analysis.summary, units, strict=True)
            ),
        )
        for load, _, text, units in LOADS
        if not kept or load in kept
    ]


def _event(event: PathEvent) -> dict[str, Any]:
    return {
        "t_s": event.t,
        "limit": event.limit.word,
        "leg": event.leg + 1 if event.leg >= 0 else None,
        "margin_m": event.margin,
        "pose": list(event.pose),
    }


def _failure(event: PathEvent | None) -> dict[str, Any] | None:
    return None if event is None else {**_event(event), "explanation": event.explanation}


def _actuators(analysis: TrajectoryAnalysis) -> list[dict[str, Any]]:
    names = zip(ACTUATOR_NAMES, TORQUE_UNITS, SPEED_UNITS, strict=True)
    return [
        {"name": name, "unit": unit, "speed_unit": speed_unit}
        | {key: getattr(summary, load) for load, key, *_ in LOADS}
        for (name, unit, speed_unit), summary in zip(names, analysis.summary, strict=False)
    ]


def _other(analysis: TrajectoryAnalysis) -> dict[str, Any]:
    return {
        "design": analysis.design.name,
        "failure": _failure(analysis.check.first),
        "actuators": _actuators(analysis),
    }


def _simulation(simulation: Simulation) -> dict[str, Any]:
    return {
        "controller": simulation.controller.control.value,
        "bandwidth_Hz": simulation.controller.bandwidth,
        "payload_kg": simulation.design.payload.mass,
        "end_t_s": float(simulation.t[-1]),
        "stopped": _failure(simulation.stopped),
        "largest_distance_m": float(simulation.distance.max()),
        "end_distance_m": float(simulation.distance[-1]),
        "largest_error": np.abs(simulation.error).max(axis=0).tolist(),
        "energy_drift_J": float(np.abs(simulation.energy_drift).max()),
    }


def _print_simulation(simulation: Simulation) -> None:
    x, y, theta, z = (
        format_ascii(float(value), unit, 3)
        for value, unit in zip(
            np.abs(simulation.error).max(axis=0), ("m", "m", "rad", "m"), strict=True
        )
    )
    print(
        f"simulated with {simulation.controller.control.value}, payload "
        f"{simulation.design.payload.mass:.4g} kg: largest errors x {x}, "
        f"y {y}, theta {theta}, z {z}; at the end "
        f"{format_ascii(simulation.distance[-1], 'm', 3)} from its place"
    )
    if simulation.stopped is not None:
        print(f"it stopped {simulation.stopped.explanation}")
    drift = float(np.abs(simulation.energy_drift).max())
    print(f"energy drift of the solution: {format_ascii(drift, 'J', 3)}")
