"""From values to colors: range, linear or symmetric log, contour levels, and beyond the range.

`ranges.choose_scales` makes the `Scale` of the data at hand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import INK, rgb
from paminsa_viz.plots import colors, ticks

if TYPE_CHECKING:
    from matplotlib.colors import Colormap, Normalize

Kind = Literal["linear", "symlog"]

_LARGEST = 1e100  # far from overflow and underflow in everything below
_DECADE_ROOM = 1 / (1 - 1 / 10)  # width of the linear part of the symmetric log, in decades


class InvalidScale(InvalidInput):
    """A color scale that cannot be drawn; see ``argument`` and ``problem``."""


@dataclass(frozen=True)
class Scale:
    """A color scale. Equal scales give equal images.

    Attributes:
        low: Value of the first color.
        high: Value of the last color.
        kind: ``"linear"``, or ``"symlog"``: linear within ``threshold`` of zero, logarithmic
            beyond, the linear part taking as much room as one decade (matplotlib's ``SymLogNorm``).
        threshold: See ``kind``; not used by a linear scale.
        colors: Name of the color table. A diverging table keeps its neutral center at zero,
            also where ``low`` and ``high`` are not opposite.
        contours: About how many contour levels.
        factor: From a value to the number that is displayed, such as degrees: ticks and contour
            levels are round as displayed.

    Raises:
        InvalidScale: If a number is not finite, the range is empty, or a name is not known.
    """

    low: float
    high: float
    kind: Kind = "linear"
    threshold: float = 1.0
    colors: str = colors.DIVERGING
    contours: int = 12
    factor: float = 1.0

    def __post_init__(self) -> None:
        check_range(self.low, self.high)
        check_kind(self.kind)
        if not (math.isfinite(self.threshold) and self.threshold > 0):
            problem = f"a finite number above 0 is needed, not {self.threshold!r}"
            raise InvalidScale("threshold", problem)
        if not (math.isfinite(self.factor) and self.factor > 0):
            raise InvalidScale("factor", f"a finite number above 0 is needed, not {self.factor!r}")
        if self.colors not in colors.BEYOND:
            known = ", ".join(colors.BEYOND)
            raise InvalidScale("colors", f"one of {known} is needed, not {self.colors!r}")

    def stretch(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return values on the axis along which colors are spread evenly (monotonic, odd)."""
        array = np.asarray(values, dtype=np.float64)
        if self.kind == "linear":
            return array
        size = np.abs(array)
        with np.errstate(divide="ignore", invalid="ignore"):
            outer = np.sign(array) * (_DECADE_ROOM + np.log10(size / self.threshold))
        return np.where(size <= self.threshold, array / self.threshold * _DECADE_ROOM, outer)

    def position(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return where values lie on the color bar: 0 at ``low``, 1 at ``high``, not clipped."""
        low, high = self._ends
        return (self.stretch(values) - low) / (high - low)

    @cached_property
    def _ends(self) -> tuple[float, float]:
        ends = self.stretch([self.low, self.high])
        return float(ends[0]), float(ends[1])

    @cached_property
    def table(self) -> NDArray[np.float64]:
        """Colors (256, 3) of sRGB in 0..1 from low to high."""
        base = colors.table(self.colors)
        if self.colors != colors.DIVERGING or self.low == -self.high:
            return base
        reach = float(self.stretch(max(abs(self.low), abs(self.high))))
        low, high = self._ends
        step = (np.arange(colors.SIZE) + 0.5) / colors.SIZE
        where = (low + (high - low) * step + reach) / (2 * reach) * colors.SIZE - 0.5
        grid = np.arange(colors.SIZE)
        return np.stack([np.interp(where, grid, base[:, i]) for i in range(3)], axis=1)

    @property
    def beyond(self) -> tuple[str, str]:
        """Colors of values below ``low`` and above ``high``, as ``#rrggbb``."""
        return colors.BEYOND[self.colors]

    def exceeded(self, values: ArrayLike) -> tuple[bool, bool]:
        """Return whether some values lie below ``low``, and whether some lie above ``high``."""
        array = np.asarray(values)
        with np.errstate(invalid="ignore"):
            return bool((array < self.low).any()), bool((array > self.high).any())

    def matplotlib_colors(self) -> tuple[Normalize, Colormap]:
        """Return matplotlib's own norm and color map."""
        from matplotlib.colors import ListedColormap, Normalize, SymLogNorm  # late: it is slow

        under, over = self.beyond
        table = ListedColormap(self.table, name=self.colors).with_extremes(
            under=under, over=over, bad=(0.0, 0.0, 0.0, 0.0)
        )
        if self.kind == "linear":
            return Normalize(self.low, self.high), table
        norm = SymLogNorm(self.threshold, linscale=1.0, vmin=self.low, vmax=self.high, base=10)
        return norm, table

    def ink(self, level: float) -> str:
        """Return the color of a contour line: dark, but white on the dark end of a magnitude.

        Diverging tables keep dark lines throughout, so that a line means the same on both sides.
        """
        if self.colors == colors.DIVERGING:
            return INK
        place = min(max(float(self.position(level)), 0.0), 1.0)
        color = self.table[round(place * (colors.SIZE - 1))]
        return INK if colors.oklab(color)[0] > 0.6 else "#ffffff"

    @cached_property
    def levels(self) -> tuple[float, ...]:
        """Contour levels: round numbers strictly inside the range."""
        if self.contours == 0:
            return ()
        low, high = self._displayed
        if self.kind == "linear":
            found = ticks.multiples(low, high, ticks.nice_step(high - low, self.contours))
        else:
            found = self._decades(max(1, self.contours // 2))
        return tuple(v / self.factor for v in found if low < v < high)

    def ticks(self, count: float) -> tuple[float, ...]:
        """Return about ``count`` round numbers for a color bar, and both ends of the range."""
        low, high = self._displayed
        if self.kind == "symlog":
            found = self._decades(max(1.0, (count - 1) / 2))
        else:
            step = ticks.dividing_step(low, high, count)
            if step is not None:
                return tuple(v / self.factor for v in ticks.multiples(low, high, step))
            found = ticks.multiples(low, high, ticks.nice_step(high - low, count))
        room = 0.6 / max(count, 1.0)
        values = [v / self.factor for v in found]
        where = self.position(np.array(values))
        inner = [v for v, p in zip(values, where, strict=True) if min(p, 1 - p) >= room]
        ends = [v for v, p in zip(values, where, strict=True) if min(p, 1 - p) < 1e-9]
        return tuple(sorted({*inner, *(ends if len(ends) == 2 else (self.low, self.high))}))

    @cached_property
    def _displayed(self) -> tuple[float, float]:
        """Both ends as displayed, without the rounding error of the factor."""
        if self.factor == 1:
            return self.low, self.high
        return ticks.clean(self.factor * self.low), ticks.clean(self.factor * self.high)

    def _decades(self, each_side: float) -> tuple[float, ...]:
        """Return zero and powers of ten on both sides, as displayed, thinned to ``each_side``."""
        low, high = self._displayed
        largest = max(abs(low), abs(high))
        first = math.floor(math.log10(self.factor * self.threshold) + 0.5)
        last = math.floor(math.log10(largest) + 1e-9)
        stride = max(1, math.ceil((last - first + 1) / each_side))
        powers = [float(f"1e{n}") for n in range(last, first - 1, -stride)]
        both = [-p for p in powers] + [0.0] + powers[::-1]
        return tuple(v for v in both if low <= v <= high)


UNDER, OVER, SINGULAR, UNREACHED = 0, colors.SIZE + 1, colors.SIZE + 2, colors.SIZE + 3
"""Codes of cells that have no color of the scale, whose colors have the codes 1 to 256: below the
range, above it, without a finite value although reached, and reached by no pose."""


def color_codes(
    values: ArrayLike, status: NDArray[np.uint8] | None, scale: Scale
) -> NDArray[np.intp]:
    """Return the color code of every cell.

    Args:
        values: (ny, nx) in the unit of the scale; infinite values lie beyond the range.
        status: (ny, nx) `Limit` codes, 0 where the value is good, or None if all are.
        scale: The color scale.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        fraction = scale.position(values) * colors.SIZE
        # fmax and fmin also turn NaN into a number; those cells are overwritten below.
        cells = np.floor(np.fmin(np.fmax(fraction, -1.0), colors.SIZE + 1.0)).astype(np.intp) + 1
    cells[fraction == colors.SIZE] = colors.SIZE
    np.minimum(cells, OVER, out=cells)
    cells[np.isnan(fraction)] = SINGULAR
    if status is not None:
        cells[status != 0] = UNREACHED
        cells[status == Limit.SINGULAR] = SINGULAR
    return cells


@lru_cache(maxsize=64)
def color_table(scale: Scale) -> NDArray[np.uint8]:
    """Return the colors of all codes as RGBA (260, 4), read-only; unreached cells are clear."""
    table = np.empty((UNREACHED + 1, 4), dtype=np.uint8)
    table[:, 3] = 255
    table[1:OVER, :3] = (scale.table * 255 + 0.5).astype(np.uint8)
    under, over = scale.beyond
    table[UNDER, :3], table[OVER, :3] = rgb(under), rgb(over)
    table[SINGULAR, :3] = rgb(colors.SINGULAR)
    table[UNREACHED] = (*rgb(colors.REACHLESS), 0)
    table.flags.writeable = False
    return table


def map_pixels(
    values: ArrayLike, status: NDArray[np.uint8] | None, scale: Scale
) -> NDArray[np.uint8]:
    """Return a map as RGBA pixels (ny, nx, 4), one a cell, clear where nothing is reached.

    Row i is ``y[i]`` and column j is ``x[j]``, so row 0 is the SMALLEST y. This is what an image
    node of viser without rotation needs to lie on the floor the right way round; for a picture
    file, which starts at the top, reverse the rows. Arguments are those of `color_codes`.
    """
    return np.take(color_table(scale), color_codes(values, status, scale), axis=0)


def check_range(low: float, high: float) -> None:
    for name, value in (("low", low), ("high", high)):
        if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
            raise InvalidScale(name, f"a number is needed, not {value!r}")
        if not math.isfinite(value):
            raise InvalidScale(name, f"a finite number is needed, not {value!r}")
    if not high > low:
        raise InvalidScale("high", f"it has to be above low = {low:.6g}, not {high:.6g}")
    size = max(abs(float(low)), abs(float(high)))
    if size > _LARGEST:
        raise InvalidScale("high", "the range is too wide for a color scale")
    if float(high) - float(low) < max(1e-12 * size, 1 / _LARGEST):
        raise InvalidScale("high", "the range is too narrow for a color scale")


def check_kind(kind: str) -> None:
    if kind not in ("linear", "symlog"):
        raise InvalidScale("kind", f"'linear' or 'symlog' is needed, not {kind!r}")
