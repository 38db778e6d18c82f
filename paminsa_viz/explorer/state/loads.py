"""Joint forces and bar loads: what is shown, and what is known along the motion."""

from __future__ import annotations

from dataclasses import dataclass, field

from paminsa_viz.elastostatics.bar_loads import BAR_NAMES
from paminsa_viz.elastostatics.joint_forces import JOINTS
from paminsa_viz.elastostatics.motion_loads import MotionLoads
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.trajectory import TrajectoryAnalysis

LoadsOutcome = Outcome[TrajectoryAnalysis, MotionLoads]


@dataclass(frozen=True)
class LoadsSettings(Settings):
    """What a person set; ``leg`` is an index, 0 to 2."""

    leg: int = setting(
        0, "Leg", "Whose joints and bars are listed", options={f"leg {i + 1}": i for i in range(3)}
    )
    bar: str = setting(
        "b4", "Bar", "Axial force, shear force and bending moment along it",
        options={name: bar for bar, name in BAR_NAMES.items()},
    )  # fmt: skip
    joint: str = setting(
        "2", "Joint", "Whose force is plotted, of all legs",
        options={joint.name: joint.key for joint in JOINTS},
    )  # fmt: skip
    along: bool = setting(
        False, "Along the motion",
        "Peak, RMS and equivalent load of every joint on the current motion",
    )  # fmt: skip


@dataclass(frozen=True)
class LoadsState:
    """What the tab *Loads* shows.

    Attributes:
        settings: What a person set.
        outcome: The last loads along a motion, or None.
    """

    settings: LoadsSettings = field(default_factory=LoadsSettings)
    outcome: LoadsOutcome | None = None
