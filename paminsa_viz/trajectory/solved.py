"""Results of geometry and motion alone: the path's check, the actuators' speeds, Y.

It is solved once. A change of masses, of gravity or of friction is then one product Q = Y c.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arguments import geometry_of, of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.dynamics import TorqueBreakdown, friction_torque
from paminsa_viz.model.jacobians import actuator_acceleration, inverse_jacobian, jacobian
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.load import generalized_force
from paminsa_viz.model.lumped import Misprint, lumped_coefficients
from paminsa_viz.model.parameters import ActuatorFriction
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.regressor import regressor_torques, torque_regressor
from paminsa_viz.trajectory.check import PathCheck, PathEvent, check_path, singular_clearance
from paminsa_viz.trajectory.sampled import Trajectory

_WEIGHTS = slice(0, 3)  # places of M_p1..3 among the lumped coefficients


@dataclass(frozen=True, eq=False)
class SolvedTrajectory:
    """A motion of n samples solved for a geometry, for any masses.

    Attributes:
        geometry: The lengths.
        trajectory: The motion.
        misprints: Misprints of the paper to reproduce.
        gravity: Gravitational acceleration that Y was made with [m/s^2].
        clearance: Least distance from type-2 singular positions that was checked [m].
        check: Where and why it fails, if it does.
        y: (n, 4, 18) regressor; NaN at samples whose status is not OK.
        speed: (n, 4) of the actuators [rad/s, m/s]; NaN there as well.
    """

    geometry: Geometry
    trajectory: Trajectory
    misprints: Misprint
    gravity: float
    clearance: float
    check: PathCheck
    y: Array
    speed: Array

    @kinds_checked
    def torques(self, design: Design, *, friction: bool = True) -> Array:
        """Return the actuator torques for a design of this geometry, (n, 4) [N m, N]."""
        torque = self._mass_torques(design)
        if friction and not design.actuator_friction.zero:
            torque += self.friction(design)
        if self.loaded(design):
            torque += self.load_torques(design)
        return torque

    def _mass_torques(self, design: Design) -> Array:
        """Return the torques of masses and weights, (n, 4) [N m, N]."""
        torque = regressor_torques(self.y, lumped_coefficients(design, self.misprints))
        if design.gravity != self.gravity:  # the legs' weights are in c, the platform's in Y
            mass = design.platform.mass + design.payload.mass
            torque[:, 3] += self.geometry.magnification * (design.gravity - self.gravity) * mass
        if any(design.drive_inertia):
            torque += self.drive_inertia_torque(design)
        return torque

    @kinds_checked
    def drive_inertia_torque(self, design: Design) -> Array:
        """Return what accelerates the drives' own inertia, (n, 4) [N m, N]."""
        return np.array(design.drive_inertia) * self.actuator_acceleration

    @cached_property
    def actuator_acceleration(self) -> Array:
        """Acceleration of the actuators, (n, 4) [rad/s^2, m/s^2]; NaN where the motion fails."""
        t = self.trajectory
        found = actuator_acceleration(self.geometry, t.pose, t.velocity, t.acceleration)
        found[~self.check.ok] = np.nan
        return found

    @kinds_checked
    def loaded(self, design: Design) -> bool:
        """Whether a load acts on the platform: the design's or the motion's own."""
        return design.load.acts or self.trajectory.load is not None

    @kinds_checked
    def load_torques(self, design: Design) -> Array:
        """Return what the actuators need against the load, (n, 4) [N m, N]."""
        w = self.load_force(design)
        torque = -np.einsum("nij,ni->nj", self.jacobian, w)
        torque[~self.check.ok] = np.nan
        return torque

    @kinds_checked
    def load_force(self, design: Design) -> Array:
        """Return the load's force in the coordinates (x, y, theta, z), (n, 4) [N, N, N m, N]."""
        t = self.trajectory
        return generalized_force(design.load, t.pose[:, 2], t.load)

    @cached_property
    def jacobian(self) -> Array:
        """J along the motion, (n, 4, 4); solved for the first load and kept."""
        return jacobian(self.geometry, self.trajectory.pose)

    @kinds_checked
    def friction(self, design: Design) -> Array:
        """Return the friction torques, (n, 4) [N m, N]; those of the last friction are kept."""
        friction = design.actuator_friction
        if friction not in self._friction:
            self._friction.clear()
            self._friction[friction] = friction_torque(friction, self.speed)
            self._friction[friction].setflags(write=False)
        return self._friction[friction]

    @cached_property
    def _friction(self) -> dict[ActuatorFriction, Array]:
        return {}

    @cached_property
    def inertial(self) -> Array:
        """Regressor of what the acceleration alone adds in a world without gravity, (n, 4, 18)."""
        t = self.trajectory
        y = torque_regressor(
            self.geometry, t.pose, np.zeros_like(t.pose), t.acceleration,
            gravity=0.0, misprints=self.misprints,
        )  # fmt: skip
        y[..., _WEIGHTS] = 0.0
        y[~self.check.ok] = np.nan
        return y

    @kinds_checked
    def breakdown(self, design: Design) -> TorqueBreakdown:
        """Return the torques' parts for a design of this geometry, each (n, 4) [N m, N].

        The weights M_p have columns of Y to themselves, so gravity's part needs no other Y, and
        what remains after it and the inertial part is the velocity's.
        """
        c = lumped_coefficients(design, self.misprints)
        gravity = np.einsum("nji,i->nj", self.y[..., _WEIGHTS], c[_WEIGHTS])
        mass = design.platform.mass + design.payload.mass
        gravity[:, 3] += self.geometry.magnification * design.gravity * mass
        inertial = regressor_torques(self.inertial, c)
        if any(design.drive_inertia):
            still = np.zeros_like(self.trajectory.velocity)
            growth = actuator_acceleration(
                self.geometry, self.trajectory.pose, still, self.trajectory.acceleration
            )
            inertial = inertial + np.array(design.drive_inertia) * growth
        velocity = self._mass_torques(design) - gravity - inertial
        friction = np.array(self.friction(design))
        loads = self.load_torques(design) if self.loaded(design) else np.zeros_like(gravity)
        return TorqueBreakdown(gravity, inertial, velocity, friction, loads)

    @cached_property
    def actuators(self) -> Array:
        """Actuator positions without jumps of a full turn, (n, 4) [rad, rad, rad, m]."""
        configuration = inverse_kinematics(self.geometry, self.trajectory.pose)
        positions = configuration.actuators.copy()
        positions[:, :3] = np.unwrap(positions[:, :3], axis=0)
        positions[~self.check.ok] = np.nan
        return positions

    def serves(
        self,
        geometry: Geometry | Design,
        trajectory: Trajectory,
        misprints: Misprint,
        clearance: float | None = None,
    ) -> bool:
        """Whether this is what `solve_trajectory` would return for these."""
        clearance = singular_clearance(geometry) if clearance is None else clearance
        return (
            self.trajectory is trajectory
            and self.misprints == misprints
            and self.clearance == clearance
            and self.geometry == geometry_of(geometry)
        )


