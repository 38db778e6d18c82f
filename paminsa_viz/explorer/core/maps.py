"""From a state to the maps it shows: what is solved again, what is kept, and what colors mean.

A field holds all that the geometry decides on a grid at one theta and z. It is kept, so that a
mass, a position, a reference or a choice of colors only rescales what is there.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.state.maps import MapView, RangeMode
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import APPENDIX_4, Design, Geometry
from paminsa_viz.model.grids import Field
from paminsa_viz.plots.map_values import (
    COARSE,
    FULL,
    MapData,
    difference,
    frame_half,
    half_width,
    map_data,
    workspace_field,
)
from paminsa_viz.plots.outside import Outside
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales, usable_range
from paminsa_viz.plots.scale import Scale
from paminsa_viz.quantities import MAP_BUDGET, QUANTITIES, TORQUES, affordable_cells
from paminsa_viz.quantities.requirements import Requirements

DRAG_BUDGET = 0.1
"""Time that a coarse map may take while something is dragged [s]."""

KEPT = 8
"""Fields that are kept: coarse and full, of the design and of the reference, twice."""

MOST_BYTES = 16 * 2**20
"""How much the fields may take before those at another theta or z than the last are given up
[bytes]. A full one takes 2 MB with torques and 27 MB with stiffness, which are solved anew with
each theta and z."""

_Asked = tuple[Geometry, float, float, int, float]
"""What a field is solved for: theta [rad], z [m], cells along each side, half of one [m]."""


class MapStore:
    """Makes the maps of one session and keeps the fields behind them. Safe to use from threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._fields: dict[_Asked, tuple[Field, int]] = {}
        self._held: dict[tuple[tuple[str, ...], MapView], tuple[Scale, ...]] = {}

    def data(
        self,
        state: State,
        cells: int = FULL,
        quantities: Sequence[str] = TORQUES,
        *,
        hatched: bool = False,
    ) -> MapData:
        """Return the maps of a state, at the requested theta and z.

        With ``map_view.difference`` and a pinned reference, they show the design minus the
        reference, each with its own geometry, masked where either is out of reach.

        Args:
            state: What to show.
            cells: Cells along each side.
            quantities: Keys of what to show, one a panel, all in one unit.
            hatched: Whether to add which cells break a requirement, for what hatches them.
        """
        shown = self._of(state, state.document.design, cells, quantities, hatched=hatched)
        reference = state.document.reference
        if not shows_difference(state) or reference is None:
            return shown
        return difference(shown, self._of(state, reference, cells, quantities))

    def current(
        self, state: State, cells: int = FULL, quantities: Sequence[str] = TORQUES
    ) -> MapData:
        """Return the maps of the current design, whether or not the difference is shown."""
        return self._of(state, state.document.design, cells, quantities)

    def _of(
        self,
        state: State,
        design: Design,
        cells: int,
        quantities: Sequence[str],
        *,
        hatched: bool = False,
    ) -> MapData:
        document = state.document
        theta, z = document.pose[2:]
        budget = DRAG_BUDGET if cells <= COARSE else MAP_BUDGET
        asked = (
            design.geometry,
            theta,
            z,
            affordable_cells(quantities, cells, budget),
            frame_half(document.design.geometry, theta, z),
        )
        known = self._fields.get(asked)
        field = workspace_field(*asked) if known is None else known[0]
        data = map_data(field, design, document.pose, quantities)
        if hatched and hatches(state, budget / field.status.size):
            data = replace(data, outside=_outside_of(field, design, document.requirements))
        self._keep(asked, field)
        return data

    def _keep(self, asked: _Asked, field: Field) -> None:
        """Keep a field, used last, with what has been solved by now; give up others."""
        with self._lock:
            self._fields.pop(asked, None)
            self._fields[asked] = field, field.nbytes
            waiting = list(self._fields)
            for key in waiting[:-KEPT]:
                del self._fields[key]
            total = sum(size for _, size in self._fields.values())
            for key in waiting[-KEPT:]:
                if total > MOST_BYTES and key[1:3] != asked[1:3]:
                    total -= self._fields.pop(key)[1]

    def scales(
        self,
        state: State,
        data: MapData,
        quantities: Sequence[str] = TORQUES,
        *,
        dragging: bool = False,
    ) -> tuple[Scale, ...]:
        """Return the color scales for maps of a state, one a panel.

        A range that is found from the values is held while a slider is dragged, so that maps are
        seen to grow or fade. Where a reference is pinned, it is the wider one of both designs.

        Args:
            state: The state that ``data`` was made from.
            data: The maps, of any resolution.
            quantities: What they show.
            dragging: Whether a slider is being dragged.
        """
        view, reference = state.map_view, state.document.reference
        key = (tuple(quantities), view)
        held = self._held.get(key)  # once: an export of another range may drop it meanwhile
        if dragging and view.range_mode is RangeMode.AUTO and held is not None:
            return held
        sample = data if data.x.size == COARSE else self.data(state, COARSE, quantities)
        found = select_scales(data, sample, view)
        if view.range_mode is RangeMode.AUTO and reference is not None and not view.difference:
            other = self._of(state, reference, COARSE, quantities)
            pairs = zip(found, select_scales(other, other, view), strict=True)
            found = tuple(max(pair, key=_reach) for pair in pairs)
        self._held = {k: v for k, v in self._held.items() if k[0] != key[0]} | {key: found}
        return found


