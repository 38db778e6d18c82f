"""Quantities of the errors that the drives' accuracy leaves in the platform's pose."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.precision.drive_errors import Bound, DriveErrors, field_drive_errors
from paminsa_viz.quantities.quantity import Missing, Quantity, in_family

_LEGS = range(-1, 3)
_TEXTS = tuple(f"no bound: {bound.reason(leg)}" for bound in Bound for leg in _LEGS)
_WORDS = tuple(
    f"no-bound:{bound.word}" + (f":leg{leg + 1}" if leg >= 0 else "")
    for bound in Bound
    for leg in _LEGS
)


def _missing(field: Field, design: Design) -> Missing:
    """Return where the exact errors have no bound, and why."""
    found = field_drive_errors(field, design.accuracy)
    code = np.where(found.ok, 0, 4 * found.bound + (found.leg + 1)).astype(np.uint8)
    return Missing(code, _TEXTS, _WORDS)


class _Kind(NamedTuple):
    key: str
    symbol: str
    label: str
    title: str
    pose: Callable[[DriveErrors], Array]
    horizontal: Callable[[DriveErrors], Array]


_KINDS = (
    _Kind("error", "err", "worst error", "Largest error of {} from the drives, exact kinematics",
          lambda e: e.worst, lambda e: e.horizontal),
    _Kind("linear_error", "lin", "linear error", "Linear estimate |J| δq of the error of {}",
          lambda e: e.linear, lambda e: e.linear_horizontal),
    _Kind("rms_error", "RMS", "RMS error", "RMS error of {}, from the drives, to first order",
          lambda e: e.rms, lambda e: e.rms_horizontal),
)  # fmt: skip

_PLACES = (
    ("x", "x", "m:um", 0), ("y", "y", "m:um", 1), ("horizontal", "xy", "m:um", None),
    ("z", "z", "m:um", 3), ("theta", "θ", "rad:arcsec", 2),
)  # fmt: skip
"""Key, name, unit, and index in a pose; without one, the distance in the plane."""


def _error(kind: _Kind, name: str, symbol: str, unit: str, index: int | None) -> Quantity:
    def value(field: Field, design: Design) -> Array:
        found = field_drive_errors(field, design.accuracy)
        return kind.horizontal(found) if index is None else kind.pose(found)[..., index]

    what = "the position in the plane" if index is None else symbol
    return Quantity(
        f"{kind.key}_{name}", f"{kind.symbol} {symbol}", f"{kind.label} of {symbol}",
        kind.title.format(what), unit, WRENCH_TORQUES, value, cost=5e-6,
        missing=_missing if kind.key == "error" else None,
    )  # fmt: skip


ACCURACY = in_family("accuracy", *(_error(kind, *place) for kind in _KINDS for place in _PLACES))
