"""Proof that a robot meets its requirements over a whole workspace, or a pose where it does not.

Reach and singularities are proven in closed form (`regions`), the condition number, static
torques and F_4 by bisection of boxes of poses, each bounded by affine arithmetic (`enclosures`).
Other quantities have no bounds here: they are sampled, and the proof says so.

The region is connected. As no pose in it is singular and each can be taken, neither the sign of the
determinant nor the branch of the knees changes in it; that it is the robot's own follows from a
path from home into the region, whose boxes are proven in the same way.
"""

from __future__ import annotations

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.reach import home_pose
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.proof.bisection import Control, Gauge, Nearest, nearest_violation
from paminsa_viz.synthesis.proof.evidence import (
    Evidence,
    Proof,
    Verdict,
    home_path,
    in_order,
    part_of,
    prove_reach,
    regions_of,
)
from paminsa_viz.synthesis.proof.families import BoundGroup, Method, groups, method
from paminsa_viz.synthesis.proof.regions import PoseRegion

FIXED = (False, False, False)


@of_design
def prove(
    design: Design,
    requirements: Requirements,
    workspace: Workspace | None = None,
    *,
    time_limit: float = 15.0,
    progress: Progress = go_on,
) -> Proof:
    """Prove that requirements hold over a workspace, or find a pose where one does not.

    Args:
        design: The robot.
        requirements: What has to hold.
        workspace: The positions, with a center; None for that of the requirements.
        time_limit: When to stop and answer that it is undecided [s].
        progress: Is told what part of the time is over, and may end it.

    Raises:
        InvalidInput: If there is no workspace, or a coordinate of its center is open.
    """
    workspace = workspace or requirements.workspace
    if workspace is None:
        raise InvalidInput("workspace", "a workspace is needed for a proof")
    center = workspace.center
    if None in center:
        raise InvalidInput("workspace.center", f"three numbers are needed for a proof: {center}")
    region = region_of(workspace, requirements)
    control = Control(time_limit, progress)
    paths = [home_path(design.geometry, part) for part in regions_of(requirements, region)]
    found = prove_reach(design, requirements, region)
    # Without reach the quantities have no values.
    reached = all(item.verdict is Verdict.PROVEN for item in found.values())
    home = Verdict.PROVEN if all(map(len, paths)) else Verdict.UNDECIDED
    found["home"] = Evidence("home", Method.CLOSED_FORM, home)
    remaining = [np.empty((0, 2, 4))]
    if reached:
        found |= {item.key: item for item in sampled_evidence(design, requirements, region)}
    for group in groups(design, requirements):
        if not reached or any(item.verdict is Verdict.REFUTED for item in found.values()):
            items = [
                Evidence.of(requirement, Method.BISECTION, Verdict.UNDECIDED)
                for requirement in group.requirements
            ]
        else:
            nearest = nearest_violation(group, Gauge(region, FIXED), 1.0, None, control)
            remaining.append(nearest.remaining)
            items = _bisected(group, nearest)
        found |= {item.key: item for item in items}
    evidence = in_order(found, requirements)
    verdicts = {item.verdict for item in evidence}
    worst = (v for v in (Verdict.REFUTED, Verdict.UNDECIDED) if v in verdicts)
    return Proof(
        next(worst, Verdict.PROVEN), region, evidence, paths[0], np.concatenate(remaining),
        control.boxes, control.elapsed,
    )  # fmt: skip


def region_of(workspace: Workspace, requirements: Requirements) -> PoseRegion:
    """Return a workspace as a region with the required headings; open coordinates at zero."""
    x, y, z = (place or 0.0 for place in workspace.center)
    a, b, c = (0.5 * extent for extent in workspace.size)
    return PoseRegion(workspace.shape, (x, y, z), (a, b, c), requirements.theta)


def _bisected(group: BoundGroup, nearest: Nearest) -> list[Evidence]:
    """Return what a bisection says of the requirements of a group."""
    done = not len(nearest.remaining) and nearest.pose is None and nearest.lower >= nearest.upper
    found = []
    for index, requirement in enumerate(group.requirements):
        verdict = Verdict.PROVEN if done else Verdict.UNDECIDED
        margin, pose = float(nearest.margins[index]) if done else np.nan, None
        if nearest.pose is not None and nearest.requirement == index:
            verdict, pose = Verdict.REFUTED, nearest.pose
            margin = float(group.pose_margins(pose[None])[0, index])
        found.append(
            Evidence.of(requirement, Method.BISECTION, verdict, margin, pose, nearest.boxes)
        )
    return found


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
        margin, pose = np.inf, None
        if len(margins):
            worst = int(np.argmin(np.nan_to_num(margins, nan=-np.inf)))
            margin, pose = float(margins[worst]), poses[worst]
        verdict = Verdict.SAMPLED if margin >= 0.0 else Verdict.REFUTED
        found.append(Evidence.of(requirement, Method.SAMPLED, verdict, margin, pose))
    return found


def sample_requirement(
    design: Design, requirements: Requirements, requirement: Requirement, region: PoseRegion
) -> tuple[Array, Array]:
    """Return sample poses of a region (n, 4), and the margins of a requirement there (n,)."""
    part = part_of(requirements, requirement, region)
    if part is None:
        return np.empty((0, 4)), np.empty(0)
    quantity = requirement.entry
    share = min(1.0, (SAMPLING_TIME / quantity.cost / np.prod(SAMPLES)) ** 0.25)
    counts = [max(2, round(share * count)) for count in SAMPLES]
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    ends = ((x0, x1), (y0, y1), part.theta, (z0, z1))
    axes = {
        name: np.linspace(low, high, count) if high > low else np.array([low])
        for name, (low, high), count in zip(("x", "y", "theta", "z"), ends, counts, strict=True)
    }
    grid = Grid.over(home_pose(design.geometry), **axes)
    values = quantity.over(solve_field(design.geometry, grid), design).ravel()
    poses = grid.poses().reshape(-1, 4)
    inside = np.ones(len(poses), bool)
    if part.shape is WorkspaceShape.CYLINDER:
        away = np.hypot(poses[:, 0] - part.center[0], poses[:, 1] - part.center[1])
        inside = away <= part.half[0] * (1.0 + 1e-12)
    return poses[inside], requirement.margin(values[inside])
