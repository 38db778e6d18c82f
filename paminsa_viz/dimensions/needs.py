"""What the drawn bodies need of the lengths: guide, shaft, and the bars of the pantograph.

Closed forms of what moves along one line, or stays in one layer, in every pose: the slider and the
block at joint 1 that holds the guide, joint 3 below that block, joint 2 above the quill, and B4
beside B7. So they are necessary: where one is broken, two bodies overlap as they are drawn. All
take arrays, and extreme values over the poses that count.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import PAYLOAD_HEIGHT, payload_offset, payload_scale
from paminsa_viz.dimensions.body_scale import design_over_scale, geometry_over_scale
from paminsa_viz.model.arguments import geometry_of, of_design
from paminsa_viz.model.arrays import Array, as_numbers
from paminsa_viz.model.design import Design, Geometry, KneeBranch

SLIDER_FROM_AXIS: Final = at.SLIDER_HALF - size.QUILL_BLOCK[0]
"""Distance of joint 8 from the leg axis at which the slider touches joint 1's block [m]."""

BEARING_FROM_2: Final = at.ARM_BEARING_HALF + size.ARM_BEARING_CAP
"""How far the bearing at joint 2 reaches above and below it [m]."""

JOINT_2_ABOVE: Final = at.QUILL_TOP + size.QUILL_KEY + BEARING_FROM_2
"""Height of joint 2 above the guides at which its bearing touches the quill, lower knee [m]."""

JOINT_2_BELOW: Final = size.QUILL_LOW - BEARING_FROM_2
"""The same height below the quill, where no column carries M4's carriage [m]."""

BESIDE: Final = at.TUBE_RADIUS["b4"] + at.TUBE_RADIUS["b7"]
"""Distance of the middle lines of B4 and B7 at which their tubes touch [m]."""

PLATE_FROM_5: Final = (-at.PLATE_BELOW_5 - size.PLATE_THICKNESS, -at.PLATE_BELOW_5)
"""Heights of the platform's plate from joint 5 [m]."""

SPARE: Final = 0.02
"""Room above the platform that `needed_shaft` leaves with the upper knee [m]."""


def joint_3_from_guides(knee: KneeBranch) -> float:
    """Return the distance of joint 3 from the guides at which it touches joint 1 [m]."""
    if knee is KneeBranch.LOWER:
        return size.SHAFT_NECK_TOP - size.QUILL_LOW
    return -size.SHAFT_BLOCK_HEIGHTS[0] - size.QUILL_LOW  # the quill is turned over


def needed_guide(slider: Array, scale: float = 1.0) -> Array:
    """Return the least length of B10 that carries the whole slider [m].

    Args:
        slider: The largest distance of joint 8 from the leg axis, |X_4| [m].
        scale: Size of the robot's bodies over the prototype's.
    """
    return as_numbers(slider, "slider") + scale * at.SLIDER_HALF


@of_design
def needed_shaft(design: Design, zeta: Array, magnification: Array) -> Array:
    """Return the length of B2 that keeps arms and carriage clear of what is below them [m].

    With the lower knee that is the least length with which joint 2's bearing clears the quill. With
    the upper knee, whose platform rises between the arms, the carriage is to clear the platform,
    the joints 5 and the payload by `SPARE`; whether it is enough is left to the bodies.

    Args:
        design: Its knee, its payload and the size of its bodies count.
        zeta: The largest |z_5| [m].
        magnification: k, of each robot.
    """
    geometry = design.geometry
    zeta, magnification = as_numbers(zeta, "zeta"), as_numbers(magnification, "magnification")
    scale = geometry.body_scale
    if scale != 1.0:
        return scale * needed_shaft(design_over_scale(design), zeta / scale, magnification)
    if geometry.knee is KneeBranch.LOWER:
        return zeta / magnification + JOINT_2_ABOVE
    top = at.BARREL_RADIUS
    if design.payload.mass > 0:
        height = PAYLOAD_HEIGHT * payload_scale(design.payload.mass)
        top = max(top, payload_offset(geometry)[2] - geometry.platform_joint_height + height)
    below = at.CARRIAGE_HALF + max(size.CARRIAGE_CAP, size.RAM_COLLAR[0])
    return zeta * (1 - 1 / magnification) + top + below + SPARE


def bar_distance(crank: Array, coupler: Array, magnification: Array, diagonal: Array) -> Array:
    """Return the distance of B4's middle line from B7's, which is parallel to it (...) [m].

    Both lie in one layer, B7 from joint 8, B4 from joint 9.

    Args:
        crank: Length of B8 [m].
        coupler: Length of B4 [m].
        magnification: k; B7 is k times shorter than B4.
        diagonal: Distance of joints 8 and 5 [m].
    """
    cosine = (crank**2 + coupler**2 - diagonal**2) / (2 * crank * coupler)
    cosine = np.clip(cosine, -1.0, 1.0)
    start = -crank * cosine  # of B4, along B7's direction from joint 8
    gap = np.maximum(start - coupler / magnification, -(start + coupler))
    return np.hypot(crank * np.sqrt(1 - cosine**2), np.maximum(gap, 0.0))


@kinds_checked
def missing_room(
    geometries: Sequence[Geometry | Design],
    slider: Array,
    zeta: Array,
    diagonal: Array,
    clearance: float,
) -> Array:
    """Return how much is missing of what the drawn bodies need, (n, 4) [m]; 0 for nothing.

    In the order: between slider and joint 1, between joints 3 and 1, between joint 2 and the quill
    (none with the upper knee; arms below the quill overlap with nothing, though no column is drawn
    there), between B4 and B7. Where one is above zero, two bodies are closer
    than required in some pose: so far as `clearance` of these poses accepts a robot, all are zero.

    Args:
        geometries: Lengths of n mechanisms.
        slider: The least distance of joint 8 from the leg axis (n,) [m].
        zeta: Least and largest |z_5| (n, 2) [m].
        diagonal: Least and largest distance of joints 8 and 5 (n, 2) [m].
        clearance: Least distance of two bodies that is required [m].
    """

    robots = [geometry_over_scale(geometry_of(robot)) for robot in geometries]
    scale = np.array([geometry_of(robot).body_scale for robot in geometries])
    slider, zeta, diagonal = slider / scale, zeta / scale[:, None], diagonal / scale[:, None]

    def of(name: str) -> Array:
        return np.array([getattr(g, name) for g in robots])

    k, lower = of("magnification"), of("knee") == KneeBranch.LOWER
    joint_3 = np.array([joint_3_from_guides(g.knee) for g in robots])
    shaft = of("shaft_length")
    above = shaft - zeta[:, 1] / k - JOINT_2_ABOVE
    above = np.maximum(above, JOINT_2_BELOW - (shaft - zeta[:, 0] / k))
    b8, b4 = of("crank_length"), of("coupler_length")
    apart = bar_distance(b8[:, None], b4[:, None], k[:, None], diagonal).min(axis=1)
    room = np.stack(
        [
            slider - SLIDER_FROM_AXIS,
            zeta[:, 0] / k - joint_3,
            np.where(lower, above, np.inf),
            apart - BESIDE,
        ],
        axis=-1,
    )
    return np.maximum(clearance - scale[:, None] * room, 0.0)
