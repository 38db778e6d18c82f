"""One picture of maps in the panel: an image that follows a drag, values under the pointer."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from paminsa_viz.explorer.browser.bridge import Slots, finite_place, marker
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import COARSE, FULL, MapStore, shows_difference
from paminsa_viz.explorer.core.motion import is_drawing
from paminsa_viz.explorer.core.motion_results import split_path
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.motion import point_entries as motion_points
from paminsa_viz.explorer.features.motion import points
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots.contours import FloorPath, joined
from paminsa_viz.plots.hover import readout
from paminsa_viz.plots.map_layout import PAGE_EM, MapLayout, map_layout
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import MM, format_value

if TYPE_CHECKING:
    from paminsa_viz.plots.map_figure import LiveMaps

Quantities = Callable[[State], Sequence[str]]

HOVER: Final = "hover"
"""Message of the page: what is under the pointer, a place in a map [mm] with the map's name and the
panel's index, a time in a motion plot [s], or None."""

COLUMNS = 2
"""Most maps side by side: what is next to the third is room for its inputs."""

LIVE_QUALITY = 88
"""Quality of the JPEG shown while dragging; the picture shown when idle is without loss."""

Inputs = Literal["below", "inside"]
"""Where a picture's inputs are: below it, or where its last row has room for another map."""


class MapPicture:
    """The picture of some maps, its caption, and what is written at the pointer.

    Made in the current container of the page, which page.css turns into a grid; inputs that are
    added to the container afterwards come there.

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
        inputs: Inputs,
    ) -> None:
        """Make the picture.

        Args:
            session: The tab it is for.
            store: Where maps come from.
            slots: Knows how wide the place is.
            name: Name of the place; it comes back with clicks.
            quantities: Keys of what to show, one a panel.
            inputs: Where the inputs go.
        """
        gui = session.client.gui
        self._session, self._store, self._slots = session, store, slots
        self._name, self._quantities = name, quantities
        self.scales: tuple[Scale, ...] = ()
        self.data: MapData | None = None
        gui.add_html(marker(name, inputs))
        gui.add_html(render("maps/picture.j2", name=name))
        self._address = gui.add_html("")
        self._markers = gui.add_html("")
        self._live: LiveMaps | None = None
        self._layout: MapLayout | None = None
        self._caption = gui.add_html("")
        self._drawn: tuple[Any, ...] = ()
        self._pointer: Any = None
        session.bridge.on(HOVER, self._receive)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what the state shows, unless it is drawn already or nobody sees it."""
        state, width = frame.state, self._slots.width(self._name)
        if not width:
            return
        quantities = self._quantities(state)
        document, view = state.document, state.map_view
        reference = document.reference
        motion = frame.analysis if "path" in state.layers else None
        # Where the robot is, is not part of it: the marker lies over the picture.
        shown = (
            document.design, document.pose[2:], reference, view, quantities, width,
            document.requirements, self._slots.ratio, motion and motion.trajectory, state.theme,
        )  # fmt: skip
        if self._drawn and self._drawn[0] == shown and (dragging or self._drawn[1]):
            self._mark(state)
            return
        cells = COARSE if dragging else FULL
        data = self._store.data(state, cells, quantities, hatched=True)
        scales = self._store.scales(state, data, quantities, dragging=dragging)
        ratio = 1.0 if dragging else self._slots.ratio
        path = None if motion is None else floor_path(motion)
        if self._live is None:
            from paminsa_viz.plots.map_figure import LiveMaps  # brings matplotlib

            self._live = LiveMaps()
        picture = self._live.draw(data, scales, width, ratio, path, COLUMNS, state.theme)
        address = picture_url(picture, exact=not dragging)
        self._address.content = render("maps/address.j2", name=self._name, address=address)
        self.data, self.scales = data, scales
        self._layout = map_layout(data, scales, width, PAGE_EM, columns=COLUMNS)
        self._mark(state)
        self._read(self._pointer)
        self._drawn = (shown, not dragging)

    def _mark(self, state: State) -> None:
        if self.data is None or self._layout is None:
            return
        self.data = self.data.with_pose(state.document.pose)
        layout, data = self._layout, self.data
        found = [] if "path" not in state.layers else points.listed(state)
        self._markers.content = render(
            "maps/markers.j2", layout=layout, places=layout.positions(data),
            frame=json.dumps(click_frame(layout, data)),
            points=[(point.name, layout.places(data, *point.pose[:2])) for point in found],
        )  # fmt: skip
        text = caption(state, data)
        if text != self._caption.content:
            self._caption.content = text

    def _receive(self, data: Any) -> None:
        """Take where the pointer is; of several messages that wait only the newest counts."""
        over = isinstance(data, dict) and data.get("map") == self._name
        self._pointer = data if over else None
        if over:
            self._session.submit(partial(self._read, data))

    def _read(self, pointer: Any) -> None:
        """Write at the pointer what the picture says there."""
        if pointer is None or pointer is not self._pointer or self.data is None:
            return
        place, panel = finite_place(pointer), pointer.get("panel")
        if place is None or type(panel) is not int or not 0 <= panel < self.data.panels:
            return
        found = readout(self.data, panel, place[0] / MM, place[1] / MM)
        if found is not None:
            self._session.bridge.call("showReadout", render("maps/readout.j2", readout=found))


