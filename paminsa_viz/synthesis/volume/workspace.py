"""Sample poses of a regular workspace, its best place, and the worst of a requirement over it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array, Pose
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import LEAST_MARGIN, MARGINS, Limit
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import (
    Range,
    Requirement,
    Requirements,
    Workspace,
)
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.margins import ColumnField, Columns, headings, solve_columns
from paminsa_viz.synthesis.volume.reach import reach_bounds
from paminsa_viz.synthesis.volume.solve import Volume

Center = tuple[float, float, float]

FINER = 4
"""How many times closer the headings of a fine check of a workspace lie than those of a volume."""

SAMPLES = {False: 3, True: 8}
"""Samples from a workspace's center to its boundary, of a coarse and of a fine check."""


class Samples(NamedTuple):
    """Positions and heights, on the boundary of a workspace and within.

    Attributes:
        positions: (n, 2) [m].
        z: (heights,) [m].
    """

    positions: Array
    z: Array

    def between(self, heights: Range | None) -> Samples | None:
        """Return the part between two heights [m], both among them; None if there is none."""
        if heights is None:
            return self
        low, high = max(self.z[0], heights[0]), min(self.z[-1], heights[1])
        return None if low > high else self._replace(z=np.unique(np.clip(self.z, low, high)))


def sample_workspace(workspace: Workspace, center: Center, density: int) -> Samples:
    """Return samples of a workspace at a center [m]; its boundary and corners are among them.

    Args:
        workspace: Shape and size.
        center: Its center (x, y, z) [m].
        density: Samples from the center to the boundary.
    """
    x, y, height = (0.5 * extent for extent in workspace.size)
    flat = workspace.shape.section.filled(density, (x, y))
    z = center[2] + height * np.linspace(-1.0, 1.0, 2 * density + 1)
    return Samples(flat + np.array(center[:2]), z)


