"""What a part carries, now and at worst on the motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.elastostatics.bar_loads import bar_loads
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS
from paminsa_viz.elastostatics.motion_loads import MotionLoads
from paminsa_viz.explorer.features.loads.solving import (
    Instant,
    bars_at,
    forces_at,
    found,
    instant,
    sideways_at,
)
from paminsa_viz.explorer.state.inspector import PartKind, RobotPart
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Limit
from paminsa_viz.model.elastic import BARS


class PartNumber(NamedTuple):
    """A number of a part.

    Attributes:
        symbol, unit: What it is, and in what unit it is shown.
        now: At the instant that is shown.
        worst: Largest in size on the motion; NaN if that is not known.
    """

    symbol: str
    unit: str
    now: float
    worst: float


def reason(state: State) -> str:
    """Return why there are no forces at the last reachable pose, or nothing."""
    status = Limit(int(forces_at(instant(state)).status))
    return "" if status is Limit.OK else status.explanation


def numbers(state: State, part: RobotPart) -> list[PartNumber]:
    """Return the forces of a part; NaN where there are none."""
    at, along = instant(state), found(state)
    if part.kind is PartKind.BAR:
        return _bar(at, along, part)
    if part.kind is PartKind.JOINT:
        return _joint(at, along, part)
    return _motor(at, along, part)


def bar_length(state: State, bar: str) -> float:
    """Return the length of a bar [m]."""
    return float(bar_loads(forces_at(instant(state)), bar).length)


def _bar(at: Instant, along: MotionLoads | None, part: RobotPart) -> list[PartNumber]:
    index, leg = BARS.index(part.name), part.leg
    inner, use = bars_at(at)
    now = [*inner[leg, index].tolist(), 100 * float(use[leg, index])]
    worst = [np.nan] * 4
    if along is not None:
        most = along.utilization.max(axis=0)[leg, index]
        worst = [*along.bar_peak[leg, index].tolist(), 100 * float(most)]
    texts = (("N", "N"), ("V", "N"), ("M", "N·m"), ("σ/R_p", "%"))
    return [PartNumber(*text, *both) for text, *both in zip(texts, now, worst, strict=True)]


def _joint(at: Instant, along: MotionLoads | None, part: RobotPart) -> list[PartNumber]:
    forces, sideways, leg = forces_at(at), sideways_at(at), part.leg
    rows = []
    for joint in JOINTS:
        if joint.key.partition("_")[0] != part.name:
            continue
        index = JOINT_INDEX[joint.key]
        peak = np.nan if along is None else float(along.peak[leg, index])
        rows.append(PartNumber(f"F {joint.label}", "N", float(forces.magnitude[leg, index]), peak))
        if sideways is not None and joint.key != "5":  # the size at joint 5 is in space
            rows.append(PartNumber(f"F_t {joint.label}", "N", float(sideways[leg, index]), np.nan))
    return rows


def _motor(at: Instant, along: MotionLoads | None, part: RobotPart) -> list[PartNumber]:
    index = 3 if part.leg is None else part.leg
    now, worst = float(forces_at(at).torque[index]), np.nan
    if along is not None:
        torque = along.forces.torque[:, index]
        worst = float(torque[np.abs(torque).argmax()])
    symbol, unit = ("F_4", "N") if part.leg is None else (f"τ_{index + 1}", "N·m")
    return [PartNumber(symbol, unit, now, worst)]
