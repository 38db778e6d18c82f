"""Joint forces and bar loads: at the pose, and peak, RMS and equivalent load on the motion."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.blocks.kinds import Block, Note, Table, rows, series_figure
from paminsa_viz.elastostatics.bar_loads import COMPONENTS, all_bar_loads, arm_tip, utilization
from paminsa_viz.elastostatics.joint_forces import (
    JOINTS,
    NEEDS_STIFFNESS,
    JointForces,
    joint_forces,
)
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.elastostatics.sideways import SidewaysForces, sideways_forces
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, number

ROUNDING = 1e-9
"""Force [N] or moment [N m] that is written as zero."""


def loads_blocks(analysis: TrajectoryAnalysis, pose: Sequence[float]) -> list[Block]:
    """Return the loads at rest in a pose (4,) and on a motion."""
    design = analysis.design
    forces = joint_forces(design, pose)
    if forces.status == Limit.OK:
        blocks = pose_blocks(forces, sideways_forces(design, pose))
    else:
        explanation = Limit(int(forces.status)).explanation
        blocks = [Note(f"There are no joint forces at the pose: {explanation}.", "bad")]
    loads = motion_loads(analysis)
    if loads is None:
        return [*blocks, Note("The robot cannot run the trajectory from its start.", "bad")]
    if analysis.check.first is not None:
        blocks.append(Note("Up to where the trajectory first fails:", "warn"))
    alt = "Forces at the joints and in the bars over time, six panels."
    return [*blocks, *motion_blocks(loads), series_figure("loads", analysis, alt)]


def pose_blocks(forces: JointForces, sideways: SidewaysForces) -> list[Block]:
    """Return the forces at rest in one pose, and the shares of the joints across the planes."""
    joint = range(len(JOINTS))
    plane = [
        np.column_stack([forces.force[:, i, 0], forces.force[:, i, 2], forces.moment[:, i]])
        for i in joint
    ]
    across = [np.column_stack([sideways.force[:, i], sideways.moment[:, i]]) for i in joint]
    labels = [item.label for item in JOINTS]
    named = [f"{item.label}: {item.on}, {item.by}" for item in JOINTS]
    inner = np.stack([loads.extremes() for loads in all_bar_loads(forces).values()], axis=1)
    tip = arm_tip(forces)
    bending = map(_text, (tip.sideways * forces.design.geometry.arm_length).reshape(3))
    torsion = map(_text, tip.torsion.reshape(3))
    torques = map(_text, forces.torque[:3])
    return [
        Note(
            "Forces in the legs' planes at rest, at joint 5 in space, from equilibrium; each is on "
            "the first body of the joint, from the second. r is toward the platform, z up."
        ),
        _of_legs(
            "Forces [N] and moments [N m] at the pose, in the planes of legs 1 to 3.",
            "Joint", named, ("r", "z", "M"), plane,
        ),
        _of_legs(
            "Across the planes, shared by elasticity: forces [N], moments [N m] about r and z.",
            "Joint", labels, ("w", "M_u", "M_z"), across,
        ),
        _bars(inner, utilization(forces)),
        Note(
            f"Torques {', '.join(torques)} N m, force of M4 {_text(forces.torque[3])} N. Roots of "
            f"the arms B1, without sideways shares: horizontal bending {', '.join(bending)} N m, "
            f"torsion {', '.join(torsion)} N m."
        ),
    ]  # fmt: skip


def motion_blocks(loads: MotionLoads) -> list[Block]:
    """Return peak, RMS and equivalent load of the joints on a motion, and the bars' loads."""
    kinds = (loads.peak, loads.rms, loads.equivalent)
    values = [np.column_stack([kind[:, i] for kind in kinds]) for i in range(len(JOINTS))]
    caption = (
        "Forces [N] at legs 1 to 3 on the trajectory: peak, RMS and equivalent load, weighted by "
        "relative rotation with exponent 3."
    )
    labels = [item.label for item in JOINTS]
    return [
        _of_legs(caption, "Joint", labels, ("peak", "RMS", "eq."), values),
        _bars(loads.bar_peak, loads.utilization.max(axis=0)),
    ]


def _bars(inner: ArrayLike, use: ArrayLike) -> Table:
    """Return the table of the largest loads (3 legs, bars, 3) and the utilization of the bars."""
    cells = np.concatenate([np.asarray(inner), 100 * np.asarray(use)[..., None]], axis=-1)
    caption = "Largest N [N], V [N], M [N m] along the bars, and stress over yield stress [%]."
    labels = [bar.upper() for bar in BARS]
    return _of_legs(caption, "Bar", labels, (*COMPONENTS, "use"), np.swapaxes(cells, 0, 1))


def _of_legs(
    caption: str,
    what: str,
    labels: Sequence[str],
    parts: Sequence[str],
    values: Iterable[ArrayLike],
) -> Table:
    """Return a table with a row a label, whose values are (3 legs, parts)."""
    head = (what, *(f"{part} {leg}" for leg in (1, 2, 3) for part in parts))
    found = [(label, *map(_text, np.ravel(row))) for label, row in zip(labels, values, strict=True)]
    return Table(head, rows(*found), caption, literal=True)


def _text(value: float) -> str:
    value = float(value)
    if math.isnan(value):
        return NONE
    return number(0.0 if abs(value) < ROUNDING else value)


def pose_data(
    design: Design, pose: Any, forces: JointForces, sideways: SidewaysForces
) -> dict[str, Any]:
    """Return the forces at rest in a pose, for JSON, in SI units."""
    use = utilization(forces)
    return {
        "design": design.name,
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
                        zip(COMPONENTS, loads.extremes()[leg], strict=True),
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
        "design": found.design.name,
        "trajectory": found.trajectory.name,
        "legs": [
            {
                "joints": {
                    joint.key: {
                        "peak_N": found.peak[leg, index],
                        "peak_t_s": found.peak_time[leg, index],
                        "rms_N": found.rms[leg, index],
                        "equivalent_N": found.equivalent[leg, index],
                        "travel": found.travel[leg, index],
                    }
                    for index, joint in enumerate(JOINTS)
                },
                "bars": {
                    bar: dict(
                        zip(COMPONENTS, found.bar_peak[leg, number], strict=True),
                        utilization=use[leg, number],
                    )
                    for number, bar in enumerate(BARS)
                },
            }
            for leg in range(3)
        ],
    }
