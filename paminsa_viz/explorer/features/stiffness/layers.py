"""Elasticity in the scene: the animated mode, the deflected robot, the compliance ellipsoid."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from paminsa_viz.elastostatics.center_lines import CenterLines
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.forces import BAR, round_scale, scale_text
from paminsa_viz.explorer.scene.nodes import NO_SHADOWS, Node, ball, curves, label_below, mesh
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.stiffness import CASES, MODE_NODE, ElasticOutcome
from paminsa_viz.kept import kept
from paminsa_viz.meshes.vibrating import vibrating_glb
from paminsa_viz.model.arrays import Pose
from paminsa_viz.units import number

MODE_COLOR: Final = "#CC79A7"
DEFLECTED_COLOR: Final = "#000000"
ELLIPSOID_COLOR: Final = "#56B4E9"
"""Hues of the Okabe-Ito set that no leg has."""

LONGEST_SWING: Final = 0.06
"""Largest displacement of an animated mode, as drawn [m]."""

PERIOD: Final = 1.6
"""Time of a swing on the page [s]: all modes are shown as slowly."""

TUBE: Final = 0.006
"""Radius of the lines of a mode [m]."""

LARGEST: Final = 0.12
"""Largest deflection, as drawn [m]."""

LONGEST_AXIS: Final = 0.3
"""Largest half axis of the ellipsoid, as drawn [m]: the platform must not hide it."""


def _outcome(frame: Frame) -> ElasticOutcome | None:
    """Return the result about the pose and the lengths that are shown, or None."""
    outcome, last = frame.state.stiffness.outcome, frame.state.last_reachable
    if outcome is None or outcome.job.pose != last.pose:
        return None
    return outcome if outcome.job.design.geometry == last.geometry else None


def mode_shape(frame: Frame) -> tuple[Node, ...]:
    """Draw the layer ``mode_shape``: the chosen mode as tubes that swing about the center lines.

    The browser plays the animation by itself. A new one is sent when the page is idle, and the old
    one is removed as soon as the robot moves.
    """
    outcome, mode = _outcome(frame), frame.state.stiffness.settings.mode
    found = None if outcome is None else outcome.result
    if outcome is None or found is None or mode >= len(found.frequencies) or not found.shapes:
        return ()
    size = symbol_size(outcome.job.design.geometry)
    text = mode_text(mode, found.frequencies[mode], LONGEST_SWING * size)
    radius = TUBE * outcome.job.design.geometry.body_scale
    return _animated(outcome.job.pose, found.shapes, mode, text, size, radius)


@kept(2)
def _animated(
    pose: Pose, shapes: CenterLines, mode: int, text: str, size: float, radius: float
) -> tuple[Node, ...]:
    moves = shapes.moves[..., mode] * LONGEST_SWING * size / shapes.largest[mode]
    data = vibrating_glb(shapes.points, moves, radius=radius, color=MODE_COLOR, period=PERIOD)
    x, y, _, z = pose
    return (
        Node(MODE_NODE, "glb", {"glb_data": data}, NO_SHADOWS),
        label_below(f"{MODE_NODE}_label", text, (x, y, z), "mode_shape", size),
    )


def mode_text(mode: int, frequency: float, swing: float) -> str:
    """Return the label of an animated mode: its frequency and its scale."""
    return (
        f"mode {mode + 1}: {number(frequency, 3)} Hz, largest swing drawn as "
        f"{number(1e3 * swing, 3)} mm, slowed down"
    )


def deflection(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``deflection``: center lines under the load case, displacements enlarged."""
    outcome = _outcome(frame)
    found = None if outcome is None or outcome.result is None else outcome.result.deflected
    if outcome is None or found is None:
        return
    size = symbol_size(outcome.job.design.geometry)
    scale = BAR / round_scale(float(found.largest[0]), LARGEST * size)
    moved = found.points + scale * found.moves[..., 0]
    yield curves("/elastic/deflected", moved, frame.state.theme.shown(DEFLECTED_COLOR), 4.0)
    center = found.points[found.names.index("platform"), 0]
    text = f"deflection × {number(scale, 3)}: {CASES[outcome.job.case][0]}"
    yield label_below("/elastic/deflected_label", text, center, "deflection", size)


def compliance(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``compliance``: displacements of P by a force of one size, all around."""
    outcome = _outcome(frame)
    if outcome is None or outcome.result is None:
        return
    found = outcome.result.stiffness.compliance
    size = symbol_size(outcome.job.design.geometry)
    longest = float(np.linalg.norm(found[:3, :3], 2))
    scale = BAR / round_scale(longest, LONGEST_AXIS * size)
    shape = scale * ball(1.0).vertices @ found[:3, :3].T
    x, y, _, z = outcome.job.pose
    yield mesh(
        "/elastic/ellipsoid", shape, ball(1.0).faces, ELLIPSOID_COLOR, place=(x, y, z), opacity=0.45
    )
    text = ellipsoid_text(scale, size)
    yield label_below("/elastic/ellipsoid_label", text, (x, y, z), "compliance", size)


def ellipsoid_text(scale: float, size: float) -> str:
    """Return the scale of the ellipsoid: drawn length for a displacement by 100 N.

    Args:
        scale: Drawn length over the displacement by 1 N.
        size: Of the symbols, see `symbol_size`.
    """
    return f"compliance: {scale_text(1e3 * 100 * BAR / scale, size, 'mm by 100 N')}"
