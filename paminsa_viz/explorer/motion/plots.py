"""What a person chose to see plotted of a motion."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.plots.series import FigureKind, SeriesKind

PLOTS: dict[str, SeriesKind] = {
    "torques and force": "torques",
    "difference to engine": "differences",
    "parts of one actuator": "breakdown",
    "power": "power",
    "energy": "energy",
    "pose": "pose",
    "speed": "speed",
    "acceleration": "acceleration",
    "simulation: error": "errors",
    "simulation: torques": "commands",
}
"""What can be plotted, by what a person reads."""

FIGURES: dict[SeriesKind, FigureKind] = {
    "differences": "comparison",
    "speed": "pose",
    "acceleration": "pose",
    "errors": "tracking",
    "commands": "tracking",
}
"""The figure that holds what is plotted, where it has another name."""

SIMULATED: tuple[SeriesKind, ...] = ("errors", "commands")
"""What is plotted of a simulation."""

COMPARED: tuple[SeriesKind, ...] = ("torques", "power", "energy")
"""What is plotted of a reference and of the formulae as published as well."""


@dataclass(frozen=True)
class PlotView:
    """How a motion is shown.

    Attributes:
        plot: What the curves show.
        actuator: Index 0 to 3 of the actuator whose parts are plotted.
        published: Whether the formulae as published are plotted next to the corrected ones.
        engine: Whether an engine's torques are plotted on the formulae's.
        color: Index 0 to 3 of the actuator by whose torque the path is colored.
    """

    plot: SeriesKind = "torques"
    actuator: int = 0
    published: bool = False
    engine: bool = False
    color: int = 0

    @property
    def needs_engine(self) -> bool:
        """Whether an engine's torques are part of what is shown."""
        return self.plot == "differences" or (self.plot == "torques" and self.engine)
