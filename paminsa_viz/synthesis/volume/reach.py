"""Reach and singularity over a whole range of headings, at positions or sets, in closed form.

The distance X_1 of joint 5 of leg k from its axis is that of two points whose angle turns with
theta: X_1^2 = A^2 + R_pl^2 + 2 A R_pl cos(theta + alpha_k - gamma), A and gamma being length and
direction from the leg axis to the platform's center. So its extremes over a range of headings lie
at the ends of the range or where the cosine is 1 or -1, and no heading between two samples is
missed. The limits of reach are bounds on X_1 and on the height of joint 5. Singular positions form
a circle whose radius grows with |theta| (see `model.singularity`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import MARGINS, Limit
from paminsa_viz.model.workspace_shapes import TURN, WorkspaceShape
from paminsa_viz.quantities.requirements import Range, Requirement

_GUIDE = MARGINS.index(Limit.GUIDE)


def contains(low: ArrayLike, high: ArrayLike, angle: float) -> NDArray[np.bool_]:
    """Say where ranges of angles [rad] contain an angle or one that is whole turns away."""
    first = np.ceil((np.asarray(low) - angle) / TURN)
    return np.floor((np.asarray(high) - angle) / TURN) >= first


def cosine_range(low: ArrayLike, high: ArrayLike) -> tuple[Array, Array]:
    """Return the least and the largest cosine over ranges of angles [rad], each (...)."""
    ends = np.cos(low), np.cos(high)
    least = np.where(contains(low, high, np.pi), -1.0, np.minimum(*ends))
    return least, np.where(contains(low, high, 0.0), 1.0, np.maximum(*ends))


@dataclass(frozen=True, eq=False)
class ReachBounds:
    """Extremes over a range of headings, at positions of batch shape (...).

    Attributes:
        geometry: Lengths of the mechanism.
        near, far: (...) least and largest X_1 of any leg [m].
        near_leg, far_leg: (...) indices of these legs.
        position: (...) distance inside the singular circle, for every heading [m].
        turn: Least R_b cos theta - R_pl, times its sign at theta = 0 [m]; not positive if the range
            reaches the singular rotation.
    """

    geometry: Geometry
    near: Array
    far: Array
    near_leg: NDArray[np.int8]
    far_leg: NDArray[np.int8]
    position: Array
    turn: float

    def margin(self, z: ArrayLike) -> tuple[Array, NDArray[np.uint8]]:
        """Return the least margin to a limit of reach, and which it is.

        Args:
            z: Heights that broadcast against the positions [m].

        Returns:
            The margin (...), negative beyond a limit [m]; and 4 * leg + limit (...), see
            `model.measures.least_margin`.
        """
        g, m = self.geometry, mechanism(self.geometry)
        zeta2 = (np.asarray(z) + g.platform_joint_height) ** 2
        bars = g.crank_length + g.coupler_length
        parts = {
            Limit.STRETCHED: bars - np.sqrt((m.span_ratio * self.far) ** 2 + zeta2),
            Limit.FOLDED: np.sqrt((m.span_ratio * self.near) ** 2 + zeta2)
            - abs(g.coupler_length - g.crank_length),
            Limit.GUIDE: m.stroke - m.guide_ratio * self.far,
            Limit.AXIS: self.near - m.clearance,
        }
        least, which = np.asarray(parts[Limit.STRETCHED]), np.zeros(1, np.uint8)
        for index, limit in enumerate(MARGINS[1:], 1):
            lower = parts[limit] < least
            least = np.where(lower, parts[limit], least)
            which = np.where(lower, np.uint8(index), which)
        far = (which % 2) == 0  # stretched, and the guide
        leg = np.where(far, self.far_leg, self.near_leg)
        return least, (which + 4 * leg).astype(np.uint8)

    @property
    def regular(self) -> NDArray[np.bool_]:
        """Where no heading is singular, nor is there one on the way from home (...)."""
        return (self.position > 0.0) & (self.turn > 0.0)


def reach_bounds(
    geometry: Geometry, x: ArrayLike, y: ArrayLike, theta: tuple[float, float]
) -> ReachBounds:
    """Return the extremes over a range of headings.

    Args:
        geometry: Lengths of the mechanism.
        x, y: Positions that broadcast [m].
        theta: Least and largest heading [rad].
    """
    rb, rp = geometry.base_radius, geometry.platform_radius
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    near, far = [], []
    for ax, ay in LEG_AXES:
        dx, dy = x - rb * ax, y - rb * ay
        length = np.hypot(dx, dy)
        shift = np.arctan2(ay, ax) - np.arctan2(dy, dx)
        least, largest = cosine_range(theta[0] + shift, theta[1] + shift)
        base, product = length**2 + rp**2, 2.0 * length * rp
        near.append(np.sqrt(np.maximum(base + product * least, 0.0)))
        far.append(np.sqrt(np.maximum(base + product * largest, 0.0)))
    nears, fars = np.stack(near), np.stack(far)
    least, largest = cosine_range(*theta)
    sign = np.sign(rb - rp)
    locus = np.sqrt(max(rb**2 + rp**2 - 2 * rb * rp * float(largest), 0.0))
    return ReachBounds(
        geometry,
        nears.min(axis=0),
        fars.max(axis=0),
        nears.argmin(axis=0).astype(np.int8),
        fars.argmax(axis=0).astype(np.int8),
        locus - np.hypot(x, y),
        float(np.min(sign * (rb * np.array([least, largest]) - rp))),
    )


def can_be_taken(margin: Array, which: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Return where a margin and its limit (`ReachBounds.margin`) are those of a pose in reach."""
    # A guide may be used to its end.
    return (margin > 0.0) | ((margin == 0.0) & (which % len(MARGINS) == _GUIDE))


def takes_own_headings(
    geometry: Geometry, x: ArrayLike, y: ArrayLike, z: Array, bound: Requirement
) -> NDArray[np.bool_]:
    """Return where a requirement's own headings can be taken, or do not count, at positions [m]."""
    assert bound.theta is not None
    own = reach_bounds(geometry, x, y, bound.theta)
    free = np.zeros(z.shape, np.bool_)
    if bound.z is not None:
        free = (z < bound.z[0]) | (z > bound.z[1])
    return (can_be_taken(*own.margin(z)) & own.regular) | free


def leg_distances(
    base_radius: Array,
    platform_radius: Array,
    center: Array,
    half: Array,
    theta: Range,
    shape: WorkspaceShape,
) -> tuple[Array, Array]:
    """Return the least and the largest X_1 of each leg over sets of positions and headings.

    Args:
        base_radius, platform_radius: Of n robots (n,) [m].
        center: Of the sets in the horizontal plane (2,) [m].
        half: Half extents of the set of each robot, the first two columns of (n, 2 or 3) [m]; a
            cylinder's are its radius.
        theta: Least and largest heading [rad].
        shape: Of the sets.

    Returns:
        Two arrays (n, 3) [m].
    """
    rb, rp = base_radius[:, None, None], platform_radius[:, None, None]
    # Joint 5 relative to the leg axis is q + g + R_pl (cos, sin)(alpha + theta), q in the set about
    # its center.
    g = center - rb * LEG_AXES  # (n, 3, 2)
    alpha = np.arctan2(LEG_AXES[:, 1], LEG_AXES[:, 0])[:, None]
    near, far = shape.section.arc_distances(g, rp, alpha, theta, half)
    return np.maximum(near, 0.0), far
