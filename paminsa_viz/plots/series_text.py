"""Captions of figures over time: design, motion, and when and why it fails."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.caption import equals, robot, shown
from paminsa_viz.plots.series import SeriesData, SeriesSources
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.simulation import ControlMode
from paminsa_viz.units import counted, format_value, number
from paminsa_viz.version import MADE_BY

NAMED_FAILURES = 4
"""Failures that a caption names one by one."""


@dataclass(frozen=True)
class Failure:
    """A time during which the motion fails; an instant if start and end are the same [s]."""

    start: float
    end: float
    reason: str

    def __str__(self) -> str:
        times = dict.fromkeys([number(self.start), number(self.end)])
        return f"{'at ' if len(times) == 1 else ''}{' to '.join(times)} s {self.reason}"


def failures(data: SeriesData) -> tuple[Failure, ...]:
    """Return when and why the motion fails, or the simulated robot stopped."""
    if data.kind != "tracking":
        return _failures_of(data.sources.analysis)
    stopped = data.sources.simulated.stopped
    if stopped is None:
        return ()
    end = float(data.sources.analysis.trajectory.t[-1])
    return (Failure(stopped.t, end, _reason(stopped.limit, stopped.leg)),)


def _failures_of(analysis: TrajectoryAnalysis) -> tuple[Failure, ...]:
    check, t = analysis.check, analysis.trajectory.t
    first = check.first
    if first is None:
        return tuple(Failure(one.t, one.t, "torques have no bound") for one in analysis.unbounded)
    bad = check.status != Limit.OK
    change = (np.diff(check.status) != 0) | (np.diff(check.leg) != 0)
    edges = [0, *(np.flatnonzero(change) + 1).tolist(), t.size]
    found = [
        Failure(
            float(t[start]), float(t[min(end, t.size - 1)]),
            _reason(Limit(int(check.status[start])), int(check.leg[start])),
        )
        for start, end in pairwise(edges)
        if bad[start]
    ]  # fmt: skip
    if found and found[0].end >= first.t and check.until == int(np.argmax(bad)):
        # The limit itself lies between two samples; the one after it is already beyond.
        found[0] = Failure(first.t, found[0].end, found[0].reason)
    else:
        found.insert(0, Failure(first.t, first.t, _reason(first.limit, first.leg)))
    return tuple(found)


def _reason(limit: Limit, leg: int) -> str:
    # A motion already fails at a clearance from singular poses.
    return "too close to a singular pose" if limit is Limit.SINGULAR else limit.reason(leg)


def caption(data: SeriesData, notes: Sequence[str] = ()) -> str:
    """Return the paragraph below a figure.

    Args:
        data: The series.
        notes: Further sentences.
    """
    sources, t = data.sources, data.sources.analysis.trajectory
    made = f" ({t.kind})" if t.kind else ""
    sentences = [
        f"{robot(sources.analysis.design)}; motion {shown(t.name)}{made}, "
        f"{equals('T', t.duration, 's')}, {counted(t.size, 'sample')}.",
        *_about(data),
    ]
    misprints = sources.analysis.solved.misprints
    if misprints and data.kind not in ("pose", "tracking"):
        sentences.append(f"Formulas as published: {_misprints_text(misprints)}.")
    sentences += _failure_sentences(data)
    sentences += [note if note.endswith(".") else f"{note}." for note in (*t.notes, *notes)]
    return " ".join([*sentences, f"{MADE_BY}."])


def summary(data: SeriesData) -> str:
    """Return one line about a figure for a file's metadata."""
    analysis = data.sources.analysis
    design, t = analysis.design, analysis.trajectory
    return (
        f"{data.title} of PAMINSA, design {shown(design.name)}, {design.geometry.knee.label}, "
        f"motion {shown(t.name)}, {t.duration:.6g} s"
    )


def _about(data: SeriesData) -> list[str]:
    """Return the sentences about a kind of figure."""
    sources = data.sources
    compared = _compared_sentences(sources)
    if data.kind == "torques":
        # of a motion that fails at once there is none
        drawn = any(trace.band is not None for panel in data.panels for trace in panel.traces)
        band = ["The band is the RMS over time, to both sides of zero."] if drawn else []
        return [*band, *compared]
    if data.kind == "power":
        return ["Positive where an actuator drives.", *compared]
    if data.kind == "energy":
        step = 1e3 * float(np.diff(sources.analysis.trajectory.t).max())
        balance = f"The balance would be zero but for the integration in steps of {step:.3g} ms."
        if sources.analysis.solved.misprints:
            balance = "Formulas as published do not balance."
        return [balance, *compared]
    if data.kind == "breakdown":
        return ["The parts add up to the total."]
    if data.kind == "loads":
        return ["Forces and stress are those in the legs’ planes; at joint 5 in space."]
    if data.kind == "comparison":
        return [f"Difference: this analysis minus {sources.other.name}.", *compared]
    return _tracking_sentences(sources) if data.kind == "tracking" else []


def _compared_sentences(sources: SeriesSources) -> list[str]:
    sentences = []
    if sources.reference is not None:
        sentences.append(f"Reference: design {shown(sources.reference.design.name)}.")
        failure = sources.reference.failure
        if failure is not None and sources.analysis.failure is None:
            sentences.append(f"The reference fails {failure.explanation}.")
    if sources.published is not None:
        misprints = sources.published.solved.misprints
        sentences.append(f"As published: {_misprints_text(misprints)}.")
    return sentences


def _tracking_sentences(sources: SeriesSources) -> list[str]:
    simulation = sources.simulated
    controller = simulation.controller
    by_rate = controller.control is not ControlMode.FEED_FORWARD and controller.proportional is None
    gains = f", {controller.bandwidth:g} Hz, damping {controller.damping:g}" if by_rate else ""
    farthest = float(np.max(simulation.distance))
    drift = float(np.max(np.abs(simulation.energy_drift)))
    sentences = [
        f"Controller: {controller.control.value}{gains}.",
        f"The platform is at most {format_value(farthest, 'm', 3)} from its place; the solution’s "
        f"energy drifts by {format_value(drift, 'J', 2)}.",
    ]
    if simulation.design != sources.analysis.design:
        sentences.insert(0, f"The simulated robot: {robot(simulation.design)}.")
    return sentences


def _failure_sentences(data: SeriesData) -> list[str]:
    found = failures(data)
    if not found:
        return []
    if data.kind == "tracking":
        return [f"The simulation stopped at {number(found[0].start)} s: {found[0].reason}."]
    named = [str(each) for each in found[:NAMED_FAILURES]]
    if len(found) > NAMED_FAILURES:
        named.append(f"and {len(found) - NAMED_FAILURES} more")
    sentences = [f"The motion fails, shaded: {'; '.join(named)}."]
    cut = not data.sources.analysis.check.possible
    if cut and data.kind in ("torques", "power", "energy"):
        sentences.append("Numbers are for the time before.")
    return sentences


def _misprints_text(misprints: Misprint) -> str:
    if misprints == Misprint.ALL:
        return "all five misprints"
    names = [m.name.lower() for m in Misprint if m in misprints and m.name]
    places = {"eq": "Eq. ", "app": "App. "}
    return ", ".join(
        re.sub(r"(eq|app)(\d+)_", lambda m: f"{places[m[1]]}{m[2]} ", name).replace("_", " ")
        for name in names
    )
