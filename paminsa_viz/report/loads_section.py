"""Joint forces and bar loads: at the pose, and peak, RMS and equivalent load on the motion."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from paminsa_viz.elastostatics.joint_forces import JOINTS, joint_forces
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.series import SeriesSources
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.report.blocks import Block, Note, Section, Table, rows, series_figure
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, number

ROUNDING = 1e-9
"""Force [N] or moment [N m] that is written as zero."""


def loads_section(analysis: TrajectoryAnalysis, pose: Sequence[float]) -> Section:
    """Return the section."""
    blocks: list[Block] = [
        Note(
            "Forces in the legs' planes, at joint 5 in space, from equilibrium; each is on the "
            "first body, from the second. r is toward the platform, z up. Sideways shares of the "
            "other joints are statically indeterminate and are not in them."
        )
    ]
    forces = joint_forces(analysis.design, pose)
    if forces.status == Limit.OK:
        found = [
            (
                joint.label, f"{joint.on}, {joint.by}",
                *(_text(forces.force[leg, i, part]) for leg in range(3) for part in (0, 2)),
            )
            for i, joint in enumerate(JOINTS)
        ]  # fmt: skip
        head = ("Joint", "Bodies", *(f"{part}, leg {leg}" for leg in (1, 2, 3) for part in "rz"))
        blocks.append(Table(head, rows(*found), "Forces at rest at the pose [N].", 2, literal=True))
    else:
        explanation = Limit(int(forces.status)).explanation
        blocks.append(Note(f"There are no joint forces at the pose: {explanation}.", "bad"))
    loads = motion_loads(analysis)
    if loads is None:
        blocks.append(Note("The robot cannot run the trajectory from its start.", "bad"))
        return Section("loads", "Joint forces and bar loads", tuple(blocks))
    if analysis.check.first is not None:
        blocks.append(Note("Up to where the trajectory first fails:", "warn"))
    blocks += [_joints(loads), _bars(loads)]
    data = build_series("loads", SeriesSources(analysis))
    blocks.append(series_figure(data, f"{data.title} over time, six panels."))
    return Section("loads", "Joint forces and bar loads", tuple(blocks))


def _joints(loads: MotionLoads) -> Table:
    found = []
    for i, joint in enumerate(JOINTS):
        leg = int(loads.peak[:, i].argmax())
        equivalent = loads.equivalent[:, i]
        worst = math.nan if np.isnan(equivalent).all() else float(np.nanmax(equivalent))
        found.append(
            (
                joint.label, str(leg + 1), _text(loads.peak[leg, i]),
                number(float(loads.peak_time[leg, i]), 3), _text(loads.rms[:, i].max()),
                _text(worst),
            )
        )  # fmt: skip
    head = ("Joint", "Leg", "Peak [N]", "At [s]", "RMS [N]", "Equivalent load [N]")
    text = (
        "Forces on the trajectory: the leg with the largest peak, and the largest RMS and "
        "equivalent load of all legs, weighted by relative rotation with exponent 3."
    )
    return Table(head, rows(*found), text, 1, literal=True)


def _bars(loads: MotionLoads) -> Table:
    size = np.abs(loads.bar_peak).max(axis=0)
    use = loads.utilization.max(axis=(0, 1))
    found = [
        (bar.upper(), *map(_text, size[i]), f"{100 * use[i]:.2g} %") for i, bar in enumerate(BARS)
    ]
    head = ("Bar", "|N| [N]", "|V| [N]", "|M| [N m]", "Stress over yield stress")
    return Table(
        head, rows(*found), "Largest loads along the bars on the trajectory.", 1, literal=True
    )


def _text(value: float) -> str:
    value = float(value)
    if math.isnan(value):
        return NONE
    return number(0.0 if abs(value) < ROUNDING else value, 3)
