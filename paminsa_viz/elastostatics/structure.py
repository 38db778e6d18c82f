"""Matrix structural analysis: legs assembled from beam elements, condensed to the platform.

The direct stiffness method (Klimchik, Chablat, Pashkevich, arXiv 1805.11366), without a preload: a
leg's matrix is condensed to the displacements of joint 5 and the carriage's height, and the
platform's 6x6 at P is what three legs and the drive of M4 give. It is the general route, to which
masses can be added; maps use `leg_compliance`, which agrees with it to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.elastostatics.beams import beam_stiffness, rotated
from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.leg_model import FIXED, LegModel, leg_model
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design

RETAINED = 4
"""What a leg is condensed to: joint 5 along u, w, z, and the carriage's height Z."""


@dataclass(frozen=True, eq=False)
class Structure:
    """The three legs at poses of batch shape (...), before platform and carriage join them.

    Attributes:
        design: The robot.
        frame: Where the legs are.
        model: Their freedoms, nodes, elements and springs.
        positions: (..., 3 legs, nodes, 3) nodes in the leg frame (u, w, z) [m].
        lengths: (..., 3 legs, elements) [m].
        axes: (..., 3 legs, elements, 3, 3) element axes, rows e, n, b in the leg frame.
        stiffness: (..., 3 legs, size, size) of a leg in the leg frame, the drive of M4 left out
            [N/m, N, N m].
    """

    design: Design
    frame: LegFrame
    model: LegModel
    positions: Array
    lengths: Array
    axes: Array
    stiffness: Array

    def condensed(self) -> Array:
        """Return the legs' stiffness at joint 5 (u, w, z) and Z, (..., 3 legs, 4, 4)."""
        inner, kept = self.split
        k = self.stiffness
        coupling = k[..., inner[:, None], kept]
        return k[..., kept[:, None], kept] - np.swapaxes(coupling, -1, -2) @ _solved(
            k[..., inner[:, None], inner], coupling
        )

    @property
    def split(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Indices of the freedoms inside a leg, and of the four that are kept."""
        kept = np.array([*self.model.joint5, self.model.carriage])
        inner = np.setdiff1d(np.arange(self.model.size), kept)
        return np.asarray(inner, np.intp), np.asarray(kept, np.intp)

    @property
    def platform_map(self) -> Array:
        """Joint 5 (u, w, z) and Z of each leg from the platform's twist and Z, (..., 3, 4, 7)."""
        found = np.zeros((*self.positions.shape[:-2], RETAINED, 7))
        found[..., :3, :6] = joint5_map(self.frame)
        found[..., 3, 6] = 1.0
        return found

    def joined(self) -> Array:
        """Return the stiffness at the platform's twist and Z, drive of M4 included, (..., 7, 7)."""
        t = self.platform_map
        k = (np.swapaxes(t, -1, -2) @ self.condensed() @ t).sum(axis=-3)
        k[..., 6, 6] += self.design.elastic.drive_linear
        return k

    def platform_stiffness(self) -> Array:
        """Return K at P, (..., 6, 6) [N/m, N, N m/rad], rows (F_x, F_y, F_z, M_x, M_y, M_z)."""
        k = self.joined()
        lift = k[..., :6, 6:]
        return k[..., :6, :6] - lift @ np.swapaxes(lift, -1, -2) / k[..., 6:, 6:]

    def displacements(self, twist: Array) -> Array:
        """Return all freedoms of the legs for small motions of the platform.

        Args:
            twist: (..., 6) displacement of P [m] and rotation [rad], in base axes.

        Returns:
            (..., 3 legs, size), in leg frames [m, rad].
        """
        k = self.joined()
        lift = -(k[..., 6, :6] * twist).sum(axis=-1, keepdims=True) / k[..., 6:, 6]
        whole = np.concatenate([twist, lift], axis=-1)
        ends = np.einsum("...kij,...j->...ki", self.platform_map, whole)
        inner, kept = self.split
        found = np.zeros((*ends.shape[:-1], self.model.size))
        found[..., kept] = ends
        pull = self.stiffness[..., inner[:, None], kept] @ ends[..., None]
        found[..., inner] = -_solved(self.stiffness[..., inner[:, None], inner], pull)[..., 0]
        return found


def joint5_map(frame: LegFrame) -> Array:
    """Return G: displacements of joints 5 along u, w, z from the platform's twist at P.

    (..., 3 legs, 3, 6); its transpose gives the wrench at P of forces on the joints 5.
    """
    px, py, pz = np.moveaxis(frame.platform, -1, 0)
    zero = np.zeros_like(px)
    # displacement t + turn x p
    cross = np.stack(
        [
            np.stack([zero, pz, -py], axis=-1),
            np.stack([-pz, zero, px], axis=-1),
            np.stack([py, -px, zero], axis=-1),
        ],
        axis=-2,
    )
    return np.concatenate([frame.axes, frame.axes @ cross], axis=-1)


def structure(
    design: Design, pose: ArrayLike, *, divisions: int = 1, shear: bool = False
) -> Structure:
    """Assemble the legs of a design.

    Args:
        design: The robot with its elastic data.
        pose: (..., 4) [m, m, rad, m]; where it cannot be reached, all is NaN.
        divisions: Elements of a bar between two joints.
        shear: Whether bars deform by shear (Timoshenko).

    Raises:
        InvalidInput: If arm or shaft has no length, or ``divisions`` is not at least 1.
    """
    if divisions < 1:
        raise InvalidInput("divisions", "one element at least is needed")
    for name in ("arm_length", "shaft_length"):
        if getattr(design.geometry, name) == 0:
            raise InvalidInput(f"geometry.{name}", "a bar without length is no beam element")
    frame = leg_frame(design.geometry, pose)
    model = leg_model(design.elastic, divisions)
    joints = _joint_positions(frame)
    positions = np.stack(
        [joints[n.first] + n.share * (joints[n.second] - joints[n.first]) for n in model.nodes],
        axis=-2,
    )
    k = np.zeros((*positions.shape[:-2], model.size + 1, model.size + 1))
    lengths, axes = [], []
    for bar, first, second in model.elements:
        along = positions[..., second, :] - positions[..., first, :]
        length = np.linalg.norm(along, axis=-1)
        e: Array = np.asarray(along / length[..., None], np.float64)
        across = _across(e, horizontal=bar == "b1")
        own = np.stack([e, np.cross(across, e), across], axis=-2)
        section = design.elastic.section(bar)
        block = rotated(beam_stiffness(length, section, design.elastic, shear=shear), own)
        index = np.array([*model.nodes[first].freedoms, *model.nodes[second].freedoms])
        # freedoms that the base holds are the last row and column, which are cut off
        for row, target in enumerate(index):
            if target != FIXED:
                k[..., target, index] += block[..., row, :]
        lengths.append(length)
        axes.append(own)
    for spring in model.springs:
        stiffness = getattr(design.elastic, spring.stiffness)
        for end, other in ((spring.first, spring.second), (spring.second, spring.first)):
            if end != FIXED:
                k[..., end, end] += stiffness
                k[..., end, other] -= stiffness
    return Structure(
        design, frame, model, positions, np.stack(lengths, axis=-1), np.stack(axes, axis=-3),
        k[..., :-1, :-1],
    )  # fmt: skip


def _joint_positions(frame: LegFrame) -> dict[int, Array]:
    """Return the joints in the leg frame (..., 3 legs, 3), with M_k as 0 and B1's root as 1."""
    found = {}
    for joint, point in frame.points.items():
        r, z = np.moveaxis(point, -1, 0)
        found[joint] = np.stack([r, np.zeros_like(r), z], axis=-1)
    found[0] = np.zeros_like(found[2]) * found[2]
    root = np.zeros_like(found[2])
    root[..., :2] = -frame.geometry.arm_length * frame.arm
    found[1] = found[2] + root
    return found


def _across(e: Array, *, horizontal: bool) -> Array:
    """Return the direction across the plane a bar bends in: w, or horizontal for the arm."""
    if not horizontal:
        return np.broadcast_to(np.array([0.0, 1.0, 0.0]), e.shape)
    return np.stack([-e[..., 1], e[..., 0], np.zeros_like(e[..., 0])], axis=-1)


def _solved(matrix: Array, right: Array) -> Array:
    """Solve, with NaN where the matrix is not finite."""
    good = np.all(np.isfinite(matrix), axis=(-1, -2))
    if good.all():
        return np.asarray(np.linalg.solve(matrix, right), np.float64)
    usable = np.where(good[..., None, None], matrix, np.eye(matrix.shape[-1]))
    found = np.asarray(np.linalg.solve(usable, right), np.float64)
    found[~good] = np.nan
    return found
