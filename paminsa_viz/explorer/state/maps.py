"""How maps are drawn."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from paminsa_viz.explorer.state.settings import Settings
from paminsa_viz.plots.ranges import LARGEST_END
from paminsa_viz.quantities import QUANTITIES


class RangeMode(Enum):
    """How a map's color range is found."""

    AUTO = "robust"
    FULL = "full"
    MANUAL = "manual"


@dataclass(frozen=True)
class MapView(Settings):
    """How the torque maps are drawn.

    Attributes:
        quantity: Key of what the single map and the floor show; the other figure shows torques.
        range_mode: How the color range is found.
        low, high: The manual range, in the quantity's SI unit.
        shared: Whether the three torque maps have one range.
        logarithmic: Whether colors follow a symmetric logarithm.
        difference: Whether the maps show the difference from the reference design.
        hatched: Whether cells that break a requirement are hatched.
    """

    quantity: str = "max_torque"
    range_mode: RangeMode = RangeMode.AUTO
    low: float = -10.0
    high: float = 10.0
    shared: bool = True
    logarithmic: bool = False
    difference: bool = False
    hatched: bool = True

    @property
    def possible(self) -> bool:
        ends = (self.low, self.high)
        return self.quantity in QUANTITIES and all(abs(end) <= LARGEST_END for end in ends)
