"""The robot with elastic drives alone: bars, joints and guides rigid, motors locked.

With the drives' stiffness k_j and the torques tau_j that hold the robot in the pose, the stiffness
in (x, y, theta, z) is

    K = G^T k G - sum_j tau_j d2q_j/dX2 + d2V/dX2 - dw/dX,

the second derivative of the potential of weight, springs and load w. G is the inverse Jacobian, so
that the first term is that of an unloaded robot. The second derivatives of the knees' heights come
from complex steps and are exact to rounding. The motors stand still, so that their inertia has no
part in the mass matrix; it is the model's for the robot without drives.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.modes import Modes, natural_modes
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.jacobians import inverse_jacobian, inverse_jacobian_rate
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.leg import Mechanism, knee_height, leg_vector, mechanism, pantograph
from paminsa_viz.model.load import LoadCase, LoadFrame, center_wrench, wrench_at_center
from paminsa_viz.model.reach import Limit, check_reach
from paminsa_viz.model.statics import static_imbalance, static_torques

STEP = 1e-30
"""Imaginary step of the derivatives [m, rad]."""

POSE_AXES = [0, 1, 5, 2]
"""Where the pose's (x, y, theta, z) are in a wrench or the platform's twist."""


def drive_matrix(design: Design) -> Array:
    """Return the stiffness of the drives M1..M4 as a diagonal matrix, (4, 4) [N m/rad, N/m]."""
    elastic = design.elastic
    return np.diag([elastic.drive_rotary] * 3 + [elastic.drive_linear])


@of_design
def drive_stiffness(design: Design, pose: ArrayLike, *, loaded: bool = True) -> Array:
    """Return K of the drives alone in (x, y, theta, z), (..., 4, 4) [N/m, N, N m/rad].

    Args:
        design: The robot with its drives' stiffness.
        pose: (..., 4) [m, m, rad, m].
        loaded: Whether weight, payload and load count. A load that turns with the platform makes K
            unsymmetric, as it has no potential.

    Returns:
        NaN where the pose cannot be reached; with loads also where it is singular.
    """
    pose = as_vectors(pose, "pose")
    g = inverse_jacobian(design.geometry, pose)
    k = np.swapaxes(g, -1, -2) @ drive_matrix(design) @ g
    if loaded:
        torque = static_torques(design, pose)
        for column in range(4):
            direction = np.zeros(4)
            direction[column] = 1.0
            change = inverse_jacobian_rate(design.geometry, pose, direction)
            k[..., :, column] -= np.einsum("...j,...ji->...i", torque, change)
        k += gravity_stiffness(design, pose) - _load_rate(design, pose)
    reached = np.asarray(check_reach(design.geometry, pose).status) == Limit.OK
    return np.where(reached[..., None, None], k, np.nan)


@np.errstate(all="ignore")
def gravity_stiffness(design: Design, pose: ArrayLike) -> Array:
    """Return d2V/dX2 of the weight in (x, y, theta, z), (..., 4, 4) [N/m, N, N m].

    The energy depends on a pose through z and the knees' heights; z alone is linear.
    """
    pose = as_vectors(pose, "pose")
    found = np.empty((*pose.shape, 4))
    for column in range(4):
        moved = pose.astype(np.complex128)
        moved[..., column] += 1j * STEP
        found[..., column] = np.imag(_knee_gradient(design, moved)) / STEP
    return static_imbalance(design) * found


def _knee_gradient(design: Design, pose: Any) -> Any:
    """Return the derivatives of the sum of the knees' heights by x, y, theta and z."""
    m = mechanism(design.geometry)
    x, y, theta, z = np.moveaxis(pose, -1, 0)[..., None]
    v = leg_vector(m, LEG_AXES[:, 0], LEG_AXES[:, 1], x, y, np.cos(theta), np.sin(theta))
    zeta = z + m.joint_height
    _, slope, lift = knee_height(m, pantograph(m, v.rho2, zeta), zeta)
    parts = (slope * v.dx, slope * v.dy, slope * (v.px * v.dy - v.py * v.dx), lift)
    return np.stack([part.sum(axis=-1) for part in parts], axis=-1)


@np.errstate(all="ignore")
def _load_rate(design: Design, pose: Array) -> Array:
    """Return dw/dX of the load, (..., 4, 4): theta turns its point, and its force if it follows."""
    load = design.load
    theta = pose[..., 2] + 1j * STEP
    arguments: Any = (*load.wrench, *load.point, load.turns, np.cos(theta), np.sin(theta))
    wrench = wrench_at_center(*arguments)
    found = np.zeros((*pose.shape, 4))
    for row, part in enumerate(POSE_AXES):
        found[..., row, 2] = np.imag(wrench[part]) / STEP
    return found


@of_design
@np.errstate(all="ignore")
def drive_modes(design: Design, pose: ArrayLike) -> Modes:
    """Return frequencies and modes of the robot whose drives alone are elastic, held at rest.

    Shapes are in (x, y, theta, z). NaN where a pose cannot be taken, is singular, or where weight
    or load push the platform away harder than the drives hold it. A load that turns with the
    platform has no potential; the symmetric part of its stiffness counts.

    Args:
        design: The robot with its drives' stiffness.
        pose: (..., 4) [m, m, rad, m].
    """
    stiffness = _symmetric(drive_stiffness(design, pose))
    return natural_modes(stiffness, mass_matrix(replace(design, drives=NO_DRIVES), pose))


