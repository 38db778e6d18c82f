"""Which requirements a robot meets: the worst value of each, where it is, and its margin."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import product

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import LEAST_MARGIN, MARGINS, Limit
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.columns import Columns, solve_columns
from paminsa_viz.synthesis.margins import Canceled, Progress, headings
from paminsa_viz.synthesis.reach_bounds import reach_bounds
from paminsa_viz.synthesis.volume import COARSE, FINE, Volume, solve_volume
from paminsa_viz.synthesis.workspace_samples import (
    Center,
    Samples,
    best_center,
    sample_workspace,
)

Pose = tuple[float, float, float, float]

FINER = 4
"""How many times closer the headings of a fine check of a workspace lie than those of a volume."""

SAMPLES = {False: 3, True: 8}
"""Samples from a workspace's center to its boundary, of a coarse and of a fine check."""

_FINE_HEADINGS = 181


class Over(Enum):
    """What a check is over."""

    WORKSPACE = "required workspace"
    VOLUME = "volume"
    BEST = "best pose of the reachable volume"


@dataclass(frozen=True)
class RequirementCheck:
    """Whether one requirement holds.

    Attributes:
        label: The requirement, for people.
        unit: SI unit of value and margin.
        value: The worst value [SI]; NaN where there is none.
        margin: How far it is inside its bounds, negative outside [SI]; minus infinite where there
            is no value.
        pose: The pose where that is [m, m, rad, m]; None where there is none.
        holds: Whether it holds.
        reason: Why there is no value, empty where there is one.
        requirement: Its index in the requirements; None for reach and singularity.
    """

    label: str
    unit: str
    value: float
    margin: float
    pose: Pose | None
    holds: bool
    reason: str = ""
    requirement: int | None = None


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


