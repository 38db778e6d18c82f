"""Forces at the platform: the external load, and the forces that the actuators can hold.

Lengths are drawn to a scale that a label states, such as "100 mm = 50 N". The sizes below are
those at Appendix 4's lengths.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from paminsa_viz import palette
from paminsa_viz.actuation.polytope import WrenchPolytope, wrench_polytope
from paminsa_viz.errors import PaminsaError
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.actuators import FACES, arc_arrow
from paminsa_viz.explorer.scene.curves import circles, linear_colors, segments
from paminsa_viz.explorer.scene.nodes import Node, arrows, label, label_below, lines, mesh
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.layers import LegendRow
from paminsa_viz.model import center_wrench
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.load import WRENCH, LoadCase
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.units import number

LONGEST: Final = 0.30
"""Longest arrow of a load [m]."""

FARTHEST: Final = 0.40
"""Largest distance of a polytope's corner from the platform's center [m]."""

BAR: Final = 0.1
"""Length that a label states the force of [m]."""

ABOVE: Final = 0.05
"""Height of the force polygon over the platform's origin, clear of its plate [m]."""

LOAD_COLOR: Final = palette.BAD

_EDGES: Final = [(a, b) for a in range(8) for b in range(a) if (a ^ b).bit_count() == 1]
"""Pairs of corners of `WrenchPolytope.vertices` that an edge joins."""

_SIDES: Final = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
"""Corners of the six faces, around each."""

_TRIANGLES: Final = np.array([[(a, b, c), (a, c, d)] for a, b, c, d in _SIDES]).reshape(-1, 3)


def round_scale(largest: float, longest: float) -> float:
    """Return what `BAR` stands for, 1, 2 or 5 times a power of ten, in the unit of ``largest``.

    The largest value is then drawn at most as long as ``longest`` [m].
    """
    return _round_up(max(largest, 1e-9) * BAR / longest)


def _round_up(least: float) -> float:
    """Return 1, 2 or 5 times a power of ten that is no less than a number above 0."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= least * (1 - 1e-9))


def full_moment(largest: float) -> float:
    """Return the moment that a full arc stands for, for the largest one to be drawn [N m]."""
    return _round_up(max(largest, 1e-9))


def scale_text(scale: float, size: float, unit: str = "N") -> str:
    """Return what a label says of a scale, beside symbols of a size: of 100 mm, 1 m or 10 mm.

    Args:
        scale: What `BAR` stands for [unit].
        size: As of `symbol_size`.
        unit: The unit.
    """
    times = 10.0 ** round(math.log10(size))
    return f"{number(1e3 * BAR * times)} mm = {number(scale * times, 3)} {unit}"


def load_arrow(design: Design, pose: Array, largest: float = 0.0) -> tuple[Array, float]:
    """Return the arrow of a design's force, from its point (1, 2, 3) [m], and its scale [N].

    The scale suits a larger force as well, if one is given [N].
    """
    x, y, theta, z = pose
    c, s = math.cos(theta), math.sin(theta)
    px, py, pz = design.load.point
    start = np.array([x + c * px - s * py, y + s * px + c * py, z + pz])
    force = center_wrench(design.load, theta)[:3]
    scale = round_scale(
        max(float(np.linalg.norm(force)), largest), LONGEST * symbol_size(design.geometry)
    )
    return np.stack([start, start + force * BAR / scale])[None], scale


def played_load(
    load: LoadCase, trajectory: Trajectory, t: float
) -> tuple[LoadCase, tuple[float, float]]:
    """Return a load with the motion's own at a time [s], and the largest force and moment about z
    on the way [N, N m]."""
    found = trajectory.load_at(np.array([t]))
    if found is None or trajectory.load is None:
        return load, (0.0, 0.0)
    loads = trajectory.load + np.array(load.wrench)
    wrench = dict(zip(WRENCH, (found[0] + load.wrench).tolist(), strict=True))
    largest = np.linalg.norm(loads[:, :3], axis=1).max(), np.abs(loads[:, 5]).max()
    return replace(load, **wrench), (float(largest[0]), float(largest[1]))


def load_arrows(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``load``: the force as an arrow at its point, the moment as an arc, a label.

    While a motion with a load of its own is played, it is the load at that time.
    """
    state, design = frame.state, frame.shown_design
    pose, force, moment = frame.configuration.pose, 0.0, 0.0
    if state.playback.following and frame.analysis is not None:
        trajectory, time = frame.analysis.trajectory, state.playback.time
        load, (force, moment) = played_load(design.load, trajectory, time)
        design = replace(design, load=load)
    load = design.load
    if not load.acts or not np.isfinite(pose).all():
        return
    arrow, scale = load_arrow(design, pose, force)
    full = full_moment(max(abs(load.moment_z), moment))
    size = symbol_size(design.geometry)
    if any(load.wrench[:3]):
        yield arrows("/load/force", arrow, LOAD_COLOR, (0.005, 0.012, 0.03), size)
    if load.moment_z:
        arc = size * arc_arrow(load.moment_z / full)
        yield mesh("/load/moment", arc, FACES, LOAD_COLOR, place=pose[[0, 1, 3]])
    yield label("/load/label", load_text(design, scale, full), arrow[0, 1], "bottom-center")


