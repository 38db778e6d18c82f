"""Center lines of the bars at a pose, and how they move and bend: for pictures of modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.leg_matrices import JOINTS, LegMatrices, axes_of, bar_masses
from paminsa_viz.elastostatics.leg_model import RETAINED
from paminsa_viz.elastostatics.vibration import SHARED
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.kinematics import LEG_AXES

POINTS = 17
"""Points of a bar's center line."""


@dataclass(frozen=True, eq=False)
class CenterLines:
    """Center lines of all bars at a pose, and of the platform from P to each of its joints 5.

    Attributes:
        names: (n,) such as ``"leg2/b4"``, and ``"platform"`` three times.
        points: (n, `POINTS`, 3) at rest, in base axes [m].
        moves: (n, `POINTS`, 3, modes) their displacements for each vector of coordinates.
    """

    names: tuple[str, ...]
    points: Array
    moves: Array

    @property
    def largest(self) -> Array:
        """The largest displacement of any point for each vector, (modes,) [m]."""
        return np.sqrt((self.moves**2).sum(axis=2)).max(axis=(0, 1))


def center_lines(matrices: LegMatrices, pose: ArrayLike, vectors: Array) -> CenterLines:
    """Return the center lines at one pose for vectors of all coordinates.

    Between two nodes a bar has the cubic shape of its element.

    Args:
        matrices: The legs.
        pose: (4,) [m, m, rad, m].
        vectors: (size, modes) in the coordinates of `vibration.whole_matrices`.
    """
    pose = as_vectors(pose, "pose")
    frame = leg_frame(matrices.design.geometry, pose)
    ends, inside = frame.shared_map, matrices.size - RETAINED
    names: list[str] = []
    points, moves = [], []
    for leg in range(3):
        first = SHARED + leg * inside
        local = np.concatenate(
            [ends[leg] @ vectors[:SHARED], vectors[first : first + inside], 0 * vectors[:1]]
        )
        for bar in JOINTS:
            rest, moved = _bar(matrices, frame, leg, bar, local)
            names.append(f"leg{leg + 1}/{bar}")
            points.append(rest)
            moves.append(moved)
        share = np.linspace(0.0, 1.0, POINTS)[:, None]
        arm = share * frame.platform[leg]
        names.append("platform")
        points.append(pose[[0, 1, 3]] + arm)
        moves.append(
            vectors[:3] + np.cross(vectors[3:6], arm[:, :, None], axisb=1, axisa=0, axisc=1)
        )
    return CenterLines(tuple(names), np.stack(points), np.stack(moves))


def _bar(
    matrices: LegMatrices, frame: LegFrame, leg: int, bar: str, local: Array
) -> tuple[Array, Array]:
    """Return a bar's points (`POINTS`, 3) and displacements (`POINTS`, 3, modes) in base axes.

    ``local`` are the freedoms of its leg, (size + 1, modes), the last one of the base.
    """
    geometry = matrices.design.geometry
    axes = axes_of(bar, frame)[leg]  # columns e, n, b in the leg frame
    base = frame.axes[leg].T  # columns u, w, z in base axes
    foot = np.array([*(geometry.base_radius * LEG_AXES[leg]), 0.0])
    nodes = [node for node in matrices.model.nodes if node.bar == bar]
    values = np.stack([local[list(node.freedoms)] for node in nodes])
    values = np.einsum("ij,npim->npjm", axes, values.reshape(len(nodes), 2, 3, -1))
    joints = {joint: place[leg] for joint, place in frame.joints.items()}
    places = np.array([joints[n.first] + n.share * (joints[n.second] - joints[n.first])
                       for n in nodes])  # fmt: skip
    where = np.linspace(0.0, sum(bar_masses(matrices.design)[bar].spans), POINTS)
    moved = _cubic(where, np.linalg.norm(places - places[0], axis=1), values)
    rest = places[0] + where[:, None] * axes[:, 0]
    return foot + rest @ base.T, np.einsum("ij,jk,pkm->pim", base, axes, moved)


def _cubic(where: Array, at: Array, values: Array) -> Array:
    """Return displacements (points, 3, modes) along (e, n, b) at places along a bar.

    Args:
        where: (points,) [m]; beyond the last node the bar is straight.
        at: (nodes,) places of the nodes [m].
        values: (nodes, 2, 3, modes) displacements and turns of the nodes in element axes.
    """
    index = np.clip(np.searchsorted(at, where, side="right") - 1, 0, len(at) - 2)
    span = (at[index + 1] - at[index])[:, None]
    t = np.minimum((where - at[index])[:, None] / span, 1.0)
    beyond = np.maximum(where - at[-1], 0.0)[:, None]
    near, far = values[index], values[index + 1]
    out = np.empty((len(where), 3, values.shape[-1]))
    out[:, 0] = (1 - t) * near[:, 0, 0] + t * far[:, 0, 0]
    h0, h1 = 1 - 3 * t**2 + 2 * t**3, 3 * t**2 - 2 * t**3
    g0, g1 = span * (t - 2 * t**2 + t**3), span * (t**3 - t**2)
    for across, turn, sign in ((1, 2, 1.0), (2, 1, -1.0)):
        slope = sign * near[:, 1, turn], sign * far[:, 1, turn]
        out[:, across] = h0 * near[:, 0, across] + h1 * far[:, 0, across]
        out[:, across] += g0 * slope[0] + g1 * slope[1] + beyond * slope[1]
    return out
