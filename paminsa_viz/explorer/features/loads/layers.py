"""Forces at the joints as arrows, and the bars colored by their utilization."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Final

import numpy as np
from trimesh import Trimesh
from trimesh.creation import cylinder

from paminsa_viz.dimensions.layers import LAYER, SHAFT_RADIUS, TUBE_RADIUS
from paminsa_viz.elastostatics.joint_forces import JOINTS, JointForces
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.loads.solving import Instant, bars_at, forces_at, instant
from paminsa_viz.explorer.scene.forces import BAR, round_scale, scale_text
from paminsa_viz.explorer.scene.hues import ForceScale, hue_colors
from paminsa_viz.explorer.scene.mechanism import plane_directions, sticks
from paminsa_viz.explorer.scene.nodes import Node, arrows, copies, label
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.layers import LegendRow
from paminsa_viz.model import Limit
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.kinematics import Configuration
from paminsa_viz.palette import INK
from paminsa_viz.units import number

LONGEST: Final = 0.30
"""Longest arrow of a joint force, at Appendix 4's lengths [m]."""

ABOVE: Final = 0.10
"""Height of the label over the highest joint 2 [m]."""

SLEEVES: Final = {bar: radius + 0.0015 for bar, radius in TUBE_RADIUS.items()} | {
    "b2": SHAFT_RADIUS + 0.0015, "b1": 0.021, "b10": 0.017,
}  # fmt: skip
"""Radii of the colored sleeves about the bars [m]."""

PLACES: Final = {"m": 3, "guide": 8, "8_b8": 8, "8_b7": 8}
"""Joints by key whose place is another joint's; M_k is on the leg axis, at the guides' height."""

_STICKS: Final = ("b4", "b3", "b7", "b8", "b2", "b1", "b10")
"""Bars in the order of `mechanism.sticks`."""


def force_arrows(forces: JointForces, configuration: Configuration) -> tuple[Array, float]:
    """Return the arrows from the joints, (30, 2, 3) [m], and their scale [N for `BAR`].

    Each is the force on the body nearer to the platform, in the leg's plane; at joint 5 in space.
    """
    radial, across = plane_directions(configuration)
    scale = round_scale(
        float(forces.magnitude.max()), LONGEST * symbol_size(configuration.geometry)
    )
    starts, ends = [], []
    for index, joint in enumerate(JOINTS):
        start = configuration.points[PLACES.get(joint.key) or int(joint.key)].copy()
        if joint.key == "m":
            start[:, 2] = 0.0
        r, t, z = np.nan_to_num(forces.force[:, index]).T[..., None]
        force = r * radial + t * across + z * np.array([0.0, 0.0, 1.0])
        starts.append(start)
        ends.append(start + force * (BAR / scale))
    found = np.stack([np.stack(starts, axis=1), np.stack(ends, axis=1)], axis=2)
    return found.reshape(-1, 2, 3), scale


def joint_arrows(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``joint_forces``: at rest, or of a motion that is played."""
    at = _instant(frame)
    if at is None:
        return
    forces = forces_at(at)
    found, scale = force_arrows(forces, frame.configuration)
    size = symbol_size(frame.configuration.geometry)
    sizes = (0.0035, 0.009, 0.022)
    yield arrows("/joint_forces/arrows", found, frame.state.theme.ink, sizes, size)
    found = forces.magnitude
    leg, index = np.unravel_index(int(found.argmax()), found.shape)
    text = f"largest {number(float(found.max()), 3)} N at joint {JOINTS[index].label}"
    text += f", leg {leg + 1} ({scale_text(scale, size)})"
    yield _label("joint_forces", text, frame.configuration, 1.0)


def bar_sleeves(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``utilization``: sleeves about the bars, at rest or of a motion."""
    at = _instant(frame)
    if at is None:
        return
    use = bars_at(at)[1]
    largest = float(use.max())
    values = use[:, [BARS.index(bar) for bar in _STICKS]].reshape(-1)
    size = frame.configuration.geometry.body_scale
    positions, turns, scales = sleeve_places(bar_lines(frame.configuration), size)
    yield copies(
        "/joint_forces/bars", _tube(), positions, batched_wxyzs=turns, batched_scales=scales,
        batched_colors=hue_colors(values, ForceScale(0.0, max(largest, 1e-12))),
    )  # fmt: skip
    leg, index = np.unravel_index(int(use.argmax()), use.shape)
    text = f"stress up to {number(100 * largest, 2)} % of yield, {BARS[index].upper()} of leg "
    text += f"{leg + 1} (light; dark is 0)"
    yield _label("utilization", text, frame.configuration, 1.6)


def arrows_meaning(frame: Frame) -> LegendRow:
    """Explain the arrows of the joint forces; their own label states the scale."""
    when = "of the motion" if frame.state.playback.following else "at rest"
    return (INK,), f"joint forces {when}, scale at the largest"


def _instant(frame: Frame) -> Instant | None:
    """Return what the forces belong to, or None where they are not known."""
    if not frame.drawable:
        return None
    at = instant(frame.state)
    return at if forces_at(at).status == Limit.OK else None


@cache
def _tube() -> Trimesh:
    return cylinder(radius=1.0, height=1.0, sections=20)


def _label(key: str, text: str, configuration: Configuration, high: float) -> Node:
    above = high * ABOVE * symbol_size(configuration.geometry)
    place = (0.0, 0.0, float(configuration.actuators[3]) + above)
    return label(f"/joint_forces/label_{key}", text, place, "bottom-center")


def bar_lines(configuration: Configuration) -> Array:
    """Return the bars' center lines as they are drawn, beside the leg's plane, (21, 2, 3) [m]."""
    lines = sticks(configuration)[:, : len(_STICKS)].copy()
    _, across = plane_directions(configuration)
    aside = np.array([LAYER.get(bar, 0.0) for bar in _STICKS])
    aside *= configuration.geometry.body_scale
    lines += aside[:, None, None] * across[:, None, None, :]
    return lines.reshape(-1, 2, 3)


def sleeve_places(lines: Array, size: float = 1.0) -> tuple[Array, Array, Array]:
    """Return middles, quaternions and scales of cylinders along z that cover lines (n, 2, 3).

    Args:
        lines: Center lines of the bars, in the order of `bar_lines` [m].
        size: Size of the bodies over the prototype's.
    """
    along = lines[:, 1] - lines[:, 0]
    length = np.linalg.norm(along, axis=1)
    direction = along / np.maximum(length, 1e-12)[:, None]
    # half the turn from z to the direction; a line straight down is turned about x
    turns = np.stack(
        [1 + direction[:, 2], -direction[:, 1], direction[:, 0], np.zeros(len(lines))], axis=1
    )
    turns[direction[:, 2] < -1 + 1e-9] = [0.0, 1.0, 0.0, 0.0]
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    radius = size * np.tile([SLEEVES[bar] for bar in _STICKS], len(lines) // len(_STICKS))
    scales = np.stack([radius, radius, length], axis=1)
    return lines.mean(axis=1), turns, scales