@np.errstate(all="ignore")
def geometric_stiffness(design: Design, pose: ArrayLike) -> Array:
    """Return what weight, payload and load add to the stiffness, (..., 6, 6) [N/m, N, N m/rad].

    For the platform's twist at P, symmetric. In (x, y, theta, z) it is what `drive_stiffness` has
    of them. In tilt, where bars have to bend, each leg's pantograph keeps its shape and its joint 2
    gives way in height. Not finite where a pose cannot be taken or is singular.

    With the energy E_k = V_k - tau_k theta_k of leg k, which is a function of the place of its
    joint 5, the legs add sum G^T (d2E_k) G for the motion G of joints 5, and, as these move on
    circles, their forces F_k on the platform at p_k the same as a load's (`load_tilt_stiffness`).
    """
    pose = as_vectors(pose, "pose")
    frame, payload = leg_frame(design.geometry, pose), design.payload
    force, second = _leg_energy(design, frame)
    found = np.einsum(
        "...kai,...kab,...kbj->...ij", frame.joint5_map, second, frame.joint5_map, optimize=True
    )
    load = center_wrench(design.load, pose[..., 2])
    # sum F_k p_k^T: of the vertical forces only what equilibrium of force and tilt says is needed
    inside = np.zeros((*pose.shape[:-1], 3, 3))
    inside[..., :2, :2] = np.einsum("...ki,...kj->...ij", force, frame.platform[..., :2])
    height = design.geometry.platform_joint_height
    weight = (design.platform.mass + payload.mass) * design.gravity
    inside[..., :2, 2] = -height * load[..., :2]
    inside[..., 2, 2] = height * (weight - load[..., 2])
    inside[..., 2, 0] = load[..., 4] - height * load[..., 0]
    inside[..., 2, 1] = -load[..., 3] - height * load[..., 1]
    trace = np.trace(inside, axis1=-2, axis2=-1)[..., None, None]
    found[..., 3:, 3:] += trace * np.eye(3) - inside
    found[(..., *np.ix_(POSE_AXES, POSE_AXES))] -= _load_rate(design, pose)
    # A tilt lowers a center above P, and lifts one below it.
    found[..., [3, 4], [3, 4]] -= payload.mass * design.gravity * payload.height
    return _symmetric(found) + load_tilt_stiffness(design.load, pose[..., 2])


def _leg_energy(design: Design, frame: LegFrame) -> tuple[Array, Array]:
    """Return the horizontal forces of the legs on the platform, and d2E_k by joint 5.

    Returns:
        (..., 3 legs, 2) in base axes [N], and (..., 3 legs, 3, 3) in leg frames [N/m].
    """
    m, imbalance = mechanism(design.geometry), static_imbalance(design)
    zeta = frame.pose[..., 3:] + m.joint_height
    torque, rho = static_torques(design, frame.pose)[..., :3], frame.rho
    pull = imbalance * _knee_slopes(m, rho, zeta)[0]
    turn = torque / rho
    second = np.zeros((*rho.shape, 3, 3))
    for row, step in ((0, (1j * STEP, 0.0)), (2, (0.0, 1j * STEP))):
        slopes = _knee_slopes(m, rho + step[0], zeta + step[1])
        second[..., row, 0], second[..., row, 2] = imbalance * np.imag(slopes) / STEP
    # d2 theta_k / du dw = -1/rho^2, d2 rho / dw2 = 1/rho
    second[..., 0, 1] = second[..., 1, 0] = turn / rho
    second[..., 1, 1] = pull / rho
    u, w = frame.axes[..., 0, :2], frame.axes[..., 1, :2]
    return turn[..., None] * w - pull[..., None] * u, second


def _knee_slopes(m: Mechanism, rho: Any, zeta: Any) -> tuple[Any, Any]:
    """Return the derivatives of a knee's height by X_1 and z_5."""
    _, by_rho, by_zeta = knee_height(m, pantograph(m, rho * rho, zeta), zeta)
    return rho * by_rho, by_zeta


@np.errstate(all="ignore")
def load_tilt_stiffness(load: LoadCase, theta: ArrayLike) -> Array:
    """Return what a load adds to the stiffness where the platform tilts, (..., 6, 6) [N, N m/rad].

    Symmetric, as `geometric_stiffness`, which has the rest: with a force F at the point r that
    keeps its direction, V = -F.(R r) for the rotation R. Of a load that turns with the platform the
    symmetric part counts. Angles (...) [rad].
    """
    force = center_wrench(load, theta)[..., :3]
    found = np.zeros((*force.shape[:-1], 6, 6))
    if load.frame is LoadFrame.PLATFORM:
        found[..., :3, 3:] = np.cross(np.eye(3), force[..., None, :])  # -d(phi x F)/d(phi)
    else:
        c, s = np.cos(theta), np.sin(theta)
        x, y, z = load.point
        r = np.stack(np.broadcast_arrays(c * x - s * y, s * x + c * y, z), axis=-1)
        along = np.sum(r * force, axis=-1)[..., None, None]
        found[..., 3:, 3:] = along * np.eye(3) - r[..., :, None] * force[..., None, :]
    found[(..., *np.ix_(POSE_AXES, POSE_AXES))] = 0.0
    return 0.5 * (found + np.swapaxes(found, -1, -2))


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + np.swapaxes(matrix, -1, -2))
