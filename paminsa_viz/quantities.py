"""The registry of quantities that can be mapped, swept and required: one entry each.

An entry names the formula that is solved over a grid once for a geometry, and how a design's
masses, load and drives turn its results into values, so that a slider rescales a map and solves
nothing. Page, command line, tables and figures read everything else about a quantity here as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.actuation.transmission import SPEED_ROWS, TRANSMISSION
from paminsa_viz.actuation.wrench_capability import field_capability
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import UNIT_TORQUES, static_imbalance
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR
from paminsa_viz.units import DisplayUnit, display_unit

MAP_BUDGET = 1.0
"""Time that the cells of a map may take [s]; maps of costly quantities have fewer cells."""


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
        value: ``value(field, design)`` of a solved grid and a design (...) [SI]; by default the
            first result of the formula, for what the geometry alone decides. What it solves stays
            in the field, so that masses, loads and limits rescale it.
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
    value: Callable[[Field, Design], Array] | None = None
    signed: bool = False
    color: str = INK
    cost: float = 1e-7

    @property
    def display(self) -> DisplayUnit:
        """The unit for display."""
        return display_unit(self.unit)

    def over(self, field: Field, design: Design) -> Array:
        """Return the values over a solved grid (...) for a design; NaN where there are none."""
        if self.value is None:
            return field.solve(self.formula)[0]
        return self.value(field, design)


def _static(field: Field, design: Design, actuator: int) -> Array:
    """Return the static torque of M1, M2 or M3 over a field (...) [N m]."""
    torque = static_imbalance(design) * field.gamma[actuator]
    return torque + field.load_torques(design)[actuator] if design.load.acts else torque


def _rotary(field: Field, design: Design) -> Array:
    """Return the static torques of M1..M3 over a field, (3, ...) [N m]."""
    return field.torques(design)[:3]


def _rms(field: Field, design: Design) -> Array:
    """Return the root mean square of the static torques of M1..M3 over a field (...) [N m]."""
    if not design.load.acts:  # M_p2 is a factor of all three
        return abs(static_imbalance(design)) * np.sqrt((field.gamma[:3] ** 2).mean(axis=0))
    return np.sqrt((_rotary(field, design) ** 2).mean(axis=0))


def _torque(actuator: int) -> Quantity:
    below = "₁₂₃"[actuator]
    return Quantity(
        f"tau_{actuator + 1}", f"τ{below}", f"τ{below} of M{actuator + 1}",
        f"Static torque of actuator {actuator + 1}", "N m", UNIT_TORQUES,
        lambda field, design: _static(field, design, actuator),
        signed=True, color=LEG_COLORS[actuator],
    )  # fmt: skip


def _reached(field: Field, formula: Formula) -> Array:
    """Return the results of a formula (results, ...), NaN where a pose cannot be taken."""
    return np.where(field.status == Limit.OK, field.solve(formula), np.nan)


def _capability(name: str) -> Callable[[Field, Design], Array]:
    """Return a value of `Capability` by its name."""
    return lambda field, design: getattr(field_capability(field, design), name)


def _transmission(leg: int) -> Quantity:
    return Quantity(
        f"transmission_{leg + 1}", f"TI{'₁₂₃'[leg]}", f"transmission index of leg {leg + 1}",
        f"Output transmission index of leg {leg + 1} (Wang, Wu and Liu 2010)", "1", TRANSMISSION,
        lambda field, _: _reached(field, TRANSMISSION)[leg], color=LEG_COLORS[leg], cost=3e-7,
    )  # fmt: skip


def _pressure(leg: int) -> Quantity:
    return Quantity(
        f"pressure_{leg + 1}", f"pressure{'₁₂₃'[leg]}", f"pressure angle of leg {leg + 1}",
        f"Angle between force and motion of joint 5 of leg {leg + 1}", "rad", TRANSMISSION,
        lambda field, _: np.arccos(np.minimum(_reached(field, TRANSMISSION)[leg], 1.0)),
        color=LEG_COLORS[leg], cost=3e-7,
    )  # fmt: skip


def _selective(axis: int) -> Quantity:
    name, unit, load = (("x", "1/m", "force along x"), ("y", "1/m", "force along y"),
                        ("θ", "1", "moment about z"))[axis]  # fmt: skip

    def value(field: Field, _: Design) -> Array:
        rows = _reached(field, WRENCH_TORQUES)[3 * axis : 3 * axis + 3]
        return 1 / np.sqrt((rows**2).sum(axis=0))

    return Quantity(
        f"selective_{name.replace('θ', 'theta')}", f"DSI {name}", f"directional index of {name}",
        f"Direction-selective index of {name}: {load} for unit torques (Boschetti et al. 2011)",
        unit, WRENCH_TORQUES, value, cost=3e-7,
    )  # fmt: skip


QUANTITIES: dict[str, Quantity] = {
    quantity.key: quantity
    for quantity in (
        *(_torque(actuator) for actuator in range(3)),
        Quantity(
            "f_4", "F₄", "F₄ of M4", "Static force of actuator 4", "N", UNIT_TORQUES,
            lambda field, design: field.torques(design)[3],
            color=LIFT_COLOR,
        ),
        Quantity(
            "max_torque", "max |τ|", "max |τ| of M1 to M3", "Largest static torque of M1 to M3",
            "N m", UNIT_TORQUES,
            lambda field, design: np.abs(_rotary(field, design)).max(axis=0),
        ),
        Quantity(
            "rms_torque", "RMS τ", "RMS τ of M1 to M3", "RMS of the static torques of M1 to M3",
            "N m", UNIT_TORQUES,
            _rms,
        ),
        Quantity(
            "condition", "κ", "condition number κ", "Condition number", "1", DEXTERITY,
            lambda field, _: field.condition,
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
        Quantity(
            "payload", "m max", "payload capacity",
            "Largest payload held at rest within the actuators' limits", "kg", UNIT_TORQUES,
            _capability("payload"), cost=1e-6,
        ),
        Quantity(
            "horizontal_force", "F_h", "guaranteed horizontal force",
            "Horizontal force held in every direction with no moment", "N", WRENCH_TORQUES,
            _capability("horizontal_force"), cost=1e-6,
        ),
        Quantity(
            "vertical_force", "F_v", "guaranteed vertical force",
            "Largest vertical force held both upward and downward", "N", UNIT_TORQUES,
            _capability("vertical_force"), cost=1e-6,
        ),
        Quantity(
            "moment", "M_z", "guaranteed moment",
            "Largest vertical moment held in both directions with no force", "N m",
            WRENCH_TORQUES, _capability("moment"), cost=1e-6,
        ),
        Quantity(
            "speed", "v", "guaranteed speed",
            "Speed within the actuators' limits in every direction of space", "m/s", SPEED_ROWS,
            _capability("speed"), cost=1e-6,
        ),
        Quantity(
            "turn_speed", "ω", "angular speed",
            "Largest angular speed about the platform's center", "rad/s", SPEED_ROWS,
            _capability("turn_speed"), cost=1e-6,
        ),
        Quantity(
            "acceleration", "a", "guaranteed acceleration",
            "Acceleration from rest within the peak torques in every direction of space", "m/s^2",
            WRENCH_TORQUES, _capability("acceleration"), cost=5e-6,
        ),
        Quantity(
            "turn_acceleration", "α", "angular acceleration",
            "Largest angular acceleration from rest within the peak torques", "rad/s^2",
            WRENCH_TORQUES, _capability("turn_acceleration"), cost=5e-6,
        ),
        Quantity(
            "transmission", "TI", "transmission index",
            "Least transmission index of the three legs (Wang, Wu and Liu 2010)", "1",
            TRANSMISSION, lambda field, _: _reached(field, TRANSMISSION).min(axis=0), cost=3e-7,
        ),
        *(_transmission(leg) for leg in range(3)),
        *(_pressure(leg) for leg in range(3)),
        *(_selective(axis) for axis in range(3)),
        Quantity(
            "selective_z", "DSI z", "directional index of z",
            "Direction-selective index of z, 1/k: force along z for a unit force of M4", "1",
            UNIT_TORQUES,
            lambda field, _: np.where(
                field.status == Limit.OK, 1 / field.geometry.magnification, np.nan
            ),
        ),
        Quantity(
            "conditioning", "LCI", "local conditioning index",
            "Local conditioning index 1/κ, with R_pl as characteristic length", "1", DEXTERITY,
            lambda field, _: 1 / _reached(field, DEXTERITY)[1], cost=3e-7,
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
