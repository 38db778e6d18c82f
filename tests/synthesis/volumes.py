"""Volumes of random robots, counted point by point, without nodes, depths or closed forms."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from paminsa_viz.model import KneeBranch
from paminsa_viz.model.statics import static_torques
from paminsa_viz.synthesis.volume.grid import Resolution
from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
from tests.support.samples import random_design, random_poses
from tests.synthesis.robots import met, needs


class CountedVolume(NamedTuple):
    """A volume by the share of points where all requirements hold at 23 headings.

    Attributes:
        volume: It [m^3].
        deviation: Its standard deviation if the points were independent; Sobol's have less [m^3].
    """

    volume: float
    deviation: float


def counted_volume(seed: int, nodes: int, points: int) -> tuple[Volume, CountedVolume]:
    """Return the volume of a random robot for random headings and bounds, and what counting says.

    Args:
        seed: Of the robot, the range of its headings, and the bounds.
        nodes: Of the grid.
        points: To count, a power of two.
    """
    rng = np.random.default_rng(seed)
    design = random_design(rng).with_knee(KneeBranch.LOWER)
    turn = rng.uniform(0.1, 0.5)
    torque = np.abs(static_torques(design, random_poses(rng, design, 200))[:, :3]).max(axis=1)
    most = float(np.quantile(torque, 0.8))
    asked = needs("condition <= 8", f"max_torque <= {most!r} N m", theta=(-turn, turn))
    volume = solve_volume(design, asked, resolution=Resolution(nodes, 9, 5.0))
    corner = np.array([volume.x[0], volume.y[0], volume.z[0]])
    size = np.array([volume.x[-1], volume.y[-1], 0.0]) - corner
    left = corner + size * qmc.Sobol(3, rng=seed).random(points)
    for theta in np.linspace(-turn, turn, 23):  # a point that breaks something is done with
        left = left[met(design, np.insert(left, 2, theta, axis=1), 8.0, most, np.inf)]
    box = float(np.prod(size))
    return volume, CountedVolume(
        box * len(left) / points, box * math.sqrt(max(len(left), 1)) / points
    )
