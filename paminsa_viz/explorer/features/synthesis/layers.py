"""The best robot of a search in the scene, while it runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.synthesis.actions import best_pose
from paminsa_viz.explorer.scene.mechanism import sticks
from paminsa_viz.explorer.scene.nodes import Node, lines
from paminsa_viz.explorer.state.synthesis import Shown
from paminsa_viz.model.kinematics import inverse_kinematics

BEST_COLOR: Final = "#CC79A7"
"""A hue of the Okabe-Ito set that no leg has."""

BEST_NODE: Final = "/synthesis/best"
"""Scene name of the best robot of a search."""


def best_robot(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``best_so_far``: the best robot of a search, as lines next to the robot."""
    synthesis = frame.state.synthesis
    best, job = synthesis.best, synthesis.running
    if job is None or synthesis.settings.shown is not Shown.GHOST:
        return
    if best is None or best.design is None:
        return
    pose = best_pose(best.center, job.case.requirements)
    bars = sticks(inverse_kinematics(best.design.geometry, pose))
    yield lines(BEST_NODE, bars.reshape(-1, 2, 3), BEST_COLOR, 4.0)
