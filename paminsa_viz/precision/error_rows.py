"""Errors from the drives a coordinate: at poses, and over a region with its statistics."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.grids import Field
from paminsa_viz.precision.drive_errors import Bound, DriveErrors, field_drive_errors


class ErrorRow(NamedTuple):
    """Errors of one coordinate.

    Attributes:
        name: Coordinate, ``"xy"`` for the distance in the plane.
        unit: SI unit and the one to show it in.
        worst, linear, rms: (n,) errors as of `DriveErrors`, [m or rad]; NaN where there is none.
    """

    name: str
    unit: str
    worst: Array
    linear: Array
    rms: Array


def error_rows(found: DriveErrors) -> tuple[ErrorRow, ...]:
    """Return the errors of x, y, in the plane, of z and theta."""

    def row(name: str, unit: str, index: int) -> ErrorRow:
        parts = (found.worst, found.linear, found.rms)
        return ErrorRow(name, unit, *(np.atleast_1d(part[..., index]).ravel() for part in parts))

    plane = (found.horizontal, found.linear_horizontal, found.rms_horizontal)
    return (
        row("x", "m:um", 0),
        row("y", "m:um", 1),
        ErrorRow("xy", "m:um", *(np.atleast_1d(part).ravel() for part in plane)),
        row("z", "m:um", 3),
        row("θ", "rad:arcsec", 2),
    )


@dataclass(frozen=True, eq=False)
class RegionErrors:
    """Errors over the poses of a region that can be reached.

    Attributes:
        rows: Errors of each coordinate, (n,) each.
        poses: n.
        unbounded: How many poses have no bound, by the reason.
    """

    rows: tuple[ErrorRow, ...]
    poses: int
    unbounded: dict[Bound, int]


def region_errors(field: Field, accuracy: DriveAccuracy, here: NDArray[np.bool_]) -> RegionErrors:
    """Return the errors from the drives over a region.

    Args:
        field: A solved grid.
        accuracy: That of the drives.
        here: Which of its cells belong to the region and can be reached.
    """
    found = field_drive_errors(field, accuracy)
    rows = tuple(
        row._replace(**{name: getattr(row, name)[here.ravel()] for name in STATISTICS_OF})
        for row in error_rows(found)
    )
    counts = Counter(Bound(code) for code in found.status[here].tolist())
    return RegionErrors(rows, int(here.sum()), {b: counts[b] for b in Bound if b and counts[b]})


STATISTICS_OF = ("worst", "linear", "rms")
"""Kinds of errors of an `ErrorRow`."""


def statistics(values: Array) -> tuple[float, float, float]:
    """Return median, 95th percentile and largest of what is no NaN; NaN where nothing is."""
    known = values[~np.isnan(values)]
    if not known.size:
        return np.nan, np.nan, np.nan
    median, most = np.percentile(known, (50, 95))
    return float(median), float(most), float(known.max())
