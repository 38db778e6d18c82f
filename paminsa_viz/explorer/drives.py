"""The search for drives on the page: its settings, its jobs and what came of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from paminsa_viz.actuation.catalog import Catalog, generic_catalog
from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.selection import ROTARY, DriveFigures, Selection, figures, select_drives
from paminsa_viz.actuation.sizing import Order
from paminsa_viz.model import NO_DRIVES, Design, PaminsaError
from paminsa_viz.trajectory import Trajectory

MOST_MOTIONS = 12
"""Most motions of a cycle."""

LISTED = 6
"""Drives that are listed for an actuator."""


@dataclass(frozen=True)
class DriveSettings:
    """What a person set.

    Attributes:
        order: What comes first in the lists.
        same: Whether M1..M3 have the same drive.
        inertia_ratio: Largest inertia of the robot over that of the motor; 0 for any.
        dwell: How long the robot waits after the motion [s].
        count: How often the motion is made in a cycle of several.
        cycle: Motions that were added to a cycle; without any, the current motion is the cycle.
        catalog: A catalog that was opened; None for the generic sizes.
    """

    order: Order = "mass"
    same: bool = True
    inertia_ratio: float = 0.0
    dwell: float = 0.0
    count: float = 1.0
    cycle: tuple[Duty, ...] = ()
    catalog: Catalog | None = field(default=None, compare=False)

    @property
    def parts(self) -> Catalog:
        """The catalog in use."""
        return generic_catalog() if self.catalog is None else self.catalog


@dataclass(frozen=True, eq=False)
class DriveJob:
    """A search with all it depends on; drives that the design has play no part."""

    design: Design
    duties: tuple[Duty, ...]
    settings: DriveSettings

    def serves(self, design: Design, trajectory: Trajectory | None) -> bool:
        """Whether its result is that of a design while a motion is the current one."""
        current = bool(self.settings.cycle) or trajectory is self.duties[0].trajectory
        return current and self.design == replace(design, drives=NO_DRIVES)


@dataclass(frozen=True, eq=False)
class DriveOutcome:
    """What came of a search.

    Attributes:
        job: The search.
        selection: The drives, or None.
        rows: The first feasible drives of each actuator; the nearest one where none is.
        advice: What would make one feasible, empty where one is.
        problem: Why there are none.
    """

    job: DriveJob
    selection: Selection | None
    rows: tuple[tuple[DriveFigures, ...], ...] = ((),) * 4
    advice: tuple[str, ...] = ("",) * 4
    problem: str = ""


@dataclass(frozen=True)
class Driving:
    """The drives of a session.

    Attributes:
        settings: What a person set.
        running: The search that runs, or None.
        outcome: The last result, or None.
        actuator: Whose drives are listed, 0 to 3.
        row: Which of them is shown in its envelope.
    """

    settings: DriveSettings = field(default_factory=DriveSettings)
    running: DriveJob | None = None
    outcome: DriveOutcome | None = None
    actuator: int = 0
    row: int = 0

    @property
    def listed(self) -> tuple[DriveFigures, ...]:
        """Drives in the list."""
        return () if self.outcome is None else self.outcome.rows[self.actuator]

    @property
    def shown(self) -> DriveFigures | None:
        """The drive in its envelope."""
        return self.listed[self.row] if self.row < len(self.listed) else None

    def shared(self, actuator: int) -> tuple[int, ...]:
        """Return the actuators that have the same drive as one of them, by the last search."""
        outcome = self.outcome
        same = outcome is not None and outcome.job.settings.same and actuator < ROTARY
        return tuple(range(ROTARY)) if same else (actuator,)


def find_drives(job: DriveJob) -> DriveOutcome:
    """Search; raises nothing that is the robot's or the catalog's fault."""
    settings = job.settings
    try:
        cycle = duty_cycle(job.design, job.duties)
        found = select_drives(
            cycle, settings.parts, order=settings.order, same=settings.same,
            inertia_ratio=settings.inertia_ratio or np.inf,
        )  # fmt: skip
        rows = []
        for j, sizing in enumerate(found.sizings):
            listed = found.figures(j, LISTED) or [figures(sizing, sizing.nearest)]
            rows.append(tuple(listed))
        advice = tuple(found.advice(j) for j in range(4))
    except PaminsaError as error:
        return DriveOutcome(job, None, problem=str(error))
    return DriveOutcome(job, found, tuple(rows), advice)
