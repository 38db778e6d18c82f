"""The search for drives on the page: its settings, its jobs and what they find."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.duty import Duty
from paminsa_viz.actuation.selection import ROTARY, DriveFigures, Selection
from paminsa_viz.actuation.sizing import Order
from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.model import Design

MOST_MOTIONS = 12
"""Most motions of a cycle."""


@dataclass(frozen=True)
class DriveSettings(Settings):
    """What a person set.

    Attributes:
        inertia_ratio: 0 for any.
        dwell: [s].
        cycle: Motions that were added to a cycle; without any, the current motion is the cycle.
        catalog: A catalog that was opened; None for the generic sizes.
    """

    order: Order = setting(
        "mass", "Order", "Of the feasible drives",
        options={"lightest first": "mass", "cheapest first": "cost", "most margin first": "margin"},
    )  # fmt: skip
    same: bool = setting(True, "M1–M3 alike", "The three rotary actuators have the same drive")
    inertia_ratio: float = setting(
        0.0, "Inertia ratio ≤",
        "Largest inertia of the robot over that of the motor, at the motor’s shaft",
        range=(0.0, 1e6),
    )  # fmt: skip
    dwell: float = setting(
        0.0, "Dwell [s]",
        "How long the robot waits after the motion; a brake or a self-locking screw holds it",
        range=(0.0, 1e6), step=0.1,
    )  # fmt: skip
    count: float = setting(
        1.0, "Times", "How often the motion is made in a cycle of several motions", range=(1.0, 1e6)
    )
    cycle: tuple[Duty, ...] = ()
    catalog: Catalog | None = None

    @property
    def saved(self) -> DriveSettings:
        """Without motions and catalog, which come from files."""
        return replace(self, cycle=(), catalog=None)

    @property
    def parts(self) -> Catalog:
        """The catalog in use."""
        return generic_catalog() if self.catalog is None else self.catalog


@dataclass(frozen=True)
class DriveJob:
    """A search with all it depends on; drives that the design has play no part."""

    design: Design
    duties: tuple[Duty, ...]
    settings: DriveSettings

    def same_robot(self, other: DriveJob) -> bool:
        """Whether another search is for the same robot on the same motions."""
        return (self.design, self.duties) == (other.design, other.duties)


@dataclass(frozen=True, eq=False)
class DriveLists:
    """The drives that a search found.

    Attributes:
        selection: The drives.
        rows: The first feasible drives of each actuator; the nearest one where none is.
        advice: What would make one feasible, empty where one is.
    """

    selection: Selection
    rows: tuple[tuple[DriveFigures, ...], ...]
    advice: tuple[str, ...]


@dataclass(frozen=True)
class DrivesState(TaskState[DriveJob, DriveLists]):
    """The drives of a session.

    Attributes:
        settings: What a person set.
        actuator: Whose drives are listed, 0 to 3.
        row: Which of them is shown in its envelope.
    """

    settings: DriveSettings = field(default_factory=DriveSettings)
    actuator: int = 0
    row: int = 0

    @property
    def unkept(self) -> tuple[str, ...]:
        """As of any task, but for a search that a reload loses the motions or the catalog of."""
        outcome = self.outcome
        job = self.running or (None if outcome is None else outcome.job)
        again = job is not None and job.settings == job.settings.saved
        return super().unkept if again else ()

    @property
    def listed(self) -> tuple[DriveFigures, ...]:
        """Drives in the list."""
        return () if self.result is None else self.result.rows[self.actuator]

    @property
    def shown(self) -> DriveFigures | None:
        """The drive in its envelope."""
        return self.listed[self.row] if self.row < len(self.listed) else None

    def shared(self, actuator: int) -> tuple[int, ...]:
        """Return the actuators that have the same drive as one of them, by the last search."""
        outcome = self.outcome
        same = outcome is not None and outcome.job.settings.same and actuator < ROTARY
        return tuple(range(ROTARY)) if same else (actuator,)
