"""Where the panels and color bars of a figure lie, in pixels or in mm.

The raster shown while dragging, the plotly figure shown at rest and the printed figure share this,
so that nothing jumps when one follows the other.
"""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.plots.maps import MapData


@dataclass(frozen=True)
class Box:
    """A rectangle: left, top, width and height, measured from the figure's top left corner."""

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
class Room:
    """Room around panels, all in the unit of the figure (pixels or mm).

    Attributes:
        left: Left of the first panel, for the y numbers and label.
        right: Right of everything.
        top: Above the panels, for the headings.
        axis: Below the panels, for the x numbers and label.
        gap: Between panels.
        bar: Thickness of a color bar.
        bar_gap: Between panels and color bar.
        bar_text: Beside an upright bar, for numbers and unit.
        bar_foot: Below a lying bar, for numbers and unit.
        bottom: Below everything.
        largest: Largest width of a panel.
        upright: Least width of the figure for a shared bar to stand upright at the right.
    """

    left: float
    right: float
    top: float
    axis: float
    gap: float
    bar: float
    bar_gap: float
    bar_text: float
    bar_foot: float
    bottom: float
    largest: float
    upright: float


@dataclass(frozen=True)
class Layout:
    """A figure's size, its panels and its color bars (one, or one a panel)."""

    width: float
    height: float
    panels: tuple[Box, ...]
    bars: tuple[Box, ...]
    upright: bool


def arrange(data: MapData, width: float, room: Room, own_bars: bool) -> Layout:
    """Place all panels of ``data`` in one row of a figure ``width`` wide, at equal x and y scale.

    A shared color bar stands at the right, or lies below in a narrow figure; own bars lie below
    their panels.
    """
    count = data.panels
    left, right, bottom, top = data.extent
    aspect = (top - bottom) / (right - left)
    upright = not own_bars and (width >= room.upright or count == 1)
    beside = room.bar_gap + room.bar + room.bar_text if upright else 0.0
    free = width - room.left - room.right - beside - room.gap * (count - 1)
    each = max(min(free / count, room.largest), 1.0)
    spare = max(0.0, free - each * count) / 2  # keeps a capped figure in the middle
    panels = tuple(
        Box(room.left + spare + i * (each + room.gap), room.top, each, each * aspect)
        for i in range(count)
    )
    foot = panels[0].bottom + room.axis
    if upright:
        last = panels[-1]
        bars = (Box(last.right + room.bar_gap, last.top, room.bar, last.height),)
    else:
        top_edge = foot + room.bar_gap
        if own_bars:
            inset = 0.6 * room.gap if count > 1 else 0.0  # numbers at its ends need room
            bars = tuple(
                Box(p.left + inset, top_edge, p.width - 2 * inset, room.bar) for p in panels
            )
        else:
            span = panels[-1].right - panels[0].left
            bars = (Box(panels[0].left + span / 8, top_edge, span * 3 / 4, room.bar),)
        foot = top_edge + room.bar + room.bar_foot
    return Layout(width, foot + room.bottom, panels, bars, upright)
