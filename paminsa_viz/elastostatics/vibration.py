"""Natural frequencies and modes of the whole robot with locked motors.

Legs in finite elements (`leg_matrices`), carriage and platform rigid. The coordinates that the legs
share are the platform's twist at P and the carriage's height Z. What is inside the legs follows

* statically (Guyan 1965): K and M in the shared coordinates alone, from the shapes that the legs
  take when these are displaced. M has too much of it where a leg vibrates by itself.
* by one step of subspace iteration (Bathe 1996, section 11.6) from those modes: the legs then bend
  under their own inertia as well. `first_frequencies` does this.
* as its own coordinates: `whole_modes` solves all of them together.

Weight and load soften or stiffen (`geometric_stiffness`): in the platform's x, y, theta and z as
they do with rigid bars, and in its tilt, where it hangs from the joints 5.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.drive_stiffness import geometric_stiffness
from paminsa_viz.elastostatics.leg_frame import leg_frame
from paminsa_viz.elastostatics.leg_matrices import LegMatrices, leg_matrices
from paminsa_viz.elastostatics.leg_model import RETAINED
from paminsa_viz.elastostatics.modes import Modes, natural_modes
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_pose, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import check_reach

SHARED = 7
"""Shared coordinates: the platform's six, and the carriage's Z."""

BLOCK = 128
"""Poses worked on at a time; their matrices take some 15 MB."""


def platform_mass(design: Design) -> Array:
    """Return the mass matrix of platform and payload at P, (6, 6) [kg, kg m^2].

    Both are discs, with half of their inertia about x and y, unless the platform's is given.
    """
    mass = design.platform.mass + design.payload.mass
    inertia = design.platform.inertia + design.payload.inertia
    tilt = design.value("elastic.platform_tilt_inertia") + design.payload.inertia / 2
    found = np.diag([mass, mass, mass, tilt, tilt, inertia])
    above = design.payload.mass * design.payload.height
    found[[0, 4], [4, 0]] += above
    found[[1, 3], [3, 1]] -= above
    found[[3, 4], [3, 4]] += above * design.payload.height
    return found


def _join(design: Design, pose: Array, stiffness: Array, mass: Array, loaded: bool = True) -> None:
    """Add what is not in the legs to matrices of the shared coordinates (..., 7, 7)."""
    if loaded:
        stiffness[..., :6, :6] += geometric_stiffness(design, pose)
    stiffness[..., 6, 6] += design.elastic.drive_linear
    mass[..., :6, :6] += platform_mass(design)


def _to_shared(ends: Array, matrix: Array) -> Array:
    """Sum matrices of the legs' ends (n, 3, 4, 4) in the shared coordinates, (n, 7, 7)."""
    return (np.swapaxes(ends, -1, -2) @ matrix @ ends).sum(axis=1)


@dataclass(frozen=True)
class ReducedRobot:
    """The robot at n poses in its shared coordinates, and the inertia inside its legs.

    Attributes:
        stiffness, mass: Condensed statically, (n, 7, 7).
        inner: (n, 3, 4, 4) Y^T F of every leg: F the inertia of its static shapes, Y = K^-1 F how
            it bends under it with its ends held.
        inner_mass: (n, 3, 4, 4) Y^T M Y.
        ends: `LegFrame.shared_map`.
    """

    stiffness: Array
    mass: Array
    inner: Array
    inner_mass: Array
    ends: Array


def reduced_robot(matrices: LegMatrices, pose: Array) -> ReducedRobot:
    """Condense the robot at poses (n, 4) that it can take."""
    frame = leg_frame(matrices.design.geometry, pose)
    k, m = matrices.assemble(frame)
    ends, r = frame.shared_map, RETAINED
    k_in, k_side = k[..., r:, r:], k[..., r:, :r]
    m_in, m_side = m[..., r:, r:], m[..., r:, :r]
    shape = -np.linalg.solve(k_in, k_side)
    force = m_in @ shape + m_side
    bend = np.linalg.solve(k_in, force)
    own_k = k[..., :r, :r] + np.swapaxes(k_side, -1, -2) @ shape
    own_m = (
        m[..., :r, :r] + np.swapaxes(shape, -1, -2) @ force + np.swapaxes(m_side, -1, -2) @ shape
    )
    stiffness, mass = _to_shared(ends, own_k), _to_shared(ends, own_m)
    _join(matrices.design, pose, stiffness, mass)
    bent = np.swapaxes(bend, -1, -2)
    return ReducedRobot(stiffness, mass, bent @ force, bent @ m_in @ bend, ends)


def guyan_modes(robot: ReducedRobot) -> Modes:
    """Return all modes of the statically condensed robot; shapes (n, 7, 7)."""
    return natural_modes(robot.stiffness, robot.mass, SHARED)


