"""What the actuators' limits let the platform hold, and how fast it can go: capability of a pose.

With |tau_j| <= T_j and the static torques tau_0 that hold the robot and its load, the external
wrenches w = (F_x, F_y, M_z) that can be held on top are those with |tau_0 - J^T w| <= T: the wrench
polytope, a parallelepiped since J is square (Firmani, Zibil, Nokleby and Podhorodeski,
Robotica 26 (2008) 791). F_z meets M4 alone. The force that the platform exerts on its surroundings
is the opposite of what it holds. Horizontal moments load the bearings, and no actuator limits them.

Limits are those of the design's drives: the rated torque for what is held continuously, the peak
torque for acceleration, the top speed; where a drive does not limit, `DEFAULT_LIMITS`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model import backend
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, own_vectors
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import OutputLimits
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.kinematic_formulas import speed_rows
from paminsa_viz.model.leg import LegVector, Mechanism, leg_vector, mechanism
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.robot import (
    AXIS_X,
    AXIS_Y,
    TangentialForces,
    platform_determinant,
    solve_wrench,
)
from paminsa_viz.model.statics import static_torques

# ----------------------------------------------------------------- transmission of motion and force
# The functions are plain formulas of a pose, see `model/leg.py` for notation.
#
# The force that leg k passes to the platform is horizontal, across its plane, along w_k in joint 5.
# With the other actuators locked the platform moves along column k of J, and joint 5 with it at
# v_5k. The power coefficient of force and motion, over the largest that force and speed could have,
# is the output transmission index |w_k . v_5k| / |v_5k| = cos(pressure angle) of Wang, Wu and Liu
# (Mech. Mach. Theory 45 (2010) 1462). The input index of a leg is 1, as its actuator turns its
# plane and so moves joint 5 along w_k, and so are both of M4, whose pantographs magnify by k
# everywhere.


def _transmission(v: LegVector, along_x: Any, along_y: Any, turning: Any) -> Any:
    """Return the index of a leg [1]: rho_k over |v_5k| for a unit speed of M_k; not in the paper.

    ``along_x``, ``along_y``, ``turning`` times rho_k^2 are its column of J [m/rad, m/rad, 1].
    """
    vx = (along_x - turning * v.py) * v.rho2
    vy = (along_y + turning * v.px) * v.rho2
    return np.sqrt(v.rho2 / (vx * vx + vy * vy))


def transmission_indices(
    m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any
) -> tuple[Any, Any, Any]:
    """Return the output transmission index of the three legs, cosines of the pressure angles [1].

    1 where force and motion of joint 5 are parallel, 0 at a type-2 singularity. Not in the paper,
    but of Wang, Wu and Liu (Mech. Mach. Theory 45 (2010) 1462). Arguments are the platform's
    position [m], cos and sin theta.
    """
    v1 = leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s)
    v2 = leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s)
    v3 = leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s)
    det = platform_determinant(m, x, y, c)
    jx: TangentialForces = solve_wrench(det, v1, v2, v3, 1.0, 0.0, 0.0)
    jy: TangentialForces = solve_wrench(det, v1, v2, v3, 0.0, 1.0, 0.0)
    jt: TangentialForces = solve_wrench(det, v1, v2, v3, 0.0, 0.0, 1.0)
    return (
        _transmission(v1, jx.t1, jy.t1, jt.t1),
        _transmission(v2, jx.t2, jy.t2, jt.t2),
        _transmission(v3, jx.t3, jy.t3, jt.t3),
    )


TRANSMISSION = Formula(transmission_indices, 3)
"""Transmission index of the three legs."""

SPEED_ROWS = Formula(speed_rows, 9)
"""Rows of J^-1 for M1..M3, see `speed_rows`."""


# ----------------------------------------------------------------- what the actuators' limits allow

DEFAULT_LIMITS: tuple[OutputLimits, ...] = (
    *(OutputLimits(peak=20.0, rated=20.0, speed=3.0),) * 3,
    OutputLimits(peak=1000.0, rated=1000.0, speed=0.25),
)
"""Limits of an actuator that no drive limits: 20 N m and 3 rad/s of M1..M3, 1000 N and 0.25 m/s of
M4. Not those of a product: the presets' motions require at most 5.5 N m, 2.7 rad/s, 290 N and 0.16
m/s of Appendix 4's robot."""