def load_meaning(frame: Frame) -> LegendRow:
    """Explain the arrow of the external load; its own label states the scale."""
    if not frame.shown_design.load.acts:
        return None
    when = "of the design and the motion" if frame.state.playback.following else "of the design"
    return (LOAD_COLOR,), f"external load {when}, scale at the arrow"


def load_text(design: Design, scale: float, full: float) -> str:
    """Return the label of a load: the size of its force, its moment, and their scales."""
    load, parts = design.load, []
    force = float(np.linalg.norm(load.wrench[:3]))
    if force:
        stated = scale_text(scale, symbol_size(design.geometry))
        parts.append(f"{number(force, 3)} N ({stated})")
    if load.moment_z:
        arc = f"full arc {number(full, 3)} N·m"
        parts.append(f"moment {number(load.moment_z, 3)} N·m about z ({arc})")
    if not parts:
        parts.append("moment on the bearings alone")
    return ", ".join(parts)


def polygon_lines(found: WrenchPolytope) -> tuple[Array, tuple[str, ...]]:
    """Return the sides of the force polygon, (n, 2, 2) [N], and the actuator limiting each."""
    polygon = found.section()
    sides = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
    return sides, found.sectors if len(polygon) else ()


def force_polygon(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``force_polygon``: horizontal forces that are held with M_z = 0.

    Each side has the color of the actuator that limits it; with the largest disc in the polygon.
    """
    found = _polytope(frame)
    if found is None:
        return
    size = symbol_size(frame.shown_design.geometry)
    platform = frame.configuration.pose[[0, 1, 3]]
    center = platform + np.array([0.0, 0.0, ABOVE * size])
    sides, limits = polygon_lines(found)
    if not len(sides):
        yield label("/forces/polygon label", "no horizontal force is held here", center)
        return
    scale = round_scale(float(np.linalg.norm(sides, axis=-1).max()), FARTHEST * size)
    flat = np.concatenate([sides, np.zeros((*sides.shape[:2], 1))], axis=-1)
    colors = linear_colors(*map(_color, limits))[:, None].repeat(2, axis=1)
    yield lines("/forces/polygon", center + flat * BAR / scale, colors, 4.0)
    edges = sides[:, 1] - sides[:, 0]
    distance = np.abs(edges[:, 0] * sides[:, 0, 1] - edges[:, 1] * sides[:, 0, 0])
    distance /= np.linalg.norm(edges, axis=1)
    worst = int(np.argmin(distance))
    radius = float(distance[worst]) if found.holds else 0.0
    dashed = segments(circles(radius * BAR / scale, 48))[::2]
    yield lines("/forces/disc", center + dashed, frame.state.theme.ink, 2.0)
    text = f"every direction {number(radius, 3)} N, {limits[worst]} ({scale_text(scale, size)})"
    yield label_below("/forces/polygon label", text, platform, "force_polygon", size)


def wrench_solid(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``wrench_solid``: forces that are held with M_z / R_pl upward.

    The face that limits first is named.
    """
    found = _polytope(frame)
    if found is None:
        return
    center = frame.configuration.pose[[0, 1, 3]]
    corners = found.vertices / [1.0, 1.0, found.length]
    size = symbol_size(frame.shown_design.geometry)
    scale = round_scale(float(np.linalg.norm(corners, axis=1).max()), FARTHEST * size)
    places = center + corners * BAR / scale
    yield mesh(
        "/forces/solid", places, _TRIANGLES, palette.PLATFORM, opacity=0.35, flat_shading=True
    )
    # an edge along which one actuator's torque varies has that actuator's color
    colors = linear_colors(*(LEG_COLORS[2 - (a ^ b).bit_length() + 1] for a, b in _EDGES))
    yield lines("/forces/edges", places[np.array(_EDGES)], colors[:, None].repeat(2, axis=1), 2.5)
    limit, up = found.faces[found.limiting_face], "moment over platform radius"
    text = f"limit: {limit} (up: {up}; {scale_text(scale, size)})"
    yield label_below("/forces/solid label", text, center, "wrench_solid", size)


def _polytope(frame: Frame) -> WrenchPolytope | None:
    try:
        return wrench_polytope(frame.shown_design, frame.configuration.pose)
    except PaminsaError:
        return None


def _color(limit: str) -> str:
    """Return the color of the actuator that a limit names, "M2 at +T"."""
    return LEG_COLORS[ACTUATORS.index(limit.partition(" ")[0])]
