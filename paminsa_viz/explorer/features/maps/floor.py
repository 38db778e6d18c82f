"""The chosen map on the ground below the robot, at its true place and scale; click it to go there.

With it lie the boundary of the workspace and the singular circle, and a ring below the platform.
"""

from __future__ import annotations

import math
import time
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import COARSE, FULL, MapStore
from paminsa_viz.explorer.features.motion.points import click_map
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.curves import circles, dashes, resampled, segments
from paminsa_viz.explorer.scene.legend import color_bar
from paminsa_viz.explorer.scene.nodes import Node, Nodes, flat_curves
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.palette import INK
from paminsa_viz.plots import contours
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale, map_pixels

ABOVE: Final = {
    "map": 0.0024,
    "boundary": 0.0034,
    "circle": 0.0040,
    "ring": 0.0050,
}
"""Heights over the ground, above its soft shadows, so that nothing flickers through, for the
prototype's bodies [m]."""

PERIOD, PERIOD_PLAIN = 0.1, 0.3
"""Time from one map to the next during a drag [s], with a graphics card and without: a new
one takes two pictures of the scene, and the robot would wait for them. The panel's maps do not."""

DASH: Final = 0.022
OUTLINE: Final = 181
"""Points of each piece of the workspace's boundary on the floor."""
LINE: Final = 0.011
"""Width of lines on the floor, at Appendix 4's lengths [m]."""
RING: Final = 0.032
"""Radius of the mark below the platform, at Appendix 4's lengths [m]."""
MARK: Final = (
    ("back", "#ffffff", (0.5,), (1.0,), 0.0),
    ("mark", INK, (0.14, 0.75), (0.28, 0.22), 0.0006),
)
"""The mark below the platform: name, color, radii and widths of its circles over `RING`, and height
of the prototype's [m]."""


@kept(4)
def _mark(size: float) -> tuple[Node, ...]:
    """Return the mark below the platform, for symbols of a size."""
    radius = size * RING
    return tuple(
        flat_curves(
            f"/floor/pose/{name}", radius * circles(radii), color, radius * np.array(widths),
            height=size * height,
        )
        for name, color, radii, widths, height in MARK
    )  # fmt: skip


