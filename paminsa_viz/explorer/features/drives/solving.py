"""Finds drives."""

from __future__ import annotations

import numpy as np

from paminsa_viz.actuation.duty import duty_cycle
from paminsa_viz.actuation.selection import figures, select_drives
from paminsa_viz.explorer.state.drives import DriveJob, DriveLists

LISTED = 6
"""Drives that are listed for an actuator."""


def find_drives(job: DriveJob, _: object) -> DriveLists:
    """Search.

    Raises:
        PaminsaError: If the robot or the catalog does not allow it.
    """
    settings = job.settings
    found = select_drives(
        duty_cycle(job.design, job.duties), settings.parts, order=settings.order,
        same=settings.same, inertia_ratio=settings.inertia_ratio or np.inf,
    )  # fmt: skip
    rows = tuple(
        tuple(found.figures(j, LISTED) or [figures(sizing, sizing.nearest)])
        for j, sizing in enumerate(found.sizings)
    )
    return DriveLists(found, rows, tuple(found.advice(j) for j in range(4)))
