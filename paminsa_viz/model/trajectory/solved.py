"""What depends on geometry and motion alone: the path's check, the actuators' speeds, Y.

It is solved once. A change of masses, of gravity or of friction is then one product Q = Y c.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Assembly, Design, Friction, Geometry
from paminsa_viz.model.dynamics import friction_torque, frictionless
from paminsa_viz.model.jacobian import inverse_jacobian
from paminsa_viz.model.kinematics import solve_posture
from paminsa_viz.model.lumped import Misprint, lumped_coefficients
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.regressor import regressor_torques, torque_regressor
from paminsa_viz.model.trajectory.check import (
    SINGULAR_CLEARANCE,
    PathCheck,
    PathEvent,
    check_path,
)
from paminsa_viz.model.trajectory.sampled import Trajectory


@dataclass(frozen=True, eq=False)
class SolvedTrajectory:
    """What a motion of n samples asks of a geometry, whatever its masses.

    Attributes:
        geometry: The lengths.
        trajectory: The motion.
        assembly: Root of the knee.
        misprints: Formulae taken as printed.
        gravity: Gravitational acceleration that Y was made with [m/s^2].
        check: Where and why it fails, if it does.
        y: (n, 4, 18) regressor; NaN at samples whose status is not OK.
        speed: (n, 4) of the actuators [rad/s, m/s]; NaN there as well.
    """

    geometry: Geometry
    trajectory: Trajectory
    assembly: Assembly
    misprints: Misprint
    gravity: float
    check: PathCheck
    y: Array
    speed: Array

    def torques(self, design: Design, *, friction: bool = True) -> Array:
        """Return the actuator torques for a design of this geometry, (n, 4) [N m, N]."""
        torque = regressor_torques(self.y, lumped_coefficients(design, self.misprints))
        if design.gravity != self.gravity:
            torque[:, 3] += self.extra_weight(design)
        if friction and not frictionless(design.friction):
            torque += self.friction(design.friction)
        return torque

    def friction(self, friction: Friction) -> Array:
        """Return the friction torques, (n, 4) [N m, N]; those of the last friction are kept."""
        kept = self._friction.get(friction)
        if kept is None:
            kept = friction_torque(friction, self.speed)
            if frictionless(friction):
                kept[~self.check.good] = np.nan
            kept.setflags(write=False)
            self._friction.clear()
            self._friction[friction] = kept
        return kept

    @cached_property
    def _friction(self) -> dict[Friction, Array]:
        return {}

    def extra_weight(self, design: Design) -> float:
        """Return what the platform weighs on M4 beyond the gravity that Y was made with [N].

        The legs' weights stand in c.
        """
        mass = design.platform.mass + design.payload.mass
        return self.geometry.magnification * (design.gravity - self.gravity) * mass

    @cached_property
    def parts(self) -> tuple[Array, Array, Array]:
        """Regressors of gravity, of the acceleration and of the velocity, each (n, 4, 18)."""
        still, t = np.zeros_like(self.trajectory.pose), self.trajectory
        motions = (still, still), (still, t.acceleration), (t.velocity, still)
        gravities = (self.gravity, 0.0, 0.0)
        found = []
        for (velocity, acceleration), gravity in zip(motions, gravities, strict=True):
            y = torque_regressor(
                self.geometry, t.pose, velocity, acceleration, self.assembly,
                gravity=gravity, misprints=self.misprints,
            )  # fmt: skip
            if gravity == 0.0:
                y[..., :3] = 0.0  # the weights M_p
            y[~self.check.good] = np.nan
            found.append(y)
        return found[0], found[1], found[2]

    @cached_property
    def actuators(self) -> Array:
        """Actuator positions without jumps of a full turn, (n, 4) [rad, rad, rad, m]."""
        posture = solve_posture(self.geometry, self.trajectory.pose, self.assembly)
        positions = posture.actuators.copy()
        positions[:, :3] = np.unwrap(positions[:, :3], axis=0)
        positions[~self.check.good] = np.nan
        return positions

    def serves(
        self, geometry: Geometry, trajectory: Trajectory, assembly: Assembly, misprints: Misprint
    ) -> bool:
        """Whether this is what `solve_trajectory` would return for these."""
        return (
            self.trajectory is trajectory
            and self.assembly is assembly
            and self.misprints == misprints
            and self.geometry == geometry
        )


def solve_trajectory(
    geometry: Geometry,
    trajectory: Trajectory,
    assembly: Assembly = Assembly.PRINTED,
    *,
    gravity: float = 9.81,
    misprints: Misprint = Misprint.NONE,
    clearance: float = SINGULAR_CLEARANCE,
) -> SolvedTrajectory:
    """Solve what depends on the geometry and the motion alone; raises nothing for a failing path.

    Args:
        geometry: Lengths and limits.
        trajectory: The motion.
        assembly: Root of the knee.
        gravity: Gravitational acceleration [m/s^2].
        misprints: Formulae to take as printed.
        clearance: See `check_path`.
    """
    check = check_path(geometry, trajectory, clearance)
    y = torque_regressor(
        geometry, trajectory.pose, trajectory.velocity, trajectory.acceleration, assembly,
        gravity=gravity, misprints=misprints,
    )  # fmt: skip
    speed = np.einsum(
        "nij,nj->ni", inverse_jacobian(geometry, trajectory.pose), trajectory.velocity
    )
    unsolved = ~np.all(np.isfinite(y), axis=(1, 2)) & check.good
    if np.any(unsolved):
        check = _with_unsolved(check, trajectory, unsolved)
    if not check.ok:
        y[~check.good] = np.nan
        speed[~check.good] = np.nan
    return SolvedTrajectory(geometry, trajectory, assembly, misprints, gravity, check, y, speed)


def _with_unsolved(
    check: PathCheck, trajectory: Trajectory, unsolved: NDArray[np.bool_]
) -> PathCheck:
    """Mark samples that lie within rounding of a limit, where no torque can be worked out."""
    status = np.where(unsolved, np.uint8(Limit.SINGULAR), check.status)
    index = int(np.argmax(unsolved))
    first = check.first
    if first is None or trajectory.t[index] < first.t:
        pose = tuple(float(value) for value in trajectory.pose[index])
        first = PathEvent(float(trajectory.t[index]), Limit.SINGULAR, -1, 0.0, pose)
    return replace(check, status=status, first=first, until=min(check.until, index))
