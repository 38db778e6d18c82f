"""What the page says of a motion: status, poses, simulation, and the texts around its curves."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion import planning
from paminsa_viz.explorer.motion.description import Kind
from paminsa_viz.explorer.motion.playback import COMPARED
from paminsa_viz.explorer.motion.results import MotionResults
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.scene.path import hue_gradient, path_scale
from paminsa_viz.explorer.state import Pose, State
from paminsa_viz.plots.series import Statistics, Trace
from paminsa_viz.plots.series_uplot import Chart, trace_order
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, number

_ROUNDING = 1e-12
"""Values up to this are rounding errors [N m, N, ...]."""


def status_line(state: State, analysis: TrajectoryAnalysis | None) -> tuple[bool, str]:
    """Return whether a motion can be run, and the line that says so or says why not."""
    found = motions.planned(state)
    if analysis is None or found.trajectory is None or found.problem:
        return False, found.problem
    check = analysis.check
    if check.first is not None:
        return False, f"fails {check.first.explanation}"
    near = check.closest
    leg = f" of leg {near.leg + 1}" if near.leg >= 0 else ""
    return True, (
        f"{number(found.trajectory.duration, 4)} s, {found.trajectory.size} samples; nearest "
        f"limit: {near.limit.noun}{leg}, {1e3 * near.margin:.0f} mm away at {number(near.t, 3)} s"
    )


def status_html(state: State, analysis: TrajectoryAnalysis | None) -> str:
    """Return whether the motion can be run."""
    reachable, line = status_line(state, analysis)
    found = motions.planned(state)
    level, title = ("ok", "Reachable") if reachable else ("bad", "Not possible")
    if found.trajectory is None:
        level, title = "plain", "No motion yet"
    lines = [line, f"shortest: {found.bound}"] if found.bound else [line]
    return render("status.j2", testid="motion-status", level=level, title=title, lines=lines)


def pose_text(pose: Pose) -> str:
    """Return a pose in millimeters and degrees."""
    x, y, theta, z = pose
    mm = [number(round(1e3 * value, 1), 6) for value in (x, y, z)]
    return f"x {mm[0]}, y {mm[1]}, z {mm[2]} mm, θ {number(round(math.degrees(theta), 1))}°"


def poses_html(state: State) -> str:
    """Return the poses of a motion that is built, or what is known of a file's."""
    motion, geometry = state.document.motion, state.document.design.geometry
    lines: list[tuple[str, str]] = []
    if motion.kind.has_ends:
        start, goal = planning.ends(motion, geometry)
        if motion.kind is Kind.LINE:
            goal = (goal[0], goal[1], start[2], goal[3])
        lines = [("from", f" {pose_text(start)}"), ("to", f" {pose_text(goal)}")]
    elif motion.kind is Kind.CIRCLE:
        lines = [("center", f" {pose_text(planning.center(motion, geometry))}")]
    elif motion.kind is Kind.WAYPOINTS:
        lines = [(f"{i}", f" {pose_text(pose)}") for i, pose in enumerate(motion.waypoints, 1)]
        lines = lines or [("", "none yet: move the robot, then add its pose")]
    elif motion.kind is Kind.TABLE and motion.table is not None:
        lines = [(motion.table.name, f", {motion.table.size} rows")]
        lines += [("", note) for note in motion.table.notes]
        lines.append(("", "A file's motion is not kept over a reload, nor in a share code."))
    return render("motion_poses.j2", lines=lines)


def path_legend_html(actuator: int, analysis: TrajectoryAnalysis | None) -> str:
    """Return the color bar of the path; empty without a motion."""
    if analysis is None:
        return ""
    scale = path_scale(analysis, actuator)
    name = ("|τ₁| [N·m]", "|τ₂| [N·m]", "|τ₃| [N·m]", "|F₄| [N]")[actuator]
    return render(
        "motion_path.j2", hues=hue_gradient(scale), name=name,
        low=number(scale.low, 3), high=number(scale.high, 3),
    )  # fmt: skip


