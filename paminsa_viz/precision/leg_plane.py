"""A leg with lengths of its own, in its plane: where joint 5 is, and how it moves with each length.

Leg plane: (r, z) with r from the leg axis toward the platform, z up from the base plane. Given are
the lift Z of joint 2 and the place s of the slider on the guide, so that joint 8 is at (s, h_8) and
joint 3 at (0, Z - l_B2). Then 7 lies on circles about 8 and 3, 4 on the line 7-3 beyond 3, 9 on
circles about 8 and 4, and 5 on the line 9-4 beyond 4. Of each pair of intersections the one is
taken that the nominal pantograph has: 7 and 9 are on opposite sides of the lines 8-3 and 8-4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.precision.leg_lengths import INDEX

PLANE_INPUTS = (
    "slide", "lift", "bar_94", "bar_45", "bar_43", "bar_37", "bar_87", "bar_89", "shaft",
    "guide_height",
)  # fmt: skip
"""What joint 5 depends on in the leg's plane, in the order of `joint_5_derivatives`."""

PLANE_COLUMN = {name: index for index, name in enumerate(PLANE_INPUTS)}
"""Places of `PLANE_INPUTS` by name."""


class LegPlane(NamedTuple):
    """Directions of a leg's bars and the place of joint 5, all (..., 2) in the leg plane (r, z).

    Attributes:
        bar_89, bar_94, bar_43, bar_87: Unit vectors from the first joint to the second; 9-4-5 and
            4-3-7 are straight.
        joint_5: Place of joint 5 [m].
    """

    bar_89: Array
    bar_94: Array
    bar_43: Array
    bar_87: Array
    joint_5: Array


@np.errstate(all="ignore")
def solve_leg(lengths: Array, slide: Array, lift: Array, root: float) -> LegPlane:
    """Solve the loops of legs (...); NaN where the bars cannot close.

    Args:
        lengths: (..., 14), see `leg_lengths.LENGTHS`.
        slide: (...) place of the slider along the guide, negative beyond the leg axis [m].
        lift: (...) height Z of joint 2 [m].
        root: Branch of the knee, `KneeBranch.sign`.
    """
    length = {name: lengths[..., index] for name, index in INDEX.items()}
    height = lift - length["shaft"]
    p8, p3 = np.zeros((2, *np.broadcast_shapes(slide.shape, height.shape), 2))
    p8[..., 0], p8[..., 1], p3[..., 1] = slide, length["guide_height"], height
    p7 = _intersection(p8, length["bar_87"], p3, length["bar_37"], root)
    bar_43 = (p7 - p3) / length["bar_37"][..., None]
    p4 = p3 - bar_43 * length["bar_43"][..., None]
    p9 = _intersection(p8, length["bar_89"], p4, length["bar_94"], -root)
    bar_94 = (p4 - p9) / length["bar_94"][..., None]
    return LegPlane(
        (p9 - p8) / length["bar_89"][..., None],
        bar_94,
        bar_43,
        (p7 - p8) / length["bar_87"][..., None],
        p4 + bar_94 * length["bar_45"][..., None],
    )


def _intersection(p: Array, radius: Array, q: Array, other: Array, side: float) -> Array:
    """Return where circles about p and q meet, (..., 2), to the left of p to q for a side of +1."""
    d = q - p
    inverse = 1.0 / np.sum(d * d, axis=-1)
    foot = 0.5 + 0.5 * (radius**2 - other**2) * inverse
    rise = side * np.sqrt(radius**2 * inverse - foot**2)
    return p + foot[..., None] * d + rise[..., None] * left(d)


@np.errstate(all="ignore")
def joint_5_derivatives(lengths: Array, plane: LegPlane) -> Array:
    """Return the derivatives of joint 5 in the leg's plane, (..., 2, 10), see `PLANE_INPUTS`.

    The loops 8-7-3 and 8-9-4-3, differentiated, are two equations each for the turns of two bars.
    """
    length = {name: lengths[..., index, None] for name, index in INDEX.items()}
    shape = (*plane.joint_5.shape, len(PLANE_INPUTS))
    at_8, at_3, loop_7, loop_9, moved = (np.zeros(shape) for _ in range(5))
    at_8[..., 0, PLANE_COLUMN["slide"]] = at_8[..., 1, PLANE_COLUMN["guide_height"]] = 1.0
    at_3[..., 1, PLANE_COLUMN["lift"]] = 1.0
    at_3[..., 1, PLANE_COLUMN["shaft"]] = -1.0
    # 8 + l_87 u_87 = 3 + l_37 u_43
    loop_7 += at_3 - at_8
    loop_7[..., PLANE_COLUMN["bar_37"]] += plane.bar_43
    loop_7[..., PLANE_COLUMN["bar_87"]] -= plane.bar_87
    turned_87 = length["bar_87"] * left(plane.bar_87)
    turned_37 = length["bar_37"] * left(plane.bar_43)
    _, turn_43 = _solve_pair(turned_87, -turned_37, loop_7)
    # 8 + l_89 u_89 + l_94 u_94 + l_43 u_43 = 3
    turned_43 = length["bar_43"] * left(plane.bar_43)
    loop_9 += at_3 - at_8 - turned_43[..., None] * turn_43[..., None, :]
    loop_9[..., PLANE_COLUMN["bar_89"]] -= plane.bar_89
    loop_9[..., PLANE_COLUMN["bar_94"]] -= plane.bar_94
    loop_9[..., PLANE_COLUMN["bar_43"]] -= plane.bar_43
    turned_89 = length["bar_89"] * left(plane.bar_89)
    turned_94 = left(plane.bar_94)
    turn_89, turn_94 = _solve_pair(turned_89, length["bar_94"] * turned_94, loop_9)
    # 5 = 8 + l_89 u_89 + (l_94 + l_45) u_94
    whole = (length["bar_94"] + length["bar_45"]) * turned_94
    moved += at_8 + turned_89[..., None] * turn_89[..., None, :]
    moved += whole[..., None] * turn_94[..., None, :]
    moved[..., PLANE_COLUMN["bar_89"]] += plane.bar_89
    moved[..., PLANE_COLUMN["bar_94"]] += plane.bar_94
    moved[..., PLANE_COLUMN["bar_45"]] += plane.bar_94
    return moved


def left(vector: Array) -> Array:
    """Return vectors (..., 2) or (..., 3) turned by +90 degrees about z, without their z."""
    found = np.zeros_like(vector)
    found[..., 0], found[..., 1] = -vector[..., 1], vector[..., 0]
    return found


def _solve_pair(a: Array, b: Array, right: Array) -> tuple[Array, Array]:
    """Solve a x + b y = right for vectors (..., 2) and right sides (..., 2, n)."""
    inverse = (1.0 / (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]))[..., None]
    first, second = right[..., 0, :], right[..., 1, :]
    x = (first * b[..., 1, None] - second * b[..., 0, None]) * inverse
    y = (a[..., 0, None] * second - a[..., 1, None] * first) * inverse
    return x, y
