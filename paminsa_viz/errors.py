"""Errors of the package; each carries the data that a page or command line needs to explain it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class PaminsaError(ValueError):
    """Root of every error that this package raises on bad input."""


class InvalidDesign(PaminsaError):
    """A design value that no machine can have.

    Attributes:
        field: Dotted path of the value, for example ``"geometry.base_radius"``.
        value: What was given.
        allowed: What is allowed, in words.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        super().__init__(f"{field} = {value!r} is not possible: {allowed}")


class InvalidInput(PaminsaError):
    """An argument whose shape or values a function cannot use.

    Attributes:
        argument: Name of the argument.
        problem: What is wrong with it and what is expected, in words.
    """

    def __init__(self, argument: str, problem: str) -> None:
        self.argument = argument
        self.problem = problem
        super().__init__(f"{argument}: {problem}")


class UnreachablePose(PaminsaError):
    """A pose that the mechanism cannot take.

    Attributes:
        pose: The pose (x, y, theta, z) [m, m, rad, m].
        leg: Paper's number of the leg that stands in the way (1, 2, 3), or 0 if no single leg does.
        limit: Name of the limit.
        excess: By how much the limit is exceeded [m].
    """

    def __init__(
        self, pose: tuple[float, ...], leg: int, limit: str, excess: float, explanation: str
    ) -> None:
        self.pose = pose
        self.leg = leg
        self.limit = limit
        self.excess = excess
        super().__init__(explanation)


def name_hint(name: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Return advice for an unknown name: the nearest of those that are known, or all of them."""
    names = list(known)
    near = difflib.get_close_matches(name[:100], names, 1, cutoff)
    return f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
