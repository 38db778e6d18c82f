"""What a robot is needed for: bounds on quantities, and the workspace over which they hold."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import check_fields, require_each
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers
from paminsa_viz.model.workspace_shapes import WorkspaceShape
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.registry import find

Range = tuple[float, float]


@dataclass(frozen=True)
class Requirement:
    """A bound on a quantity over headings and heights.

    Attributes:
        quantity: Key of a quantity of the registry.
        low, high: Least and largest value that is allowed, in the quantity's SI unit; None for no
            bound on that side. A bound on a magnitude is ``low = -high``.
        theta: Headings over which it holds (least, largest) [rad]; None for all that are required.
        z: Heights of the platform over which it holds (least, largest) [m]; None for all.

    Raises:
        InvalidInput: If the quantity is unknown, or a bound or a range is not possible.
    """

    quantity: str
    low: float | None = None
    high: float | None = None
    theta: Range | None = None
    z: Range | None = None

    def __post_init__(self) -> None:
        _take_sequences(self, "theta", "z")
        check_fields(self)
        find([self.quantity])
        given = [bound for bound in (self.low, self.high) if bound is not None]
        if not given:
            raise InvalidInput(self.quantity, "a least or a largest value is needed")
        if any(math.isnan(bound) for bound in given) or given != sorted(given):
            problem = "the least value has to be a number that is at most the largest"
            raise InvalidInput(self.quantity, f"{problem}, not {self.low} and {self.high}")
        _check_range("theta", self.theta)
        _check_range("z", self.z)

    @property
    def entry(self) -> Quantity:
        """The quantity."""
        return find([self.quantity])[0]

    @property
    def size(self) -> float:
        """What margins are compared with: the smallest bound that is not 0, else 1 [SI]."""
        return min((abs(limit) for limit in (self.low, self.high) if limit), default=1.0)

    def margin(self, values: ArrayLike) -> Array:
        """Return how far values are inside the bounds, negative outside (...) [SI]; NaN of NaN.

        Raises:
            InvalidInput: If the values are no real numbers.
        """
        values = as_numbers(values, "values")
        above = values - self.low if self.low is not None else None
        below = self.high - values if self.high is not None else None
        sides = [side for side in (above, below) if side is not None]
        return np.minimum(sides[0], sides[-1])


@dataclass(frozen=True)
class Workspace:
    """A regular workspace of the platform's center P.

    Attributes:
        shape: Cylinder or box.
        size: (diameter, diameter, height) of a cylinder; extent along (x, y, z) of a box [m].
        center: Its center (x, y, z) [m]; a coordinate that is None is free to be found.

    Raises:
        InvalidInput: If a size is not positive, or a number is not finite.
    """

    shape: WorkspaceShape
    size: tuple[float, float, float]
    center: tuple[float | None, float | None, float | None] = (0.0, 0.0, None)

    def __post_init__(self) -> None:
        _take_sequences(self, "size", "center")
        check_fields(self)
        if not (_are_finite(self.size, 3) and min(self.size) > 0):
            problem = f"three positive numbers are needed, not {self.size}"
            raise InvalidInput("workspace.size", problem)
        if not _are_finite([0.0 if place is None else place for place in self.center], 3):
            problem = f"three finite numbers are needed, not {self.center}"
            raise InvalidInput("workspace.center", problem)
        if self.size != self.shape.section.fitted(self.size):
            raise InvalidInput("workspace.size", self.shape.section.rule)


@dataclass(frozen=True)
class Requirements:
    """What a robot has to do: reach a workspace with every heading, within bounds on quantities.

    Every pose that counts can be taken, and is joined to home without a singularity between.

    Attributes:
        bounds: Bounds on quantities.
        theta: Headings that count (least, largest) [rad].
        workspace: What has to lie within the volume where all bounds hold; None if any will do.

    Raises:
        InvalidInput: If the range of headings is not possible.
    """

    bounds: tuple[Requirement, ...] = ()
    theta: Range = (0.0, 0.0)
    workspace: Workspace | None = None

    def __post_init__(self) -> None:
        _take_sequences(self, "bounds", "theta")
        check_fields(self)
        require_each(self.bounds, "bounds", Requirement)
        _check_range("theta", self.theta)

    def headings(self, requirement: Requirement) -> Range:
        """Return the headings over which a requirement holds (least, largest) [rad]."""
        return self.theta if requirement.theta is None else requirement.theta


def _take_sequences(record: object, *names: str) -> None:
    """Let lists and arrays stand for the tuples of a record."""
    for name in names:
        value = getattr(record, name)
        if isinstance(value, list | np.ndarray):
            object.__setattr__(record, name, tuple(value))


def _check_range(name: str, limits: Range | None) -> None:
    if limits is not None and not (_are_finite(limits, 2) and limits[0] <= limits[1]):
        raise InvalidInput(name, f"two finite numbers, least and largest, are needed, not {limits}")


def _are_finite(values: Sequence[Any], count: int) -> bool:
    """Whether values are so many finite numbers."""
    # a float needs no look through the registered classes: a search makes many workspaces
    numbers = [
        (type(each) is float or isinstance(each, Real)) and math.isfinite(each) for each in values
    ]
    return len(numbers) == count and all(numbers)
