"""Random robots with boxes of their drives' errors, and errors at points of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model import Design, check_reach, inverse_kinematics, nearest_solution
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.precision.drive_errors import DriveErrors, drive_errors
from tests.support.samples import random_design


class Boxes(NamedTuple):
    """Poses (n, 4) of one robot, each with a bound of its errors, see `random_boxes`."""

    design: Design
    half: Any
    found: DriveErrors

    @property
    def bounds(self) -> Any:
        """Errors of x, y, theta and in the plane as the program bounds them, (n, 4)."""
        return np.column_stack([self.found.worst[..., :3], self.found.horizontal])

    @property
    def corners(self) -> Any:
        """The same of the corners alone, (n, 4)."""
        return self.bounds - self.found.between

    def worst(self, steps: Any) -> Any:
        """The same at points (m, 4) of the box, by forward kinematics, (n, 4)."""
        off = moved(self.design, self.found.pose, steps)
        assert np.isfinite(off).all()  # a box with a bound has a platform everywhere
        sideways = np.hypot(off[..., 0], off[..., 1]).max(axis=1)
        return np.column_stack([np.abs(off[..., :3]).max(axis=1), sideways])


def boxes(design: Design, poses: Any, accuracy: DriveAccuracy) -> Boxes:
    """The boxes about those of the poses (n, 4) that have a bound."""
    found = drive_errors(design.geometry, accuracy, poses)
    bounded = drive_errors(design.geometry, accuracy, poses[found.ok])
    return Boxes(design, np.array(accuracy.half_widths), bounded)


def random_boxes(rng: np.random.Generator, robots: int, each: int = 20) -> Iterator[Boxes]:
    """Robots and boxes of 0.06 to 6 degrees to each side at random.

    Every second robot has a platform that may be wider than its base, and poses outside of the
    singular circle; in many of its boxes an edge is worse than the corners.
    """
    for number in range(robots):
        design = random_design(rng)
        g = design.geometry
        if number % 2:
            wider = replace(g, platform_radius=rng.uniform(0.6, 1.8) * g.base_radius,
                            crank_length=4 * g.crank_length, coupler_length=4 * g.coupler_length,
                            guide_link_length=5.0)  # fmt: skip
            design = replace(design, geometry=wider)
        g = design.geometry
        length = g.crank_length + g.coupler_length
        poses = rng.uniform(-1, 1, (150, 4)) * [length / 3, length / 3, 1.4, length]
        poses = poses[check_reach(g, poses).ok][:each]
        half = np.radians(10 ** rng.uniform(-1.2, 0.78))
        yield boxes(design, poses, DriveAccuracy(resolution_rotary=2 * half))


def moved(design: Design, poses: Any, steps: Any) -> Any:
    """Errors (n, m, 4) of poses (n, 4) for actuators off by (m, 4), by forward kinematics."""
    actuators = inverse_kinematics(design.geometry, poses).actuators[:, None] + steps
    return nearest_solution(design.geometry, actuators, poses[:, None]) - poses[:, None]


def samples(rng: np.random.Generator, half: Any, count: int) -> Any:
    """Points of the box (count, 4): a third inside, a third on its edges, a third on faces."""
    drawn = rng.uniform(-1.0, 1.0, (count, 4))
    pinned = rng.permuted(np.tile([True, True, False], (count, 1)), axis=1)
    pinned[: count // 3] = False
    pinned[: 2 * count // 3] &= rng.uniform(size=(2 * count // 3, 1)) < 0.5
    drawn[:, :3] = np.where(pinned, np.sign(drawn[:, :3]), drawn[:, :3])
    return drawn * half


def edge_points(half: Any, count: int) -> Any:
    """So many points of each of the twelve edges of M1..M3, (12 count, 4)."""
    along = np.linspace(-1.0, 1.0, count)
    edges = []
    for j in range(3):
        for others in product((-1.0, 1.0), repeat=2):
            points = np.zeros((count, 4))
            points[:, [i for i in range(3) if i != j]], points[:, j] = others, along
            edges.append(points)
    return np.concatenate(edges) * half