@np.errstate(all="ignore")
def iterated_modes(robot: ReducedRobot, count: int = 1) -> Modes:
    """Return the lowest modes after a step of subspace iteration; shapes (n, 7, count)."""
    start = guyan_modes(robot)
    x = start.shapes / (2 * np.pi * start.frequencies[:, None, :])  # x^T K x = 1
    real = np.all(np.isfinite(x), axis=1)  # not those without mass
    x = np.where(real[:, None, :], x, 0.0)
    stable = np.asarray(start.ok)[:, None, None]
    firm = np.where(stable, robot.stiffness, np.eye(SHARED))
    inertia = robot.mass @ x
    y = np.linalg.solve(firm, inertia)
    x_t, y_t = np.swapaxes(x, 1, 2), np.swapaxes(y, 1, 2)
    inner = _to_shared(robot.ends, robot.inner) @ x
    mixed = y_t @ inner
    stiffness = y_t @ inertia + x_t @ inner
    mass = y_t @ robot.mass @ y + mixed + np.swapaxes(mixed, 1, 2)
    mass = mass + x_t @ _to_shared(robot.ends, robot.inner_mass) @ x
    stiffness[~start.ok] = np.nan
    stiffness += np.where(real, 0.0, 1.0)[:, :, None] * np.eye(SHARED)
    found = natural_modes(stiffness, mass, count)
    return replace(found, shapes=y @ found.shapes)


@of_design
@np.errstate(invalid="ignore")
def first_frequencies(design: Design, pose: ArrayLike) -> Array:
    """Return the first natural frequency of the whole robot, (...) [Hz].

    Each bar is one element between two joints; see `iterated_modes`.

    Args:
        design: The robot with its elastic data, payload and load.
        pose: (..., 4) [m, m, rad, m].

    Returns:
        NaN where the pose cannot be taken or is singular, and where weight or load push the
        platform away harder than it is held.

    Raises:
        InvalidInput: If arm or shaft has no length.
    """
    pose = as_vectors(pose, "pose")
    matrices, flat = leg_matrices(design), pose.reshape(-1, 4)
    found = np.full(len(flat), np.nan)
    usable = np.flatnonzero(check_reach(design.geometry, flat).ok)
    for start in range(0, len(usable), BLOCK):
        block = usable[start : start + BLOCK]
        robot = reduced_robot(matrices, flat[block])
        found[block] = iterated_modes(robot).frequencies[:, 0]
    return found.reshape(pose.shape[:-1])


@of_design
def robot_modes(
    design: Design,
    pose: ArrayLike,
    count: int = 6,
    *,
    divisions: int = 1,
    shear: bool = False,
) -> Modes:
    """Return the lowest frequencies and modes of the whole robot at one pose.

    Args:
        design: The robot with its elastic data, payload and load.
        pose: (4,) [m, m, rad, m].
        count: How many.
        divisions: Elements of a bar between two joints; one is exact to 1e-5.
        shear: Whether bars deform by shear (Timoshenko).

    Returns:
        Frequencies (count,) [Hz], and shapes in the coordinates of `whole_matrices`; NaN where the
        robot does not hold the pose, see `first_frequencies`.

    Raises:
        InvalidInput: If it is not one pose, arm or shaft has no length, or ``count`` or
            ``divisions`` is not possible.
    """
    pose = as_pose(pose)
    if count < 1:
        raise InvalidInput("count", f"at least one mode is needed, not {count}")
    matrices = leg_matrices(design, divisions, shear)
    return whole_modes(matrices, pose, count)


def whole_matrices(
    matrices: LegMatrices, pose: ArrayLike, *, loaded: bool = True
) -> tuple[Array, Array]:
    """Return stiffness and mass in all coordinates at one pose (4,), (n, n) each.

    The shared ones come first, then those inside each of the legs. Without ``loaded`` the stiffness
    is that of bars, joints and drives alone.
    """
    pose = as_vectors(pose, "pose")
    frame = leg_frame(matrices.design.geometry, pose)
    legs, ends = matrices.assemble(frame), frame.shared_map
    inside = matrices.size - RETAINED
    size = SHARED + 3 * inside
    found = np.zeros((2, size, size))
    shared = slice(0, SHARED)
    _join(matrices.design, pose, found[0, shared, shared], found[1, shared, shared], loaded)
    for leg in range(3):
        spread = np.zeros((matrices.size, size))
        spread[:RETAINED, :SHARED] = ends[leg]
        first = SHARED + leg * inside
        spread[RETAINED:, first : first + inside] = np.eye(inside)
        for out, part in zip(found, legs, strict=True):
            out += spread.T @ part[leg] @ spread
    return found[0], found[1]


@np.errstate(divide="ignore", invalid="ignore")
def whole_modes(matrices: LegMatrices, pose: ArrayLike, count: int = 6) -> Modes:
    """Return the lowest modes in all coordinates at one pose (4,), see `whole_matrices`."""
    stiffness, mass = whole_matrices(matrices, pose)
    size = len(stiffness)
    count = min(count, size)
    lost = Modes(np.full(count, np.nan), np.full((size, count), np.nan), np.array(False))
    if not np.isfinite(stiffness).all():
        return lost
    try:
        lower = np.linalg.cholesky(stiffness)
        half = np.linalg.solve(lower, mass)
        inertia, turned = np.linalg.eigh(np.linalg.solve(lower, half.T))
    except np.linalg.LinAlgError:  # not positive definite
        return lost
    inertia, turned = np.maximum(inertia[: -count - 1 : -1], 0.0), turned[:, : -count - 1 : -1]
    shapes = np.linalg.solve(lower.T, turned) / np.sqrt(inertia)
    return Modes(1 / (2 * np.pi * np.sqrt(inertia)), shapes, np.array(True))
