"""The escape twist where a motion crosses a singularity, as arrows of the platform."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.nodes import Node, arrows, label_below
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.layers import LegendRow
from paminsa_viz.model import Geometry, inverse_kinematics
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import BAD
from paminsa_viz.trajectory import TimeOptimalPlan

LONGEST: Final = 0.2
"""Longest arrow [m]."""


def twist_arrows(geometry: Geometry, found: TimeOptimalPlan) -> Array:
    """Return the motions of the platform's center and joints 5 along t_s, (4 k, 2, 3) [m].

    The crossings are after each other; the longest arrow of each is `LONGEST`, in a robot of
    Appendix 4's lengths.
    """
    found_arrows = [np.zeros((0, 2, 3))]
    for item in found.crossings:
        pose, twist = np.array(item.crossing.pose), np.array(item.condition.twist)
        center = pose[[0, 1, 3]]
        joints = inverse_kinematics(geometry, pose).points[5]
        starts = np.concatenate([center[None], joints])
        arms = starts - center
        moves = np.array([twist[0], twist[1], twist[3]]) + twist[2] * np.stack(
            [-arms[:, 1], arms[:, 0], np.zeros(4)], axis=1
        )
        moves *= LONGEST * symbol_size(geometry) / np.linalg.norm(moves, axis=1).max()
        found_arrows.append(np.stack([starts, starts + moves], axis=1))
    return np.concatenate(found_arrows)


def escape_arrows(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``escape_twist``: arrows at every planned crossing, with a label."""
    state = frame.state
    crosses = state.document.motion.crosses and "path" in state.layers
    found = motions.planned(state).crossing if crosses else None
    if found is None or not found.crossings:
        return
    geometry = state.document.design.geometry
    twists, size = twist_arrows(geometry, found), symbol_size(geometry)
    yield arrows("/escape/arrows", twists, BAD, (0.006, 0.014, 0.035), size)
    for index, item in enumerate(found.crossings):
        x, y, _, z = item.crossing.pose
        text = f"Escape twist at the {item.crossing.locus.label}"
        yield label_below(f"/escape/label{index}", text, (x, y, z), "escape_twist", size)


def escape_meaning(frame: Frame) -> LegendRow:
    """Explain the arrows of the platform's motion at a planned crossing."""
    state = frame.state
    if not state.document.motion.crosses or "path" not in state.layers:
        return None
    return (BAD,), "escape twist at the crossing, not to scale"