def picture_url(pixels: NDArray[np.uint8], *, exact: bool) -> str:
    """Return a picture (h, w, 3) as an address that holds all of it.

    Args:
        pixels: The picture.
        exact: As PNG, without loss; otherwise as JPEG, which is smaller and made sooner.
    """
    file = io.BytesIO()
    if exact:
        Image.fromarray(pixels).save(file, "PNG")
    else:
        Image.fromarray(pixels).save(file, "JPEG", quality=LIVE_QUALITY)
    kind = "png" if exact else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(file.getvalue()).decode()}"


def click_frame(layout: MapLayout, data: MapData) -> dict[str, list[Any]]:
    """Return what the page reads the pointer over a picture with, sent with the picture itself.

    Returns:
        ``edges``, those of every panel: left, right, bottom, top [mm]; and ``panels``: left, top,
        width and height of each as shares of the picture's width and height.
    """
    wide, high = layout.width, layout.height
    panels = [[p.left / wide, p.top / high, p.width / wide, p.height / high] for p in layout.panels]
    return {"edges": [MM * float(edge) for edge in data.extent], "panels": panels}


def floor_path(motion: TrajectoryAnalysis) -> FloorPath:
    """Return a motion as it is drawn on maps."""
    found = split_path(motion)
    good, bad = ([found.place[run, :2] for run in runs] for runs in (found.good, found.bad))
    return FloorPath(joined(good), joined(bad))


ZERO = 1e-9
"""Values up to this are rounding errors of what is zero, in whatever unit is shown."""


def is_zero(values: Array) -> bool:
    """Whether there are values, and all are zero but for rounding."""
    known = values[np.isfinite(values)]
    return known.size > 0 and float(np.abs(known).max()) < ZERO


def caption(state: State, data: MapData) -> str:
    """Return the line below a picture: what it shows, where, and what its marks mean."""
    reference = state.document.reference if shows_difference(state) else None
    return render(
        "maps/caption.j2",
        title="Static torques" if data.panels > 1 else data.title.removesuffix(", difference"),
        reference=None if reference is None else reference.name,
        theta=format_value(data.theta, "rad"),
        z=format_value(data.z, "m"),
        zero=is_zero(data.values),
        missing=data.missing_word,
        outside=() if data.outside is None else data.outside.present(),
        drawing=is_drawing(state),
        message=motion_points.DRAW,
        number=len(state.document.motion.waypoints) + 1,
    )