def _outside_of(field: Field, design: Design, requirements: Requirements) -> Outside:
    def find() -> Outside:
        from paminsa_viz.explorer.core.causes import outside_of  # loads SciPy

        return outside_of(field, design, requirements)

    return field.keep("outside", (design, requirements), find)


def hatches(state: State, cost: float) -> bool:
    """Whether cells are hatched that break a requirement, if that takes less time a cell [s]."""
    bounds = state.document.requirements.bounds
    each = {bound.entry.formula: bound.entry.cost for bound in bounds}
    return state.map_view.hatched and bool(bounds) and sum(each.values()) <= cost


def _reach(scale: Scale) -> float:
    return max(abs(scale.low), abs(scale.high))


def shows_difference(state: State) -> bool:
    """Return whether maps show the difference from the reference."""
    return state.map_view.difference and state.document.reference is not None


def hold_range(state: State) -> State:
    """Hold the color range of torques that suits the design and the reference alike.

    So maps of both, and of their difference, compare by their colors. Appendix 4 takes the place
    of a reference where there is none.
    """
    document, store = state.document, MapStore()
    largest = 0.0
    for design in (document.design, document.reference or APPENDIX_4):
        shown = replace(state, document=replace(document, design=design))
        data = store.current(shown, COARSE, TORQUES)
        scale = select_scales(data, data, MapView())[0]
        if np.nanmax(np.abs(data.values), initial=0.0) > 0:
            largest = max(largest, -scale.low, scale.high)
    if largest == 0:
        return state
    return state.updated(
        "map_view", range_mode=RangeMode.MANUAL, low=-largest, high=largest, shared=True
    )


def toggle_difference(state: State) -> State:
    """Show the difference from the reference, or no longer."""
    return state.updated("map_view", difference=not shows_difference(state))


def on_map(state: State, x: float, y: float) -> tuple[float, float]:
    """Return a position [m] at most as far out as maps show, rounded to 0.1 mm."""
    half = half_width(state.document.design.geometry)
    x, y = (round(min(max(value, -half), half), 4) + 0.0 for value in (x, y))
    return x, y


def go_to(state: State, x: float, y: float) -> State:
    """Ask for another position [m], at most as far out as maps show, rounded to 0.1 mm."""
    x, y = on_map(state, x, y)
    return actions.move(state, x=x, y=y)


def select_scales(data: MapData, sample: MapData, view: MapView) -> tuple[Scale, ...]:
    """Return the color scales that a person chose, one a panel.

    A manual range counts for maps in the unit of ``view.quantity`` only; others get the robust
    range. Its ends may be given in either order.

    Args:
        data: The maps; their extremes decide on the full range.
        sample: The same maps, coarse; they decide on the robust range.
        view: What was chosen.
    """
    choice = ScaleChoice(
        shared=view.shared,
        kind="symlog" if view.logarithmic else "linear",
        full=view.range_mode is RangeMode.FULL,
    )
    ends = usable_range(view.low, view.high)
    manual = view.range_mode is RangeMode.MANUAL and QUANTITIES[view.quantity].unit == data.unit
    if manual and ends is not None:
        choice = replace(choice, low=ends[0], high=ends[1])
    return choose_scales(data, choice, sample)


def choose_quantity(state: State, quantity: str) -> State:
    """Show another quantity; a manual range in another unit is given up."""
    view = state.map_view
    mode = view.range_mode
    if mode is RangeMode.MANUAL and QUANTITIES[quantity].unit != QUANTITIES[view.quantity].unit:
        mode = RangeMode.AUTO
    return state.updated("map_view", quantity=quantity, range_mode=mode)
