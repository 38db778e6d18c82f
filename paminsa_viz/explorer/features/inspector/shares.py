"""Shares of a part in the robot's imbalance, strain energy and error by tolerances."""

from __future__ import annotations

from typing import Final

import numpy as np

from paminsa_viz.elastostatics.stiffness import SHARES, StrainShares, strain_shares
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.accuracy.manufacture import errors_at
from paminsa_viz.explorer.features.accuracy.monte_carlo import shown_lengths
from paminsa_viz.explorer.state.inspector import PartKind, RobotPart
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.stiffness import ElasticJob
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.model.statics import imbalance_parts
from paminsa_viz.precision.leg_lengths import INDEX

LENGTHS_OF: Final[dict[str, tuple[str, ...]]] = {
    "b2": ("shaft",), "b3": ("bar_43", "bar_37"), "b4": ("bar_94", "bar_45"), "b7": ("bar_87",),
    "b8": ("bar_89",), "5": ("joint_height", "joint_radius", "joint_angle"), "8": ("guide_height",),
    "M1": ("axis_radius", "axis_angle", "actuator_zero"),
}  # fmt: skip
"""Lengths whose tolerance is a part's, each once; M1 stands for M1 to M3."""


def imbalance_share(design: Design, part: RobotPart) -> float | None:
    """Return what a part of all three legs adds to M_p2 [N], None for a motor.

    Counterweights belong to their bars. All parts add up to M_p2.
    """
    if not part.mass_path:
        return None
    parts = imbalance_parts(design)
    weights = (
        parts[f"counterweights.{number}.mass"]
        for number, weight in enumerate(design.counterweights)
        if part.kind is PartKind.BAR and weight.bar == part.name
    )
    return parts[part.mass_path] + sum(weights)


@kept(4)
def _strain(job: ElasticJob) -> StrainShares:
    return strain_shares(job.design, np.array(job.pose), job.wrench)


def strain_share(state: State, part: RobotPart) -> float | None:
    """Return the share of one part in the strain energy under the load case of *Stiffness*.

    None for joints whose bearings are counted together, and NaN without a load.
    """
    case = state.stiffness.settings.case
    found = _strain(ElasticJob(state.shown_design, state.last_reachable.pose, case))
    name = {
        PartKind.BAR: part.name.upper(),
        PartKind.JOINT: {"5": "ball joint", "8": "guide"}.get(part.name, ""),
        PartKind.MOTOR: "M4" if part.leg is None else "drive",
    }[part.kind]
    if name not in SHARES:
        return None
    energy = found.energy[:, SHARES.index(name)]
    with np.errstate(invalid="ignore"):
        return float((energy.sum() if part.leg is None else energy[part.leg]) / found.total)


def tolerance_share(frame: Frame, part: RobotPart) -> float | None:
    """Return the share of a part of all three legs in the variance of the chosen coordinate.

    The coordinate is that of *Errors > Manufacture*. None for a part that no tolerance belongs to.
    """
    motor = part.kind is PartKind.MOTOR and part.leg is not None
    names = LENGTHS_OF.get("M1" if motor else part.name)
    if names is None:
        return None
    shares = errors_at(*shown_lengths(frame)).shares[frame.state.monte_carlo.settings.coordinate]
    return float(sum(shares[INDEX[name]] for name in names))
