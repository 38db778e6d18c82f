"""Worked case (c): 0.5 kg on an arch, within a cylinder."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.balancing import CounterweightRange
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)
from paminsa_viz.synthesis import SearchRange, SynthesisCase
from paminsa_viz.synthesis.inner_case import InnerCase
from paminsa_viz.trajectory.planners import arch, round_trip

TURN = float(np.radians(30.0))


def arch_case(rate: float = 40.0) -> SynthesisCase:
    start, goal = np.array([-0.15, 0.0, -TURN, -0.05]), np.array([0.15, 0.0, TURN, -0.05])
    motion = round_trip(arch(start, goal, 0.1, 1.0)).sample(rate)
    weights = (
        CounterweightRange("b8", 8, 0.2, 0.2, 4.0),
        CounterweightRange("b3", 7, 0.2, 0.2, 4.0),
    )
    return SynthesisCase(
        Requirements(
            (Requirement("condition", high=10.0), Requirement("f_4", high=300.0)),
            (-TURN, TURN),
            Workspace(WorkspaceShape.CYLINDER, (0.32, 0.32, 0.12)),
        ),
        (
            SearchRange("geometry.base_radius", 0.1, 0.8),
            SearchRange("geometry.platform_radius", 0.08, 0.3),
            SearchRange("geometry.magnification", 1.5, 5.0),
            SearchRange("geometry.crank_length", 0.1, 0.8),
            SearchRange("geometry.coupler_length", 0.1, 0.9),
        ),
        reference=replace(APPENDIX_4, payload=replace(APPENDIX_4.payload, mass=0.5)),
        objective="peak_torque",
        inner=InnerCase(
            "peak_torque", (motion,), from_center=True, counterweights=weights, motion_force=300.0
        ),
        name="arch",
    )
