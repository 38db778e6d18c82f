"""Limits of the program of masses and springs: bounds at rest as convex functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.balancing.convex import ConvexTerm, MaxAbs
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.inner_case import ACTUATORS_OF
from paminsa_viz.synthesis.inner_space import MP2, InnerSpace, static_rows

EDGE = 1e-9
"""How far outside of a bound's headings and heights a pose still counts [rad, m]."""


class InnerLimit(NamedTuple):
    """A limit of the program.

    Attributes:
        label: What is limited, in words.
        unit: Its SI unit.
        side: ``"low"`` or ``"high"``; a bound on a magnitude is ``"high"``.
        bound: Its value.
        requirement: The bound at rest that it comes from; None for one on motions.
        term: The program's function; of a ``"low"`` side it is the negative of the quantity.
    """

    label: str
    unit: str
    side: str
    bound: float
    requirement: Requirement | None
    term: ConvexTerm

    @property
    def limit(self) -> float:
        """What the function may be at most."""
        return -self.bound if self.side == "low" else self.bound


class InnerInfeasible(PaminsaError):
    """No masses and springs within their bounds do what is asked.

    Attributes:
        excess: The least by which the worst limit is broken, as a part of it (or of 1); infinite
            where a pose or a motion is out of reach.
        reason: Why, in words.
    """

    def __init__(self, excess: float, reason: str) -> None:
        self.excess = excess
        self.reason = reason
        super().__init__(reason)


def within(bound: Requirement, pose: Array) -> NDArray[np.intp]:
    """Return which poses (n, 4) are among a bound's headings and heights, their indices."""
    inside = np.ones(len(pose), bool)
    for axis, limits in ((2, bound.theta), (3, bound.z)):
        if limits is not None:
            inside &= (limits[0] - EDGE <= pose[:, axis]) & (pose[:, axis] <= limits[1] + EDGE)
    return np.flatnonzero(inside)


def limits_at_rest(space: InnerSpace, bound: Requirement, pose: Array) -> list[InnerLimit]:
    """Return a bound on torques at rest as limits of the program.

    Args:
        space: Masses and springs as states.
        bound: The bound, on one of `ACTUATORS_OF`.
        pose: (n, 4) poses at which bounds count [m, m, rad, m].

    Raises:
        InnerInfeasible: If one of the poses is out of reach.
        InvalidInput: If none is among the bound's headings and heights.
    """
    pose = as_vectors(pose, "pose").reshape(-1, 4)
    pose = pose[within(bound, pose)]
    if not len(pose):
        raise InvalidInput(bound.quantity, "there is no pose at which it has to hold")
    matrix, offset = static_rows(space, pose)
    if not np.isfinite(matrix).all():
        raise InnerInfeasible(np.inf, "a pose at which a torque is bounded is out of reach")
    actuators = ACTUATORS_OF[bound.quantity]
    plain = not space.springs and not space.design.load.acts
    rows, offsets = [], []
    for j in actuators:
        use = slice(None)
        if plain:  # M_p2 is the only factor of the pose: its two extremes bound all others
            gamma = matrix[:, j, MP2]
            use = [int(gamma.argmin()), int(gamma.argmax())]
        rows.append(matrix[use, j])
        offsets.append(offset[use, j])
    m, b = np.concatenate(rows), np.concatenate(offsets)
    label, unit = bound.entry.title, bound.entry.unit
    both = bound.quantity == "max_torque" or (bound.high is not None and bound.low == -bound.high)
    if both and bound.high is not None:
        return [InnerLimit(label, unit, "high", bound.high, bound, MaxAbs(m, b))]
    found = []
    if bound.high is not None:
        term = MaxAbs(m, b, absolute=False)
        found.append(InnerLimit(label, unit, "high", bound.high, bound, term))
    if bound.low is not None:
        term = MaxAbs(-m, -b, absolute=False)
        found.append(InnerLimit(label, unit, "low", bound.low, bound, term))
    return found
