"""Requirements on quantities without bounds over boxes: samples of a region."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grid import Grid
from paminsa_viz.model.grids import solve_field
from paminsa_viz.quantities.requirements import Requirement, Requirements, WorkspaceShape
from paminsa_viz.synthesis.evidence import Evidence, Verdict, pose_of
from paminsa_viz.synthesis.families import Method, method
from paminsa_viz.synthesis.reach_proof import part_of
from paminsa_viz.synthesis.region_margins import PoseRegion

SAMPLING_TIME = 0.5
"""Time that the samples of a quantity without bounds may take [s]."""

SAMPLES = (9, 9, 9, 5)
"""Most samples of such a quantity along x, y, theta and z."""


def sampled_evidence(
    design: Design, requirements: Requirements, region: PoseRegion
) -> list[Evidence]:
    """Return what samples say of the requirements that cannot be proven."""
    found = []
    for requirement in requirements.bounds:
        if method(requirement) is not Method.SAMPLED:
            continue
        poses, margins = sample_requirement(design, requirements, requirement, region)
        if not len(margins):
            found.append(
                Evidence(
                    requirement.quantity, Method.SAMPLED, Verdict.SAMPLED, np.inf, None, requirement
                )
            )
            continue
        worst = int(np.argmin(np.nan_to_num(margins, nan=-np.inf)))
        margin = float(margins[worst])
        verdict = Verdict.SAMPLED if margin >= 0.0 else Verdict.REFUTED
        found.append(
            Evidence(
                requirement.quantity, Method.SAMPLED, verdict, margin, pose_of(poses[worst]),
                requirement,
            )
        )  # fmt: skip
    return found


def sample_requirement(
    design: Design, requirements: Requirements, requirement: Requirement, region: PoseRegion
) -> tuple[Array, Array]:
    """Return sample poses of a region (n, 4), and the margins of a requirement there (n,)."""
    part = part_of(requirements, requirement, region)
    if part is None:
        return np.zeros((0, 4)), np.zeros(0)
    quantity = requirement.entry
    share = min(1.0, (SAMPLING_TIME / quantity.cost / np.prod(SAMPLES)) ** 0.25)
    counts = [max(2, round(share * count)) for count in SAMPLES]
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    ends = ((x0, x1), (y0, y1), part.theta, (z0, z1))
    axes = {
        name: np.linspace(low, high, count) if high > low else np.array([low])
        for name, (low, high), count in zip(("x", "y", "theta", "z"), ends, counts, strict=True)
    }
    grid = Grid.over((0.0, 0.0, 0.0, 0.0), **axes)
    values = quantity.over(solve_field(design.geometry, grid), design).ravel()
    poses = grid.poses().reshape(-1, 4)
    inside = np.ones(len(poses), bool)
    if part.shape is WorkspaceShape.CYLINDER:
        away = np.hypot(poses[:, 0] - part.center[0], poses[:, 1] - part.center[1])
        inside = away <= part.half[0] * (1.0 + 1e-12)
    return poses[inside], requirement.margin(values[inside])
