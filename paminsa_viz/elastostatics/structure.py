"""Matrix structural analysis: legs assembled from beam elements, condensed to the platform.

The direct stiffness method (Klimchik, Chablat, Pashkevich, arXiv 1805.11366), without a preload: a
leg's matrix (`leg_matrices`) is condensed to the displacements of joint 5 and the carriage's
height, and the platform's 6x6 at P is what three legs and the drive of M4 give. It is the general
route; maps use `leg_compliance`, which agrees with it to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.leg_matrices import LegMatrices, leg_matrices
from paminsa_viz.elastostatics.leg_model import RETAINED
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design


@dataclass(frozen=True, eq=False)
class Structure:
    """The three legs at poses of batch shape (...), before platform and carriage join them.

    Attributes:
        matrices: The legs of the design.
        frame: Where they are.
        stiffness: (..., 3 legs, size, size) of a leg in the leg frame, the drive of M4 left out
            [N/m, N, N m]; the freedoms are those of `leg_model`.
    """

    matrices: LegMatrices
    frame: LegFrame
    stiffness: Array

    def condensed(self) -> Array:
        """Return the legs' stiffness at joint 5 (u, w, z) and Z, (..., 3 legs, 4, 4)."""
        k, coupling = self.stiffness, self.stiffness[..., RETAINED:, :RETAINED]
        inside = _solved(k[..., RETAINED:, RETAINED:], coupling)
        return k[..., :RETAINED, :RETAINED] - np.swapaxes(coupling, -1, -2) @ inside

    def joined(self) -> Array:
        """Return the stiffness at the platform's twist and Z, drive of M4 included, (..., 7, 7)."""
        t = self.frame.shared_map
        k = (np.swapaxes(t, -1, -2) @ self.condensed() @ t).sum(axis=-3)
        k[..., 6, 6] += self.matrices.design.elastic.drive_linear
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
        ends = np.einsum("...kij,...j->...ki", self.frame.shared_map, whole)
        pull = self.stiffness[..., RETAINED:, :RETAINED] @ ends[..., None]
        inside = -_solved(self.stiffness[..., RETAINED:, RETAINED:], pull)[..., 0]
        return np.concatenate([ends, inside], axis=-1)


@of_design
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
        InvalidInput: If arm or shaft has no length, or ``divisions`` is not possible.
    """
    matrices, frame = leg_matrices(design, divisions, shear), leg_frame(design.geometry, pose)
    return Structure(matrices, frame, matrices.assemble(frame)[0])


def _solved(matrix: Array, right: Array) -> Array:
    """Solve, with NaN where the matrix is not finite."""
    good = np.all(np.isfinite(matrix), axis=(-1, -2))[..., None, None]
    usable = np.where(good, matrix, np.eye(matrix.shape[-1]))
    return np.where(good, np.linalg.solve(usable, np.where(good, right, 0.0)), np.nan)
