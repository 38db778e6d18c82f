"""Errors by the drives on the page: encoders as a person gives them, and the largest errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.model import DriveAccuracy, Geometry
from paminsa_viz.quantities.requirements import Range, Workspace

if TYPE_CHECKING:
    from paminsa_viz.synthesis.volume.workspace import (
        RequirementCheck,  # noqa: F401 - a type argument
    )

TURN = 2 * math.pi

BITS = (3.0, 40.0)
"""Bits a turn that can be typed; a count of fewer is more than the model's errors may be."""


@dataclass(frozen=True)
class EncoderSettings(Settings):
    """What a count of the encoders of M1 to M3 is read with."""

    gear: float = setting(
        1.0, "Gear ratio", "Turns of the encoder for one of the actuator; its bits stay",
        range=(0.01, 1e4), step=1.0,
    )  # fmt: skip


@dataclass(frozen=True)
class EncoderState:
    """Encoders of a session."""

    settings: EncoderSettings = EncoderSettings()


def bits_of(count: float, gear: float) -> float:
    """Return the bits a turn of an encoder whose count moves the actuator by `count` [rad]."""
    return math.log2(TURN / (count * gear)) if count > 0 else math.inf


def count_of(bits: float, gear: float) -> float:
    """Return one count at the actuator [rad]: 2 pi / (2^bits gear)."""
    return TURN / (2.0**bits * gear)


@dataclass(frozen=True)
class WorstErrorsJob:
    """Where errors are looked for, with all that they depend on.

    Attributes:
        geometry: Lengths of the robot.
        accuracy: Accuracy of its drives.
        theta: Headings [rad].
        workspace: The required one, or that of a suggestion.
    """

    geometry: Geometry
    accuracy: DriveAccuracy
    theta: Range
    workspace: Workspace


@dataclass(frozen=True)
class WorstErrorsState(TaskState[WorstErrorsJob, "tuple[RequirementCheck, ...]"]):
    """The search for the largest errors of a session: the largest of each, with its pose."""
