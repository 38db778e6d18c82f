"""Forces at the platform: the external load, and the forces that the actuators can hold.

Lengths are drawn to a scale that a label states, such as "100 mm = 50 N".
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from viser import ArrowsHandle, LabelHandle, LineSegmentsHandle, MeshHandle

from paminsa_viz import palette
from paminsa_viz.actuation.polytope import WrenchPolytope, wrench_polytope
from paminsa_viz.errors import PaminsaError
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.actuators import FACES, arc_arrow
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model import center_wrench
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.load import WRENCH, LoadCase
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.units import number

Array = NDArray[np.float64]

LONGEST: Final = 0.30
"""Longest arrow of a load [m]."""

FARTHEST: Final = 0.40
"""Largest distance of a polytope's corner from the platform's center [m]."""

FULL_MOMENT: Final = 20.0
"""Moment that a full arc stands for [N m]; greater ones are drawn as long."""

BAR: Final = 0.1
"""Length that a label states the force of [m]."""

ABOVE: Final = 0.05
"""Height of the force polygon over the platform's origin, clear of its plate [m]."""

BELOW: Final = 0.14
"""Distance of the polygon's label below the platform [m]."""

LOAD_COLOR: Final = palette.BAD

_EDGES: Final = [(a, b) for a in range(8) for b in range(a) if (a ^ b).bit_count() == 1]
"""Pairs of corners of `WrenchPolytope.vertices` that an edge joins."""

_SIDES: Final = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
"""Corners of the six faces, around each."""

_TRIANGLES: Final = np.array([[(a, b, c), (a, c, d)] for a, b, c, d in _SIDES]).reshape(-1, 3)


def force_scale(largest: float, longest: float) -> float:
    """Return the force that `BAR` stands for, 1, 2 or 5 times a power of ten [N].

    The largest force [N] is then drawn at most as long as ``longest`` [m].
    """
    least = max(largest, 1e-9) * BAR / longest
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= least * (1 - 1e-9))


def scale_text(scale: float) -> str:
    """Return what a label says of a scale [N for `BAR`]."""
    return f"{1e3 * BAR:.0f} mm = {number(scale, 3)} N"


def load_arrow(design: Design, pose: Array, largest: float = 0.0) -> tuple[Array, float]:
    """Return the arrow of a design's force, from its point (1, 2, 3) [m], and its scale [N].

    The scale suits a larger force as well, if one is given [N].
    """
    x, y, theta, z = pose
    c, s = math.cos(theta), math.sin(theta)
    px, py, pz = design.load.point
    start = np.array([x + c * px - s * py, y + s * px + c * py, z + pz])
    force = center_wrench(design.load, theta)[:3]
    scale = force_scale(max(float(np.linalg.norm(force)), largest), LONGEST)
    return np.stack([start, start + force * BAR / scale])[None], scale


def played_load(load: LoadCase, trajectory: Trajectory, t: float) -> tuple[LoadCase, float]:
    """Return a load with the motion's own at a time [s], and the largest force on the way [N]."""
    found = trajectory.load_at(np.array([t]))
    if found is None or trajectory.load is None:
        return load, 0.0
    forces = trajectory.load[:, :3] + np.array(load.wrench[:3])
    wrench = dict(zip(WRENCH, (found[0] + load.wrench).tolist(), strict=True))
    return replace(load, **wrench), float(np.linalg.norm(forces, axis=1).max())


