"""What a person chose to see plotted of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Plot(Enum):
    """What the curves show; values are what a person reads."""

    TORQUES = "torques and force"
    DIFFERENCE = "difference to engine"
    PARTS = "parts of one actuator"
    POWER = "power"
    ENERGY = "energy"
    POSE = "pose"
    SPEED = "speed"
    ACCELERATION = "acceleration"
    TRACKING = "simulation: error"
    DRIVEN = "simulation: torques"


@dataclass(frozen=True)
class PlotView:
    """How a motion is shown.

    Attributes:
        plot: What the curves show.
        actuator: Index 0 to 3 of the actuator whose parts are plotted.
        printed: Whether the formulae as printed are plotted beside the corrected ones.
        engine: Whether an engine's torques are plotted on the formulae's.
        color: Index 0 to 3 of the actuator by whose torque the path is colored.
    """

    plot: Plot = Plot.TORQUES
    actuator: int = 0
    printed: bool = False
    engine: bool = False
    color: int = 0

    @property
    def needs_engine(self) -> bool:
        """Whether an engine's torques are part of what is shown."""
        return self.plot is Plot.DIFFERENCE or (self.plot is Plot.TORQUES and self.engine)
