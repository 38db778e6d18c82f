"""The motion: what it is, the required actuator torques, and figures over time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import (
    Block,
    Fact,
    Figure,
    Note,
    Row,
    Table,
    actuator_rows,
    rows,
    series_figure,
)
from paminsa_viz.files.published_table import PublishedTorques
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory import (
    CrossingDrift,
    PathCheck,
    PathEvent,
    ShortestMotion,
    ShortestStretch,
    Simulation,
    TimeOptimalPlan,
    Trajectory,
    TrajectoryAnalysis,
    escape_inertia,
    payload_drift,
    unplanned_torque,
)
from paminsa_viz.units import NONE, counted, format_value, number, rounded_to_side

if TYPE_CHECKING:
    from paminsa_viz.plots.series import FigureKind

LOADS = (
    ("peak", "peak", "Peak", TORQUE_UNITS),
    ("peak_t", "peak_t_s", "At", ("s",) * 4),
    ("rms", "rms", "RMS", TORQUE_UNITS),
    ("top_speed", "top_speed", "Top speed", SPEED_UNITS),
    ("top_power", "top_power_W", "Peak power", ("W",) * 4),
    ("top_power_t", "top_power_t_s", "At", ("s",) * 4),
    ("driven", "driven_J", "Energy driving", ("J",) * 4),
    ("braked", "braked_J", "Braking", ("J",) * 4),
)
"""Loads of an actuator: field of `ActuatorSummary`, JSON key, heading, units of the actuators."""

REPORTED: tuple[FigureKind, ...] = ("pose", "torques", "breakdown", "power")
"""Kinds of figures that the report has of a motion."""


def motion_figures(
    analysis: TrajectoryAnalysis, reference: TrajectoryAnalysis | None = None
) -> list[Figure]:
    """Return the figures over time of a motion that the robot can begin, and of a reference."""
    from paminsa_viz.plots.series import TITLES  # late: contours of maps

    return [
        series_figure(
            kind, analysis, f"{TITLES[kind]} over time, four panels.",
            reference=reference, caption=kind == "torques",
        )
        for kind in (REPORTED if analysis.summary else ())
    ]  # fmt: skip


def trajectory_blocks(
    analysis: TrajectoryAnalysis, others: Mapping[str, TrajectoryAnalysis | None] | None = None
) -> list[Block]:
    """Return a motion, whether it can be run, and its torques next to those of other analyses."""
    t, check = analysis.trajectory, analysis.check
    kind = f" ({t.kind})" if t.kind else ""
    blocks: list[Block] = [
        Note(f"“{t.name}”{kind}: {samples_text(t)}. {' '.join(t.notes)}".strip())
    ]
    if check.first is not None:
        text = f"The robot cannot run all of it: it fails {check.first.explanation}."
        if analysis.summary:
            text += " The numbers are of the time before."
        blocks.append(Note(text, "bad"))
    elif analysis.failure is None:
        blocks.append(Note(f"The robot can run it. {margin_text(check)}", "ok"))
    blocks += [
        Note(
            f"The robot cannot run it: at {item.t:.4g} s its torques have no bound. The motion "
            f"crosses the {item.locus.label} with t_sᵀ F = {format_value(item.residual, 'N m', 3)} "
            "instead of zero. Sampled values next to it depend on the rate.",
            "bad",
        )
        for item in analysis.unbounded
    ]
    if analysis.crossings:
        blocks.append(crossings_table(analysis))
    known = {name: other for name, other in (others or {}).items() if other and other.summary}
    if analysis.summary:
        found = [row for each in ({"": analysis} | known).items() for row in _loads(*each)]
        head = ("", *(heading for _, _, heading, _ in LOADS))
        blocks.append(Table(head, tuple(found), "Required actuator torques on the motion."))
    return blocks


def trajectory_facts(analysis: TrajectoryAnalysis) -> list[Fact]:
    """Return the largest torque and force of a motion, and that the robot cannot run it."""
    torque = force = NONE
    if analysis.summary:
        torque = format_value(max(abs(one.peak) for one in analysis.summary[:3]), "N m", 3)
        force = format_value(abs(analysis.summary[3].peak), "N", 4)
    facts = [
        Fact("Peak torque", torque, "M1 to M3 on the trajectory"),
        Fact("Peak force", force, "M4 on the trajectory"),
    ]
    if analysis.failure is not None:
        facts.append(Fact("Trajectory", "fails", "the robot cannot run it", "bad"))
    return facts


def samples_text(trajectory: Trajectory) -> str:
    """Return how long a motion is, and of how many samples."""
    return f"{trajectory.duration:.4g} s, {counted(trajectory.size, 'sample')}"


def margin_text(check: PathCheck) -> str:
    """Return how near a motion that the robot can run comes to a limit."""
    near = check.closest
    leg = f", leg {near.leg + 1}" if near.leg >= 0 else ""
    # At a pose the distance to turn is an angle, so these millimeters would be found nowhere.
    turn = "; a turn counts as the path of the joints 5" if near.limit is Limit.SINGULAR else ""
    return (
        f"It comes nearest to a limit ({near.limit.noun}{leg}) at {near.t:.4g} s, with "
        f"{format_value(near.margin, 'm', 3)} to spare{turn}."
    )


def _loads(name: str, analysis: TrajectoryAnalysis) -> tuple[Row, ...]:
    """Return the rows of M1 to M4 of one analysis."""
    cells = (
        (
            f"M{j + 1}{f', {name}' if name else ''}",
            *(format_value(getattr(summary, load), units[j]) for load, _, _, units in LOADS),
        )
        for j, summary in enumerate(analysis.summary)
    )
    return actuator_rows(*cells)


def crossings_table(analysis: TrajectoryAnalysis) -> Table:
    """Return the torques of a motion where it crosses singularities, and what moves it there."""
    found = []
    for item in analysis.crossings:
        limits = ["no bound"] * 4
        if item not in analysis.unbounded:
            limits = list(map(format_value, item.torque, TORQUE_UNITS))
        found.append(
            (
                item.locus.label,
                format_value(item.t, "s", 4),
                format_value(item.residual, "N m", 3),
                *limits,
                format_value(_inertia_at(analysis, item.t), "kg m^2", 3),
            )
        )
    head = ("", "At", "Generalized force along t_s", *ACTUATORS, "Inertia along t_s")
    text = (
        "Crossings of singularities and the torques in the limit. There the actuators have no "
        "authority along the escape twist t_s: what the model does not know of moves the platform "
        "along it, against its inertia only."
    )
    return Table(head, rows(*found), text)


PAYLOAD_ERROR = 0.1
"""Payload that the model does not know of, whose drift is told [kg]."""


def passages_blocks(design: Design, plan: TimeOptimalPlan) -> list[Table | Note]:
    """Return how fast a planned motion passes singularities, and what is not certain there."""
    low, high = (
        format_value(rounded_to_side(end, 4, up=up), "s", 4)  # as where another one is refused
        for end, up in zip(plan.durations, (True, False), strict=True)
    )
    passed = [
        (
            item.crossing.locus.label,
            number(item.crossing.s, 4),
            *(format_value(rate, "1/s", 3) for rate in (item.speed, *item.speed_range)),
            format_value(item.residual, "N m", 1),
            format_value(unplanned_torque(item, plan.plan.duration), "N m", 3),
        )
        for item in plan.crossings
    ]
    head = ("", "s", "ṡ", "Least ṡ", "Largest ṡ", "Generalized force along t_s", "Quintic law")
    caption = (
        "Passages of the path s = 0 to 1, with the speeds that the limits allow, and what the "
        "quintic law in the same time would need of M1 to M3 at 1 kHz."
    )
    drifts = payload_drift(design, plan, PAYLOAD_ERROR)
    return [
        Note(f"Within the limits {low} to {high} are possible."),
        *([Table(head, rows(*passed), caption)] if passed else []),
        *(
            Note(f"{item.crossing.locus.label}: {_drift_text(drift)}", "warn")
            for item, drift in zip(plan.crossings, drifts, strict=True)
        ),
    ]


def _drift_text(drift: CrossingDrift) -> str:
    moved, turned = math.hypot(*drift.shift[:2]), abs(drift.shift[2])
    far = format_value(moved, "m:um", 2) if moved > 1e-8 else "less than 0.01 µm"
    wide = format_value(turned, "rad:arcsec", 2) if turned > 1.75e-7 else "less than 0.036″"
    return (
        f"{format_value(PAYLOAD_ERROR, 'kg')} more payload lets the platform drift by {far} and "
        f"{wide} in {number(1e3 * drift.time, 2)} ms."
    )


def shortest_note(found: ShortestStretch) -> Note:
    """Return what the duration of a shortest motion follows from."""
    return Note(f"shortest duration, {found.explanation}")


def reference_note(reference: TrajectoryAnalysis) -> Note:
    """Return whether another design can run the motion too."""
    failure = reference.failure
    verdict = "can run it too" if failure is None else f"fails {failure.explanation}"
    return Note(f'reference "{reference.design.name}": {verdict}', "bad" if failure else "ok")


def published_differences(
    analysis: TrajectoryAnalysis, table: PublishedTorques
) -> list[dict[str, Any] | None]:
    """Return how far computed torques are from a table's, for each actuator; None without any."""
    off = table.differences(analysis.trajectory.t, analysis.torque)
    found: list[dict[str, Any] | None] = []
    for j in range(4):
        known = np.isfinite(off[:, j])
        if not known.any():
            found.append(None)
            continue
        part = off[known, j]
        found.append(
            {
                "rows": int(known.sum()),
                "largest_difference": float(np.abs(part).max()),
                "rms_difference": float(np.sqrt(np.mean(part**2))),
                "largest_published": float(np.abs(table.torque[known, j]).max()),
            }
        )
    return found


