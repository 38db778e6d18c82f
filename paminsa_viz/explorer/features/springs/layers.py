"""The springs that were fitted, in the scene, and what they are fixed to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.mechanism import directions
from paminsa_viz.explorer.scene.nodes import Node, curves, lines
from paminsa_viz.model import Configuration
from paminsa_viz.model.arrays import Array

if TYPE_CHECKING:
    from paminsa_viz.balancing.springs import Anchor, Spring  # loads SciPy

TURNS: Final = 10
"""Turns of a spring as it is drawn."""

WIDTH: Final = 0.03
"""Width of a spring as it is drawn beside the prototype's bodies [m]."""

END: Final = 0.12
"""Share of its length that is straight at each end."""


def fitted_springs(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``springs``: zigzags in the planes of the legs, and masts or posts."""
    found = frame.state.springs.result
    if found is None or not frame.drawable:
        return
    ink, configuration = frame.state.theme.ink, frame.configuration
    width = WIDTH * configuration.geometry.body_scale
    for index, spring in enumerate(found.springs):
        if not spring.stiffness:
            continue
        ends = spring_ends(configuration, spring)
        yield curves(f"/springs/{index}", zigzags(ends, width), ink, 2.5)
        if spring.first.kind in ("slider", "guide"):
            foot = ends[:, 0] * [1.0, 1.0, 0.0]
            masts = np.stack([foot, ends[:, 0]], axis=1)
            yield lines(f"/springs/{index}/masts", masts, ink, 4.0)


def spring_ends(configuration: Configuration, spring: Spring) -> Array:
    """Return both ends of the springs of the three legs, (3, 2, 3) [m]."""
    ends = [_place(configuration, anchor) for anchor in (spring.first, spring.second)]
    return np.stack(ends, axis=1)


def _place(configuration: Configuration, anchor: Anchor) -> Array:
    """Return where a point of the legs is, (3, 3) [m]."""
    axis, _, heading = directions(configuration)
    knee, joint = configuration.points[9] - axis, configuration.points[5] - axis
    radius, knee_radius = ((place * heading).sum(axis=-1) for place in (joint, knee))
    w = anchor.weights(configuration.geometry)
    along = w.r5 * radius + w.r9 * knee_radius + w.r0
    height = w.z5 * joint[:, 2] + w.r9 * knee[:, 2] + w.z0
    return axis + along[:, None] * heading + height[:, None] * [0.0, 0.0, 1.0]


def zigzags(ends: Array, width: float = WIDTH) -> Array:
    """Return springs between their ends (n, 2, 3) as curves in upright planes, (n, m, 3) [m]."""
    start, span = ends[:, 0], ends[:, 1] - ends[:, 0]
    level = np.hypot(span[:, 0], span[:, 1])
    # across the spring, in the upright plane through it
    across = np.stack([-span[:, 0] * span[:, 2], -span[:, 1] * span[:, 2], level**2], axis=1)
    size = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.divide(across, size, out=np.tile([1.0, 0.0, 0.0], (len(ends), 1)), where=size > 0)
    share = np.concatenate(
        [[0.0, END], np.linspace(END, 1 - END, 2 * TURNS + 2)[1:-1], [1 - END, 1]]
    )
    side = np.zeros(share.size)
    side[2:-2] = width / 2 * (-1.0) ** np.arange(2 * TURNS)
    return start[:, None] + share[:, None] * span[:, None] + side[:, None] * across[:, None]
