"""The registry of quantities that can be mapped, swept and required: one entry each.

An entry names the formula that is solved over a grid once for a geometry, and how a design's
masses, load and drives turn its results into values, so that a slider rescales a map and solves
nothing. Page, command line, tables and figures read everything else about a quantity here as well.
A file of this package holds those of one family.
"""

from __future__ import annotations

import copyreg
import math
import pickle
from collections.abc import Sequence
from typing import Any

from paminsa_viz.checks import kinds_checked, require_at_least
from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.model.backend import Formula
from paminsa_viz.quantities.accuracy import ACCURACY
from paminsa_viz.quantities.capability import CAPABILITY
from paminsa_viz.quantities.clearance import CLEARANCE
from paminsa_viz.quantities.joint_forces import JOINT_FORCES
from paminsa_viz.quantities.kinematics import KINEMATICS
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.statics import STATICS
from paminsa_viz.quantities.stiffness import STIFFNESS

MAP_BUDGET = 1.0
"""Time that the cells of a map may take [s]; maps of costly quantities have fewer cells."""

QUANTITIES: dict[str, Quantity] = {
    quantity.key: quantity
    for quantity in (
        *STATICS,
        *KINEMATICS,
        *CAPABILITY,
        *ACCURACY,
        *JOINT_FORCES,
        *STIFFNESS,
        *CLEARANCE,
    )
}
"""Every quantity by its key, in the order of choices."""

TORQUES: tuple[str, ...] = ("tau_1", "tau_2", "tau_3")
"""The three panels of Fig. 3."""


def families() -> dict[str, tuple[Quantity, ...]]:
    """Return the quantities by their families, in the order of choices."""
    found: dict[str, tuple[Quantity, ...]] = {}
    for quantity in QUANTITIES.values():
        found[quantity.family] = (*found.get(quantity.family, ()), quantity)
    return found


@kinds_checked
def find(keys: Sequence[str]) -> tuple[Quantity, ...]:
    """Return quantities by their keys.

    Raises:
        InvalidInput: If a key is unknown; names the nearest one.
    """
    return tuple(map(quantity_of, keys))


def quantity_of(key: str) -> Quantity:
    """Return a quantity by its key.

    Raises:
        InvalidInput: If the key is unknown; names the nearest one.
    """
    if key not in QUANTITIES:
        hint = name_hint(key, QUANTITIES)
        raise InvalidInput("quantity", f"there is no quantity {key[:40]!r}; {hint}")
    return QUANTITIES[key]


def _pickled(quantity: Quantity) -> Any:
    """Return what a quantity is made of again: its key, as its functions have no names."""
    if QUANTITIES.get(quantity.key) is quantity:
        return quantity_of, (quantity.key,)
    return quantity.__reduce_ex__(pickle.HIGHEST_PROTOCOL)


copyreg.pickle(Quantity, _pickled)


def selections() -> dict[str, tuple[str, ...]]:
    """Return the selections of a map by name: the three torques side by side, or one quantity."""
    found: dict[str, tuple[str, ...]] = {"torques": TORQUES}
    return found | {key: (key,) for key in QUANTITIES}


def formulas() -> tuple[Formula, ...]:
    """Return every formula of the registry once, for `backend.compile_in_background`."""
    return tuple(dict.fromkeys(quantity.formula for quantity in QUANTITIES.values()))


@kinds_checked
def affordable_cells(keys: Sequence[str], most: int, budget: float = MAP_BUDGET) -> int:
    """Return how many cells a side, at most ``most``, a map may have within a time [s].

    Raises:
        InvalidInput: If a key is unknown, or the time negative or not finite.
    """
    require_at_least(budget, "budget", what="a time of at least 0 s")
    work = {(item.family, item.formula, item.cost) for item in find(keys)}  # shared by its results
    cost = sum(seconds for *_, seconds in work)
    affordable = math.isqrt(int(budget / cost)) if budget < cost * most**2 else most
    return max(2, min(most, affordable))
