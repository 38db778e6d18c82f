"""Quantities of the errors of the pose: from the drives, from tolerances, from deviations.

The drives' errors follow from their accuracy; tolerances and clearances are what any robot of a
design may have, known deviations what one of them has.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.kinematics import wrap
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.precision.drive_errors import Bound, field_drive_errors
from paminsa_viz.precision.manufacture import field_manufactured_pose, field_tolerance_errors
from paminsa_viz.precision.unequal_legs import Closure
from paminsa_viz.quantities.quantity import Missing, Quantity, in_family

COST = 2.5e-5
"""Time for a pose of unequal legs [s]: nine equations with 42 lengths, or solving them."""

_LENGTH, _ANGLE = "m:um", "rad:arcsec"
_TILT = ("tilt", "tilt", "the platform’s tilt", _ANGLE, "tilt")
_PLACES: tuple[tuple[str, str, str, str, int | str], ...] = (
    ("x", "x", "x", _LENGTH, 0), ("y", "y", "y", _LENGTH, 1),
    ("horizontal", "position", "the position in x and y", _LENGTH, "horizontal"),
    ("z", "z", "z", _LENGTH, 3), ("theta", "θ", "θ", _ANGLE, 2),
)  # fmt: skip
"""Key, symbol, name, unit, and place in a pose, or the name of what combines several."""

_TEXTS = tuple(f"no bound: {bound.reason(leg)}" for bound in Bound for leg in range(-1, 3))
_WORDS = tuple(
    f"no-bound:{bound.word}" + (f":leg{leg + 1}" if leg >= 0 else "")
    for bound in Bound
    for leg in range(-1, 3)
)


def _unbounded(field: Field, design: Design) -> Missing:
    """Return where the exact errors from the drives have no bound, and why."""
    found = field_drive_errors(field, design.accuracy)
    code = np.where(found.ok, 0, 4 * found.status + (found.leg + 1)).astype(np.uint8)
    return Missing(code, _TEXTS, _WORDS)


def _of(
    errors: Callable[[Field, Design], object], name: str, place: int | str, prefix: str
) -> Callable[[Field, Design], Array]:
    """Return a coordinate of the named array of errors, or what combines several of them."""

    def value(field: Field, design: Design) -> Array:
        found = errors(field, design)
        if isinstance(place, int):
            return getattr(found, name)[..., place]
        return getattr(found, prefix + place)

    return value


def _from_drives(
    key: str, symbol: str, label: str, title: str, name: str, prefix: str
) -> list[Quantity]:
    """Return an error from the drives, of every coordinate; ``name`` as in `DriveErrors`."""
    return [
        Quantity(
            f"{key}_{part}", f"{symbol} {short}", f"{label} of {short}", title.format(what), unit,
            WRENCH_TORQUES,
            _of(lambda field, design: field_drive_errors(field, design.accuracy),
                name, place, prefix),
            cost=5e-6, missing=_unbounded if key == "error" else None,
        )
        for part, short, what, unit, place in _PLACES
    ]  # fmt: skip


def _from_tolerances(key: str, word: str, start: str, name: str, prefix: str) -> list[Quantity]:
    """Return an error from tolerances, of every coordinate; ``name`` as in `ToleranceErrors`."""
    return [
        Quantity(
            f"{key}_{part}", f"{word}tol {short}", f"{word}tolerance error of {short}",
            f"{start} error of {what} by tolerances and clearances, to first order",
            unit, LEAST_MARGIN, _of(field_tolerance_errors, name, place, prefix), cost=COST,
        )
        for part, short, what, unit, place in (*_PLACES, _TILT)
    ]  # fmt: skip


_UNCLOSED_TEXTS = tuple(f"no assembly: {closure.reason()}" for closure in Closure)
_UNCLOSED_WORDS = tuple(f"no-assembly:{closure.word}" for closure in Closure)


def _unclosed(field: Field, design: Design) -> Missing:
    """Return where the legs of a design cannot be assembled, and why."""
    found = field_manufactured_pose(field, design)
    return Missing(found.status, _UNCLOSED_TEXTS, _UNCLOSED_WORDS)


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
        unit, LEAST_MARGIN, value, signed=isinstance(place, int), cost=2 * COST, missing=_unclosed,
    )  # fmt: skip


_OWN_LEGS = (
    *_from_tolerances("tolerance", "", "Worst", "worst", ""),
    *_from_tolerances("rms_tolerance", "RMS ", "RMS", "rms", "rms_"),
    *(_deviation(*place) for place in (*_PLACES, _TILT)),
)

OF_OWN_LEGS = frozenset(quantity.key for quantity in _OWN_LEGS)
"""Quantities that follow the deviations of a design's single legs; all others have equal legs."""

ACCURACY = in_family(
    "accuracy",
    *_from_drives("error", "err", "worst error",
                  "Largest error of {} from the drives, exact kinematics", "worst", ""),
    *_from_drives("linear_error", "lin", "linear error",
                  "Linear estimate |J| δq of the error of {}", "linear", "linear_"),
    *_from_drives("rms_error", "RMS", "RMS error",
                  "RMS error of {}, from the drives, to first order", "rms", "rms_"),
    *_OWN_LEGS,
)  # fmt: skip
