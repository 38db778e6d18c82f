"""Requirements on a box of poses, and a robot's measures over it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import ROTARY_TORQUES, WRENCH_TORQUES
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.load import generalized_force
from paminsa_viz.model.reach import LEAST_MARGIN
from paminsa_viz.model.singularity import DEXTERITY, singular_radius, singular_rotation
from paminsa_viz.model.statics import static_imbalance

FINER = 3
"""How many times closer the poses of the last check lie."""

Pose = tuple[float, float, float, float]


@dataclass(frozen=True)
class BoxRequirements:
    """A box of poses that the robot has to reach, and how far from its limits.

    Attributes:
        low, high: Corners of the box, (x, y, theta, z) [m, m, rad, m].
        margin: Least distance to every limit of reach over the box [m].
        radius_clearance: Least distance from the box to the singular circle [m].
        turn_clearance: Least turn from the box to the singular rotation [rad].
        counts: Sample poses along each axis for torque, condition and reach.
    """

    low: Pose
    high: Pose
    margin: float = 0.01
    radius_clearance: float = 0.03
    turn_clearance: float = 0.15
    counts: tuple[int, int, int, int] = (5, 5, 5, 5)

    def __post_init__(self) -> None:
        corners = np.array([self.low, self.high], float)
        if corners.shape != (2, 4) or not np.isfinite(corners).all():
            raise InvalidInput("box", "two corners of four finite numbers are needed")
        if (corners[0] > corners[1]).any():
            raise InvalidInput("box", "low must not be above high on any axis")
        if len(self.counts) != 4 or min(self.counts) < 1:
            raise InvalidInput("counts", "at least one pose along each of the four axes is needed")

    def poses(self) -> Array:
        """Return the sample poses, (n, 4); the corners are among them."""
        axes = [
            np.linspace(a, b, n if b > a else 1)
            for a, b, n in zip(self.low, self.high, self.counts, strict=True)
        ]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)

    def finer(self) -> BoxRequirements:
        """Return the same with poses `FINER` times as close."""
        x, y, theta, z = (FINER * (count - 1) + 1 for count in self.counts)
        return replace(self, counts=(x, y, theta, z))


@dataclass(frozen=True)
class Measures:
    """Measures of a robot over a box.

    Attributes:
        torque: Peak static torque of M1..M3 [N m]; infinite if a pose cannot be taken.
        condition: Largest condition number; infinite likewise.
        size: R_b + l_B8 + l_B4 [m].
        margin: Least distance to a limit of reach, negative beyond it [m].
        radius_clearance: Distance from the box to the singular circle, for every theta in it [m].
        turn_clearance: Turn from the box to the singular rotation; infinite if there is none [rad].
    """

    torque: float
    condition: float
    size: float
    margin: float
    radius_clearance: float
    turn_clearance: float

    def broken(self, needs: BoxRequirements) -> float:
        """Return by how much requirements are broken in all [m, rad]; zero if all are met."""
        names = ("margin", "radius_clearance", "turn_clearance")
        return float(sum(max(0.0, getattr(needs, n) - getattr(self, n)) for n in names))


def measure(design: Design, needs: BoxRequirements) -> Measures:
    """Measure a robot over a box of poses.

    Reach, torque and condition are those of the sample poses; clearances from
    singularities are those of the whole box, in closed form.
    """
    g = design.geometry
    x, y, theta, z = needs.poses().T
    # Always on arrays: compiled kernels differ in the last digit, and a search has to come out the
    # same in processes that have them and in others.
    args = (mechanism(g), x, y, np.cos(theta), np.sin(theta), z)
    gamma = np.array(backend.on_arrays(ROTARY_TORQUES, *args))
    margin = backend.on_arrays(LEAST_MARGIN, *args)[0]
    condition = backend.on_arrays(DEXTERITY, *args)[1]
    torque = abs(static_imbalance(design)) * np.abs(gamma).max()
    if design.load.acts:
        j = np.array(backend.on_arrays(WRENCH_TORQUES, *args)).reshape(3, 3, -1)
        w = generalized_force(design.load, theta)[:, :3]
        loaded = static_imbalance(design) * gamma - np.einsum("ijn,ni->jn", j, w)
        torque = np.abs(loaded).max()
    corners = np.abs([needs.low, needs.high])
    far = float(np.hypot(*corners[:, :2].max(axis=0)))
    # the circle is smallest at the theta nearest to zero
    least = 0.0 if needs.low[2] <= 0.0 <= needs.high[2] else float(corners[:, 2].min())
    return Measures(
        torque=float(np.nan_to_num(torque, nan=np.inf)),
        condition=float(np.nan_to_num(condition, nan=np.inf).max()),
        size=g.base_radius + g.crank_length + g.coupler_length,
        margin=float(np.nan_to_num(margin, nan=-1.0).min()),
        radius_clearance=float(singular_radius(g, min(least, np.pi))) - far,
        turn_clearance=float(np.nan_to_num(singular_rotation(g), nan=np.inf) - corners[:, 2].max()),
    )
