"""The registry of quantities that can be mapped, swept and required: one entry each.

An entry names the formula that is solved over a grid once for a geometry, and how a design's masses
turn its results into values, so that a mass slider rescales a map and solves nothing. Page, command
line, tables and figures read everything else about a quantity here as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import UNIT_TORQUES, lift_constant, static_imbalance
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR
from paminsa_viz.units import DisplayUnit, display_unit

MAP_BUDGET = 1.0
"""Time that the cells of a map may take [s]; maps of costly quantities have fewer cells."""


def first_result(solved: Array, design: Design) -> Array:
    """Return the first result of a formula: for quantities that the geometry alone decides."""
    del design
    return solved[0]


@dataclass(frozen=True)
class Quantity:
    """A number of every pose.

    Attributes:
        key: Name in Python and in state; the command line writes ``-`` for ``_``.
        symbol: Short name, for headings and table columns.
        label: Name in choices.
        title: What it is, for captions and help texts.
        unit: SI unit.
        formula: Solved over a grid, once for a geometry.
        value: ``value(solved, design)`` of the formula's results (results, ...) and a design [SI].
        signed: Whether zero is its natural center: diverging colors.
        color: ``#rrggbb`` of its heading.
        cost: Time that the formula takes [s] a pose, on NumPy arrays.
    """

    key: str
    symbol: str
    label: str
    title: str
    unit: str
    formula: Formula
    value: Callable[[Array, Design], Array] = first_result
    signed: bool = False
    color: str = INK
    cost: float = 1e-7

    @property
    def display(self) -> DisplayUnit:
        """The unit for display."""
        return display_unit(self.unit)

    def over(self, field: Field, design: Design) -> Array:
        """Return the values over a solved grid (...) for a design; NaN where there are none."""
        return self.value(field.solve(self.formula), design)


def _torque(actuator: int) -> Quantity:
    below = "₁₂₃"[actuator]
    return Quantity(
        f"tau_{actuator + 1}", f"τ{below}", f"τ{below} of M{actuator + 1}",
        f"Static torque of actuator {actuator + 1}", "N m", UNIT_TORQUES,
        lambda gamma, design: static_imbalance(design) * gamma[actuator],
        signed=True, color=LEG_COLORS[actuator],
    )  # fmt: skip


QUANTITIES: dict[str, Quantity] = {
    quantity.key: quantity
    for quantity in (
        *(_torque(actuator) for actuator in range(3)),
        Quantity(
            "f_4", "F₄", "F₄ of M4", "Static force of actuator 4", "N", UNIT_TORQUES,
            lambda gamma, design: static_imbalance(design) * gamma[3] + lift_constant(design),
            color=LIFT_COLOR,
        ),
        Quantity(
            "max_torque", "max |τ|", "max |τ| of M1 to M3", "Largest static torque of M1 to M3",
            "N m", UNIT_TORQUES,
            lambda gamma, design: abs(static_imbalance(design)) * np.abs(gamma[:3]).max(axis=0),
        ),
        Quantity(
            "rms_torque", "RMS τ", "RMS τ of M1 to M3", "RMS of the static torques of M1 to M3",
            "N m", UNIT_TORQUES,
            lambda gamma, design: abs(static_imbalance(design))
            * np.sqrt((gamma[:3] ** 2).mean(axis=0)),
        ),
        Quantity(
            "condition", "κ", "condition number κ", "Condition number", "1", DEXTERITY,
            lambda dexterity, _: dexterity[1],
            cost=3e-7,
        ),
        Quantity(
            "determinant", "det", "determinant", "Determinant, zero at a singularity", "m",
            DEXTERITY, signed=True, cost=3e-7,
        ),
        Quantity(
            "reach_margin", "margin", "reach margin", "Distance to the nearest limit of reach", "m",
            LEAST_MARGIN,
        ),
    )
}  # fmt: skip
"""Every quantity by its key, in the order of choices."""

TORQUES: tuple[str, ...] = ("tau_1", "tau_2", "tau_3")
"""The three panels of Fig. 3."""


def find(keys: Sequence[str]) -> tuple[Quantity, ...]:
    """Return quantities by their keys.

    Raises:
        InvalidInput: If a key is unknown; names the known ones.
    """
    for key in keys:
        if key not in QUANTITIES:
            known = ", ".join(QUANTITIES)
            raise InvalidInput("quantity", f"{known} are known, not {key!r}")
    return tuple(QUANTITIES[key] for key in keys)


def selections() -> dict[str, tuple[str, ...]]:
    """Return the selections of a map by name: the three torques side by side, or one quantity."""
    found: dict[str, tuple[str, ...]] = {"torques": TORQUES}
    return found | {key: (key,) for key in QUANTITIES}


def formulas() -> tuple[Formula, ...]:
    """Return every formula of the registry once, for `backend.compile_in_background`."""
    return tuple(dict.fromkeys(quantity.formula for quantity in QUANTITIES.values()))


def affordable_cells(keys: Sequence[str], most: int) -> int:
    """Return how many cells a side, at most ``most``, a map may have within `MAP_BUDGET`."""
    cost = sum({item.formula: item.cost for item in find(keys)}.values())
    return max(2, min(most, math.isqrt(int(MAP_BUDGET / cost))))
