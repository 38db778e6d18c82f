"""Tolerances of masses and lengths, and the robots that are drawn within them."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.balancing.tolerance import (
    LengthTolerance,
)
from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.plane import PlaneJob
from paminsa_viz.explorer.state.settings import PERCENT, Settings, setting


@dataclass(frozen=True)
class ToleranceSettings(Settings):
    """Relative tolerances, each even to both sides."""

    mass: float = setting(
        0.02, "Masses ± [%]",
        "Of every mass of joints, links and counterweights, in each leg by itself",
        range=(0.0, 0.5), step=0.5, unit=PERCENT,
    )  # fmt: skip
    length: float = setting(
        0.001, "Lengths ± [%]",
        "Of k, R_b, R_pl, the bars, l_B5 and the places of counterweights, in all legs alike",
        range=(0.0, 0.1), step=0.05, unit=PERCENT,
    )  # fmt: skip


@dataclass(frozen=True)
class TolerancesState(TaskState[PlaneJob, LengthTolerance]):
    """Tolerances of a session, and the robots that are drawn within that of lengths."""

    settings: ToleranceSettings = ToleranceSettings()