@of_geometry
def solve_trajectory(
    geometry: Geometry,
    trajectory: Trajectory,
    *,
    gravity: float = 9.81,
    misprints: Misprint = Misprint.NONE,
    clearance: float | None = None,
) -> SolvedTrajectory:
    """Solve what depends on the geometry and the motion alone; raises nothing for a failing path.

    Args:
        geometry: Lengths and limits.
        trajectory: The motion.
        gravity: Gravitational acceleration [m/s^2].
        misprints: Misprints of the paper to reproduce.
        clearance: See `check_path`.

    Raises:
        InvalidInput: If gravity or clearance is not possible.
    """
    clearance = singular_clearance(geometry) if clearance is None else clearance
    check = check_path(geometry, trajectory, clearance)
    y = torque_regressor(
        geometry, trajectory.pose, trajectory.velocity, trajectory.acceleration,
        gravity=gravity, misprints=misprints,
    )  # fmt: skip
    speed = np.einsum(
        "nij,nj->ni", inverse_jacobian(geometry, trajectory.pose), trajectory.velocity
    )
    unsolved = ~np.all(np.isfinite(y), axis=(1, 2)) & check.ok
    if np.any(unsolved):
        check = _with_unsolved(check, trajectory, unsolved)
    if not check.possible:
        y[~check.ok] = np.nan
        speed[~check.ok] = np.nan
    return SolvedTrajectory(geometry, trajectory, misprints, gravity, clearance, check, y, speed)


def _with_unsolved(
    check: PathCheck, trajectory: Trajectory, unsolved: NDArray[np.bool_]
) -> PathCheck:
    """Mark samples that lie within rounding of a limit, where no torque can be computed."""
    status = np.where(unsolved, np.uint8(Limit.SINGULAR), check.status)
    index = int(np.argmax(unsolved))
    first = check.first
    if first is None or trajectory.t[index] < first.t:
        pose = tuple(float(value) for value in trajectory.pose[index])
        first = PathEvent(float(trajectory.t[index]), Limit.SINGULAR, -1, 0.0, pose)
    return replace(check, status=status, first=first, until=min(check.until, index))
