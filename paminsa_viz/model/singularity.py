"""Singularities in closed form: where the platform escapes the actuators, and how far that is.

Type 2 (parallel): det = 0 exactly where cos theta = R_pl / R_b, or where the platform center lies
on the circle x^2 + y^2 = R_b^2 + R_pl^2 - 2 R_b R_pl cos theta. Type 1 (serial): joint 5 on its leg
axis, or a pantograph fully stretched or folded; there the reach margins vanish (see `reach`).

Which side of a singularity a pose is on is decided by a difference. Where that is within
`leg.SINGULAR` (2^-40, about 1e-12) of the size of what is subtracted, rounding of the pose leaves
torques, rates and accelerations few digits or none, and the pose counts as singular, at rest and in
motion: for R_b cos theta - R_pl of R_b + R_pl, for the circle of (R_b + R_pl)^2, for X_1 of
R_b + R_pl, and for |85| of l_B4 + l_B8 + (R_b + R_pl) k/(k-1). Kernels and arrays use the same
formulas. On the prototype that is some 1e-12 m or rad; 1e-9 m away there are torques, of 1e11 N m.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model import backend, measures
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import wrap
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import MARGINS, Limit, check_reach
from paminsa_viz.model.resizing import radius_ratio

DEXTERITY = backend.Formula(measures.dexterity, 2)
"""The determinant of the rows (w_k, p_k x w_k) [m] and the condition number of J."""


NEAR_LOCUS = 1e-6
"""How far from a type-2 singular pose `escape_twist` is still defined, at Appendix 4's R_b [m]."""


@of_geometry
@np.errstate(invalid="ignore")
def singular_radius(geometry: Geometry, theta: ArrayLike) -> Array:
    """Return the radius of the circle of type-2 singular positions at theta [rad], (...) [m]."""
    rb, rp = geometry.base_radius, geometry.platform_radius
    theta = as_numbers(theta, "theta")
    return np.sqrt(np.maximum(rb**2 + rp**2 - 2 * rb * rp * np.cos(theta), 0.0))


@of_geometry
def singular_rotation(geometry: Geometry) -> float:
    """Return the |theta| at which every position is singular [rad]; NaN if R_pl > R_b."""
    ratio = geometry.platform_radius / geometry.base_radius
    return float(np.arccos(ratio)) if ratio <= 1 else float("nan")


def type2_distances(geometry: Geometry, pose: Array) -> tuple[Array, Array]:
    """Return signed distances of poses (..., 4) to both type-2 loci, (...) each [m].

    To the circle of singular positions, positive inside, and to the singular turn as the path of
    the joints 5, positive below it; the second is NaN where R_pl > R_b.
    """
    x, y, theta, _ = np.moveaxis(pose, -1, 0)
    circle = singular_radius(geometry, theta) - np.hypot(x, y)
    turn = geometry.platform_radius * (singular_rotation(geometry) - np.abs(wrap(theta)))
    return circle, turn


@of_geometry
def escape_twist(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return t_s, the platform's motion that no actuator feels at a type-2 singular pose, (..., 4).

    With G the inverse Jacobian, G t_s = 0: t_s = (v, 1, 0), v = (R_pl/r_s^2) z x [(R_b R(-theta) -
    R_pl)(x, y)]. On the circle it is tangent to the locus, so the platform can move along it with
    locked actuators; at cos theta = R_pl/R_b the two assembly modes meet in a fold.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].

    Returns:
        (x', y', theta', z') [m/rad, m/rad, 1, m/rad], with theta' = 1. NaN farther than
        `NEAR_LOCUS` from both loci; a turn counts as the path of the joints 5.
    """
    pose = as_vectors(pose, "pose")
    with np.errstate(invalid="ignore"):
        circle, turn = type2_distances(geometry, pose)
        most = NEAR_LOCUS * radius_ratio(geometry)
        near = (np.abs(circle) <= most) | (np.abs(turn) <= most)
    return np.where(near[..., None], twist_field(geometry, pose), np.nan)


@np.errstate(all="ignore")
def twist_field(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return the formula of `escape_twist` at any pose, (..., 4); t_s on the loci alone."""
    x, y, theta, _ = np.moveaxis(as_vectors(pose, "pose"), -1, 0)
    rb, rp = geometry.base_radius, geometry.platform_radius
    scale = rp / singular_radius(geometry, theta) ** 2
    cos, sin = np.cos(theta), np.sin(theta)
    along_x = rb * (cos * x + sin * y) - rp * x
    along_y = rb * (cos * y - sin * x) - rp * y
    parts = [-scale * along_y, scale * along_x, np.ones_like(x), np.zeros_like(x)]
    return np.stack(parts, axis=-1)


@dataclass(frozen=True, eq=False)
class Singularity:
    """How far poses of batch shape (...) are from singular ones.

    Attributes:
        determinant: det of the rows (w_k, p_k x w_k), w_k the tangential direction of leg k [m];
            zero at type-2 singularities.
        condition: 2-norm condition number of the map from (x', y', R_pl theta') to the rotary
            actuators' speeds; R_pl is the characteristic length. Infinite at type 2.
        position_distance: Signed distance from (x, y) to the singular circle at this theta,
            positive inside [m].
        rotation_distance: Signed turn from theta to the nearest theta at which this (x, y) is
            singular, positive where the center at theta = 0 is: inside the singular circle, with
            |theta| below `singular_rotation` [rad].
        serial_distance: Smallest of X_1 and the margins of the pantographs to fully stretched and
            fully folded, negative beyond them [m]: distance to type 1.
    """

    determinant: Array
    condition: Array
    position_distance: Array
    rotation_distance: Array
    serial_distance: Array


@of_geometry
def measure_singularity(geometry: Geometry, pose: ArrayLike) -> Singularity:
    """Measure poses (..., 4) [m, m, rad, m] against every singularity.

    Both branches of the knee have the same ones. Determinant and condition are NaN where the pose
    cannot be taken.
    """
    pose = as_vectors(pose, "pose")
    flat = pose.reshape(-1, 4)
    det, condition = backend.over_list(DEXTERITY, mechanism(geometry), flat).T
    x, y, theta, _ = np.moveaxis(pose, -1, 0)
    with np.errstate(all="ignore"):
        distances = measures.singular_distances(
            mechanism(geometry), x, y, np.cos(theta), np.abs(wrap(theta))
        )

    margins = check_reach(geometry, pose).margins
    kinds = [MARGINS.index(kind) for kind in (Limit.STRETCHED, Limit.FOLDED, Limit.AXIS)]
    serial = margins[..., kinds]
    serial[..., 2] += geometry.axis_clearance
    shape = pose.shape[:-1]
    return Singularity(
        determinant=det.reshape(shape),
        condition=condition.reshape(shape),
        position_distance=distances.position,
        rotation_distance=distances.rotation,
        serial_distance=serial.min(axis=(-1, -2)),
    )