def simulation_html(state: State) -> str:
    """Return what came of the last simulation."""
    simulating = state.simulating
    level, title, lines = "plain", "Simulating …", []
    outcome = simulating.outcome
    if simulating.running is None and outcome is None:
        text = "Errors and torques are plotted in “Motion plots”."
        return render("note.j2", testid="simulation", muted=True, text=text)
    if simulating.running is None and outcome is not None:
        level, title, lines = "bad", "Not simulated", [outcome.problem]
        simulation = outcome.simulation
        if simulation is not None:
            drift = float(np.abs(simulation.energy_drift).max())
            lines = [
                f"largest distance {number(1e3 * float(simulation.distance.max()), 3)} mm, "
                f"at the end {number(1e3 * float(simulation.distance[-1]), 3)} mm",
                f"energy drift of the solution {number(drift, 2)} J",
            ]
            level, title = "ok", f"Ran to the end, {simulation.t[-1]:.3f} s"
            if simulation.stopped is not None:
                level, title = "bad", f"Stopped {simulation.stopped.explanation}"
            if not motions.simulation_is_current(state):
                level = "warn" if simulation.stopped is None else level
                lines.append("of an earlier design, motion or setting: simulate again")
    return render("status.j2", testid="simulation", level=level, title=title, lines=lines)


def caption_html(state: State, found: MotionResults | None, drawn: tuple[Chart, ...]) -> str:
    """Return the line below the charts: which motion, what strokes mean, and whether it fails."""
    if found is None:
        return render("motion_empty.j2", text=status_line(state, None)[1])
    if not drawn:
        text = "nothing has been simulated yet: press Simulate in the tab “Motion”"
        return render("motion_empty.j2", text=text)
    sources, first = found.sources, found.analysis.check.first
    compared = state.plots.plot in COMPARED
    return render(
        "motion_caption.j2",
        trajectory=found.analysis.trajectory,
        reference=sources.reference.design.name if compared and sources.reference else "",
        published=compared and sources.published is not None,
        failure="" if first is None else first.explanation,
        engine=_engine(state, found) if state.plots.needs_engine else None,
    )


def _engine(state: State, found: MotionResults) -> dict[str, object]:
    """Return what the caption says of an engine's torques."""
    context: dict[str, object] = {
        "marked": state.plots.plot == "torques", "answer": found.answer, "own": None
    }  # fmt: skip
    check = found.answer.found if found.answer else None
    if check is not None:
        published = found.sources.published
        context |= {
            "name": check.engine.name,
            "tolerance": check.tolerance,
            "own": check.comparison(found.analysis),
            "published": None if published is None else check.comparison(published),
        }
    return context


def numbers_html(drawn: tuple[Chart, ...], read: dict[Trace, Statistics], time: float) -> str:
    """Return the table of the curves: the value at the cursor, the largest one, the RMS.

    Args:
        drawn: The charts.
        read: Peak and RMS of every curve.
        time: Of the cursor [s].
    """
    rows = []
    for chart, trace in _rows(drawn):
        peak, peak_t, mean = read[trace]
        at = f"{peak_t:.3f} s" if math.isfinite(peak_t) else NONE
        values = (_value(chart.value_at(trace, time)), _value(peak), at, _value(mean))
        rows.append((trace, (*values, chart.unit), None))
    heads = (f"at {time:.3f} s", "largest", "at", "RMS", "")
    return render("motion_numbers.j2", heads=heads, rows=rows)


def difference_html(drawn: tuple[Chart, ...], found: MotionResults, time: float) -> str:
    """Return the table of differences to an engine, over the largest torque, with a verdict."""
    check = found.answer.found if found.answer else None
    shares: dict[str, list[float]] = {}
    if check is not None:
        for suffix, analysis in (("", found.analysis), ("as published", found.sources.published)):
            if analysis is not None:
                shares[suffix] = check.comparison(analysis).relative.tolist()
    rows = []
    for chart, trace in _rows(drawn):
        if check is None:
            rows.append((trace, (NONE, NONE, NONE, "", NONE, ""), None))
            continue
        values = trace.values[np.isfinite(trace.values)]
        share = shares[trace.suffix or ""].pop(0)
        cells = (
            _value(chart.value_at(trace, time)),
            _value(float(np.abs(values).max())),
            _value(float(np.sqrt((values**2).mean()))),
            chart.unit,
            number(share, 2),
        )
        rows.append((trace, cells, share <= check.tolerance))
    heads = (f"at {time:.3f} s", "largest", "RMS", "", "relative", "")
    return render("motion_numbers.j2", heads=heads, rows=rows)


def _rows(drawn: tuple[Chart, ...]) -> list[tuple[Chart, Trace]]:
    """Return the curves in the order of their rows: the design's of all charts before others."""
    rows = [(chart, trace) for chart in drawn for trace in chart.traces if not trace.marks]
    return sorted(rows, key=lambda row: trace_order(row[1]))


def _value(value: float) -> str:
    """Return a value of a curve; a rounding error as 0."""
    if not math.isfinite(value):
        return NONE
    return number(value if abs(value) > _ROUNDING else 0.0, 4)
