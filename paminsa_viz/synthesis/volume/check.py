"""Which requirements a robot meets: the worst value of each, where it is, and its margin."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.causes import bound_size
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.margins import headings
from paminsa_viz.synthesis.volume.reach import reach_bounds
from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
from paminsa_viz.synthesis.volume.workspace import (
    SAMPLES,
    Center,
    RequirementCheck,
    Samples,
    affordable_samples,
    best_center,
    reach_items,
    sample_workspace,
    worst_over,
)

_ROUNDS = 8
"""Moves of a workspace that is free, each by a node's distance or less."""


class Over(Enum):
    """What a check is over."""

    WORKSPACE = "required workspace"
    VOLUME = "volume"
    BEST = "best pose of the reachable volume"


@dataclass(frozen=True, eq=False)
class RequirementsCheck:
    """Which requirements hold.

    Attributes:
        items: Reach, singularity, then every requirement.
        over: What they are checked over.
        center: Center of the required workspace, where there is one [m].
        volume: The volume that was solved, None where none was needed.
    """

    items: tuple[RequirementCheck, ...]
    over: Over
    center: Center | None
    volume: Volume | None

    @property
    def holds(self) -> bool:
        """Whether all hold together."""
        return self.over is not Over.BEST and all(item.holds for item in self.items)


@of_design
def check_requirements(
    design: Design,
    requirements: Requirements,
    *,
    fine: bool = False,
    volume: Volume | None = None,
    progress: Progress = go_on,
) -> RequirementsCheck:
    """Say which requirements hold, over the required workspace if there is one.

    Without one, they are checked over the volume where all hold; if that is empty, each at the pose
    that is best for it. Free coordinates of a workspace are chosen so that it lies deepest in the
    volume. Reach and singularity hold for the whole range of headings, by closed forms; quantities
    at sampled poses.

    Args:
        design: The robot.
        requirements: What has to hold.
        fine: Whether to sample finely; coarse takes some ten milliseconds.
        volume: The volume of the same design and requirements, if it is at hand.
        progress: Is told what part is done, and may end it.

    Raises:
        Canceled: If ``progress`` says so.
    """
    resolution = FINE if fine else COARSE
    workspace = requirements.workspace
    if workspace is not None and None not in workspace.center:
        x, y, z = (float(place or 0.0) for place in workspace.center)
        return _over_workspace(design, requirements, (x, y, z), fine, volume, progress)
    if volume is None:
        volume = solve_volume(design, requirements, resolution=resolution, progress=progress)
    if workspace is None:
        return _over_volume(volume)
    center = best_center(workspace, volume)
    if fine:
        center = _refined(design, requirements, center, volume.cell)
    return _over_workspace(design, requirements, center, fine, volume, progress)


def _over_workspace(
    design: Design,
    requirements: Requirements,
    center: Center,
    fine: bool,
    volume: Volume | None,
    progress: Progress,
) -> RequirementsCheck:
    assert requirements.workspace is not None
    workspace = requirements.workspace
    samples = sample_workspace(workspace, center, SAMPLES[fine])
    items = list(reach_items(design, requirements, samples))
    for index, bound in enumerate(requirements.bounds):
        keep_on(progress, index / len(requirements.bounds))
        limits = requirements.headings(bound)
        own, theta = affordable_samples(workspace, center, bound, limits, fine=fine)
        items.append(worst_over(design, bound, index, own, theta))
    return RequirementsCheck(tuple(items), Over.WORKSPACE, center, volume)


def _over_volume(volume: Volume) -> RequirementsCheck:
    """Check requirements at the nodes of the volume, or where it is empty at the best nodes."""
    over = Over.BEST if volume.empty else Over.VOLUME
    inside = volume.reachable if volume.empty else volume.inside
    requirements = volume.requirements
    if not volume.reachable.any():
        return RequirementsCheck(_nothing(volume), over, None, volume)
    nodes, columns = np.nonzero(inside), np.nonzero(inside.any(axis=2))
    positions = np.column_stack([volume.x[columns[0]], volume.y[columns[1]]])
    everywhere = Samples(positions, volume.z)
    items = list(reach_items(volume.design, requirements, everywhere, inside[columns]))
    margins = volume.reached_margins[:, inside[volume.reachable]]
    for index, (bound, margin) in enumerate(zip(requirements.bounds, margins, strict=True)):
        number = int(margin.argmax() if volume.empty else margin.argmin())
        i, j, k = (int(axis[number]) for axis in nodes)
        samples = Samples(np.array([[volume.x[i], volume.y[j]]]), volume.z[[k]])
        theta = headings(requirements.headings(bound), volume.headings)
        items.append(worst_over(volume.design, bound, index, samples, theta))
    return RequirementsCheck(tuple(items), over, None, volume)


def _nothing(volume: Volume) -> tuple[RequirementCheck, ...]:
    """Return the items of a robot that can take no pose with every heading."""
    bounds = reach_bounds(volume.design.geometry, 0.0, 0.0, volume.requirements.theta)
    best = int(bounds.margin(volume.z)[0].argmax())
    middle = Samples(np.zeros((1, 2)), volume.z[[best]])
    items = reach_items(volume.design, volume.requirements, middle)
    reason = "no pose can be taken with every heading"
    broken = (
        RequirementCheck(
            requirement_label(bound), bound.entry.unit, np.nan, -np.inf, None, False, reason, index
        )
        for index, bound in enumerate(volume.requirements.bounds)
    )
    return (*items, *broken)


def _refined(design: Design, requirements: Requirements, center: Center, step: float) -> Center:
    """Move the free coordinates of a workspace to where its least relative margin is larger."""
    workspace = requirements.workspace
    assert workspace is not None
    free = [place is None for place in workspace.center]

    def score(place: Center) -> float:
        found = _over_workspace(design, requirements, place, False, None, go_on)
        return min(_relative(design, requirements, item) for item in found.items)

    # Moves are counted, in the smallest that there may be: a center that has come back to the axis
    # is exactly on it.
    smallest, move = step / 2**_ROUNDS, 2**_ROUNDS

    def at(moves: NDArray[np.int64]) -> Center:
        x, y, z = (place + smallest * int(n) for place, n in zip(center, moves, strict=True))
        return x, y, z

    best, moves = score(center), np.zeros(3, np.int64)
    for _ in range(_ROUNDS):
        tried = [
            moves + sign * move * np.eye(3, dtype=np.int64)[axis]
            for axis in range(3)
            for sign in (-1, 1)
            if free[axis]
        ]
        scores = [score(at(each)) for each in tried]
        if max(scores) > best:
            best = max(scores)
            moves = tried[int(np.argmax(scores))]
        else:
            move //= 2
    return at(moves)


def _relative(design: Design, requirements: Requirements, item: RequirementCheck) -> float:
    """Return a margin over the size of its bound; of lengths over that of B4 and B8."""
    if item.requirement is None:
        return item.margin / (design.geometry.crank_length + design.geometry.coupler_length)
    return item.margin / bound_size(requirements.bounds[item.requirement])
