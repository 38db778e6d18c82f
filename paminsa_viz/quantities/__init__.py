"""What can be mapped, swept and required, and what is required of a robot.

`QUANTITIES` is the registry; `Requirements` bound its quantities over a `Workspace`.
"""

from __future__ import annotations

from paminsa_viz.quantities.quantity import Missing, Quantity
from paminsa_viz.quantities.registry import (
    MAP_BUDGET,
    QUANTITIES,
    TORQUES,
    affordable_cells,
    families,
    find,
    formulas,
    selections,
)
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape

__all__ = [
    "MAP_BUDGET",
    "QUANTITIES",
    "TORQUES",
    "Missing",
    "Quantity",
    "Requirement",
    "Requirements",
    "Workspace",
    "WorkspaceShape",
    "affordable_cells",
    "families",
    "find",
    "formulas",
    "parse_requirement",
    "selections",
]