class FloorMap:
    """The map on the ground of one session.

    Its maps come from the panel's store, so that nothing is solved twice.
    """

    def __init__(self, context: SceneContext) -> None:
        self._dispatch = context.dispatch
        self._store = context.maps or MapStore()
        scene = context.scene
        self._height, self._size = 0.0, 1.0
        self._due = 0.0
        flat: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False, "visible": False}
        clear = np.zeros((2, 2, 4), dtype=np.uint8)
        self._map = scene.add_image("/floor/map", clear, 1.0, 1.0, **flat)
        self._map.on_click(self._click)
        self._legend = context.legend
        self._ring = scene.add_frame("/floor/pose", show_axes=False, visible=False)
        # Solid, not pictures: what is clear in a picture still hides what lies below it.
        self._mark = Nodes(scene)
        self._curves = Nodes(scene)
        self._key: tuple[Any, ...] = ()
        self._curves_key: tuple[Any, ...] = ()

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what has changed; nothing is computed for layers that are hidden."""
        self._draw(frame, dragging)

    def _draw(self, frame: Frame, dragging: bool, *, same_colors: bool = False) -> None:
        state = frame.state
        layers, last_reachable = state.layers, state.last_reachable
        self._stand(layout(last_reachable.geometry).ground, last_reachable.geometry.body_scale)
        x, y = last_reachable.pose[:2]
        self._ring.position = (x, y, self._above("ring"))
        self._mark.show(_mark(symbol_size(last_reachable.geometry)))
        if not dragging or time.monotonic() >= self._due:
            self._due = time.monotonic() + (PERIOD if "fine" in layers else PERIOD_PLAIN)
            if "floor_map" in layers:
                self._draw_map(state, dragging, same_colors)
            self._draw_curves(state, dragging)
        for node in (self._map, self._ring):
            node.visible = "floor_map" in layers

    def draw_at_once(self, frame: Frame) -> bool:
        """Draw as during a drag, however soon after another map, and with the colors of that one:
        the page may have found others meanwhile, for another design.

        Returns:
            Whether the map is another one than before; a browser decodes it while it goes on.
        """
        before, self._due = self._key, 0.0
        self._draw(frame, True, same_colors=True)
        return self._key is not before

    def _above(self, what: str) -> float:
        return self._height + self._size * ABOVE[what]

    def _stand(self, height: float, size: float) -> None:
        if (height, size) == (self._height, self._size):
            return
        self._height, self._size = height, size
        self._map.position = (0.0, 0.0, self._above("map"))
        self._curves_key = ()

    def _draw_map(self, state: State, dragging: bool, same_colors: bool) -> None:
        document, view, opacity = state.document, state.map_view, state.floor_opacity
        theta, z = document.pose[2:]
        shown = (document.design, theta, z, document.reference, view, opacity)
        if self._key and self._key[0] == shown and (dragging or self._key[1]):
            return
        quantities = (view.quantity,)
        data = self._store.data(state, COARSE if dragging else FULL, quantities)
        colors = (document.design, document.reference, view)
        if same_colors and self._key and self._key[2] == colors:
            scale = self._key[3]
        else:
            scale = self._store.scales(state, data, quantities, dragging=dragging)[0]
        self._map.image = floor_image(data, scale, opacity)
        left, right, _, _ = data.extent
        side = right - left
        self._map.scale = (side, side, 1.0)
        if self._legend is not None:
            self._legend.bar = color_bar(data, scale)
        self._key = (shown, not dragging, colors, scale)

    def _draw_curves(self, state: State, dragging: bool) -> None:
        document, seen = state.document, state.layers & {"workspace", "singularity"}
        theta, z = document.pose[2:]
        shown = (document.design.geometry, theta, z, seen)
        if self._curves_key and self._curves_key[0] == shown and (dragging or self._curves_key[1]):
            return
        self._curves_key = (shown, not dragging)
        if not seen:
            self._curves.show(())
            return
        # Shapes of the reach alone: the same for every quantity, and without a reference.
        cells = COARSE if dragging else FULL
        data = self._store.current(state, cells, ("reach_margin",))
        width = LINE * symbol_size(document.design.geometry)
        nodes = []
        outline = contours.pieces(contours.boundary(data)) if "workspace" in seen else []
        if outline:
            found = np.stack([resampled(piece, OUTLINE) for piece in outline])
            height = self._above("boundary")
            nodes.append(flat_curves("/floor/workspace", found, INK, width, height=height))
        circle = contours.pieces(contours.singular_circle(data)) if "singularity" in seen else []
        if circle:
            found = np.concatenate(
                [dashes(segments(piece), self._size * DASH)[..., :2] for piece in circle]
            )
            height = self._above("circle")
            nodes.append(flat_curves("/floor/singularity", found, INK, width, height=height))
        self._curves.show(nodes)

    async def _click(self, event: Any) -> None:
        place = where_on_floor(event.ray_origin, event.ray_direction, self._above("map"))
        if place is not None:
            self._dispatch("floor click", lambda state: click_map(state, *place))


def floor_image(data: MapData, scale: Scale, opacity: float) -> NDArray[np.uint8]:
    """Return one map as RGBA with row 0 at the smallest y, clear where nothing is reached."""
    pixels = map_pixels(data.values[0], data.status, scale)
    pixels[pixels[..., 3] > 0, 3] = round(255 * min(max(opacity, 0.0), 1.0))
    return pixels


def where_on_floor(
    origin: tuple[float, float, float], direction: tuple[float, float, float], height: float
) -> tuple[float, float] | None:
    """Return where a ray meets the plane at a height, (x, y) [m], or None if it does not."""
    if not all(map(math.isfinite, (*origin, *direction))) or abs(direction[2]) < 1e-9:
        return None
    way = (height - origin[2]) / direction[2]
    if way <= 0:
        return None
    x, y = (origin[i] + way * direction[i] for i in (0, 1))
    return (x, y) if math.isfinite(x) and math.isfinite(y) else None
