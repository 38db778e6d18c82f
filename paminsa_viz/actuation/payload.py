"""What a payload does to the torques of M1..M3: nothing at rest, its inertia in motion.

The prototype's authors state that the rotary actuators need the same torques with and without a
payload, and that M4 carries it (J. Mech. Des. 130 (2008) 122303, abstract). At rest that is exact:
a mass m on the platform's vertical axis weighs k m g on M4 and nothing on the others. In motion the
dynamic torques fall with the square of the time, so that there is a fastest time scaling at which
the payload changes the torques by no more than a given share.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.checks import require_positive
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.trajectory import Trajectory, analyze
from paminsa_viz.trajectory.integrals import mean_weights

SLOWEST, FASTEST = 1e3, 1e-3
"""Time scalings between which one is looked for."""

SCANNED = 600
"""Scalings that are looked at, in equal steps of their logarithm."""


class PayloadChange(NamedTuple):
    """Readings of a payload's change of the torques of M1..M3, each of the worst of the three.

    Attributes:
        largest: Largest change over the largest torque without payload.
        peak: Change of the largest torque, over it.
        rms: Change of the RMS torque, over it.
    """

    largest: float
    peak: float
    rms: float


class _Torques(NamedTuple):
    """Torques of M1..M3 on a motion (n, 3) [N m]: at rest, dynamic without and with the payload.

    The weights (n,) are those of its samples in a mean over time.
    """

    weights: Array
    gravity: Array
    bare: Array
    full: Array

    def change(self, slower: float) -> PayloadChange:
        without = self.gravity + self.bare / slower**2
        carrying = self.gravity + self.full / slower**2
        peak = np.abs(without).max(axis=0)
        mean, loaded = (np.sqrt(self.weights @ torques**2) for torques in (without, carrying))
        return PayloadChange(
            float((np.abs(carrying - without).max(axis=0) / peak).max()),
            float(np.abs(np.abs(carrying).max(axis=0) / peak - 1).max()),
            float(np.abs(loaded / mean - 1).max()),
        )


@of_design
def payload_change(
    design: Design, motion: Trajectory, mass: float, slower: float = 1.0
) -> PayloadChange:
    """Return how a payload changes the torques of M1..M3 on a motion; friction is left out.

    Args:
        design: The robot; its own payload is replaced.
        motion: The motion.
        mass: The payload [kg].
        slower: Factor on the time.

    Raises:
        ImpossibleTrajectory: If the robot cannot run the motion.
    """
    return _torques(design, motion, mass).change(slower)


@of_design
def payload_time_scaling(
    design: Design, motion: Trajectory, mass: float, share: float = 0.05
) -> PayloadChange:
    """Return the factors on a motion's time down to which each reading stays within a share.

    Coming from slow motions it is where the reading first exceeds the share; 0 if it never does.
    NaN if it does so however slow the motion is: a statically balanced robot has dynamic torques
    alone, of which the payload's part is always the same, and at rest none at all.

    Args:
        design: The robot; its own payload is replaced, friction is left out.
        motion: The motion.
        mass: The payload [kg].
        share: Change that still counts as none, such as 0.05.

    Raises:
        ImpossibleTrajectory: If the robot cannot run the motion.
        InvalidInput: If the share is not positive.
    """
    require_positive(share, "share")
    torques = _torques(design, motion, mass)
    grid = np.geomspace(SLOWEST, FASTEST, SCANNED)
    exceeds = np.zeros((SCANNED, 3), np.bool_)
    for index, slower in enumerate(grid):
        exceeds[index] = np.array(torques.change(slower)) > share
        if exceeds.any(axis=0).all():  # only where each first exceeds it counts
            break
    found = []
    for reading in range(3):
        first = int(exceeds[:, reading].argmax())
        if not exceeds[first, reading]:
            found.append(0.0)
        elif first == 0:
            found.append(np.nan)
        else:
            from scipy.optimize import brentq  # slow to load

            root: Any = brentq(
                lambda slower, reading=reading: torques.change(slower)[reading] - share,
                grid[first], grid[first - 1], rtol=np.float64(1e-12),
            )  # fmt: skip
            found.append(float(root))
    return PayloadChange(*found)


def _torques(design: Design, motion: Trajectory, mass: float) -> _Torques:
    bare = design.without_friction().vary({"payload.mass": 0.0, "payload.inertia": 0.0})
    analyses = [analyze(one, motion) for one in (bare, bare.vary({"payload.mass": mass}))]
    analyses[0].check.require()
    parts = [analysis.breakdown for analysis in analyses]
    dynamic = [(part.inertial + part.velocity)[:, :3] for part in parts]
    return _Torques(mean_weights(motion.t), (parts[0].gravity + parts[0].load)[:, :3], *dynamic)
