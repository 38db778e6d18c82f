"""What a motion does where it crosses singularities, as text."""

from __future__ import annotations

import math

from markupsafe import Markup

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.trajectory import CrossingDrift, TimeOptimalPlan, payload_drift, unplanned_torque
from paminsa_viz.units import number

PAYLOAD_ERROR = 0.1
"""Payload that the model does not know of, whose drift is shown [kg]."""


def chart_html(frame: Frame) -> str:
    """Return the chart of the motion over its path; empty if it crosses nothing."""
    found = motions.planned(frame.state).crossing
    if found is None or not found.crossings:
        return ""
    return _chart(frame.state.document.design, found)


@kept(4)
def _chart(design: Design, found: TimeOptimalPlan) -> str:
    from paminsa_viz.plots.crossing_figure import crossing_svg  # matplotlib is slow to load

    svg = crossing_svg(design, found).decode()
    return render("motion/crossing_chart.j2", svg=Markup(svg[svg.index("<svg") :]))


def crossing_html(frame: Frame) -> str:
    """Return the crossings of the motion; empty if none is planned."""
    document = frame.state.document
    planned = motions.planned(frame.state)
    if planned.crossing is None:
        return ""
    lines = list(crossing_lines(document.design, planned.crossing))
    if planned.deviation:
        text = number(1e3 * planned.deviation, 3)
        lines.insert(0, f"path changed by up to {text} mm along the escape twist")
    count = len(planned.crossing.crossings)
    title = f"Passes {count} singularit{'y' if count == 1 else 'ies'}"
    level = "warn" if count else "plain"
    return render("status.j2", testid="motion-crossing", level=level, title=title, lines=lines)


@kept(4)
def crossing_lines(design: Design, found: TimeOptimalPlan) -> tuple[str, ...]:
    """Return what each crossing of a plan needs, and what cannot be certified there."""
    low, high = (number(value, 3) for value in found.durations)
    lines = [f"possible within the limits: {low} s to {high} s"]
    for item, drift in zip(
        found.crossings, payload_drift(design, found, PAYLOAD_ERROR), strict=True
    ):
        torques = ", ".join(number(torque, 3) for torque in item.torque[:3])
        speeds = [number(value, 3) for value in (item.speed, *item.speed_range)]
        naive = number(unplanned_torque(item, found.plan.duration), 3)
        lines += [
            f"{item.crossing.locus.label} at {number(item.t, 4)} s (s = {item.crossing.s:.4f}): "
            f"in the limit M1–M3 {torques} N·m, M4 {number(item.torque[3], 3)} N",
            f"generalized force along the escape twist {number(item.residual, 1)} N·m; "
            f"without the condition: {naive} N·m at 1 kHz",
            f"ṡ = {speeds[0]} /s, of {speeds[1]} to {speeds[2]} /s within the limits",
            drift_text(drift),
        ]
    return tuple(lines)


def drift_text(drift: CrossingDrift) -> str:
    """Return what the actuators have no authority over."""
    moved, turned = math.hypot(*drift.shift[:2]), math.degrees(abs(drift.shift[2]))
    far = f"{number(1e6 * moved, 2)} µm" if moved > 1e-8 else "less than 0.01 µm"
    wide = f"{number(3600 * turned, 2)}″" if turned > 1e-5 else "less than 0.036″"
    return (
        f"no authority along the escape twist, inertia there {number(drift.inertia, 3)} kg·m²: "
        f"{number(PAYLOAD_ERROR)} kg more payload lets it drift by {far} and {wide} "
        f"in {number(1e3 * drift.time, 2)} ms"
    )
