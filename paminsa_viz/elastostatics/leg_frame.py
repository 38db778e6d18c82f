"""Where the legs are, in the axes of their own planes.

Leg frame: origin on the leg axis at the height of the guides, axes u (radial, toward the platform),
w = z x u (across the plane) and z (up), in this order in all arrays. With the platform's center P
at (x, y, z), joint 5 is at p_k from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, own_vectors
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.leg import leg_position, mechanism
from paminsa_viz.model.leg_points import point_weights
from paminsa_viz.model.reach import Limit, OfLimits, check_reach


@dataclass(frozen=True, eq=False)
class LegFrame(OfLimits):
    """The three legs at poses of batch shape (...); NaN where a pose cannot be reached.

    Attributes:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        status: (...) values of `Limit`; a singular pose counts as reached here.
        leg: (...) index of the leg that is the reason, -1 for none.
        axes: (..., 3 legs, 3, 3) rows u, w, z in base axes.
        arm: (..., 3 legs, 2) direction of B1, outward from the base center, along u and w.
        psi, phi: (..., 3 legs, 2) cosine and sine of the elevations of B4 and B7 (from 9 to 5), and
            of B8 and B3 (from 8 to 9).
        rho: (..., 3 legs) X_1, distance of joint 5 from its leg axis [m].
        points: (..., 3 legs, 2) r and z of the joints by the paper's number [m].
        platform: (..., 3 legs, 3) p_k, from P to joint 5, in base axes [m].
    """

    geometry: Geometry
    pose: Array
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]
    axes: Array
    arm: Array
    psi: Array
    phi: Array
    rho: Array
    points: dict[int, Array]
    platform: Array

    @property
    def joints(self) -> dict[int, Array]:
        """The joints in the leg frame (..., 3 legs, 3), M_k on the guides as 0, B1's root as 1."""
        found = {}
        for joint, point in self.points.items():
            found[joint] = np.insert(point, 1, 0.0, axis=-1)
        found[0] = np.zeros_like(found[2]) * found[2]
        found[1] = found[2].copy()
        found[1][..., :2] -= self.geometry.arm_length * self.arm
        return found

    @property
    def joint5_map(self) -> Array:
        """G: displacements of joints 5 along u, w, z from the platform's twist at P.

        (..., 3 legs, 3, 6); its transpose gives the wrench at P of forces on the joints 5.
        """
        # displacement t + turn x p: the rows of turn x p are p x u, p x w and p x z
        return np.concatenate([self.axes, np.cross(self.platform[..., None, :], self.axes)], -1)

    @property
    def shared_map(self) -> Array:
        """Joint 5 (u, w, z) and Z of each leg from the platform's twist and Z, (..., 3, 4, 7)."""
        found = np.zeros((*self.rho.shape, 4, 7))
        found[..., :3, :6] = self.joint5_map
        found[..., 3, 6] = 1.0
        return found


@np.errstate(all="ignore")
def leg_frame(geometry: Geometry, pose: ArrayLike) -> LegFrame:
    """Return where the legs are at poses (..., 4) [m, m, rad, m]."""
    pose = own_vectors(pose, "pose")
    reach = check_reach(geometry, pose)
    usable = np.where((reach.status == Limit.OK)[..., None], pose, np.nan)
    x, y, theta, z = np.moveaxis(usable, -1, 0)[..., None]
    ax, ay = LEG_AXES.T
    g = leg_position(mechanism(geometry), ax, ay, x, y, np.cos(theta), np.sin(theta), z)
    axes = np.zeros((*pose.shape[:-1], 3, 3, 3))
    axes[..., 0, 0] = axes[..., 1, 1] = g.ux
    axes[..., 0, 1] = g.uy
    axes[..., 1, 0] = -g.uy
    axes[..., 2, 2] = 1.0
    points = {
        joint: np.stack(np.broadcast_arrays(*w.of(g)), axis=-1)
        for joint, w in point_weights(geometry).items()
    }
    height = np.full_like(g.px, geometry.platform_joint_height)
    return LegFrame(
        geometry,
        pose,
        np.asarray(reach.status),
        np.asarray(reach.leg),
        axes,
        np.stack([ax * g.ux + ay * g.uy, ay * g.ux - ax * g.uy], axis=-1),
        np.stack([g.cos_psi, g.sin_psi], axis=-1),
        np.stack([g.cos_phi, g.sin_phi], axis=-1),
        g.rho,
        points,
        np.stack([g.px, g.py, height], axis=-1),
    )


