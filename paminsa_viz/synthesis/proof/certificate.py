"""Proof that a robot meets its requirements over a whole workspace, or a pose where it does not.

Reach and singularities are proven in closed form (`regions`), the condition number, static
torques and F_4 by bisection of boxes of poses, each bounded by affine arithmetic (`enclosures`).
Other quantities have no bounds here: they are sampled as by `check_requirements` at least, and
about the worst sample, and the proof says so.

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
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace
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
from paminsa_viz.synthesis.volume.workspace import Samples, affordable_samples, margins_over

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

    What cannot be proven is sampled. What a coarse `check_requirements` refutes is refuted.

    Args:
        design: The robot.
        requirements: What has to hold.
        workspace: The positions, with a center; None for that of the requirements.
        time_limit: When to stop and answer that it is undecided, without the time that compiling
            takes [s].
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


SAMPLING_TIME = 0.1
"""Time that fine samples of a quantity without bounds may take [s]."""

_ROUNDS = 8
"""Rounds in which the surroundings of the worst sample are looked at, each half as wide."""


def sampled_evidence(
    design: Design, requirements: Requirements, region: PoseRegion
) -> list[Evidence]:
    """Return what samples say of the requirements that cannot be proven."""
    found = []
    for requirement in requirements.bounds:
        if method(requirement) is not Method.SAMPLED:
            continue
        samples = sample_requirement(design, requirements, requirement, region)
        found.append(evidence_of_samples(requirement, *samples))
    return found


def evidence_of_samples(requirement: Requirement, poses: Array, margins: Array) -> Evidence:
    """Return what sample poses (n, 4) say of a requirement with margins (n,) there."""
    margin, pose = np.inf, None
    if len(margins):
        worst = int(np.argmin(np.nan_to_num(margins, nan=-np.inf)))
        margin, pose = float(margins[worst]), poses[worst]
    verdict = Verdict.SAMPLED if margin >= 0.0 else Verdict.REFUTED
    return Evidence.of(requirement, Method.SAMPLED, verdict, margin, pose)


def sample_requirement(
    design: Design, requirements: Requirements, requirement: Requirement, region: PoseRegion
) -> tuple[Array, Array]:
    """Return sample poses of a region (n, 4), and the margins of a requirement there (n,).

    Those of a coarse check of the region (`check_requirements`) are among them, so that what it
    refutes is refuted here; and the finer ones that the time allows. If the requirement holds at
    all of them, the surroundings of the worst one are sampled as well. A margin is minus infinite
    where a pose has no value.
    """
    part = part_of(requirements, requirement, region)
    if part is None:
        return np.empty((0, 4)), np.empty(0)
    x, y, z = (2.0 * half for half in region.half)
    workspace = Workspace(region.shape, (x, y, z), region.center)
    theta = requirements.headings(requirement)
    poses, margins = [], []
    for fine, budget in ((False, None), (True, SAMPLING_TIME)):
        samples, turns = affordable_samples(
            workspace, region.center, requirement, theta, fine=fine, budget=budget
        )
        samples = samples.between(requirement.z)
        assert samples is not None  # the part above is of the same heights
        field, _, margin = margins_over(design, requirement, samples, turns)
        poses.append(field.grid.poses().reshape(-1, 4))
        margins.append(margin.ravel())
    found, least = np.concatenate(poses), np.concatenate(margins)
    worst = int(least.argmin())
    if least[worst] < 0.0:
        return found, least
    near, margin = _near(design, requirement, part, found[worst])
    return np.concatenate([found, near]), np.concatenate([least, margin])


def _near(
    design: Design, requirement: Requirement, part: PoseRegion, pose: Array
) -> tuple[Array, Array]:
    """Return poses of a region near one (4,), (n, 4), and the margins there (n,).

    Each round looks about the worst pose of the one before, on the region's boundary where it
    would leave it, half as far away.
    """
    center, half = np.array(part.center), np.array(part.half)
    low, high = part.theta
    unit = np.array([-1.0, 0.0, 1.0])
    square = np.stack(np.meshgrid(unit, unit), axis=-1).reshape(-1, 2)
    poses, margins = [], []
    for step in 0.25 * 0.5 ** np.arange(_ROUNDS):
        away = pose[:2] - center[:2] + step * half[:2] * square
        away = part.shape.section.clipped(away, half[:2])
        theta = np.unique(np.clip(pose[2] + 0.5 * step * (high - low) * unit, low, high))
        z = np.unique(np.clip(pose[3] + step * half[2] * unit, part.low[2], part.high[2]))
        samples = Samples(center[:2] + away, z)
        field, _, margin = margins_over(design, requirement, samples, theta)
        poses.append(field.grid.poses().reshape(-1, 4))
        margins.append(margin.ravel())
        pose = poses[-1][int(margin.argmin())]
    return np.concatenate(poses), np.concatenate(margins)
