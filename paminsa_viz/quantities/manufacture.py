"""Quantities of the errors that tolerances, clearances and known deviations of the legs cause."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.kinematics import wrap
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.precision.manufacture import (
    ToleranceErrors,
    field_manufactured_pose,
    field_tolerance_errors,
)
from paminsa_viz.precision.unequal_legs import Closure
from paminsa_viz.quantities.quantity import Missing, Quantity, in_family

COST = 2.5e-5
"""Time for a pose [s]: nine equations with 42 lengths, or solving them."""

_LENGTH, _ANGLE = "m:um", "rad:arcsec"
_PLACES: tuple[tuple[str, str, str, str, int | str], ...] = (
    ("x", "x", "x", _LENGTH, 0), ("y", "y", "y", _LENGTH, 1),
    ("horizontal", "xy", "the position in the plane", _LENGTH, "horizontal"),
    ("z", "z", "z", _LENGTH, 3), ("theta", "θ", "θ", _ANGLE, 2),
    ("tilt", "tilt", "the platform's tilt", _ANGLE, "tilt"),
)  # fmt: skip
"""Key, symbol, name, unit, and place in the six coordinates, or name in `ToleranceErrors`."""


def _tolerance(rms: bool) -> list[Quantity]:
    kind, word, start = ("rms_tolerance", "RMS ", "RMS") if rms else ("tolerance", "", "Worst")

    def value(place: int | str) -> Callable[[Field, Design], Array]:
        def of(found: ToleranceErrors) -> Array:
            if isinstance(place, int):
                return (found.rms if rms else found.worst)[..., place]
            return getattr(found, f"rms_{place}" if rms else place)

        return lambda field, design: of(field_tolerance_errors(field, design))

    return [
        Quantity(
            f"{kind}_{key}", f"{'RMS ' if rms else ''}tol {symbol}",
            f"{word}tolerance error of {symbol}",
            f"{start} error of {name} by tolerances and clearances, to first order",
            unit, LEAST_MARGIN, value(place), cost=COST,
        )
        for key, symbol, name, unit, place in _PLACES
    ]  # fmt: skip


_TEXTS = tuple(f"no assembly: {closure.reason}" for closure in Closure)
_WORDS = tuple(f"no-assembly:{closure.name.lower().replace('_', '-')}" for closure in Closure)


def _missing(field: Field, design: Design) -> Missing:
    """Return where the legs of a design cannot be assembled, and why."""
    return Missing(field_manufactured_pose(field, design).closure, _TEXTS, _WORDS)


def _deviation(key: str, symbol: str, name: str, unit: str, place: int | str) -> Quantity:
    def value(field: Field, design: Design) -> Array:
        found = field_manufactured_pose(field, design)
        change = found.pose - field.grid.poses()
        if place == "horizontal":
            error = np.hypot(change[..., 0], change[..., 1])
        elif place == "tilt":
            error = np.hypot(found.tilt[..., 0], found.tilt[..., 1])
        else:
            assert isinstance(place, int)
            error = wrap(change[..., 2]) if place == 2 else change[..., place]
        return np.where(field.status == Limit.OK, error, np.nan)

    return Quantity(
        f"deviation_{key}", f"dev {symbol}", f"deviation of {symbol}",
        f"Error of {name} if the controller takes the legs as equal, exact kinematics",
        unit, LEAST_MARGIN, value, signed=isinstance(place, int), cost=2 * COST, missing=_missing,
    )  # fmt: skip


MANUFACTURE = in_family(
    "accuracy",
    *_tolerance(rms=False),
    *_tolerance(rms=True),
    *(_deviation(*place) for place in _PLACES),
)