def published_notes(analysis: TrajectoryAnalysis, table: PublishedTorques) -> list[Note]:
    """Return how far computed torques are from published ones, an actuator a sentence."""
    notes = []
    for j, row in enumerate(published_differences(analysis, table)):
        name = f"published {table.name}, {ACTUATORS[j]}"
        if row is None:
            notes.append(Note(f"{name}: no value at a time of this motion", "warn"))
            continue
        largest, rms, size = (
            format_value(row[key], TORQUE_UNITS[j], 3)
            for key in ("largest_difference", "rms_difference", "largest_published")
        )
        text = f"computed off by at most {largest}, RMS {rms}, of {size}"
        notes.append(Note(f"{name}: {text} at {counted(row['rows'], 'time')}"))
    return notes


def simulation_notes(simulation: Simulation) -> list[Note]:
    """Return how far a simulated robot was off the motion, and what its solution drifted by."""
    units = ("m", "m", "rad", "m")
    errors = np.abs(simulation.error).max(axis=0)
    x, y, theta, z = (
        format_value(float(e), unit, 3) for e, unit in zip(errors, units, strict=True)
    )
    notes = [
        Note(
            f"simulated with {simulation.controller.control.value}, payload "
            f"{format_value(simulation.design.payload.mass, 'kg')}: largest errors x {x}, y {y}, "
            f"θ {theta}, z {z}; at the end {format_value(simulation.distance[-1], 'm', 3)} from "
            "its place"
        )
    ]
    if simulation.stopped is not None:
        notes.append(Note(f"it stopped {simulation.stopped.explanation}", "bad"))
    drift = float(np.abs(simulation.energy_drift).max())
    return [*notes, Note(f"energy drift of the solution: {format_value(drift, 'J', 3)}")]


