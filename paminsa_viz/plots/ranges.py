"""Color ranges: robust by default, full or manual on request."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.plots import colors, ticks
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import (
    InvalidScale,
    Kind,
    Scale,
    check_kind,
    check_range,
)

NEGLIGIBLE = 1e-9
"""Smallest range, in the unit of the data; below it are rounding errors of a balanced robot."""

LARGEST_END = 1e9
"""Largest size of a manual range, in its SI unit."""


@dataclass(frozen=True)
class ScaleChoice:
    """Settings for the colors of a map.

    Attributes:
        low: Lower end in the unit of the data, or None for a range found from the data. Give both
            or none.
        high: Upper end, or None.
        full: Whether a range found from the data spans every value, instead of the ordinary ones.
        shared: One range for all panels, or one for each.
        kind: ``"linear"`` or ``"symlog"``.

    Raises:
        InvalidScale: If a number is not finite, the range is empty, or the kind is not known.
    """

    low: float | None = None
    high: float | None = None
    full: bool = False
    shared: bool = True
    kind: Kind = "linear"

    def __post_init__(self) -> None:
        if (self.low is None) != (self.high is None):
            raise InvalidScale("low" if self.low is None else "high", "give both ends or none")
        if self.low is not None and self.high is not None:
            check_range(self.low, self.high)
        check_kind(self.kind)


@kinds_checked
def choose_scales(
    data: MapData, choice: ScaleChoice | None = None, sample: MapData | None = None
) -> tuple[Scale, ...]:
    """Return one scale a panel; with ``choice.shared`` they are all the same one.

    Args:
        data: The maps.
        choice: Settings; None for the defaults.
        sample: The same maps, coarser: a robust range is found from them, so that it is the same
            at every resolution.
    """
    asked = choice or ScaleChoice()
    if data.bounded and not data.signed:
        asked = replace(asked, full=True)
    spans_zero = asked.low is not None and asked.high is not None and asked.low < 0 < asked.high
    if spans_zero and not data.signed and not (data.values < 0).any():
        asked = replace(asked, low=0.0)  # colors of impossible values would dull the others
    found = (data if asked.full else sample or data).values
    factor, one = data.display.factor, 1.0
    if math.log10(factor).is_integer():  # what is round in SI units is round as displayed
        factor, one = 1.0, 1.0 / factor
    if asked.shared or data.panels == 1:
        return (_scale(found, data.signed, asked, factor, one),) * data.panels
    return tuple(_scale(values, data.signed, asked, factor, one) for values in found)


def per_panel(data: MapData, scale: Scale | Sequence[Scale]) -> tuple[Scale, ...]:
    """Return one scale a panel from a single one or a sequence.

    Raises:
        InvalidScale: If a sequence has another length than there are panels.
    """
    if isinstance(scale, Scale):
        return (scale,) * data.panels
    if len(scale) != data.panels:
        raise InvalidScale("scale", f"1 or {data.panels} are needed, not {len(scale)}")
    return tuple(scale)


def robust_range(values: ArrayLike, signed: bool, one: float = 1.0) -> tuple[float, float]:
    """Return a round range of the ordinary values, whatever grows without bound beyond its ends.

    Near a singularity torques grow like one over the distance, so no percentile near 100 is safe:
    a quarter of a map can lie above ten times its median. The range is therefore tied to the
    lower part of the values, and holds them all where they have no such tail.
    Signed quantities get a range symmetric about zero of four times the 40th percentile of their
    size; magnitudes four times as far from their low end as the 40th percentile is. Values below
    `NEGLIGIBLE` count as zero; where there is nothing else, the range is (-one, one) or (0, one):
    one of the unit that is displayed.
    """
    array = np.asarray(values, dtype=np.float64)
    finite = array[np.isfinite(array)]
    if signed:
        size = np.abs(finite)
        size = size[size > NEGLIGIBLE]
        if size.size == 0:
            return -one, one
        ordinary = 4 * float(np.percentile(size, 40.0))
        most = _high_end(size, 0.0)
        # Rounded up if the range is to hold the data, to the nearest where it cannot anyway.
        limit = ticks.nice_limit(min(ordinary, most), nearest=ordinary < most)
        return -limit, limit
    if finite.size == 0:
        return 0.0, one
    least, lower, middle, upper = (float(v) for v in np.percentile(finite, [2.0, 40.0, 50.0, 60.0]))
    least = min(least, -_high_end(-finite, -middle))
    most = _high_end(finite, middle)
    high = min(least + 4 * (lower - least), most) if lower - least > NEGLIGIBLE else most
    low = max(most - 4 * (most - upper), least) if most - upper > NEGLIGIBLE else least
    return _rounded(low, high, middle, one)


def full_range(values: ArrayLike, signed: bool) -> tuple[float, float] | None:
    """Return the round range that holds every finite value, symmetric for signed quantities.

    There is none if there are no values, or none that `usable_range` accepts.
    """
    array = np.asarray(values, dtype=np.float64)
    finite = array[np.isfinite(array)]
    ends = usable_range(float(finite.min()), float(finite.max())) if finite.size else None
    if ends is None:
        return None
    low, high = ends
    if signed:
        high = ticks.nice_limit(max(abs(low), abs(high)))
        return -high, high
    step = ticks.nice_step(high - low, 20)
    return ticks.clean(step * np.floor(low / step)), ticks.clean(step * np.ceil(high / step))


def usable_range(low: float, high: float) -> tuple[float, float] | None:
    """Return both ends in order, or None if they are too large or too close together."""
    low, high = min(low, high), max(low, high)
    size = max(abs(low), abs(high))
    return (low, high) if size <= LARGEST_END and high - low > 1e-9 * size else None


def _high_end(values: NDArray[np.float64], base: float) -> float:
    """Return the largest value, or the 98th percentile where the last 2 % stick out."""
    largest, most = float(values.max()), float(np.percentile(values, 98.0))
    return largest if largest - base <= 1.25 * (most - base) else most


def _rounded(low: float, high: float, middle: float, one: float) -> tuple[float, float]:
    """Widen a range to round ends, to zero where that is near, to something where it is empty."""
    if high - low <= NEGLIGIBLE + 1e-9 * max(abs(low), abs(high)):
        if abs(middle) <= NEGLIGIBLE:
            return 0.0, one
        low, high = middle - abs(middle) / 10, middle + abs(middle) / 10
    if 0 < low < high / 4:
        low = 0.0
    elif high < 0 and high > low / 4:
        high = 0.0
    step = ticks.nice_step(high - low, 10)
    return (
        ticks.clean(math.floor(low / step + 1e-9) * step),
        ticks.clean(math.ceil(high / step - 1e-9) * step),
    )


def _scale(
    values: NDArray[np.float64], signed: bool, choice: ScaleChoice, factor: float, one: float
) -> Scale:
    values = factor * values  # ends are round as displayed
    full = full_range(values, signed) if choice.full else None
    if choice.low is not None and choice.high is not None:
        low, high = factor * choice.low, factor * choice.high
    elif full is not None:
        low, high = full
    else:
        low, high = robust_range(values, signed, one)
        if choice.kind == "symlog":  # a log has room for the explosion, so show most of it
            low, high = _wide_range(values, low, high)
    threshold = float(f"1e{math.floor(math.log10(max(abs(low), abs(high)))) - 2}")
    table = colors.DIVERGING if signed else colors.SEQUENTIAL
    return Scale(low / factor, high / factor, choice.kind, threshold / factor, table, factor=factor)


def _wide_range(values: NDArray[np.float64], low: float, high: float) -> tuple[float, float]:
    """Widen a robust range to the power of ten that holds 95 % of the cells."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return low, high
    most = float(np.percentile(np.abs(finite), 95.0))
    if most <= max(abs(low), abs(high)):
        return low, high
    limit = float(f"1e{math.ceil(math.log10(most) - 1e-9)}")
    return (-limit if low < 0 else low), (limit if high > 0 else high)
