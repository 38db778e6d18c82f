"""Errors of balancing; each carries the data that a page or a command line needs to explain it."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.errors import PaminsaError


@dataclass(frozen=True)
class Shortfall:
    """A limit that cannot be met.

    Attributes:
        label: What is limited.
        unit: Its SI unit.
        limit: The requested limit.
        attainable: The least value within the bounds, the other limits met; with the other limits
            left out where they cannot be met either.
    """

    label: str
    unit: str
    limit: float
    attainable: float


@dataclass(frozen=True)
class Relaxation:
    """A bound of a mass to move.

    Attributes:
        name: Path of the mass, or name of the counterweight range.
        side: ``"low"`` or ``"high"``.
        bound: The bound as it is [kg].
        needed: Where it would have to be [kg].
    """

    name: str
    side: str
    bound: float
    needed: float


class SolverFailed(PaminsaError):
    """A program that the linear solver could not finish; its numbers may differ too much in size.

    Attributes:
        reason: What went wrong, in words.
    """

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(f"the best masses could not be worked out: {reason}")


class InfeasibleBounds(PaminsaError):
    """No masses within the bounds meet all limits.

    Attributes:
        limits: What cannot be met, and the least values instead.
        relax: The bounds whose least movement, added up over the robot, makes it possible; empty if
            none does.
    """

    def __init__(self, limits: tuple[Shortfall, ...], relax: tuple[Relaxation, ...]) -> None:
        self.limits = limits
        self.relax = relax
        shortfalls = "; ".join(
            f"{item.label} of at most {item.limit:.6g} {item.unit} is requested and "
            f"{item.attainable:.6g} {item.unit} is the least"
            for item in limits
        )
        remedy = ", ".join(
            f"{'raise the upper' if item.side == 'high' else 'lower the lower'} bound of "
            f"{item.name} from {item.bound:.6g} kg to {item.needed:.6g} kg"
            for item in relax
        )
        remedy = remedy or "no other bounds would help either"
        super().__init__(f"the bounds do not allow it: {shortfalls}; {remedy}")
