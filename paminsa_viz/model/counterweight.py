"""Counterweights: point masses on the bars of every leg, between their joints or beyond them."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.quantity import check_numbers, quantity
from paminsa_viz.units import format_ascii

BAR_ENDS: dict[str, tuple[int, int]] = {"b3": (4, 7), "b4": (9, 5), "b7": (8, 7), "b8": (8, 9)}
"""Bars of the pantograph and the joints at their two ends."""


@dataclass(frozen=True)
class Counterweight:
    """A point mass on one bar; every leg carries the same.

    Attributes:
        bar: ``"b3"``, ``"b4"``, ``"b7"`` or ``"b8"``.
        joint: The end of the bar, by the paper's number, that its place is measured from.
        beyond: Distance from that joint along the bar, away from its other end [m]. Negative
            values lie on the bar, between its two ends.
        mass: Mass [kg] on each leg.
    """

    bar: str
    joint: int
    beyond: float = quantity(0.0, "l_c", "m", "place, beyond the joint", signed=True)
    mass: float = quantity(0.0, "m_c", "kg", "counterweight")

    def __post_init__(self) -> None:
        ends = BAR_ENDS.get(self.bar) if isinstance(self.bar, str) else None
        if ends is None:
            allowed = f"a counterweight is on one of the bars {', '.join(BAR_ENDS)}"
            raise InvalidDesign("counterweight.bar", self.bar, allowed)
        if self.joint not in ends or isinstance(self.joint, bool):
            allowed = f"the ends of {self.bar.upper()} are joints {ends[0]} and {ends[1]}"
            raise InvalidDesign("counterweight.joint", self.joint, allowed)
        object.__setattr__(self, "joint", int(self.joint))
        check_numbers(self, "counterweight")

    @property
    def other(self) -> int:
        """The bar's other end."""
        first, second = BAR_ENDS[self.bar]
        return second if self.joint == first else first

    @property
    def place(self) -> str:
        """Where it is, in words, lengths in mm."""
        side = "beyond" if self.beyond >= 0 else "before"
        distance = format_ascii(abs(self.beyond), "m")
        return f"{self.bar.upper()}, {distance} {side} joint {self.joint}"
