"""Cases for the tests of the search."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis import SearchRange, SynthesisCase
from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case

TURN = float(np.radians(30.0))
CONDITION = Requirement("condition", high=10.0)

CYLINDER = SynthesisCase(
    Requirements((CONDITION,), (-TURN, TURN), Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4))),
    (
        SearchRange("geometry.base_radius", 0.1, 0.6),
        SearchRange("geometry.platform_radius", 0.08, 0.3),
        SearchRange("geometry.magnification", 1.5, 5.0),
        SearchRange("geometry.crank_length", 0.1, 0.8),
        SearchRange("geometry.coupler_length", 0.1, 0.9),
    ),
    allow_overlap=True,
)
"""Cylinder of radius 150 mm and height 400 mm; bodies may overlap."""

CELL = SynthesisCase(
    Requirements(
        (CONDITION, Requirement("max_torque", high=15.0), Requirement("f_4", high=450.0)),
        (-TURN, TURN),
        Workspace(WorkspaceShape.BOX, (0.6, 0.6, 0.3)),
    ),
    (
        SearchRange("geometry.base_radius", 0.2, 1.5),
        SearchRange("geometry.platform_radius", 0.1, 0.3),
        SearchRange("geometry.magnification", 2.0, 5.0),
        SearchRange("geometry.crank_length", 0.3, 1.6),
        SearchRange("geometry.coupler_length", 0.3, 1.6),
    ),
    reference=replace(APPENDIX_4, payload=replace(APPENDIX_4.payload, mass=3.0)),
    allow_overlap=True,
)
"""Palletizing cell of 600 x 600 x 300 mm, 3 kg; bodies may overlap."""


@cache
def arch_case() -> SynthesisCase:
    """Return the case that comes with the program; bodies may overlap."""
    return load_case(EXAMPLES["arch"], allow_overlap=True)
