"""One picture of maps in the panel: an image that follows the hand, values under the pointer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from typing import Any, cast

import numpy as np

from paminsa_viz.explorer.maps import COARSE, FULL, MapStore, shows_difference
from paminsa_viz.explorer.motion.path_segments import cut
from paminsa_viz.explorer.motion.store import MotionStore
from paminsa_viz.explorer.panels.slots import Slots, marker
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import INK, MUTED
from paminsa_viz.plots.contours import joined
from paminsa_viz.plots.hover import HoverFigure
from paminsa_viz.plots.map_data import MapData
from paminsa_viz.plots.map_figure import PAGE_EM, FloorPath, LiveMaps
from paminsa_viz.plots.map_layout import MapLayout, map_layout
from paminsa_viz.plots.scale import Scale
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import number

Quantities = Callable[[State], tuple[str, ...]]

LIVE_QUALITY = 88
"""Quality of the JPEG that follows the hand; at rest the picture is without loss."""

# viser stacks what a container holds. Here the container becomes a grid: the picture with the
# hover figure over it, the caption and the inputs side by side below, or one below the other at
# the right.
_STYLE = """
<style>
div:has(> div > [data-paminsa-slot="%(name)s"]) {
  display: grid; grid-template-columns: %(columns)s; align-items: center; padding: 6px 0 4px 0;
  & > div { min-width: 0; padding: 0 5px 2px 5px; }
  & > div:has(> [data-paminsa-slot]) { display: none; }
  & > div:has(> div > img), & > div:has(> .mantine-Paper-root) {
    grid-row: %(rows)s; grid-column: %(span)s; padding: 0 !important; align-self: start; }
  & > div:has(> .paminsa-line) { grid-column: %(line)s; padding: 0; }
  & > div:has(> .paminsa-marks) {
    grid-row: %(rows)s; grid-column: %(span)s; padding: 0; align-self: start; z-index: 1;
    pointer-events: none; }
  & > div:has(> .mantine-Paper-root) { z-index: 1; }
  & > div > .mantine-Paper-root { margin: 0; padding: 0; border: 0; background: transparent; }
  & > div > div > img { width: 100%%; }
  & > div:has(> .mantine-Paper-root) .mantine-ActionIcon-root { display: none; }
  & .nsewdrag { cursor: crosshair; }
  & .mantine-Button-root { padding: 0 4px; }
  & > div > .mantine-Flex-root > div:first-child {
    width: %(label)s !important; white-space: nowrap; padding-right: 5px; }
}
</style>
"""


@dataclass(frozen=True)
class Arrangement:
    """How a picture and its inputs share the panel.

    Attributes:
        columns: Widths of the inputs side by side below the picture, as CSS
            ``grid-template-columns``; empty for inputs one below the other at the right.
        share: What the picture takes of the panel's width.
    """

    columns: str = ""
    share: float = 1.0

    def style(self, name: str) -> str:
        """Return the style of the container that holds the place ``name``."""
        fill = {"name": name, "columns": self.columns, "rows": "1", "span": "1 / -1",
                "line": "1 / -1", "label": "auto"}  # fmt: skip
        if not self.columns:
            fill |= {"columns": f"{100 * self.share:g}% 1fr", "rows": "1 / span 12", "span": "1",
                     "line": "2", "label": "6em"}  # fmt: skip
        return _STYLE % fill


class MapPicture:
    """The picture of some maps, its caption, and what lies under the pointer.

    Made in the current container of the page, which is turned into a grid; inputs that are added
    to the container afterwards come below or at the right.

    Attributes:
        scales: The color scales drawn last, one a panel.
        data: The maps drawn last, or None before the first.
    """

    def __init__(
        self,
        session: Session,
        store: MapStore,
        slots: Slots,
        name: str,
        quantities: Quantities,
        arrangement: Arrangement,
        motions: MotionStore,
    ) -> None:
        """Make the picture.

        Args:
            session: The tab it is for.
            store: Where maps come from.
            slots: Knows how wide the place is.
            name: Name of the place; it comes back with clicks.
            quantities: What to show, one a panel.
            arrangement: Where the inputs go.
            motions: Knows the motion, whose path is drawn on the maps.
        """
        gui = session.client.gui
        self._gui, self._store, self._slots = gui, store, slots
        self._name, self._quantities, self._motions = name, quantities, motions
        self._live = LiveMaps()
        self.scales: tuple[Scale, ...] = ()
        self.data: MapData | None = None
        gui.add_html(marker(name, arrangement.share) + arrangement.style(name))
        blank = np.full((2, max(slots.width(name), 2), 3), 255, dtype=np.uint8)
        self._image = gui.add_image(blank, format="auto", jpeg_quality=LIVE_QUALITY)
        self._marks = gui.add_html("")
        self._place = gui.add_folder(None)
        self._hover: Any = None
        self._layout: MapLayout | None = None
        self._caption = gui.add_html("")
        self._drawn: tuple[Any, ...] = ()
        self._offered: tuple[Any, ...] = ()

    def draw(self, state: State, moving: bool) -> None:
        """Draw what the state shows, unless it is drawn already or nobody sees it."""
        width = self._slots.width(self._name)
        if not width:
            return
        quantities = self._quantities(state)
        document, view = state.document, state.map_view
        reference = document.reference if shows_difference(state) else None
        motion = self._motions.present(state) if "path" in state.layers else None
        # Where the robot stands is not part of it: the mark lies over the picture.
        shown = (
            document.design, document.pose[2:], reference, view, quantities,
            width, self._slots.ratio, motion and motion.trajectory,
        )  # fmt: skip
        if self._drawn and self._drawn[0] == shown and (moving or self._drawn[1]):
            self._mark(state)
            return
        data = self._store.data(state, COARSE if moving else FULL, quantities)
        scales = self._store.scales(state, data, quantities)
        ratio = 1.0 if moving else self._slots.ratio
        path = None if motion is None else floor_path(motion)
        picture = self._live.draw(data, scales, width, ratio, path)
        if not moving:
            opaque = np.full((*picture.shape[:2], 1), 255, dtype=np.uint8)
            picture = np.concatenate([picture, opaque], axis=2)  # as PNG, without loss
        self._image.image = picture
        self.data, self.scales = data, scales
        self._layout = map_layout(data, scales, width, PAGE_EM)
        self._mark(state)
        self._say(state, data)
        # All that the values depend on; how finely they are drawn is not part of it.
        if not moving and shown[:7] != self._offered:
            self._offer_values(data, self._layout)
            self._offered = shown[:7]
        self._drawn = (shown, not moving)

    def _mark(self, state: State) -> None:
        if self.data is None or self._layout is None:
            return
        self.data = self.data.with_pose(state.document.pose)
        html = marks_html(self.data, self._layout)
        if html != self._marks.content:
            self._marks.content = html

    def _offer_values(self, data: MapData, layout: MapLayout) -> None:
        figure = cast(Any, HoverFigure(data, layout, self._name))
        height = layout.height / layout.width
        if self._hover is None:
            # Not before the first rest: it sends Plotly's own code, a few megabytes.
            with self._place:
                self._hover = self._gui.add_plotly(figure, aspect=height)
            return
        self._hover.figure = figure
        if self._hover.aspect != height:
            self._hover.aspect = height

    def _say(self, state: State, data: MapData) -> None:
        text = caption(state, data)
        if text != self._caption.content:
            self._caption.content = text


def marks_html(data: MapData, layout: MapLayout) -> str:
    """Return the marks of the pose, to be laid over a picture that has this layout."""
    rings = f"0 0 0 2.3px #fff,0 0 0 3.8px {INK},0 0 0 4.8px #fff"
    spots = "".join(
        f'<i style="position:absolute;left:{100 * x:.3f}%;top:{100 * y:.3f}%;width:3.4px;'
        f"height:3.4px;margin:-1.7px 0 0 -1.7px;border-radius:50%;background:{INK};"
        f'box-shadow:{rings}"></i>'
        for x, y in layout.positions(data)
    )
    return (
        '<div class="paminsa-marks" style="position:relative;'
        f'aspect-ratio:{layout.width:g}/{layout.height:g}">{spots}</div>'
    )


def floor_path(motion: TrajectoryAnalysis) -> FloorPath:
    """Return a motion as it is drawn on maps."""
    found = cut(motion)
    good, bad = ([found.place[run, :2] for run in runs] for runs in (found.good, found.bad))
    return FloorPath(joined(good), joined(bad))


def caption(state: State, data: MapData) -> str:
    """Return the line below a picture: what it shows, where, and what its marks mean."""
    pose = f"θ = {number(np.degrees(data.theta))}°, z = {number(1e3 * data.z)}\u00a0mm"
    reference = state.document.reference
    title = "Static torques" if data.panels > 1 else data.title
    if shows_difference(state) and reference is not None:
        title = f"{title.removesuffix(', difference')}, difference from “{reference.name}”,"
    marks = "◎ pose · dashed: singular · hatched: out of reach · click: go there"
    return (
        '<div class="paminsa-line" style="display:flex;flex-wrap:wrap;gap:2px 16px;'
        'justify-content:space-between;font-size:12px;line-height:1.3;padding:0 8px 5px 8px">'
        f'<span style="color:{INK}"><b>{escape(title)}</b> at {pose}</span>'
        f'<span style="color:{MUTED}">{marks}</span></div>'
    )