def trajectory_data(analysis: TrajectoryAnalysis) -> dict[str, Any]:
    """Return a motion, whether it can be run, and its torques, for JSON, in SI units."""
    t, check = analysis.trajectory, analysis.check
    return {
        **robot(analysis.design),
        "trajectory": {"samples": t.size, **record(t, "name", "kind", "duration_s", "notes")},
        "failure": _failure(analysis.failure),
        "closest": _event(check.closest),
        "crossings": [
            {
                "locus": item.locus.name.lower(),
                **record(item, "t_s", "residual_Nm"),
                "torques": None if item in analysis.unbounded else item.torque,
                "inertia_kg_m2": _inertia_at(analysis, item.t),
            }
            for item in analysis.crossings
        ],
        "actuators": _actuators(analysis),
    }


def _inertia_at(analysis: TrajectoryAnalysis, t: float) -> float:
    """Return the inertia along the escape twist at an instant [kg m^2]."""
    return float(escape_inertia(analysis.design, analysis.trajectory.at(t).pose))


def shortest_data(found: ShortestStretch) -> dict[str, Any]:
    """Return what the duration of a shortest motion follows from."""
    data = record(found, "quantity", "limit", "unit", "t_s")
    if isinstance(found, ShortestMotion):
        data |= {"stretched_s": found.stretched, "note": found.note}
    return data


def compared_data(analysis: TrajectoryAnalysis) -> dict[str, Any]:
    """Return the torques of another analysis of the same motion."""
    return {
        **robot(analysis.design),
        "failure": _failure(analysis.failure),
        "actuators": _actuators(analysis),
    }


def simulation_data(simulation: Simulation) -> dict[str, Any]:
    """Return a simulation for JSON, in SI units."""
    return {
        "controller": simulation.controller.control.value,
        "bandwidth_Hz": simulation.controller.bandwidth,
        "payload_kg": simulation.design.payload.mass,
        "end_t_s": simulation.t[-1],
        "stopped": _failure(simulation.stopped),
        "largest_distance_m": simulation.distance.max(),
        "end_distance_m": simulation.distance[-1],
        "largest_error": np.abs(simulation.error).max(axis=0),
        "energy_drift_J": np.abs(simulation.energy_drift).max(),
    }


def _event(event: PathEvent) -> dict[str, Any]:
    return {
        "t_s": event.t,
        "limit": event.limit.word,
        "leg": event.leg + 1 if event.leg >= 0 else None,
        "margin_m": event.margin,
        "pose": event.pose,
    }


def _failure(event: PathEvent | None) -> dict[str, Any] | None:
    return None if event is None else {**_event(event), "explanation": event.explanation}


def _actuators(analysis: TrajectoryAnalysis) -> list[dict[str, Any]]:
    names = zip(ACTUATORS, TORQUE_UNITS, SPEED_UNITS, strict=True)
    return [
        {"name": name, "unit": unit, "speed_unit": speed_unit}
        | {key: getattr(summary, load) for load, key, *_ in LOADS}
        for (name, unit, speed_unit), summary in zip(names, analysis.summary, strict=False)
    ]