def check_requirements(
    design: Design,
    requirements: Requirements,
    *,
    fine: bool = False,
    volume: Volume | None = None,
    progress: Progress | None = None,
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
    progress: Progress | None,
) -> RequirementsCheck:
    assert requirements.workspace is not None
    density = SAMPLES[fine]
    samples = sample_workspace(requirements.workspace, center, density)
    count = FINER * (COARSE.headings - 1) + 1 if fine else COARSE.headings
    items = list(_reach_items(design, requirements, samples))
    for index, bound in enumerate(requirements.bounds):
        if progress is not None and progress(index / len(requirements.bounds)):
            raise Canceled
        budget = (FINE if fine else COARSE).budget
        few, turns = density, count
        own = samples
        while few > 1 and bound.entry.cost * len(own.positions) * len(own.z) * turns > budget:
            few, turns = few - 1, max(COARSE.headings, turns // 2)
            own = sample_workspace(requirements.workspace, center, few)
        theta = headings(requirements.headings(bound), turns)
        items.append(worst_over(design, bound, index, own, theta))
    return RequirementsCheck(tuple(items), Over.WORKSPACE, center, volume)


def worst_over(
    design: Design, bound: Requirement, index: int, samples: Samples, theta: Array
) -> RequirementCheck:
    """Return the worst value of a requirement over positions and heights with headings [rad]."""
    entry, label = bound.entry, requirement_label(bound)
    z = samples.z
    if bound.z is not None:
        low, high = max(z[0], bound.z[0]), min(z[-1], bound.z[1])
        if low > high:
            reason = "no height of the workspace is within its range of z"
            return RequirementCheck(label, entry.unit, np.nan, np.inf, None, True, reason, index)
        z = np.unique(np.clip(z, low, high))
    columns = Columns.at(samples.positions, theta, z)
    field = solve_columns(design.geometry, columns)
    with np.errstate(all="ignore"):
        values = entry.over(field, design)
    values = np.where(field.status == Limit.OK, values, np.nan)
    margin = np.where(np.isnan(values), -np.inf, bound.margin(values))
    flat = int(margin.argmin())
    place = tuple(int(i) for i in np.unravel_index(flat, margin.shape))
    i, j, k = place
    x, y = samples.positions[i]
    pose = (float(x), float(y), float(theta[j]), float(z[k]))
    value, least, reason = float(values[place]), float(margin[place]), ""
    if np.isnan(value):
        status = Limit(int(field.status[place]))
        reason = status.reason(int(field.leg[place])) if status else "no value"
        if status is Limit.OK and entry.missing is not None:
            missing = entry.missing(field, design)
            reason = missing.texts[int(missing.code[place])] or reason
    return RequirementCheck(label, entry.unit, value, least, pose, least >= 0.0, reason, index)


def _reach_items(
    design: Design, requirements: Requirements, samples: Samples
) -> tuple[RequirementCheck, RequirementCheck]:
    """Check reach and singularity over all headings at positions and heights."""
    x, y = samples.positions[:, 0], samples.positions[:, 1]
    bounds = reach_bounds(design.geometry, x[:, None], y[:, None], requirements.theta)
    margin, which = bounds.margin(samples.z)
    i, k = (int(n) for n in np.unravel_index(int(margin.argmin()), margin.shape))
    least, limit = float(margin[i, k]), MARGINS[int(which[i, k]) % len(MARGINS)]
    theta = headings(requirements.theta, _FINE_HEADINGS)
    columns = Columns.at(samples.positions[[i]], theta, samples.z[[k]])
    worst = solve_columns(design.geometry, columns).solve(LEAST_MARGIN)[0, 0, :, 0]
    pose = (float(x[i]), float(y[i]), float(theta[int(worst.argmin())]), float(samples.z[k]))
    holds = least > 0.0 or (least == 0.0 and limit is Limit.GUIDE)
    reason = "" if holds else limit.reason(int(which[i, k]) // len(MARGINS))
    reach = RequirementCheck("reach", "m", least, least, pose, holds, reason)

    position = bounds.position[:, 0]
    n = int(position.argmin())
    distance = float(position[n])
    turned, regular = bounds.turn > 0.0, bool(bounds.regular.all())
    value = distance if turned else min(distance, bounds.turn)
    cosine = np.cos(theta)
    sign = np.sign(design.geometry.base_radius - design.geometry.platform_radius)
    worst_index = int((sign * cosine).argmin() if not turned else cosine.argmax())
    where = (float(x[n]), float(y[n]), float(theta[worst_index]), float(samples.z[0]))
    reason = "" if regular else "the headings reach the singular rotation"
    if not regular and turned:
        reason = "beyond the circle of singular positions"
    item = RequirementCheck("singularity", "m", value, value, where, regular, reason)
    return reach, item


def _over_volume(volume: Volume) -> RequirementsCheck:
    """Check requirements at the nodes of the volume, or where it is empty at the best nodes."""
    over = Over.BEST if volume.empty else Over.VOLUME
    inside = volume.reachable if volume.empty else volume.inside
    requirements = volume.requirements
    if not volume.reachable.any():
        middle = np.zeros((1, 2))
        samples = Samples(middle, volume.z)
        return RequirementsCheck(_nothing(volume, samples), over, None, volume)
    nodes = np.nonzero(inside)
    items = list(_volume_reach_items(volume, inside))
    for index, bound in enumerate(requirements.bounds):
        margin = volume.margins[index][nodes]
        number = int(margin.argmax() if volume.empty else margin.argmin())
        i, j, k = (int(axis[number]) for axis in nodes)
        samples = Samples(np.array([[volume.x[i], volume.y[j]]]), volume.z[[k]])
        theta = headings(requirements.headings(bound), volume.headings)
        items.append(worst_over(volume.design, bound, index, samples, theta))
    return RequirementsCheck(tuple(items), over, None, volume)


def _volume_reach_items(volume: Volume, inside: Array) -> list[RequirementCheck]:
    columns = np.nonzero(inside.any(axis=2))
    positions = np.column_stack([volume.x[columns[0]], volume.y[columns[1]]])
    bounds = reach_bounds(
        volume.design.geometry, positions[:, :1], positions[:, 1:], volume.requirements.theta
    )
    margin = np.where(inside[columns], bounds.margin(volume.z)[0], np.inf)
    i, k = (int(n) for n in np.unravel_index(int(margin.argmin()), margin.shape))
    reach, _ = _reach_items(
        volume.design, volume.requirements, Samples(positions[[i]], volume.z[[k]])
    )
    n = int(bounds.position[:, 0].argmin())
    _, singular = _reach_items(
        volume.design, volume.requirements, Samples(positions[[n]], volume.z[[k]])
    )
    return [reach, singular]


def _nothing(volume: Volume, samples: Samples) -> tuple[RequirementCheck, ...]:
    """Return the items of a robot that can take no pose with every heading."""
    bounds = reach_bounds(volume.design.geometry, 0.0, 0.0, volume.requirements.theta)
    height = Samples(samples.positions, samples.z[[int(bounds.margin(samples.z)[0].argmax())]])
    items = _reach_items(volume.design, volume.requirements, height)
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
        found = _over_workspace(design, requirements, place, False, None, None)
        return min(_relative(design, requirements, item) for item in found.items)

    best = score(center)
    for _ in range(6):
        moves = product(*[(-step, 0.0, step) if moved else (0.0,) for moved in free])
        tried = [(center[0] + a, center[1] + b, center[2] + c) for a, b, c in moves]
        scores = [score(place) for place in tried]
        if max(scores) > best:
            best = max(scores)
            center = tried[int(np.argmax(scores))]
        else:
            step *= 0.5
    return center


def _relative(design: Design, requirements: Requirements, item: RequirementCheck) -> float:
    """Return a margin over the size of its bound; of lengths over that of B4 and B8."""
    if item.requirement is None:
        return item.margin / (design.geometry.crank_length + design.geometry.coupler_length)
    bound = requirements.bounds[item.requirement]
    sizes = [abs(limit) for limit in (bound.low, bound.high) if limit]
    return item.margin / (min(sizes) if sizes else 1.0)
