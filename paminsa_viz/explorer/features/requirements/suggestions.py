"""Bounds and a workspace to begin with, from what a design can do about home."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.explorer.core.requirements import default_workspace
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.requirements import Range, Requirement, Workspace

SPARE = 1.1
"""How far a suggested bound is beyond what a few poses need."""


def sampled(
    design: Design, theta: Range, workspace: Workspace, quantities: list[Quantity]
) -> dict[str, Array]:
    """Return values of quantities at poses of a workspace, by their keys; NaN out of reach.

    They are coarse: 7 x 7 positions, 3 headings, 3 heights.
    """
    home = home_pose(design.geometry)
    middles = zip(workspace.center, (home[0], home[1], home[3]), strict=True)
    place = [at if center is None else center for center, at in middles]
    x, y, z = (
        middle + extent / 2 * np.linspace(-1, 1, count)
        for middle, extent, count in zip(place, workspace.size, (7, 7, 3), strict=True)
    )
    grid = Grid.over(home, theta=np.linspace(*theta, 3), z=z, y=y, x=x)
    field = solve_field(design.geometry, grid)
    half = (workspace.size[0] / 2, workspace.size[1] / 2)
    away = x - place[0], (y - place[1])[:, None]
    inside = workspace.shape.section.gauge_squared(*away, half) <= 1.0 + 1e-9
    return {q.key: np.where(inside, q.over(field, design), np.nan).ravel() for q in quantities}


def suggested(document: Document, quantity: str) -> Requirement:
    """Return a bound that a quantity of the current design keeps over the workspace.

    A magnitude is bounded for signed quantities, and from below what is better if it is larger.
    """
    entry = QUANTITIES[quantity]
    workspace = document.requirements.workspace or default_workspace(document)
    values = sampled(document.design, document.requirements.theta, workspace, [entry])[quantity]
    values = values[np.isfinite(values)]
    if quantity == "condition":
        return Requirement(quantity, high=10.0)
    if not values.size:
        values = np.ones(1)
    if entry.signed:
        size = rounded(SPARE * float(np.abs(values).max()), entry, up=True)
        return Requirement(quantity, -size, size)
    if (
        quantity in LARGER_IS_BETTER
        or entry.family == "capability"
        or quantity.startswith(("transmission", "selective", "stiffness", "frequency", "clearance"))
    ):
        return Requirement(quantity, low=rounded(float(values.min()) / SPARE, entry, up=False))
    return Requirement(quantity, high=rounded(SPARE * float(values.max()), entry, up=True))


LARGER_IS_BETTER = ("reach_margin", "conditioning")
"""Quantities that are bounded from below, next to whole families."""


def rounded(value: float, entry: Quantity, *, up: bool) -> float:
    """Return a value rounded away to two digits as it is shown [SI]."""
    shown = round(entry.display.from_si(value), 9)  # torques of a balanced robot are rounding
    if shown == 0 or not math.isfinite(shown):
        return 1.0 if up else 0.0
    step = 10.0 ** (math.floor(math.log10(abs(shown))) - 1)
    steps = math.floor(shown / step + 1e-9) + 1 if up else math.ceil(shown / step - 1e-9) - 1
    return entry.display.to_si(float(f"{steps * step:.2g}"))
