"""Errors of the platform's pose from errors of the drives: linear, and by exact kinematics.

With the actuators off by at most d_j (`DriveAccuracy.half_widths`), the linear estimate of an error
is the sum of |J_ij| d_j. It is finite where the robot may jump into another assembly mode, so the
exact error is worked out as well: forward kinematics in the corners of the box q +- d, in the
assembly mode that is connected with the pose (Briot and Bonev, Mech. Mach. Theory 43 (2008) 445).
Where the box holds a singular position of the actuators, or one without a platform, there is no
bound, whatever the linear estimate says (Tannous, Caro and Goldsztejn, Mech. Mach. Theory 71 (2014)
93). What errors have beyond the corners they have on an edge between two of them, where it follows
in closed form (`drive_corners.beyond_corners`).

Heights separate: z = k (Z - l_B2) - l_B5, so that its error is k d_4, and x, y and theta depend on
the eight corners of M1..M3 alone. Z counts for the reach of the legs only.

The closure equations of M1..M3 are a cos theta - b sin theta = (R_b/R_pl) a with a and b functions
of the angles beta_k (see `kinematics.forward_kinematics`): the two assembly modes are apart exactly
where b^2 > ((R_b/R_pl)^2 - 1) a^2 and (a, b) is not zero. `drive_corners` proves that for the
whole box by a Taylor expansion with a bound of its remainder.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import require_kind
from paminsa_viz.kept import kept
from paminsa_viz.model import backend
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, by_blocks, own_vectors, unfolded
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import LEAST_MARGIN, Limit, decode
from paminsa_viz.model.status import Status, WithStatus
from paminsa_viz.precision.drive_corners import (
    CORNERS,
    beyond_corners,
    beyond_reach,
    corner_errors,
)


class Bound(Status):
    """Whether the errors at a pose are bounded, or why not."""

    OK = 0, "bounded"
    UNREACHABLE = 1, "the pose is out of reach of {leg}"
    SINGULAR = 2, "the pose is singular"
    NOT_ASSEMBLED = 3, "within the errors of the drives the robot cannot be assembled"
    SINGULARITY = 4, "a singularity lies within the errors of the drives"
    LIMIT = 5, "within the errors of the drives {leg} passes a limit of its reach"


@dataclass(frozen=True, eq=False)
class DriveErrors(WithStatus):
    """Errors at poses of batch shape (...), in the order (x, y, theta, z) of a pose.

    Attributes:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        accuracy: Accuracy of the drives.
        linear: (..., 4) sum of |J_ij| d_j [m, m, rad, m]; NaN where the pose is out of reach or
            singular.
        worst: (..., 4) largest errors in the box: those of the corners, by exact kinematics, and
            ``between`` [m, m, rad, m]; NaN where there is no bound.
        rms: (..., 4) standard deviations to first order, for independent uniform errors
            [m, m, rad, m]; NaN as ``linear``.
        linear_horizontal, horizontal, rms_horizontal: (...) the same of the distance in the plane
            [m].
        between: (..., 4) by how much edges exceed the corners: x, y, theta (which they never do)
            and the distance in the plane, a bound [m, m, rad, m]; NaN as ``worst``.
        status: (...) values of `Bound`: whether they are bounded, or why not.
        leg: (...) index of the leg that is the reason, -1 for none.
    """

    geometry: Geometry
    pose: Array
    accuracy: DriveAccuracy
    linear: Array
    worst: Array
    rms: Array
    linear_horizontal: Array
    horizontal: Array
    rms_horizontal: Array
    between: Array
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]

    KINDS = Bound

    @property
    def corners(self) -> Array:
        """Errors of x, y and theta in the corners `CORNERS` of M1..M3, (..., 8, 3) [m, m, rad].

        NaN as ``worst``. They are worked out when asked for: over a map they take more memory than
        all else.
        """
        found = np.full((*self.status.shape, 8, 3), np.nan)
        half = np.array(self.accuracy.half_widths[:3])
        found[self.ok] = corner_errors(self.geometry, self.pose[self.ok], half)[0]
        return found


@of_geometry
def drive_errors(geometry: Geometry, accuracy: DriveAccuracy, pose: ArrayLike) -> DriveErrors:
    """Return the errors at poses.

    Args:
        geometry: Lengths of the mechanism.
        accuracy: Accuracy of its drives.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    require_kind(accuracy, "accuracy", DriveAccuracy)
    pose = own_vectors(pose, "pose")
    flat, m = pose.reshape(-1, 4), mechanism(geometry)
    rows = backend.over_list(WRENCH_TORQUES, m, flat).T
    margin, which = backend.over_list(LEAST_MARGIN, m, flat).T
    status, leg = decode(margin, which)
    found = _errors(geometry, accuracy, flat, rows, margin, status, leg)
    return DriveErrors(geometry, pose, accuracy, *unfolded(found, pose.shape[:-1]))