# -------------------------------------------------------------- where bars would touch in one plane
# A real leg has its bars side by side; the model of `structure` has not, and lets them pass.
# Hanging, the shaft passes the root of B10 at the leg axis, and B7 passes the shaft in every pose
# of the prototype: there a design needs forks or offsets.

PAIRS: tuple[tuple[str, str], ...] = (
    ("b2", "b10"),
    ("b2", "b7"),
    ("b2", "b4"),
    ("b2", "b8"),
    ("b3", "b10"),
    ("b4", "b10"),
    ("b3", "b8"),
    ("b4", "b7"),
)
"""Bars of a leg that no joint connects."""

_ENDS = {"b2": (3, 2), "b3": (7, 4), "b4": (9, 5), "b7": (8, 7), "b8": (8, 9)}


@dataclass(frozen=True, eq=False)
class Contacts:
    """Gaps between bars at poses of batch shape (...); NaN where a pose cannot be reached.

    Attributes:
        gap: (..., 3 legs, pairs) distance of the center lines less the two outer radii, negative
            where the bars would touch [m]; pairs in the order of `PAIRS`.
        point: (..., 3 legs, pairs, 3) where they are nearest, in base axes [m].
    """

    gap: Array
    point: Array

    def touching(self) -> list[str]:
        """Return the pairs that would touch in any leg of any pose: ``"B2–B10"``."""
        found = (self.gap < 0).reshape(-1, len(PAIRS)).any(axis=0)
        return [pair_name(i) for i, touches in enumerate(np.atleast_1d(found)) if touches]


def pair_name(index: int) -> str:
    """Return the name of a pair: ``"B2–B10"``."""
    first, second = PAIRS[index]
    return f"{first.upper()}–{second.upper()}"


@of_design
def contacts(design: Design, pose: ArrayLike) -> Contacts:
    """Return the gaps between the bars of each leg that no joint connects.

    Args:
        design: The robot; the radii are those of its tubes.
        pose: (..., 4) [m, m, rad, m].
    """
    frame = leg_frame(design.geometry, pose)
    ends = {bar: (frame.points[a], frame.points[b]) for bar, (a, b) in _ENDS.items()}
    root = np.zeros_like(frame.points[2]) * frame.rho[..., None]
    tip = root - np.array([design.geometry.guide_link_length, 0.0])
    ends["b10"] = (root, tip)
    gaps, points = [], []
    for first, second in PAIRS:
        distance, place = _nearest(*ends[first], *ends[second])
        radii = sum(0.5 * design.value(f"elastic.{bar}_outer") for bar in (first, second))
        gaps.append(distance - radii)
        points.append(place)
    place = np.stack(points, axis=-2)
    u = frame.axes[..., 0, :]
    base = np.zeros_like(u)
    base[..., :2] = design.geometry.base_radius * LEG_AXES
    whole = base[..., None, :] + place[..., :1] * u[..., None, :]
    whole[..., 2] = place[..., 1]
    return Contacts(np.stack(gaps, axis=-1), whole)


@np.errstate(all="ignore")
def _nearest(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, Array]:
    """Return the distance of two segments a-b and c-d in a plane, and the middle between them."""
    along, other, between = b - a, d - c, c - a
    cross = _cross(along, other)
    s, t = _cross(between, other) / cross, _cross(between, along) / cross
    crossing = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    distance = np.where(crossing, 0.0, np.inf)
    place = np.where(crossing[..., None], a + s[..., None] * along, np.nan)
    for point, start, way in ((c, a, along), (d, a, along), (a, c, other), (b, c, other)):
        share = ((point - start) * way).sum(axis=-1) / (way * way).sum(axis=-1)
        foot = start + np.clip(np.nan_to_num(share), 0.0, 1.0)[..., None] * way
        apart = np.linalg.norm(point - foot, axis=-1)
        nearer = ~(apart >= distance)
        distance = np.where(nearer, apart, distance)
        place = np.where(nearer[..., None], 0.5 * (point + foot), place)
    return distance, place


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
