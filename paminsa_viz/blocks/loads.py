"""Joint forces and bar loads: at the pose, and peak, RMS and equivalent load on the motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.blocks.data import robot
from paminsa_viz.blocks.kinds import (
    Block,
    Cell,
    Note,
    Row,
    Table,
    heading,
    rows,
    series_figure,
    shown,
)
from paminsa_viz.elastostatics.bar_loads import (
    BAR_NAMES,
    COMPONENTS,
    all_bar_loads,
    arm_tip,
    utilization,
)
from paminsa_viz.elastostatics.joint_forces import (
    JOINTS,
    NEEDS_STIFFNESS,
    JointForces,
    joint_forces,
)
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.elastostatics.sideways import SidewaysForces, sideways_forces
from paminsa_viz.files.columns import BAR_LOADS
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory import TrajectoryAnalysis

ROUNDING = 1e-9
"""Force [N] or moment [N m] that is written as zero."""

LEGS = (0, 1, 2)
SUBSCRIPTS = "₁₂₃"

_HINTS = {
    "Equivalent": "constant force with the same wear", "Use": "stress over yield stress, σ/R_p",
}  # fmt: skip

_JOINT_LABELS = rows(*((joint.label,) for joint in JOINTS))

MOMENT_AT = ("m", "2")
"""Keys of the joints that take a moment in the plane of a leg."""


NO_FORCES = "There are no joint forces at the pose"


def loads_blocks(analysis: TrajectoryAnalysis, pose: Sequence[float]) -> list[Block]:
    """Return the loads at rest in a pose (4,) and on a motion."""
    from paminsa_viz.plots.series import TITLES  # late: contours of maps

    design = analysis.design
    forces = joint_forces(design, pose)
    if forces.status == Limit.OK:
        blocks = pose_blocks(forces, sideways_forces(design, pose))
    else:
        explanation = Limit(int(forces.status)).explanation
        blocks = [Note(f"{NO_FORCES}: {explanation}.", "bad")]
    loads = motion_loads(analysis)
    if loads is None:
        return [*blocks, Note("The robot cannot run the trajectory from its start.", "bad")]
    if analysis.failure is not None:
        blocks.append(Note(f"{until_text(analysis)}:", "warn"))
    alt = f"{TITLES['loads']} over time, six panels."
    return [*blocks, *motion_blocks(loads), series_figure("loads", analysis, alt)]


def until_text(analysis: TrajectoryAnalysis) -> str:
    """Return up to where the loads on a motion are those of the whole motion."""
    failure = analysis.failure
    if failure is None:
        return ""
    where = "The motion" if analysis.check.possible else "Up to where the motion"
    return f"{where} fails {failure.explanation}"


def pose_blocks(forces: JointForces, sideways: SidewaysForces) -> list[Block]:
    """Return the forces at rest in one pose, and the shares of the joints across the planes."""
    inner = np.stack([loads.extremes() for loads in all_bar_loads(forces).values()], axis=1)
    tip = arm_tip(forces)
    bending = map(_text, (tip.sideways * forces.design.geometry.arm_length).reshape(3))
    torsion = map(_text, tip.torsion.reshape(3))
    torques = map(_text, forces.torque[:3])
    return [
        Note(
            "Forces in the legs’ planes at rest, at joint 5 in space, from equilibrium; each is on "
            "the first body of the joint, from the second. r is toward the platform, t along "
            "increasing θ, z up."
        ),
        joints_table(forces, sideways.force),
        _of_legs(
            "Moments across the planes, shared by elasticity as the forces t are.", ("Joint",),
            _JOINT_LABELS, {"M_r": "N m", "M_z": "N m"}, sideways.moment,
        ),
        bars_table(inner, utilization(forces)),
        Note(
            f"Torques {', '.join(torques)} N·m, force of M4 {_text(forces.torque[3])} N. Roots of "
            f"the arms B1, without sideways shares: horizontal bending {', '.join(bending)} N·m, "
            f"torsion {', '.join(torsion)} N·m."
        ),
    ]  # fmt: skip


def motion_blocks(loads: MotionLoads) -> list[Table]:
    """Return peak, RMS and equivalent load of the joints on a motion, and the bars' loads."""
    kinds = (loads.peak, loads.peak_time, loads.rms, loads.equivalent)
    caption = (
        "Forces at the joints on the motion: the peak and when it is, the RMS, and the equivalent "
        "load, the constant force with the same wear: weighted by relative rotation with exponent "
        "3."
    )
    units = {"Peak": "N", "At": "s", "RMS": "N", "Equivalent": "N"}
    return [
        _of_legs(caption, ("Joint",), _JOINT_LABELS, units, np.stack(kinds, axis=-1)),
        bars_table(loads.bar_peak, loads.utilization.max(axis=0)),
    ]


