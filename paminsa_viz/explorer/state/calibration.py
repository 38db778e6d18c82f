"""Calibration on the page: its measured poses and settings, its tasks, and what they find."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import PERCENT, Settings, followed, setting
from paminsa_viz.model import Design, Geometry
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.precision import Calibration, CalibrationPlan, Measurements
from paminsa_viz.units import display_unit

MOST_HELD = 0.9
"""Largest share that can be held back."""

EXAMPLE_SIZE = 5e-4
"""Largest deviation of the legs of which example measurements are made, less of a small robot
[m, rad]."""

NOISES = (1e-8, 1e-2)
"""Uncertainties of a measured coordinate that are possible [m]."""


@dataclass(frozen=True)
class CalibrationSettings(Settings):
    """What a person set: of the poses to measure and, last, of the calibration.

    Attributes:
        noise: Standard deviation of a measured coordinate, angles counted with R_pl [m].
        seed: Of the poses that are tried, and of those that are held back.
    """

    poses: int = setting(40, "Poses", "How many to measure; 8 at least, 11 without the tilt",
                         range=(8, 1000), step=5.0)  # fmt: skip
    coordinates: int = setting(
        6, "Measured", "What of a pose the device measures, such as a laser tracker",
        options={"position, heading, tilt": 6, "position, heading": 4},
    )  # fmt: skip
    noise: float = setting(
        2e-5, "Uncertainty [µm]",
        "Standard deviation of a measured coordinate; angles as the path at the joints 5",
        range=NOISES, step=5.0, unit=display_unit("m:um"),
    )  # fmt: skip
    held: float = setting(
        0.25, "Held back [%]", "Share of the measured poses that only checks the result",
        range=(0.0, MOST_HELD), step=5.0, unit=PERCENT,
    )  # fmt: skip
    seed: int = setting(0, "Seed", "The same seed draws the same poses", range=(0, 10**9))

    @property
    def of_proposal(self) -> CalibrationSettings:
        """Those that the choice of poses depends on, the others as they are at first."""
        return replace(self, held=CalibrationSettings.held)

    @property
    def of_calibration(self) -> CalibrationSettings:
        """Those that a calibration depends on, the others as they are at first."""
        return CalibrationSettings(held=self.held, seed=self.seed)


def sized_calibration(
    settings: CalibrationSettings, was: Geometry, now: Geometry
) -> CalibrationSettings:
    """Return settings whose uncertainty follows the robot's lengths, unless it was chosen."""
    powers = {"noise": (1, NOISES)}
    return followed(settings, CalibrationSettings(), powers, length_ratio(was), length_ratio(now))


@dataclass(frozen=True, eq=False)
class MeasuredPoses:
    """Measured poses that are open.

    Attributes:
        name: Of their file.
        measurements: The poses and readings.
        first_row: Row of the first of them as a spreadsheet counts; 0 if they are of no file.
        about: Where they come from, if from no file.
    """

    name: str
    measurements: Measurements
    first_row: int = 0
    about: str = ""


@dataclass(frozen=True)
class ProposalJob:
    """A choice of poses with all it depends on; of the design only the lengths."""

    design: Design
    settings: CalibrationSettings


@dataclass(frozen=True)
class CalibrateJob:
    """A calibration with all it depends on; of the design only lengths and deviations."""

    design: Design
    measured: MeasuredPoses
    settings: CalibrationSettings


@dataclass(frozen=True)
class CalibrationState(TaskState[CalibrateJob, Calibration]):
    """The calibration of a session; settings outlive a result, measured poses are not saved.

    Attributes:
        settings: What a person set.
        measured: The open poses, or None.
        proposal: The choice of poses to measure.
    """

    settings: CalibrationSettings = field(default_factory=CalibrationSettings)
    measured: MeasuredPoses | None = None
    proposal: TaskState[ProposalJob, CalibrationPlan] = TaskState()
