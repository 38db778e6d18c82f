"""What is shown of a motion: the instant, and the curves."""

from __future__ import annotations

from dataclasses import dataclass, replace

from paminsa_viz.plots.series import FigureKind, SeriesKind

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0)
"""How many times as fast as true time a motion can be played."""


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
"""What is plotted of a reference and of the formulas as published as well."""


@dataclass(frozen=True)
class Playback:
    """The instant that is shown, and whether it moves on.

    Attributes:
        time: Since the motion's start [s].
        playing: Whether it moves on.
        following: Whether the robot stands where the motion is at ``time``; it does not once a
            person has moved it, until the motion is played or scrubbed again.
        speed: Times as fast as true time.
        loop: Whether the motion starts again at its end.
    """

    time: float = 0.0
    playing: bool = False
    following: bool = False
    speed: float = 1.0
    loop: bool = False


def advanced(playback: Playback, passed: float, duration: float) -> Playback:
    """Return a playback after some time has passed.

    Args:
        playback: A playback.
        passed: True time [s].
        duration: Of the motion [s]; without a loop, it stops there.
    """
    if not playback.playing:
        return playback
    time = playback.time + passed * playback.speed
    if time < duration:
        return replace(playback, time=time)
    if playback.loop and duration > 0:
        return replace(playback, time=time % duration)
    return replace(playback, time=duration, playing=False)


def started(playback: Playback, duration: float) -> Playback:
    """Return a playback that runs: from where it is, or from the start if it is at the end."""
    time = playback.time if playback.time < duration else 0.0
    return replace(playback, time=time, playing=True, following=True)


@dataclass(frozen=True)
class PlotView:
    """How a motion is shown.

    Attributes:
        plot: What the curves show.
        actuator: Index 0 to 3 of the actuator whose parts are plotted.
        published: Whether the formulas as published are plotted next to the corrected ones.
        engine: Whether an engine's torques are plotted on the formulas'.
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
