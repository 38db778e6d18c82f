"""What a quantity of a pose is."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import INK
from paminsa_viz.units import DisplayUnit, display_unit


class Missing(NamedTuple):
    """Where a quantity has no value though the pose can be taken, and why.

    Attributes:
        code: (...) 0 where there is a value, else the index of the reason.
        texts: Reasons by code, for people.
        words: The same for tables, as words without blanks.
    """

    code: NDArray[np.uint8]
    texts: tuple[str, ...]
    words: tuple[str, ...]


@dataclass(frozen=True)
class Quantity:
    """A number of every pose.

    Attributes:
        key: Name in Python and in state; the command line writes ``-`` for ``_``.
        symbol: Short name, for headings and table columns.
        label: Name in choices.
        title: What it is, for captions and help texts.
        unit: SI unit, with another to show it in if it needs one, see `units.display_unit`.
        formula: Solved over a grid, once for a geometry.
        value: ``value(field, design)`` of a solved grid and a design (...) [SI]; by default the
            first result of the formula, for what the geometry alone decides. What it solves stays
            in the field, so that masses, loads and limits rescale it.
        bounded: Whether it grows at no singularity, so that a map's colors span all its values.
        signed: Whether zero is its natural center: diverging colors.
        color: ``#rrggbb`` of its heading.
        cost: Time that the formula takes [s] a pose, on NumPy arrays.
        family: What it belongs to, in choices.
        missing: ``missing(field, design)`` says where and why there is no value though the pose
            can be taken; only for quantities that have such poses.
        flat: Whether it depends on neither z nor the lengths of the bars, but for reach: then a
            volume has it once a position and heading.
    """

    key: str
    symbol: str
    label: str
    title: str
    unit: str
    formula: Formula
    value: Callable[[Field, Design], Array] | None = None
    signed: bool = False
    bounded: bool = False
    color: str = INK
    cost: float = 1e-7
    family: str = "other"
    missing: Callable[[Field, Design], Missing] | None = None
    flat: bool = False

    @property
    def display(self) -> DisplayUnit:
        """The unit for display."""
        return display_unit(self.unit)

    @kinds_checked
    def over(self, field: Field, design: Design) -> Array:
        """Return the values over a solved grid (...) for a design; NaN where there are none."""
        if self.value is None:
            return field.solve(self.formula)[0]
        return self.value(field, design)


def reached(field: Field, formula: Formula) -> Array:
    """Return the results of a formula (results, ...), NaN where a pose cannot be taken."""
    return np.where(field.status == Limit.OK, field.solve(formula), np.nan)


def kept_over_poses(
    name: str,
    find: Callable[[Design, Array], Array],
    key: Callable[[Design], Hashable] = lambda design: design,
) -> Callable[[Field, Design], Array]:
    """Return values of a list of poses as those over a field, kept until the key changes.

    ``find(design, poses)`` gets NaN for poses (..., 4) that cannot be taken.
    """

    def over(field: Field, design: Design) -> Array:
        def solve() -> Array:
            poses = field.grid.poses()
            poses[field.status != Limit.OK] = np.nan
            return find(replace(design, geometry=field.geometry), poses)

        return field.keep(name, key(design), solve)

    return over


def in_family(family: str, *quantities: Quantity) -> tuple[Quantity, ...]:
    """Return quantities as those of a family."""
    return tuple(replace(quantity, family=family) for quantity in quantities)