@kept(4)
def field_drive_errors(field: Field, accuracy: DriveAccuracy) -> DriveErrors:
    """Return the errors over a solved grid; those of the last few are kept."""
    pose = field.grid.poses()
    rows = field.solve(WRENCH_TORQUES).reshape(9, -1)
    status = np.where(field.status == Limit.SINGULAR, Limit.OK, field.status).astype(np.uint8)
    found = _errors(
        field.geometry, accuracy, pose.reshape(-1, 4), rows,
        field.margin.reshape(-1), status.reshape(-1), field.leg.reshape(-1),
    )  # fmt: skip
    return DriveErrors(field.geometry, pose, accuracy, *unfolded(found, pose.shape[:-1]))


BLOCK = 1024
"""Poses worked on at a time, each with eight corners and twelve edges."""


def _errors(
    geometry: Geometry, accuracy: DriveAccuracy, pose: Array, *known: NDArray[Any]
) -> Iterator[NDArray[Any]]:
    """Yield the values of `DriveErrors` from ``linear`` on, for a list of poses (n, 4).

    Known are J's rows (9, n), and of the reach (n) the margin, the status and the leg.
    """

    def found(part: slice) -> tuple[NDArray[Any], ...]:
        return _errors_of_block(geometry, accuracy, pose[part], *(one[..., part] for one in known))

    return by_blocks(found, len(pose), BLOCK)


@np.errstate(all="ignore")
def _errors_of_block(
    geometry: Geometry,
    accuracy: DriveAccuracy,
    pose: Array,
    rows: Array,
    margin: Array,
    status: NDArray[np.uint8],
    leg: NDArray[np.int8],
) -> tuple[NDArray[Any], ...]:
    half, deviation = np.array(accuracy.half_widths), np.array(accuracy.deviations)
    lift = geometry.magnification
    j = np.where(status == Limit.OK, rows, np.nan).reshape(3, 3, -1)
    singular = (status == Limit.OK) & ~np.isfinite(j).all(axis=(0, 1))
    j = np.where(singular, np.nan, j)
    shown = np.where(np.isnan(j[0, 0]), np.nan, 1.0)
    linear = np.einsum("ijn,j->in", np.abs(j), half[:3])
    linear = np.column_stack([*linear, shown * lift * half[3]])
    rms = np.sqrt(np.einsum("ijn,j->in", j**2, deviation[:3] ** 2))
    rms = np.column_stack([*rms, shown * lift * deviation[3]])
    sideways = np.einsum("ijn,cj->inc", j[:2], CORNERS[4:] * half[:3])  # the others are opposite

    bound = np.full(len(pose), Bound.UNREACHABLE, np.uint8)
    bound[singular] = Bound.SINGULAR
    why = np.where(status != Limit.OK, leg, np.int8(-1))
    moved = np.full((len(pose), 8, 3), np.nan)
    here = np.flatnonzero((status == Limit.OK) & ~singular)
    moved[here], assembled, regular = corner_errors(geometry, pose[here], half[:3])
    bound[here] = np.where(regular, Bound.OK, Bound.SINGULARITY)
    bound[here[~assembled]] = Bound.NOT_ASSEMBLED
    distance = np.hypot(moved[..., 0], moved[..., 1]).max(axis=1)
    turn = geometry.platform_radius * np.abs(moved[..., 2]).max(axis=1)
    # No margin shrinks by more than this: that of |85|, by k/(k-1) times joint 5's way.
    way = geometry.span_ratio * (distance + turn) + lift * half[3]
    near = (bound == Bound.OK) & ~(margin > way)
    if near.any():
        outside, which = beyond_reach(geometry, pose[near], moved[near], lift * half[3])
        bound[near] = np.where(outside, Bound.LIMIT, Bound.OK)
        why[near] = np.where(outside, which, -1)
    bounded = bound == Bound.OK
    kept = np.where(bounded, 1.0, np.nan)
    moved = kept[:, None, None] * moved
    between = np.full((len(pose), 4), np.nan)
    between[bounded] = beyond_corners(geometry, pose[bounded], moved[bounded])
    turned = np.abs(moved).max(axis=-2) + between[:, :3]
    return (
        linear,
        np.column_stack([turned, kept * lift * half[3]]),
        rms,
        np.hypot(sideways[0], sideways[1]).max(axis=1),
        kept * distance + between[:, 3],
        np.hypot(rms[:, 0], rms[:, 1]),
        between,
        bound,
        why,
    )  # fmt: skip