class ActuatorLimits(NamedTuple):
    """Limits at the actuators M1..M4, each (4,).

    Attributes:
        rated: Continuous torques and force [N m, N].
        peak: Torques and force for a short time [N m, N].
        speed: Speeds [rad/s, m/s].
    """

    rated: Array
    peak: Array
    speed: Array


@of_design
def actuator_limits(design: Design) -> ActuatorLimits:
    """Return the limits of a design's drives, those of `DEFAULT_LIMITS` where they have none.

    A drive with a peak and no rated torque is held to its peak continuously, and the reverse.
    """
    rated, peak, speed = [], [], []
    for own, default in zip(design.output_limits, DEFAULT_LIMITS, strict=True):
        high = own.peak if math.isfinite(own.peak) else max(own.rated, 0.0)
        high = high if math.isfinite(high) else default.peak
        low = min(own.rated, high)
        rated.append(low)
        peak.append(high)
        speed.append(own.speed if math.isfinite(own.speed) else default.speed)
    return ActuatorLimits(np.array(rated), np.array(peak), np.array(speed))


@dataclass(frozen=True, eq=False)
class Capability:
    """Capability at poses of batch shape (...); NaN where a pose cannot be taken.

    Attributes:
        design: The robot.
        limits: Limits of its actuators.
        pose: (..., 4) [m, m, rad, m].
        torque: (4, ...) static torques, the design's load included [N m, N].
        rows: (3, 3, ...) J for (x, y, theta) and M1..M3 [m, m, 1].
        speeds: (3, 3, ...) J^-1 for M1..M3 and (x, y, theta) [1/m, 1/m, 1].
    """

    design: Design
    limits: ActuatorLimits
    pose: Array
    torque: Array
    rows: Array
    speeds: Array

    @property
    def room(self) -> Array:
        """What is left of the rated torques, T_j - |tau_0j|, (4, ...) [N m, N]; negative beyond."""
        return _column(self.limits.rated, self.torque) - np.abs(self.torque)

    @property
    def payload(self) -> Array:
        """Largest payload that can be held at rest (...) [kg]; zero where M1..M3 cannot hold.

        A payload on the platform's axis loads M4 alone, by k m g; what the design carries counts.
        """
        lift = self.limits.rated[3] - self.torque[3]
        weight = self.design.geometry.magnification * self.design.gravity
        with np.errstate(divide="ignore", invalid="ignore"):
            mass = self.design.payload.mass + np.divide(lift, weight)
        held = (self.room[:3] >= 0).all(axis=0)
        return self._masked(np.where(held, np.maximum(mass, 0.0), 0.0))

    @property
    def horizontal_force(self) -> Array:
        """Guaranteed horizontal force (...) [N]: held in every direction, with M_z = 0.

        The radius of the largest disc about zero inside the polytope's section M_z = 0,
        min_j (T_j - |tau_0j|) / |(J_xj, J_yj)|; zero where the robot cannot hold itself.
        """
        return self._held(_least(self.room[:3], np.hypot(self.rows[0], self.rows[1])))

    @property
    def horizontal_limit(self) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
        """Index of the actuator that limits it (...), and the sign of its torque there."""
        with np.errstate(all="ignore"):
            index = np.argmin(
                np.nan_to_num(self.room[:3] / np.hypot(self.rows[0], self.rows[1]), nan=np.inf),
                axis=0,
            )
        torque = np.take_along_axis(self.torque, index[None], axis=0)[0]
        return index, np.where(torque < 0, -1, 1)

    @property
    def vertical_force(self) -> Array:
        """Largest vertical force that is held both upward and downward (...) [N].

        (T_4 - |F_4|) / k; zero where the robot cannot hold itself.
        """
        return self._held(self.room[3] / self.design.geometry.magnification)

    @property
    def moment(self) -> Array:
        """Largest vertical moment that is held in both directions, no force (...) [N m].

        Zero where the robot cannot hold itself.
        """
        return self._held(_least(self.room[:3], np.abs(self.rows[2])))

    @property
    def speed(self) -> Array:
        """Guaranteed speed of the platform in every direction of space, without turning [m/s].

        min over M1..M3 of W_j / |(row j of J^-1)_xy|, and k W_4 (...).
        """
        rotary = _least(
            _column(self.limits.speed[:3], self.pose),
            np.hypot(self.speeds[:, 0], self.speeds[:, 1]),
        )
        vertical = self.design.geometry.magnification * self.limits.speed[3]
        return self._masked(np.minimum(rotary, vertical))

    @property
    def turn_speed(self) -> Array:
        """Largest angular speed about the center, min_j W_j / |J^-1_j,theta| (...) [rad/s]."""
        return self._masked(
            _least(_column(self.limits.speed[:3], self.pose), np.abs(self.speeds[:, 2]))
        )

    @cached_property
    def inertia(self) -> Array:
        """J^T M (..., 4, 4): torques for unit accelerations of the platform from rest.

        Inertias of the drives included.
        """
        matrix = mass_matrix(self.design, self.pose)
        turned = np.empty_like(matrix)
        j = np.moveaxis(self.rows, (0, 1), (-2, -1))
        with np.errstate(all="ignore"):
            turned[..., :3, :] = np.swapaxes(j, -1, -2) @ matrix[..., :3, :]
        turned[..., 3, :] = self.design.geometry.magnification * matrix[..., 3, :]
        return turned

    @property
    def _peak_room(self) -> Array:
        return np.moveaxis(_column(self.limits.peak, self.torque) - np.abs(self.torque), 0, -1)

    @property
    def acceleration(self) -> Array:
        """Guaranteed acceleration in every direction of space, from rest, without turning [m/s^2].

        min_j (peak T_j - |tau_0j|) / |(row j of J^T M)_xyz| (...); zero where the robot cannot
        hold itself. Friction at rest is not counted.
        """
        size = np.linalg.norm(self.inertia[..., [0, 1, 3]], axis=-1)
        return self._masked(np.maximum(_least(self._peak_room, size, axis=-1), 0.0))

    @property
    def turn_acceleration(self) -> Array:
        """Largest angular acceleration from rest, the center at rest (...) [rad/s^2]."""
        size = np.abs(self.inertia[..., 2])
        return self._masked(np.maximum(_least(self._peak_room, size, axis=-1), 0.0))

    def _held(self, values: Array) -> Array:
        return self._masked(np.where((self.room >= 0).all(axis=0), values, 0.0))

    def _masked(self, values: Array) -> Array:
        return np.where(np.isfinite(self.torque).all(axis=0), values, np.nan)