def affordable_samples(
    workspace: Workspace,
    center: Center,
    bound: Requirement,
    theta: Range,
    *,
    fine: bool,
    budget: float | None = None,
) -> tuple[Samples, Array]:
    """Return samples of a workspace and headings [rad] that a requirement has the time for.

    Args:
        workspace: Shape and size.
        center: Its center (x, y, z) [m].
        bound: The requirement, of whose quantity the cost counts.
        theta: Least and largest heading [rad].
        fine: Whether to sample finely.
        budget: Time that all of them may take [s]; None for that of a check.
    """
    budget = (FINE if fine else COARSE).budget if budget is None else budget
    few = SAMPLES[fine]
    turns = FINER * (FINE.headings - 1) + 1 if fine else COARSE.headings
    samples, cost = sample_workspace(workspace, center, few), bound.entry.cost
    while few > 1 and cost * len(samples.positions) * len(samples.z) * turns > budget:
        few, turns = few - 1, max(COARSE.headings, turns // 2)
        samples = sample_workspace(workspace, center, few)
    return samples, headings(theta, turns)


def best_center(workspace: Workspace, volume: Volume) -> Center:
    """Return the center at which a workspace lies deepest in a volume, to a node [m].

    Coordinates that the workspace gives are kept. Where it does not fit, it is where it sticks out
    least.
    """
    depth = least_within(volume.depth, workspace, volume)
    return center_at(workspace, volume, int(depth.argmax()))


def center_at(workspace: Workspace, volume: Volume, candidate: int) -> Center:
    """Return the center [m] of a candidate by its flat index in the result of `least_within`."""
    axes = _candidates(workspace, volume)
    index = np.unravel_index(candidate, [len(axis) for axis in axes])
    x, y, z = (
        float(coordinate[axis[i]]) if place is None else place
        for axis, i, place, coordinate in zip(
            axes, index, workspace.center, (volume.x, volume.y, volume.z), strict=True
        )
    )
    return x, y, z


def least_within(values: Array, workspace: Workspace, volume: Volume) -> Array:
    """Return the least value within a workspace at each of its possible centers, (x, y, z).

    Coordinates that the workspace gives have one center, the nearest node.

    Args:
        values: (x, y, z) on the volume's nodes; NaN counts as minus infinite, as does what lies
            beyond the nodes.
        workspace: Shape, size and center.
        volume: The volume.
    """
    # Late: it takes a third of a second to load.
    from scipy import ndimage

    step = volume.cell
    found = np.where(np.isnan(values), -np.inf, values)
    reach = [round(0.5 * extent / step) for extent in workspace.size]
    candidates = _candidates(workspace, volume)
    if any(2 * count >= size for count, size in zip(reach, found.shape, strict=True)):
        return np.full([len(axis) for axis in candidates], -np.inf)  # it sticks out of all nodes
    found = ndimage.minimum_filter1d(found, 2 * reach[2] + 1, axis=2, mode="constant", cval=-np.inf)
    rows, columns, heights = candidates
    found = found[..., heights]
    offset = [step * np.arange(-count, count + 1) for count in reach[:2]]
    half = 0.5 * np.array(workspace.size[:2]) + 1e-9 * step
    section = workspace.shape.section.on_nodes(offset[0], offset[1], half)
    if len(rows) > 1 or len(columns) > 1:
        found = ndimage.minimum_filter(
            found, footprint=section[..., None], mode="constant", cval=-np.inf
        )
        return found[np.ix_(rows, columns)]
    i, j = np.nonzero(section)
    i, j = i + rows[0] - reach[0], j + columns[0] - reach[1]
    held = (i >= 0) & (i < len(volume.x)) & (j >= 0) & (j < len(volume.y))
    if not held.all():
        return np.full((1, 1, len(heights)), -np.inf)
    return found[i, j].min(axis=0)[None, None]


def _candidates(workspace: Workspace, volume: Volume) -> list[NDArray[np.intp]]:
    """Return the indices of the nodes at which a center may lie, along each axis."""
    return [
        np.arange(len(axis)) if place is None else np.array([np.abs(axis - place).argmin()])
        for axis, place in zip((volume.x, volume.y, volume.z), workspace.center, strict=True)
    ]


_FINE_HEADINGS = 181
"""Headings among which the worst one for reach is looked for; whether it holds is exact."""


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


def margins_over(
    design: Design, bound: Requirement, samples: Samples, theta: Array
) -> tuple[ColumnField, Array, Array]:
    """Return a field of poses, and value and margin of a requirement at each [SI].

    Both have the shape of the field, (positions, headings, heights). Where a pose cannot be taken
    or has no value, that is NaN and the margin minus infinite.
    """
    field = solve_columns(design.geometry, Columns.at(samples.positions, theta, samples.z))
    with np.errstate(all="ignore"):
        values = bound.entry.over(field, design)
    values = np.where(field.status == Limit.OK, values, np.nan)
    return field, values, np.where(np.isnan(values), -np.inf, bound.margin(values))


def worst_over(
    design: Design, bound: Requirement, index: int, samples: Samples, theta: Array
) -> RequirementCheck:
    """Return the worst value of a requirement over positions and heights with headings [rad]."""
    entry, label = bound.entry, requirement_label(bound)
    part = samples.between(bound.z)
    if part is None:
        reason = "no height of the workspace is within its range of z"
        return RequirementCheck(label, entry.unit, np.nan, np.inf, None, True, reason, index)
    field, values, margin = margins_over(design, bound, part, theta)
    flat = int(margin.argmin())
    place = tuple(int(i) for i in np.unravel_index(flat, margin.shape))
    i, j, k = place
    x, y = samples.positions[i]
    pose = (float(x), float(y), float(theta[j]), float(part.z[k]))
    value, least, reason = float(values[place]), float(margin[place]), ""
    if np.isnan(value):
        status = Limit(int(field.status[place]))
        reason = status.reason(int(field.leg[place])) if status else "no value"
        if status is Limit.OK and entry.missing is not None:
            missing = entry.missing(field, design)
            reason = missing.texts[int(missing.code[place])] or reason
    return RequirementCheck(label, entry.unit, value, least, pose, least >= 0.0, reason, index)


def reach_items(
    design: Design,
    requirements: Requirements,
    samples: Samples,
    inside: NDArray[np.bool_] | None = None,
) -> tuple[RequirementCheck, RequirementCheck]:
    """Check reach and singularity over all headings at positions and heights.

    Args:
        design: The robot.
        requirements: Of which the headings count.
        samples: Positions and heights.
        inside: (positions, heights) which of them count for reach; None for all.
    """
    x, y = samples.positions[:, 0], samples.positions[:, 1]
    bounds = reach_bounds(design.geometry, x[:, None], y[:, None], requirements.theta)
    margin, which = bounds.margin(samples.z)
    if inside is not None:
        margin = np.where(inside, margin, np.inf)
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
    cosine, height = np.cos(theta), 0 if inside is None else int(inside[n].argmax())
    worst_index = int(cosine.argmin() if bounds.turn < 0.0 else cosine.argmax())
    where = (float(x[n]), float(y[n]), float(theta[worst_index]), float(samples.z[height]))
    reason = "" if regular else "the headings reach the singular rotation"
    if not regular and turned:
        reason = "beyond the circle of singular positions"
    item = RequirementCheck("singularity", "m", value, value, where, regular, reason)
    return reach, item
