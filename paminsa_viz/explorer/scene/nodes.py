"""What layers draw, as plain data, and the nodes of the viewer that follow it.

A layer is a function of a frame, which returns the nodes that are seen. Those that are new are
made, those that have changed are updated, and those that are gone are removed.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import Trimesh
from trimesh.creation import icosphere
from viser import SceneApi

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.curves import bands, dashes, linear_colors, segments
from paminsa_viz.explorer.scene.label_places import apart, hung
from paminsa_viz.explorer.scene.sizes import hanging
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import rgb

if TYPE_CHECKING:
    from paminsa_viz.explorer.scene.context import SceneContext
    from paminsa_viz.explorer.state.layers import Layer

NO_SHADOWS = {"cast_shadow": False, "receive_shadow": False}


@dataclass(frozen=True, eq=False)
class Node:
    """One node of the scene.

    Attributes:
        name: Its name in the scene.
        kind: What it is: viser's scene makes it with ``add_`` and this.
        live: Its properties that may change, by viser's names.
        fixed: Its other properties.
        count: Parts whose number may not change; with another one it is made again.
        click: Called when it is clicked.
        spaced: Width and height of a label [px] that is kept clear of others of its layer.
        hanging: How far below what it is of a label is on the screen [m], see `label_below`.
    """

    name: str
    kind: str
    live: dict[str, Any]
    fixed: dict[str, Any] = field(default_factory=dict)
    count: int = 0
    click: Callable[[Any], Any] | None = None
    spaced: tuple[float, float] | None = None
    hanging: float = 0.0


def lines(name: str, points: ArrayLike, color: str | NDArray[np.uint8], width: float) -> Node:
    """Return line segments.

    Args:
        name: Scene name.
        points: (n, 2, 3) [m].
        color: ``#rrggbb``, or the linear colors of all ends (n, 2, 3), see `linear_colors`.
        width: On the screen [px].
    """
    found = np.asarray(points, np.float32)
    one = isinstance(color, str)
    live = {"points": found, "colors": linear_colors(color)[0] if one else color}
    fixed = {"thickness": width, "thickness_units": "screen"}
    return Node(name, "line_segments", live, fixed, 0 if one else len(found))


def curves(
    name: str,
    found: Iterable[ArrayLike],
    color: str,
    width: float = 2.0,
    *,
    height: float = 0.0,
    dash: float | None = None,
) -> Node:
    """Return curves (n, 2) at a height, or (n, 3) in space [m], as one node.

    Args:
        name: Scene name.
        found: The curves; a point that is not finite breaks one.
        color: ``#rrggbb``.
        width: On the screen [px].
        height: Of plane curves [m].
        dash: Length of a dash and of a gap [m]; None draws full lines.
    """
    parts = [segments(curve, height) for curve in found]
    if dash is not None:
        parts = [dashes(part, dash) for part in parts]
    return lines(name, np.concatenate([np.zeros((0, 2, 3)), *parts]), color, width)


def flat_curves(
    name: str, found: Array, color: str, width: ArrayLike, *, height: float = 0.0
) -> Node:
    """Return plane curves (k, n, 2) [m] drawn on a level plane, as a mesh.

    A browser without a graphics card draws it many times as fast as `curves`.

    Args:
        name: Scene name.
        found: The curves.
        color: ``#rrggbb``.
        width: Of the lines, one for all or (k,) [m].
        height: Of the plane [m].
    """
    corners, faces = bands(found, width)
    level = np.full((len(corners), 1), height)
    return mesh(name, np.hstack([corners, level]), faces, color, flat_shading=True)


def arrows(
    name: str,
    points: ArrayLike,
    color: str,
    sizes: tuple[float, float, float],
    times: float,
) -> Node:
    """Return arrows (n, 2, 3) [m].

    Args:
        name: Scene name.
        points: Where they start and end.
        color: ``#rrggbb``.
        sizes: Radius of the shaft, radius and length of the head [m].
        times: By what those are multiplied, see `sizes.symbol_size`.
    """
    shaft, head, length = (times * size for size in sizes)
    live = {"points": np.asarray(points, np.float32), "colors": linear_colors(color)[0]}
    live |= {"shaft_radius": shaft, "head_radius": head, "head_length": length}
    return Node(name, "arrows", live)


def mesh(
    name: str,
    vertices: ArrayLike,
    faces: ArrayLike,
    color: str,
    *,
    place: ArrayLike = (0.0, 0.0, 0.0),
    turn: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    **fixed: Any,
) -> Node:
    """Return a mesh without shadows, seen from both sides.

    Args:
        name: Scene name.
        vertices: (n, 3) [m].
        faces: (m, 3).
        color: ``#rrggbb``.
        place: Position [m].
        turn: Quaternion (w, x, y, z).
        **fixed: More of viser's properties, such as ``opacity``.
    """
    found = np.asarray(vertices, np.float32)
    live = {"vertices": found, "faces": np.asarray(faces, np.uint32), "position": place}
    given = {"color": rgb(color), "side": "double", **NO_SHADOWS, **fixed}
    return Node(name, "mesh_simple", live | {"wxyz": turn}, given, len(found))


@cache
def ball(radius: float) -> Trimesh:
    """Return a ball about the origin; the radius in [m]."""
    return icosphere(subdivisions=2, radius=radius)


def copies(name: str, shape: Trimesh, places: ArrayLike, **live: Any) -> Node:
    """Return a shape at many places (n, 3) [m].

    Args:
        name: Scene name.
        shape: The shape.
        places: Where it is.
        **live: ``batched_colors`` (n, 3), linear; ``batched_scales`` (n,) or (n, 3);
            ``batched_wxyzs`` (n, 4), upright without it.
    """
    positions = np.asarray(places, np.float32)
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(positions), 1))
    live = {"batched_positions": positions, "batched_wxyzs": upright} | live
    fixed = {"vertices": shape.vertices, "faces": shape.faces, "lod": "off", **NO_SHADOWS}
    return Node(name, "batched_meshes_simple", live, fixed, len(positions))


def label(
    name: str,
    text: str,
    place: ArrayLike,
    anchor: str = "top-center",
    size: float = 0.9,
    spaced: tuple[float, float] | None = None,
) -> Node:
    """Return a text at a place (3,) [m]; ``size`` is in letters of the page.

    With its width and height on the screen [px] in ``spaced`` it is kept clear of the others of its
    layer.
    """
    live = {"text": text, "position": place}
    fixed = {"font_screen_scale": size, "anchor": anchor}
    return Node(name, "label", live, fixed, spaced=spaced)


def label_below(name: str, text: str, center: ArrayLike, layer: str, size: float) -> Node:
    """Return the label of one of `LABELS_BELOW`, clear of those of the others.

    It is below the center on the screen: from above, those at different heights would coincide.

    Args:
        name: Scene name.
        text: What it says.
        center: The platform's center (3,) [m].
        layer: Key of the layer.
        size: Of the symbols, see `symbol_size`.
    """
    down = hanging(layer, size)
    return replace(label(name, text, np.asarray(center) - [0.0, 0.0, down]), hanging=down)


class Nodes:
    """The nodes in a scene that one layer has drawn.

    Labels are arranged on other threads too, whenever the camera moves: one at a time, or an older
    arrangement could be written last.
    """

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._shown: dict[str, tuple[Node, Any]] = {}
        self._lock = threading.Lock()

    def holds(self, node: Node) -> bool:
        """Whether this very node is shown."""
        return node.name in self._shown and self._shown[node.name][0] is node

    def show(self, wanted: Iterable[Node]) -> None:
        """Show these nodes, except lines without a segment, and no others."""
        found = {node.name: node for node in wanted if len(node.live.get("points", "_"))}
        with self._lock:
            for name in self._shown.keys() - found.keys():
                self._shown.pop(name)[1].remove()
            for node in found.values():
                if not self.holds(node):
                    self._shown[node.name] = (node, self._put(node))

    def arrange(self, camera: Any, pixel_ratio: float) -> bool:
        """Put labels where none covers another; return whether the camera decides that."""
        with self._lock:
            found = [each for each in self._shown.values() if _is_arranged(each[0])]
            if not found:
                return False
            places = np.array([node.live["position"] for node, _ in found], dtype=np.float64)
            down = np.array([node.hanging for node, _ in found])
            size = found[0][0].spaced
            if camera is not None:
                places = hung(places, down, camera)
            if camera is not None and size is not None:
                width, height = size
                places = apart(places, camera, (pixel_ratio * width, pixel_ratio * height))
            for (_, handle), place in zip(found, places, strict=True):
                handle.position = place
        return True

    def _put(self, node: Node) -> Any:
        before, handle = self._shown.get(node.name, (None, None))
        if before is not None and before.count == node.count:
            for name, value in node.live.items():
                arranged = _is_arranged(node) and name == "position"
                if value is not before.live[name] and not arranged:
                    setattr(handle, name, value)  # viser sends only what is different
            return handle
        if handle is not None:
            handle.remove()
        make = getattr(self._scene, f"add_{node.kind}")
        handle = make(node.name, **node.live, **node.fixed)
        if node.click is not None:
            handle.on_click(node.click)
        return handle


def _is_arranged(node: Node) -> bool:
    """Whether the camera decides where a label is."""
    return node.spaced is not None or node.hanging > 0.0


Draw = Callable[[Frame], Iterable[Node]]
"""Returns what is seen of a layer."""


class LayerView:
    """Draws a layer while it is switched on."""

    def __init__(self, layer: Layer, draw: Draw, context: SceneContext) -> None:
        self._layer, self._draw = layer, draw
        self._nodes = Nodes(context.scene)
        self._camera, self._follows = context.camera, False
        self._pixel_ratio = context.pixel_ratio

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the frame; nothing is computed while the layer is off."""
        shown = self._layer.key in frame.state.layers
        wanted = self._draw(frame) if shown else ()
        if dragging and self._layer.idle:
            wanted = filter(self._nodes.holds, wanted)
        self._nodes.show(wanted)
        if self._arrange() and self._camera is not None and not self._follows:
            self._follows = True
            self._camera.on_update(lambda _: self._arrange())

    def _arrange(self) -> bool:
        return self._nodes.arrange(self._camera, self._pixel_ratio())