class LoadView:
    """The layer ``load``: the force as an arrow at its point, the moment as an arc; with labels.

    While a motion with a load of its own is played, it is the load at that time.
    """

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._motions = context.motions
        self._drawn: tuple[object, ...] = ()
        self._arrow: ArrowsHandle | None = None
        self._arc: MeshHandle | None = None
        self._label: LabelHandle | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the load and the platform; nothing is sent while hidden."""
        del dragging
        design, pose, largest = frame.shown_design, frame.configuration.pose, 0.0
        state = frame.state
        if "load" in state.layers and state.playback.following and self._motions is not None:
            analysis = self._motions.analysis(state)
            if analysis is not None:
                load, largest = played_load(design.load, analysis.trajectory, state.playback.time)
                design = replace(design, load=load)
        load = design.load
        shown = "load" in frame.state.layers and load.acts and bool(np.isfinite(pose).all())
        key = (load, largest, tuple(pose.tolist()))
        if shown and key != self._drawn:
            self._drawn = key
            self._draw(design, pose, largest)
        pushed = any(load.wrench[:3])
        for node, wanted in ((self._arrow, pushed), (self._arc, load.moment_z), (self._label, 1)):
            if node is not None:
                node.visible = shown and bool(wanted)

    def _draw(self, design: Design, pose: Array, largest: float) -> None:
        load = design.load
        arrow, scale = load_arrow(design, pose, largest)
        if any(load.wrench[:3]):
            points = arrow.astype(np.float32)
            if self._arrow is None:
                self._arrow = self._scene.add_arrows(
                    "/load/force", points, linear_colors(LOAD_COLOR)[0],
                    shaft_radius=0.005, head_radius=0.012, head_length=0.03,
                )  # fmt: skip
            self._arrow.points = points
        if load.moment_z:
            vertices = arc_arrow(load.moment_z / FULL_MOMENT).astype(np.float32)
            if self._arc is None:
                self._arc = self._scene.add_mesh_simple(
                    "/load/moment", vertices, FACES, color=palette.rgb(LOAD_COLOR), side="double",
                    cast_shadow=False, receive_shadow=False,
                )  # fmt: skip
            self._arc.vertices = vertices
            self._arc.position = (float(pose[0]), float(pose[1]), float(pose[3]))
        text = load_text(design, scale)
        if self._label is None:
            self._label = self._scene.add_label(
                "/load/label", text, font_screen_scale=0.9, anchor="bottom-left"
            )
        self._label.text = text
        self._label.position = arrow[0, 1]


def load_text(design: Design, scale: float) -> str:
    """Return the label of a load: the size of its force, its moment, and their scales."""
    load, parts = design.load, []
    force = float(np.linalg.norm(load.wrench[:3]))
    if force:
        parts.append(f"{number(force, 3)} N ({scale_text(scale)})")
    if load.moment_z:
        full = f"full arc {number(FULL_MOMENT, 3)} N·m"
        parts.append(f"M_z {number(load.moment_z, 3)} N·m ({full})")
    if not parts:
        parts.append("moment on the bearings alone")
    return ", ".join(parts)


def polygon_lines(found: WrenchPolytope) -> tuple[Array, tuple[str, ...]]:
    """Return the sides of the force polygon, (n, 2, 2) [N], and the actuator limiting each."""
    polygon = found.section()
    sides = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
    return sides, found.sectors if len(polygon) else ()


class PolytopeView:
    """The layers ``force_polygon`` and ``wrench_solid``, about the platform's center.

    Polygon: horizontal forces that are held with M_z = 0, each side in the color of the actuator
    that limits it, and the largest disc in it. Solid: the same with M_z / R_pl upward, the face
    that limits first named.
    """

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: tuple[object, ...] = ()
        self._nodes: dict[str, Any] = {}

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow masses, load, drives and pose; nothing is sent while hidden."""
        del dragging
        shown = frame.state.layers & {"force_polygon", "wrench_solid"}
        design, pose = frame.shown_design, frame.configuration.pose
        theme = frame.state.theme
        key = (shown, design, tuple(pose.tolist()), theme)
        if shown and key != self._drawn:
            self._drawn = key
            try:
                found = wrench_polytope(design, pose)
            except PaminsaError:
                found = None
            self._remove()
            if found is not None:
                center = pose[[0, 1, 3]]
                if "force_polygon" in shown:
                    self._draw_polygon(found, center + np.array([0.0, 0.0, ABOVE]), theme.ink)
                if "wrench_solid" in shown:
                    self._draw_solid(found, center)
        if not shown and self._nodes:
            self._drawn = ()
            self._remove()

    def _remove(self) -> None:
        for node in self._nodes.values():
            node.remove()
        self._nodes.clear()

    def _lines(self, name: str, lines: Array, colors: Iterable[str], width: float) -> None:
        found = linear_colors(*colors)[:, None].repeat(2, axis=1)
        node: LineSegmentsHandle = self._scene.add_line_segments(
            f"/forces/{name}", lines.astype(np.float32), found,
            thickness=width, thickness_units="screen",
        )  # fmt: skip
        self._nodes[name] = node

    def _text(self, name: str, text: str, place: Array) -> None:
        self._nodes[name] = self._scene.add_label(
            f"/forces/{name}", text, font_screen_scale=0.9, anchor="top-center",
            position=place,
        )  # fmt: skip

    def _draw_polygon(self, found: WrenchPolytope, center: Array, ink: str) -> None:
        sides, limits = polygon_lines(found)
        if not len(sides):
            self._text("polygon", "no horizontal force is held here", center)
            return
        scale = force_scale(float(np.linalg.norm(sides, axis=-1).max()), FARTHEST)
        flat = np.concatenate([sides, np.zeros((*sides.shape[:2], 1))], axis=-1)
        self._lines("polygon", center + flat * BAR / scale, map(_color, limits), 4.0)
        edges = sides[:, 1] - sides[:, 0]
        distance = np.abs(edges[:, 0] * sides[:, 0, 1] - edges[:, 1] * sides[:, 0, 0])
        distance /= np.linalg.norm(edges, axis=1)
        worst = int(np.argmin(distance))
        radius = float(distance[worst]) if found.holds else 0.0
        angle = np.linspace(0, 2 * np.pi, 49)
        ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) * radius * BAR / scale
        circle = center + np.stack([ring[:-1:2], ring[1::2]], axis=1)
        self._lines("disc", circle, [ink] * len(circle), 2.0)
        text = f"every direction {number(radius, 3)} N, {limits[worst]} ({scale_text(scale)})"
        self._text("polygon label", text, center - [0.0, 0.0, ABOVE + BELOW])

    def _draw_solid(self, found: WrenchPolytope, center: Array) -> None:
        corners = found.vertices / [1.0, 1.0, found.length]
        scale = force_scale(float(np.linalg.norm(corners, axis=1).max()), FARTHEST)
        places = center + corners * BAR / scale
        mesh = self._scene.add_mesh_simple(
            "/forces/solid", places.astype(np.float32), _TRIANGLES.astype(np.uint32),
            color=palette.rgb(palette.PLATFORM), opacity=0.35, side="double", flat_shading=True,
            cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        self._nodes["solid"] = mesh
        edges = np.array([[places[a], places[b]] for a, b in _EDGES])
        # an edge along which one actuator's torque varies has that actuator's color
        colors = [LEG_COLORS[2 - (a ^ b).bit_length() + 1] for a, b in _EDGES]
        self._lines("edges", edges, colors, 2.5)
        face = found.limiting_face
        text = f"limit: {found.faces[face]} (up M_z/R_pl; {scale_text(scale)})"
        self._text("solid label", text, np.array([center[0], center[1], places[:, 2].min()]))


def _color(limit: str) -> str:
    """Return the color of the actuator that a limit names, "M2 at +T"."""
    return LEG_COLORS[ACTUATORS.index(limit.partition(" ")[0])]
