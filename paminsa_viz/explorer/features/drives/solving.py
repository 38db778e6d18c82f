"""Finds drives."""

from __future__ import annotations

import numpy as np

from paminsa_viz.actuation.duty import duty_cycle
from paminsa_viz.actuation.selection import figures, select_drives
from paminsa_viz.explorer.state.drives import DriveJob, DriveLists
from paminsa_viz.progress import Progress, of_part

LISTED = 6
"""Drives that are listed for an actuator."""


SIZING_SHARE = 0.5
"""Part of a search that measuring the drives takes; what would make one feasible takes the rest."""


def find_drives(job: DriveJob, progress: Progress) -> DriveLists:
    """Search.

    Raises:
        PaminsaError: If the robot or the catalog does not allow it.
    """
    settings = job.settings
    found = select_drives(
        duty_cycle(job.design, job.duties), settings.parts, order=settings.order,
        same=settings.same, inertia_ratio=settings.inertia_ratio or np.inf,
        progress=of_part(progress, 0.0, SIZING_SHARE),
    )  # fmt: skip
    rows = tuple(
        tuple(found.figures(j, LISTED) or [figures(sizing, sizing.nearest)])
        for j, sizing in enumerate(found.sizings)
    )
    rest = of_part(progress, SIZING_SHARE, 1.0)
    advice = tuple(found.advice(j, of_part(rest, j / 4, (j + 1) / 4)) for j in range(4))
    return DriveLists(found, rows, advice)
