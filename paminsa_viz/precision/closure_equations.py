"""The nine equations that three legs and the platform fulfill, and all their derivatives.

Joint 5 of leg k is at e_k + r_5 u(beta_k) + z_5 z, where r_5 and z_5 follow from the lift Z and the
place s_k of the slider (`leg_plane`), beta_k from theta_k and the zero of M_k. The platform has it
at P + R c_k with R = R_z(theta) exp(tilt), tilt = (t_x, t_y, 0) in the platform's axes; P lies l_B5
below the joints 5.

A state is (x, y, theta, z, t_x, t_y, s_1..s_3, theta_1..theta_3, Z).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematics import HEADINGS
from paminsa_viz.precision.leg_lengths import INDEX
from paminsa_viz.precision.leg_plane import (
    PLANE_COLUMN,
    PLANE_INPUTS,
    joint_5_derivatives,
    left,
    solve_leg,
)

STATE = 13
"""Numbers of a state."""

SLIDES = slice(6, 9)
ACTUATORS = slice(9, 13)
"""Places of sliders and actuators in a state."""


class ClosureEquations(NamedTuple):
    """Gaps and derivatives at n states."""

    gap: Array  # (n, 9) joint 5 of the legs minus that of the platform [m]
    by_state: Array  # (n, 9, 13)
    by_length: Array  # (n, 3 legs, 3 axes, 14): each leg's own three equations


@np.errstate(all="ignore")
def closure_equations(lengths: Array, state: Array, root: float) -> ClosureEquations:
    """Return the nine equations at states (n, 13) of legs (n, 3, 14); NaN where bars cannot close.

    ``root`` is the branch of the knee, `KneeBranch.sign`.
    """
    n = len(state)
    length = {name: lengths[..., index, None] for name, index in INDEX.items()}
    plane = solve_leg(lengths, state[:, SLIDES], state[:, 12:13], root)
    radial = _horizontal(state[:, 9:12] + HEADINGS + lengths[..., INDEX["actuator_zero"]])
    outward = _horizontal(lengths[..., INDEX["axis_angle"]])
    inner = _horizontal(lengths[..., INDEX["joint_angle"]])  # c_k's direction in the platform
    joint = length["joint_radius"] * inner + length["joint_height"] * _UP
    turn, right = _turns(state[:, 2], state[:, 4:6])
    back = np.swapaxes(turn, -1, -2)
    held = joint @ back  # R c_k
    own = length["axis_radius"] * outward
    own = own + plane.joint_5[..., :1] * radial + plane.joint_5[..., 1:] * _UP
    center = state[:, None, [0, 1, 3]]

    in_plane = joint_5_derivatives(lengths, plane)
    moved = radial[..., None] * in_plane[..., :1, :] + _UP[:, None] * in_plane[..., 1:, :]
    around = plane.joint_5[..., :1] * left(radial)
    by_state = np.zeros((n, 3, 3, STATE))
    by_state[..., 0, 0] = by_state[..., 1, 1] = by_state[..., 2, 3] = -1.0
    by_state[..., 2] = -left(held)
    # d(R c) = R (J_r dt x c) = -R [c]x J_r dt
    tilted = turn[:, None] @ _cross_matrix(joint) @ right[:, None]
    by_state[..., 4:6] = tilted[..., :2]
    for leg in range(3):
        by_state[:, leg, :, 6 + leg] = moved[:, leg, :, PLANE_COLUMN["slide"]]
        by_state[:, leg, :, 9 + leg] = around[:, leg]
    by_state[..., 12] = moved[..., PLANE_COLUMN["lift"]]

    by_length = np.zeros((n, 3, 3, len(INDEX)))
    for name in _OF_PLANE:
        by_length[..., INDEX[name]] = moved[..., PLANE_COLUMN[name]]
    by_length[..., INDEX["joint_height"]] = -turn[:, None, :, 2]
    by_length[..., INDEX["axis_radius"]] = outward
    by_length[..., INDEX["axis_angle"]] = length["axis_radius"] * left(outward)
    by_length[..., INDEX["joint_radius"]] = -(inner @ back)
    by_length[..., INDEX["joint_angle"]] = -length["joint_radius"] * (left(inner) @ back)
    by_length[..., INDEX["actuator_zero"]] = around
    gap = (own - center - held).reshape(n, 9)
    return ClosureEquations(gap, by_state.reshape(n, 9, STATE), by_length)


_UP = np.array([0.0, 0.0, 1.0])
_OF_PLANE = tuple(name for name in PLANE_INPUTS if name in INDEX)


def _horizontal(angle: Array) -> Array:
    found = np.zeros((*angle.shape, 3))
    found[..., 0], found[..., 1] = np.cos(angle), np.sin(angle)
    return found


def _cross_matrix(vector: Array) -> Array:
    matrix = np.zeros((*vector.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = np.moveaxis(vector, -1, 0)
    matrix[..., 1, 2], matrix[..., 2, 0], matrix[..., 0, 1] = np.moveaxis(-vector, -1, 0)
    return matrix


def _turns(theta: Array, tilt: Array) -> tuple[Array, Array]:
    """Return R = R_z(theta) exp(tilt), and J_r with exp(t + dt) = exp(t) exp(J_r dt), (n, 3, 3)."""
    about_z = np.zeros((len(theta), 3, 3))
    about_z[:, 0, 0] = about_z[:, 1, 1] = np.cos(theta)
    about_z[:, 1, 0] = np.sin(theta)
    about_z[:, 0, 1] = -about_z[:, 1, 0]
    about_z[:, 2, 2] = 1.0
    vector = np.zeros((len(theta), 3))
    vector[:, :2] = tilt
    matrix = _cross_matrix(vector)
    size = np.hypot(tilt[:, 0], tilt[:, 1])[:, None, None]
    half = np.sinc(0.5 * size / np.pi)
    turn = about_z @ (np.eye(3) + np.sinc(size / np.pi) * matrix + 0.5 * half**2 * matrix @ matrix)
    square = size**2
    series = 1 / 6 - square / 120 + square**2 / 5040
    exact = (size - np.sin(size)) / np.where(size > 0, size**3, 1.0)
    right = (
        np.eye(3)
        - 0.5 * half**2 * matrix
        + np.where(size < 0.01, series, exact) * (matrix @ matrix)
    )
    return turn, right
