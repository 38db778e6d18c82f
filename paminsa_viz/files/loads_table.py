"""Joint forces and bar loads as tables in SI units: of a pose, along a bar, along a motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.elastostatics.bar_loads import bar_loads
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS, NEEDS_STIFFNESS, JointForces
from paminsa_viz.elastostatics.motion_loads import MotionLoads
from paminsa_viz.files.columns import BAR_LOADS, TIME
from paminsa_viz.files.tables import DataTable, provenance
from paminsa_viz.files.trajectory_table import parameter_facts, robot_facts
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS

JOINTS_FORMAT = "paminsa_viz joint forces 1"
"""Name and version of the layout of a pose's table."""

BARS_FORMAT = "paminsa_viz bar loads 1"

MOTION_FORMAT = "paminsa_viz loads of a motion 1"

SUMMARY_FORMAT = "paminsa_viz bearing loads 1"

SECTIONS = 101
"""Places along a bar that a table has."""

LEGS = (0, 1, 2)

Columns = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class MotionInstant:
    """The instant of a motion that a pose's table is of.

    Attributes:
        motion: Name of the motion.
        time: [s].
        velocity, acceleration: (4,) of the platform [m, rad, s].
        load: (6,) the motion's own load [N, N m], None for none.
    """

    motion: str
    time: float
    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    load: tuple[float, ...] | None = None


def joint_table(
    forces: JointForces,
    pose: NDArray[np.float64],
    sideways: NDArray[np.float64] | None = None,
    at: MotionInstant | None = None,
) -> DataTable:
    """Return the forces at the joints in one pose, a row for each joint of each leg.

    Args:
        forces: Forces in the legs' planes.
        pose: (4,) [m, m, rad, m].
        sideways: (3 legs, 10 joints) forces across them [N], where the legs' stiffness is known to
            decide them; without it that column is empty but for joint 5.
        at: Of which instant of a motion the forces are, None at rest.
    """
    force = forces.force.reshape(-1, 3).copy()
    why = NEEDS_STIFFNESS
    if sideways is not None:
        force[:, 1] = sideways.ravel()
        why = "at rest, from the stiffness of bars and bearings"
    columns: Columns = {
        **_joints(),
        "on": _texts([joint.on for joint in JOINTS] * len(LEGS)),
        "by": _texts([joint.by for joint in JOINTS] * len(LEGS)),
        "radial_N": force[:, 0],
        "tangential_N": force[:, 1],
        "vertical_N": force[:, 2],
        "moment_Nm": forces.moment.ravel(),
    }
    facts = _place(pose, at) | {"tangential": why}
    return DataTable(columns, provenance(JOINTS_FORMAT, facts | _design(forces.design)))


def bar_table(
    forces: JointForces, pose: NDArray[np.float64], bar: str, at: MotionInstant | None = None
) -> DataTable:
    """Return N, V and M along a bar of every leg in one pose, at rest or at an instant of a motion;
    see `bar_loads` for signs."""
    loads = bar_loads(forces, bar)
    s = np.linspace(0.0, loads.length, SECTIONS)
    columns: Columns = {"s_m": s}
    for leg in LEGS:
        inner = loads.at(s)[leg]
        for index, name in enumerate(BAR_LOADS):
            columns[f"leg{leg + 1}_{name}"] = inner[:, index]
    facts = {"bar": bar.upper()} | _place(pose, at)
    return DataTable(columns, provenance(BARS_FORMAT, facts | _design(forces.design)))


def motion_loads_table(loads: MotionLoads) -> DataTable:
    """Return forces at the joints and the largest loads of the bars at every sample."""
    force, moment = loads.forces.force, loads.forces.moment
    columns: Columns = {TIME: loads.trajectory.t, "axial_N": loads.forces.axial}
    for leg in LEGS:
        for index, joint in enumerate(JOINTS):
            name = f"leg{leg + 1}_{joint.key}"
            columns[f"{name}_radial_N"] = force[:, leg, index, 0]
            if joint.key == "5":
                columns[f"{name}_tangential_N"] = force[:, leg, index, 1]
            columns[f"{name}_vertical_N"] = force[:, leg, index, 2]
            if joint.key in ("m", "2"):
                columns[f"{name}_moment_Nm"] = moment[:, leg, JOINT_INDEX[joint.key]]
        for index, bar in enumerate(BARS):
            name = f"leg{leg + 1}_{bar}"
            for place, part in enumerate(BAR_LOADS):
                columns[f"{name}_{part}"] = loads.bars[:, leg, index, place]
            columns[f"{name}_utilization"] = loads.utilization[:, leg, index]
    facts = {"trajectory": loads.trajectory.name, "tangential": NEEDS_STIFFNESS}
    return DataTable(columns, provenance(MOTION_FORMAT, facts | _design(loads.design)))


def bearing_table(loads: MotionLoads) -> DataTable:
    """Return peak, RMS and equivalent load of every joint, a row each."""
    columns: Columns = {
        **_joints(),
        "peak_N": loads.peak.ravel(),
        "peak_t_s": loads.peak_time.ravel(),
        "rms_N": loads.rms.ravel(),
        "equivalent_N": loads.equivalent.ravel(),
        "travel": loads.travel.ravel(),
        "travel_unit": _texts(["rad" if joint.turning else "m" for joint in JOINTS] * len(LEGS)),
    }
    facts = {"trajectory": loads.trajectory.name}
    return DataTable(columns, provenance(SUMMARY_FORMAT, facts | _design(loads.design)))


def _joints() -> Columns:
    """Return which joints the rows are of: those of the first leg, of the second, of the third."""
    return {
        "leg": _texts([str(leg + 1) for leg in LEGS for _ in JOINTS]),
        "joint": _texts([joint.key for joint in JOINTS] * len(LEGS)),
    }


def _texts(words: Any) -> NDArray[Any]:
    return np.array(list(words))


def _place(pose: NDArray[np.float64], at: MotionInstant | None) -> dict[str, str]:
    """Return where and when the forces of a table are."""
    facts = {"pose [m, m, rad, m]": _numbers(pose.tolist())}
    if at is None:
        return facts | {"motion": "at rest"}
    facts |= {
        "motion": at.motion,
        "time [s]": repr(at.time),
        "velocity [m/s, m/s, rad/s, m/s]": _numbers(at.velocity),
        "acceleration [m/s^2, m/s^2, rad/s^2, m/s^2]": _numbers(at.acceleration),
    }
    load = "load of the motion [N, N, N, N m, N m, N m]"
    return facts if at.load is None else facts | {load: _numbers(at.load)}


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(repr, values))


def _design(design: Design) -> dict[str, str]:
    return robot_facts(design) | parameter_facts(design)