def joints_table(forces: JointForces, sideways: Array | None) -> Table:
    """Return the forces and moments at the joints of legs.

    Args:
        forces: Of one pose.
        sideways: (3, joints) forces across the planes; None where only those of joint 5 are known.
    """
    across = forces.force[..., 1] if sideways is None else sideways
    turning = [joint.key in MOMENT_AT for joint in JOINTS]
    moment = np.where(turning, forces.moment, np.inf)  # pins and balls take none
    values = np.stack([forces.force[..., 0], across, forces.force[..., 2], moment], axis=-1)
    labels = tuple(
        Row((one.label, one.on, one.by), hint=f"on {one.on}, from {one.by}") for one in JOINTS
    )
    caption = "Forces at the joints, and moments in the planes of the legs."
    units = {"r": "N", "t": "N", "z": "N", "M": "N m"}
    return _of_legs(caption, ("Joint", "On", "From"), labels, units, values)


def bars_table(inner: ArrayLike, use: ArrayLike) -> Table:
    """Return the largest loads (3 legs, bars, 3) in the bars, and their utilization (3, bars)."""
    values = np.concatenate([np.asarray(inner), np.asarray(use)[..., None]], axis=-1)
    units: dict[str, str] = dict(zip(COMPONENTS, ("N", "N", "N m"), strict=True))
    units["Use"] = "1:%"
    caption = "Largest forces N, V and moments M along the bars, and stress over yield stress."
    labels = rows(*((BAR_NAMES[bar],) for bar in BARS))
    return _of_legs(caption, ("Bar",), labels, units, values)


def _of_legs(
    caption: str, what: tuple[str, ...], labels: Sequence[Row], units: Mapping[str, str],
    values: Array,
) -> Table:  # fmt: skip
    """Return a table with rows of joints or bars, and columns of legs.

    Args:
        caption: What it shows.
        what: What the labels are.
        labels: How the rows begin.
        units: Units of a leg's numbers by their headings.
        values: (3 legs, rows, units) [N, N m, s, 1]; infinite where a cell stays empty.
    """
    head = (
        Cell(
            heading(f"{name}{leg + 1 if '_' in name else SUBSCRIPTS[leg]}", unit),
            hint=_HINTS.get(name, ""),
        )
        for leg in LEGS
        for name, unit in units.items()
    )
    found = []
    for place, label in enumerate(labels):
        numbers = (
            _text(value, unit)
            for leg in LEGS
            for value, unit in zip(values[leg, place], units.values(), strict=True)
        )
        found.append(replace(label, cells=(*label.cells, *numbers)))
    return Table((*what, *head), tuple(found), caption, words=len(what))


def of_leg(table: Table, leg: int) -> Table:
    """Return one of these tables with the columns of a leg; where forces are from is a tooltip."""
    width = (len(table.head) - table.words) // len(LEGS)
    first = table.words + width * leg
    chosen = table.columns(*range(min(table.words, 2)), *range(first, first + width))
    rows = (
        replace(row, cells=(row.cells[0].replace("M_k", f"M{leg + 1}"), *row.cells[1:]))
        for row in chosen.rows
    )
    return replace(chosen, rows=tuple(rows))


def _text(value: float, unit: str = "N") -> str:
    if math.isinf(value):
        return ""
    return shown(0.0 if abs(value) < ROUNDING else value, unit)


def pose_data(
    design: Design, pose: Any, forces: JointForces, sideways: SidewaysForces
) -> dict[str, Any]:
    """Return the forces at rest in a pose, for JSON, in SI units."""
    use = utilization(forces)
    return {
        **robot(design),
        "pose": pose,
        "torque": forces.torque,
        "axial_N": forces.axial,
        "sideways": NEEDS_STIFFNESS,
        "legs": [
            {
                "joints": {
                    joint.key: {
                        "on": joint.on, "by": joint.by,
                        "force_N": forces.force[leg, index],
                        "moment_Nm": forces.moment[leg, index],
                        "sideways_N": sideways.force[leg, index],
                        "sideways_moments_Nm": sideways.moment[leg, index],
                    }
                    for index, joint in enumerate(JOINTS)
                },
                "bars": {
                    bar: dict(
                        zip(BAR_LOADS, loads.extremes()[leg], strict=True),
                        utilization=use[leg, number],
                    )
                    for number, (bar, loads) in enumerate(all_bar_loads(forces).items())
                },
            }
            for leg in range(3)
        ],
    }  # fmt: skip


def motion_data(found: MotionLoads) -> dict[str, Any]:
    """Return the loads on a motion, for JSON, in SI units."""
    use = found.utilization.max(axis=0)
    return {
        **robot(found.design),
        "trajectory": found.trajectory.name,
        "legs": [
            {
                "joints": {
                    joint.key: {
                        "peak_N": found.peak[leg, index],
                        "peak_t_s": found.peak_time[leg, index],
                        "rms_N": found.rms[leg, index],
                        "equivalent_N": found.equivalent[leg, index],
                        f"travel_{'rad' if joint.turning else 'm'}": found.travel[leg, index],
                    }
                    for index, joint in enumerate(JOINTS)
                },
                "bars": {
                    bar: dict(
                        zip(BAR_LOADS, found.bar_peak[leg, number], strict=True),
                        utilization=use[leg, number],
                    )
                    for number, bar in enumerate(BARS)
                },
            }
            for leg in range(3)
        ],
    }