def _column(limits: Array, like: Array) -> Array:
    """Return limits (n,) that broadcast along the first axis of (n, ...) arrays."""
    return limits.reshape(-1, *[1] * (like.ndim - 1))


def _least(room: Array, size: Array, axis: int = 0) -> Array:
    """Return the least of room / size along an axis; infinite where nothing limits."""
    with np.errstate(all="ignore"):
        return np.where(size > 0, room / size, np.where(room < 0, room, np.inf)).min(axis=axis)


@of_design
def capability(design: Design, pose: ArrayLike) -> Capability:
    """Return the capability at poses (..., 4) [m, m, rad, m]."""
    pose = own_vectors(pose, "pose")
    flat, m = pose.reshape(-1, 4), mechanism(design.geometry)
    shape = (3, 3, *pose.shape[:-1])
    return Capability(
        design,
        actuator_limits(design),
        pose,
        np.moveaxis(static_torques(design, pose), -1, 0),
        backend.over_list(WRENCH_TORQUES, m, flat).T.reshape(shape),
        backend.over_list(SPEED_ROWS, m, flat).T.reshape(shape),
    )


@kinds_checked
def field_capability(field: Field, design: Design) -> Capability:
    """Return the capability over a solved grid; formulas are solved once for a geometry."""
    shape = field.status.shape
    torque = np.where(field.status == Limit.OK, field.torques(design), np.nan)
    return Capability(
        design,
        actuator_limits(design),
        field.grid.poses(),
        torque,
        field.solve(WRENCH_TORQUES).reshape(3, 3, *shape),
        field.solve(SPEED_ROWS).reshape(3, 3, *shape),
    )
