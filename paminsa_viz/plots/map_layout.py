"""Where the panels and color bars of a figure of maps lie, the same on a page and in print.

Lengths are in points from the figure's top left corner; on a page, a point is one page pixel. They
grow with the size of the letters, the em.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from paminsa_viz.errors import InvalidInput
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale
from paminsa_viz.units import MM

PAGE_EM = 11.0
"""Size of letters on a page [page pixels]."""

# In em.
_LEFT = 4.7  # y numbers of up to three digits, and label
_DIGIT = 0.64  # one more
_RIGHT = 0.8
_TOP = 1.9  # headings of the panels
_AXIS = 3.1  # x numbers and label
_GAP = 0.95  # between panels
_BAR = 0.95  # thickness of a color bar
_BAR_GAP = 0.85
_BAR_TEXT = 4.6  # numbers at the right of a vertical bar
_BAR_FOOT = 2.9  # numbers and unit below a horizontal bar
_BOTTOM = 0.3
_PANELS = (6.0, 42.0)  # least and largest width of a panel
_VERTICAL = 42.0  # least width of a figure of several maps with a vertical bar


@dataclass(frozen=True)
class Rectangle:
    """A rectangle by its left and top edge, width and height [points]."""

    left: float
    top: float
    width: float
    height: float

    @property
    def right(self) -> float:
        """Right edge."""
        return self.left + self.width

    @property
    def bottom(self) -> float:
        """Bottom edge."""
        return self.top + self.height


@dataclass(frozen=True)
class MapLayout:
    """The size of a figure, its panels, and its color bars: one, or one a panel [points]."""

    em: float
    width: float
    height: float
    panels: tuple[Rectangle, ...]
    bars: tuple[Rectangle, ...]
    vertical: bool
    columns: int

    def leftmost(self, index: int) -> bool:
        """Whether a panel is the first of its row, with numbers at its y axis."""
        return index % self.columns == 0

    def lowest(self, index: int) -> bool:
        """Whether no panel is below a panel; its x axis then has numbers."""
        return index + self.columns >= len(self.panels)

    def positions(self, data: MapData) -> list[tuple[float, float]]:
        """Return where the pose lies on each panel, as shares of the figure's width and height.

        There is none where the pose is not on the map.
        """
        return self.places(data, float(data.pose[0]), float(data.pose[1]))

    def places(self, data: MapData, x: float, y: float) -> list[tuple[float, float]]:
        """Return where a position [m] lies on each panel, as `positions` does for the pose."""
        left, right, bottom, top = data.extent
        if not (left <= x <= right and bottom <= y <= top):
            return []
        across, down = (x - left) / (right - left), (top - y) / (top - bottom)
        return [
            (
                (panel.left + across * panel.width) / self.width,
                (panel.top + down * panel.height) / self.height,
            )
            for panel in self.panels
        ]


def room_for_digits(low: float, high: float) -> float:
    """Return what numbers of mm between two positions [m] need beyond three digits [em]."""
    most = max(abs(low), abs(high)) * MM
    return _DIGIT * max(0, len(f"{most:.0f}") - 3)


def map_layout(
    data: MapData,
    scales: Sequence[Scale],
    width: float,
    em: float,
    head: float = 0.0,
    columns: int | None = None,
) -> MapLayout:
    """Place all panels in rows, at equal x and y scale.

    A shared color bar is at the right of a single row, or below in a narrow figure of several
    maps; a last row that is not full has room for it. Bars of their own lie below the panels.

    Args:
        data: The maps.
        scales: Color scales, one a panel; if they differ, each panel has a bar.
        width: Width of the figure [points].
        em: Size of the letters [points].
        head: Room above everything [points].
        columns: Panels in a row; all if None.

    Raises:
        InvalidInput: If the width is not enough for the panels.
    """
    count = data.panels
    columns = count if columns is None else min(columns, count)
    rows = math.ceil(count / columns)
    own_bars = len(set(scales)) > 1
    vertical = not own_bars and rows == 1 and (count == 1 or width >= _VERTICAL * em)
    right_of = (_BAR_GAP + _BAR + _BAR_TEXT) * em if vertical else 0.0
    left, right, bottom, top = data.extent
    beside = _LEFT + room_for_digits(bottom, top)
    free = width - (beside + _RIGHT + _GAP * (columns - 1)) * em - right_of
    each = min(free / columns, _PANELS[1] * em)
    if not each >= _PANELS[0] * em:
        raise InvalidInput("width", f"too narrow for {columns} panels side by side")
    tall = each * (top - bottom) / (right - left)
    spare = (free - each * columns) / 2  # keeps a wide figure's panels in the middle
    bar_room = (_BAR_GAP + _BAR + _BAR_FOOT) * em
    first, step = beside * em + spare, each + _GAP * em
    down = tall + _TOP * em + ((_AXIS * em + bar_room) if own_bars else 0.0)
    panels = tuple(
        Rectangle(
            first + i % columns * step, head + _TOP * em + i // columns * down, each, tall
        )
        for i in range(count)
    )  # fmt: skip
    foot = panels[-1].bottom + _AXIS * em
    if vertical:
        last = panels[-1]
        bars = (Rectangle(last.right + _BAR_GAP * em, last.top, _BAR * em, tall),)
    elif own_bars:
        bars = tuple(_bar_below(p.left, p.width, p.bottom + _AXIS * em, em, 0.04) for p in panels)
        foot += bar_room
    elif count % columns:  # below the panel whose place in the next row is free
        above = panels[count - columns]
        bars = (_bar_below(above.left, above.width, above.bottom + _AXIS * em, em, 0.125),)
    else:
        across = panels[-1].right - first
        bars = (_bar_below(first, across, foot, em, 0.125),)
        foot += bar_room
    height = math.ceil(foot + _BOTTOM * em)  # whole pixels on a page
    return MapLayout(em, width, height, panels, bars, vertical, columns)


def _bar_below(left: float, width: float, top: float, em: float, inset: float) -> Rectangle:
    """Return a horizontal bar below something; its numbers need room beyond the ends."""
    place = left + inset * width, top + _BAR_GAP * em
    return Rectangle(*place, (1 - 2 * inset) * width, _BAR * em)
