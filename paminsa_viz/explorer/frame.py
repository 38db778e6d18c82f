"""What one state shows: everything the page draws, computed by a pure function."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.state import State
from paminsa_viz.model import (
    Configuration,
    Design,
    Limit,
    Reach,
    Singularity,
    check_reach,
    inverse_kinematics,
    measure_singularity,
    static_imbalance,
    static_torques,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import home_pose
from paminsa_viz.trajectory import Locus
from paminsa_viz.trajectory.crossing import locus_distances

NEAR_POSITION = 0.02
"""Closer than this to the singular circle, the pose counts as near a singularity [m]."""
NEAR_ROTATION = np.radians(5.0)
"""Closer than this to a singular rotation, the pose counts as near a singularity [rad]."""
NEAR_SERIAL = 0.01
"""Less room than this to a stretched or folded pantograph counts as near a singularity [m]."""


def near_singularity(singularity: Singularity) -> NDArray[np.bool_]:
    """Return which poses count as near a singularity, in the shape of the distances."""
    return (
        (np.abs(singularity.position_distance) < NEAR_POSITION)
        | (np.abs(singularity.rotation_distance) < NEAR_ROTATION)
        | (np.asarray(singularity.serial_distance) < NEAR_SERIAL)
    )


class Health(Enum):
    """Status of the requested pose."""

    OK = "reachable"
    NEAR = "near a singularity"
    UNREACHABLE = "unreachable"


@dataclass(frozen=True)
class Frame:
    """What a state means, for the views.

    Attributes:
        state: The state.
        configuration: The configuration at the last reachable pose.
        shown_design: The current masses on the last reachable geometry.
        requested: Reach of the requested pose.
        singularity: Distances of the last reachable pose.
        torques: Static torques there with the current masses, (4,) [N m, N].
        reference_torques: The same for the reference design, or None without one or if it cannot
            be there.
        balance: M_p2 of the current design [N].
    """

    state: State
    configuration: Configuration
    shown_design: Design
    requested: Reach
    singularity: Singularity
    torques: Array
    reference_torques: Array | None
    balance: float

    @cached_property
    def drawable(self) -> bool:
        """Whether every joint of the configuration has a place."""
        points = self.configuration.points
        return all(bool(np.isfinite(points[joint]).all()) for joint in (5, 8, 9))

    @cached_property
    def health(self) -> Health:
        """Status of the request."""
        if not self.requested.ok.all():
            return Health.UNREACHABLE
        return Health.NEAR if near_singularity(self.singularity).all() else Health.OK

    @cached_property
    def explanation(self) -> str:
        """One sentence that says why, in millimeters."""
        if self.health is Health.UNREACHABLE:
            limit, leg = Limit(int(self.requested.status)), int(self.requested.leg)
            text = limit.explanation
            if leg >= 0:
                text += f" (leg {leg + 1}, by {1e3 * float(self.requested.excess):.1f} mm)"
            return text
        s = self.singularity
        if self.health is Health.NEAR:
            return (
                f"{1e3 * abs(float(s.position_distance)):.0f} mm from the singular circle, "
                f"{np.degrees(abs(float(s.rotation_distance))):.1f}° from a singular rotation, "
                f"{1e3 * float(s.serial_distance):.0f} mm from a pantograph's limit"
            )
        return "all legs within their limits"

    @cached_property
    def barriers(self) -> tuple[Locus, ...]:
        """Type-2 loci between the last reachable pose and home: no way there avoids them."""
        last_reachable = self.state.last_reachable
        geometry, pose = last_reachable.geometry, last_reachable.pose
        poses = np.array([pose, home_pose(geometry)])
        here, home = locus_distances(geometry, poses)
        return tuple(locus for locus in Locus if here[locus.value] * home[locus.value] < 0)


def compute(state: State) -> Frame:
    """Return what a state shows."""
    document, last_reachable = state.document, state.last_reachable
    configuration = inverse_kinematics(last_reachable.geometry, last_reachable.pose)
    # If the current geometry is out of reach, its masses are shown on the last one that was not.
    here = document.design
    if last_reachable.geometry != here.geometry:
        here = replace(here, geometry=last_reachable.geometry)
    reference = None
    if document.reference is not None:
        held = static_torques(document.reference, last_reachable.pose)
        reference = held if np.isfinite(held).all() else None
    return Frame(
        state=state,
        configuration=configuration,
        shown_design=here,
        requested=check_reach(document.design.geometry, document.pose),
        singularity=measure_singularity(last_reachable.geometry, last_reachable.pose),
        torques=static_torques(here, last_reachable.pose),
        reference_torques=reference,
        balance=static_imbalance(document.design),
    )
