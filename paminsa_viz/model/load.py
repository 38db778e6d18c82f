"""The load case: an external force and moment on the platform.

Moments M_x and M_y, and the horizontal moments of a force off the platform's center, load the
bearings and not the actuators: the platform moves along x, y, z and turns about z alone, so that
they do no work. `center_wrench` returns them, and the torques do not depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import require_kind
from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors
from paminsa_viz.model.parameters import Group, parameter


class LoadFrame(Enum):
    """What the direction of a load is fixed in."""

    WORLD = "world"
    PLATFORM = "platform"


WRENCH = ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z")
"""Fields of `LoadCase` that are a wrench, in its order [N, N, N, N m, N m, N m]."""

POINT = ("point_x", "point_y", "point_z")
"""Fields that are the point of its force [m]."""


@dataclass(frozen=True)
class LoadCase(Group, path="load"):
    """An external force and moment on the platform (none in the paper).

    The force acts at a point that moves with the platform, given in the platform's frame: from its
    center, with x, y, z as the base's at theta = 0. ``frame`` says whether force and moment keep
    their direction in the world or turn with the platform.
    """

    force_x: float = parameter(0.0, "F_x", "N", "external force along x", signed=True)
    force_y: float = parameter(0.0, "F_y", "N", "external force along y", signed=True)
    force_z: float = parameter(0.0, "F_z", "N", "external force along z", signed=True)
    moment_x: float = parameter(
        0.0, "M_x", "N m", "external moment about x, on the bearings alone", signed=True
    )
    moment_y: float = parameter(
        0.0, "M_y", "N m", "external moment about y, on the bearings alone", signed=True
    )
    moment_z: float = parameter(0.0, "M_z", "N m", "external moment about z", signed=True)
    point_x: float = parameter(0.0, "r_x", "m", "point of the force, x from center", signed=True)
    point_y: float = parameter(0.0, "r_y", "m", "point of the force, y from center", signed=True)
    point_z: float = parameter(0.0, "r_z", "m", "point of the force, z from center", signed=True)
    frame: LoadFrame = LoadFrame.WORLD

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.frame, LoadFrame):
            raise InvalidDesign("load.frame", self.frame, "a LoadFrame is needed")

    @property
    def wrench(self) -> tuple[float, float, float, float, float, float]:
        """(F_x, F_y, F_z, M_x, M_y, M_z) in the load's own directions [N, N m]."""
        return (
            self.force_x, self.force_y, self.force_z, self.moment_x, self.moment_y, self.moment_z
        )  # fmt: skip

    @property
    def point(self) -> tuple[float, float, float]:
        """Where the force acts, in the platform's frame [m]."""
        return self.point_x, self.point_y, self.point_z

    @property
    def acts(self) -> bool:
        """Whether there is any force or moment."""
        return any(self.wrench)

    @property
    def turns(self) -> float:
        """1 if the load turns with the platform, 0 if not: as `wrench_at_center` takes it."""
        return 1.0 if self.frame is LoadFrame.PLATFORM else 0.0


NO_LOAD = LoadCase()
"""No force and no moment."""


def wrench_at_center(
    fx: Any, fy: Any, fz: Any, mx: Any, my: Any, mz: Any, px: Any, py: Any, pz: Any, turns: Any,
    c: Any, s: Any,
) -> tuple[Any, Any, Any, Any, Any, Any]:  # fmt: skip
    """Return a load's force [N], and its moment about the platform's center [N m], in base axes.

    A plain formula of numbers; not in the paper.

    Args:
        fx, fy, fz, mx, my, mz: Force [N] and moment [N m].
        px, py, pz: Where the force acts, in the platform's frame [m].
        turns: 1 if force and moment turn with the platform, 0 if they do not.
        c, s: cos theta, sin theta.
    """
    cf, sf = turns * c + (1.0 - turns), turns * s
    wx, wy = cf * fx - sf * fy, sf * fx + cf * fy
    ax, ay = c * px - s * py, s * px + c * py
    return (
        wx,
        wy,
        fz,
        cf * mx - sf * my + ay * fz - pz * wy,
        sf * mx + cf * my + pz * wx - ax * fz,
        mz + ax * wy - ay * wx,
    )


def center_wrench(load: LoadCase, theta: ArrayLike, extra: ArrayLike | None = None) -> Array:
    """Return a load's force, and its moment about the platform's center, in base axes (..., 6).

    Args:
        load: The load.
        theta: Angle of the platform (...) [rad].
        extra: (..., 6) a further wrench at the same point and in the same directions [N, N m].

    Returns:
        (F_x, F_y, F_z, M_x, M_y, M_z) [N, N m]. M_x and M_y load the bearings alone.

    Raises:
        InvalidInput: If theta is no real number, or the further wrench does not hold six each.
    """
    require_kind(load, "load", LoadCase)
    theta = as_numbers(theta, "theta")
    parts: Any = load.wrench
    if extra is not None:
        parts = np.moveaxis(as_vectors(extra, "load", 6) + np.array(load.wrench), -1, 0)
    with np.errstate(invalid="ignore"):
        c, s = np.cos(theta), np.sin(theta)
        arguments: Any = (*parts, *load.point, load.turns, c, s)
        found = wrench_at_center(*arguments)
    return np.stack(np.broadcast_arrays(*found, theta)[:6], axis=-1)


def generalized_force(load: LoadCase, theta: ArrayLike, extra: ArrayLike | None = None) -> Array:
    """Return w, a load's force in the coordinates (x, y, theta, z), (..., 4) [N, N, N m, N].

    Arguments as in `center_wrench`.
    """
    return center_wrench(load, theta, extra)[..., [0, 1, 5, 2]]


def flat_load(load: ArrayLike | None, shape: tuple[int, ...]) -> Array | None:
    """Return a further wrench (..., 6) for every state of a batch, (n, 6).

    Raises:
        InvalidInput: If it does not fit the batch's shape.
    """
    if load is None:
        return None
    wrench = as_vectors(load, "load", 6)
    try:
        return np.broadcast_to(wrench, (*shape, 6)).reshape(-1, 6)
    except ValueError:
        raise InvalidInput("load", f"shape {wrench.shape} does not fit {(*shape, 6)}") from None
