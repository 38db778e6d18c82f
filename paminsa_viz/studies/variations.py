"""Which designs a study looks at: every combination on a grid, or random ones.

Design ``i`` can be made without those before it, and is the same wherever it is made.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.checks import kinds_checked, require_range, require_seed
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import PARAMETER, Design, no_value
from paminsa_viz.units import counted


@dataclass(frozen=True)
class DesignAxis:
    """One design value and the numbers that it takes.

    Attributes:
        path: Dotted path of the value, such as ``links.b3``.
        values: The numbers, at least one [SI].

    Raises:
        InvalidInput: If there is no such value, or no finite numbers for it.
    """

    path: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        check_path(self.path)
        if not self.values or not np.isfinite(self.values).all():
            raise InvalidInput(self.path, "one finite number at least is needed")

    @property
    def words(self) -> str:
        """Its values in short, for the head of a table."""
        return f"{counted(len(self.values), 'value')}, {min(self.values)!r} to {max(self.values)!r}"


@dataclass(frozen=True)
class DesignRange:
    """One design value and the range that random numbers are drawn from.

    Attributes:
        path: Dotted path of the value.
        low, high: Ends of the range [SI].

    Raises:
        InvalidInput: If there is no such value, or the range is empty.
    """

    path: str
    low: float
    high: float

    def __post_init__(self) -> None:
        check_path(self.path)
        require_range(self.low, self.high, self.path)

    @property
    def words(self) -> str:
        """The range, for the head of a table."""
        return f"{self.low!r} to {self.high!r}"

    @classmethod
    @kinds_checked
    def around(cls, design: Design, path: str, spread: float) -> DesignRange:
        """Return the range of a design's own value, less and more by a share ``spread`` of it.

        Raises:
            InvalidInput: If the value is zero, so that a share of it is no range.
        """
        check_path(path)
        value = design.value(path)
        if value == 0:
            raise InvalidInput(path, "is 0, so that a spread around it is nothing; give a range")
        ends = value * (1 - spread), value * (1 + spread)
        return cls(path, *(ends if value > 0 else ends[::-1]))


@dataclass(frozen=True)
class DesignGrid:
    """Every combination of some values; the last axis runs fastest.

    Attributes:
        axes: What varies.
    """

    axes: tuple[DesignAxis, ...]

    def __post_init__(self) -> None:
        _check_paths(self.paths)

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths of the values that vary."""
        return tuple(axis.path for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of designs."""
        return int(np.prod([len(axis.values) for axis in self.axes], dtype=object))

    def values(self, index: int) -> tuple[float, ...]:
        """Return the values of one design, in the order of `paths`."""
        places = np.unravel_index(index, [len(axis.values) for axis in self.axes])
        return tuple(axis.values[i] for axis, i in zip(self.axes, places, strict=True))


@dataclass(frozen=True)
class RandomDesigns:
    """Designs with values drawn evenly from ranges.

    Attributes:
        ranges: What varies.
        size: Number of designs.
        seed: The same seed gives the same designs; more of them begin with the same ones.
    """

    ranges: tuple[DesignRange, ...]
    size: int
    seed: int = 0

    def __post_init__(self) -> None:
        _check_paths(self.paths)
        if self.size < 1:
            raise InvalidInput("size", f"one random design at least is needed, not {self.size}")
        require_seed(self.seed)

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths of the values that vary."""
        return tuple(item.path for item in self.ranges)

    def values(self, index: int) -> tuple[float, ...]:
        """Return the values of one design, in the order of `paths`."""
        drawn = np.random.default_rng((self.seed, index)).uniform(size=len(self.ranges))
        pairs = zip(self.ranges, drawn.tolist(), strict=True)
        return tuple(item.low + (item.high - item.low) * share for item, share in pairs)


def check_path(path: str) -> None:
    """Raise `InvalidInput`, with the nearest name, unless a design has such a value."""
    if path not in PARAMETER:
        raise InvalidInput(path[:60], no_value(path))


def _check_paths(paths: tuple[str, ...]) -> None:
    if not paths:
        raise InvalidInput("paths", "at least one design value has to vary")
    for path in paths:
        if paths.count(path) > 1:
            raise InvalidInput(path, "varies twice")
