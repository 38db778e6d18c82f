"""What one state shows: everything the page draws, computed by a pure function."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from paminsa_viz.explorer.core.motion_results import MotionStore
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import (
    Configuration,
    Design,
    Reach,
    Singularity,
    check_reach,
    inverse_kinematics,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.singular_limit import near_by_reach
from paminsa_viz.model.statics import shown_imbalance
from paminsa_viz.trajectory import Locus, TrajectoryAnalysis
from paminsa_viz.trajectory.crossing import locus_distances
from paminsa_viz.units import number


class Health(Enum):
    """Status of the requested pose."""

    OK = "reachable"
    BEYOND = "beyond a singularity"
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
        motions: What the session knows along its motion.
        is_preview: Whether it shows a robot that is not the session's, as while a search runs.
    """

    state: State
    configuration: Configuration
    shown_design: Design
    requested: Reach
    singularity: Singularity
    torques: Array
    reference_torques: Array | None
    balance: float
    motions: MotionStore
    is_preview: bool = False

    @cached_property
    def analysis(self) -> TrajectoryAnalysis | None:
        """The current design on the current motion, or None without a motion."""
        return self.motions.analysis(self.state)

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
        if self.near:
            return Health.NEAR
        return Health.BEYOND if self.barriers else Health.OK

    @cached_property
    def near(self) -> bool:
        """Whether the last reachable pose is too close to a singularity to count."""
        limit = self.state.condition_limit
        taken, condition = self.configuration, self.singularity.condition
        return bool(near_by_reach(taken.geometry, condition, taken.reach, limit))

    @cached_property
    def explanation(self) -> str:
        """One sentence that says why, in millimeters."""
        if self.health is Health.UNREACHABLE:
            return self.requested.explanation()
        if self.health is Health.NEAR:
            limit = self.state.condition_limit
            condition = float(self.singularity.condition)
            sign = ">" if condition > limit else "≤"
            return f"κ = {number(condition, 3)} {sign} {limit:g}; {self.distances}"
        if self.health is Health.BEYOND:
            return self.distances
        return "all legs within their limits"

    @cached_property
    def distances(self) -> str:
        """How far the last reachable pose is from each singularity."""
        s = self.singularity
        found = [f"{number(1e3 * abs(float(s.position_distance)), 3)} mm from the singular circle"]
        if np.isfinite(s.rotation_distance):
            turn = np.degrees(abs(float(s.rotation_distance)))
            found.append(f"{turn:.1f}° from a singular rotation")
        found.append(f"{number(1e3 * float(s.serial_distance), 3)} mm from a pantograph’s limit")
        return ", ".join(found)

    @cached_property
    def barriers(self) -> tuple[Locus, ...]:
        """Type-2 loci between the last reachable pose and home: no way there avoids them."""
        last_reachable = self.state.last_reachable
        geometry, pose = last_reachable.geometry, last_reachable.pose
        poses = np.array([pose, home_pose(geometry)])
        here, home = locus_distances(geometry, poses)
        return tuple(locus for locus in Locus if here[locus.value] * home[locus.value] < 0)


def compute(state: State, motions: MotionStore | None = None, *, is_preview: bool = False) -> Frame:
    """Return what a state shows.

    Args:
        state: The state.
        motions: What is known along the motion.
        is_preview: Whether the state is not the session's, but what is shown in its place.
    """
    document, last_reachable = state.document, state.last_reachable
    configuration = inverse_kinematics(last_reachable.geometry, last_reachable.pose)
    here, reference = state.shown_design, None
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
        balance=shown_imbalance(document.design),
        motions=motions or MotionStore(),
        is_preview=is_preview,
    )
