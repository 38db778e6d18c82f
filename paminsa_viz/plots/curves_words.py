"""What figures over time say in words: readings, failures, captions."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.caption import equals, robot, shown
from paminsa_viz.plots.curves_data import Interval
from paminsa_viz.plots.curves_sources import Sources
from paminsa_viz.plots.map_data import Provenance, provenance
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.control import Control
from paminsa_viz.units import NONE, format_value, number

NAMED_FAILURES = 4
"""Failures that a caption names one by one."""


def size(values: NDArray[np.float64], unit: str) -> str:
    """Return the largest size among values (n,), with its unit; a dash if there is none."""
    known = np.abs(values[np.isfinite(values)])
    return format_value(float(known.max()), unit, 3) if known.size else NONE


def failures(sources: Sources, simulated: bool) -> tuple[Interval, ...]:
    """Return when and why the motion fails, or the simulated robot stopped."""
    if simulated:
        simulation = sources.simulation
        if simulation is None or simulation.stopped is None:
            return ()
        end = float(sources.analysis.trajectory.t[-1])
        stopped = simulation.stopped
        return (Interval(stopped.t, end, _reason(stopped.limit, stopped.leg)),)
    return _failed(sources.analysis)


def _failed(analysis: TrajectoryAnalysis) -> tuple[Interval, ...]:
    check, t = analysis.check, analysis.trajectory.t
    if check.first is None:
        return ()
    bad = check.status != Limit.OK
    change = (np.diff(check.status) != 0) | (np.diff(check.leg) != 0)
    starts = np.concatenate([[0], np.flatnonzero(change) + 1])
    ends = np.concatenate([starts[1:], [t.size]])
    found = [
        Interval(
            float(t[a]), float(t[min(b, t.size - 1)]),
            _reason(Limit(int(check.status[a])), int(check.leg[a])),
        )
        for a, b in zip(starts.tolist(), ends.tolist(), strict=True)
        if bad[a]
    ]  # fmt: skip
    first = check.first
    if found and found[0].end >= first.t and check.until == int(np.argmax(bad)):
        # The limit itself lies between two samples; the one after it is already beyond.
        found[0] = Interval(first.t, found[0].end, found[0].reason)
    else:
        found.insert(0, Interval(first.t, first.t, _reason(first.limit, first.leg)))
    return tuple(found)


def _reason(limit: Limit, leg: int) -> str:
    # A motion already fails at a clearance from what is singular.
    return "too close to a singular pose" if limit is Limit.SINGULAR else limit.reason(leg)


def span(interval: Interval) -> str:
    """Return a time interval in words."""
    if interval.end == interval.start:
        return f"at {number(interval.start, 4)} s"
    return f"{number(interval.start, 4)} to {number(interval.end, 4)} s"


def caption(
    kind: str, sources: Sources, source: Provenance, notes: Sequence[str] = ()
) -> tuple[str, ...]:
    """Return the sentences below a figure."""
    analysis = sources.analysis
    t = analysis.trajectory
    made = f" ({t.kind})" if t.kind else ""
    said = [
        f"{robot(source)}; motion {shown(t.name)}{made}, {equals('T', t.duration, 's')}, "
        f"{t.size} samples.",
        *_CAPTIONS[kind](sources),
    ]
    printed = analysis.solved.misprints
    if printed and kind not in ("pose", "tracking"):
        said.append(f"Formulae as printed: {_misprints(printed)}.")
    said += _failure_sentences(failures(sources, kind == "tracking"), kind)
    said += [note if note.endswith(".") else f"{note}." for note in (*t.notes, *notes)]
    said.append(f"paminsa_viz {source.version}.")
    return tuple(said)


def summary(title: str, sources: Sources, source: Provenance) -> str:
    """Return one line about a figure for a file's metadata."""
    t = sources.analysis.trajectory
    return (
        f"{title} of PAMINSA, design {shown(source.design)}, {source.knee.label}, "
        f"motion {shown(t.name)}, {t.duration:.6g} s"
    )


def _misprints(printed: Misprint) -> str:
    if printed == Misprint.ALL:
        return "all five misprints"
    names = [m.name.lower() for m in Misprint if m in printed and m.name]
    places = {"eq": "Eq. ", "app": "App. "}
    return ", ".join(
        re.sub(r"(eq|app)(\d+)_", lambda m: f"{places[m[1]]}{m[2]} ", name).replace("_", " ")
        for name in names
    )


def _failure_sentences(found: Sequence[Interval], kind: str) -> list[str]:
    if not found:
        return []
    if kind == "tracking":
        return [f"The simulation stopped at {number(found[0].start, 4)} s: {found[0].reason}."]
    named = [f"{span(each)} {each.reason}" for each in found[:NAMED_FAILURES]]
    if len(found) > NAMED_FAILURES:
        named.append(f"and {len(found) - NAMED_FAILURES} more")
    said = [f"The motion fails, shaded: {'; '.join(named)}."]
    if kind in ("torques", "power", "energy"):
        said.append("Numbers are of the time before.")
    return said


def _besides(sources: Sources) -> list[str]:
    said = []
    if sources.reference is not None:
        said.append(f"Reference: design {shown(sources.reference.design.name)}.")
        if sources.reference.check.first is not None and sources.analysis.check.ok:
            said.append(f"The reference fails {sources.reference.check.first.explanation}.")
    if sources.printed is not None:
        said.append(f"As printed: {_misprints(sources.printed.solved.misprints)}.")
    return said


def _torques(sources: Sources) -> list[str]:
    return ["The RMS over time is drawn on the side of the peak.", *_besides(sources)]


def _power(sources: Sources) -> list[str]:
    return ["Positive where an actuator drives.", *_besides(sources)]


def _energy(sources: Sources) -> list[str]:
    analysis = sources.analysis
    step = 1e3 * float(np.diff(analysis.trajectory.t).max())
    balance = f"The balance would be zero but for the integration in steps of {step:.3g} ms."
    if analysis.solved.misprints:
        balance = "Formulae as printed do not balance."
    return [balance, *_besides(sources)]


def _breakdown(sources: Sources) -> list[str]:
    del sources
    return ["The parts add up to the whole."]


def _pose(sources: Sources) -> list[str]:
    del sources
    return []


def _tracking(sources: Sources) -> list[str]:
    simulation = sources.simulation
    if simulation is None:
        return []
    c = simulation.controller
    by_rate = c.control is not Control.FEED_FORWARD and c.proportional is None
    gains = f", {c.bandwidth:g} Hz, damping {c.damping:g}" if by_rate else ""
    furthest = float(np.max(simulation.distance)) if simulation.distance.size else math.nan
    drift = float(np.max(np.abs(simulation.energy_drift)))
    said = [
        f"Controller: {c.control.value}{gains}.",
        f"The platform is at most {format_value(furthest, 'm', 3)} from its place; the solution's "
        f"energy drifts by {format_value(drift, 'J', 2)}.",
    ]
    if simulation.design != sources.analysis.design:
        other = provenance(simulation.design)
        said.insert(0, f"The robot that is simulated: {robot(other)}.")
    return said


def _comparison(sources: Sources) -> list[str]:
    name, _ = sources.other
    return [f"Difference: this analysis minus {name}.", *_besides(sources)]


_CAPTIONS = {
    "torques": _torques,
    "breakdown": _breakdown,
    "pose": _pose,
    "power": _power,
    "energy": _energy,
    "tracking": _tracking,
    "comparison": _comparison,
}
