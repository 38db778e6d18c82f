"""Whether a requirement, or reach, holds at positions, headings and heights: its worst value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import LEAST_MARGIN, MARGINS, Limit
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.columns import Columns, solve_columns
from paminsa_viz.synthesis.margins import headings
from paminsa_viz.synthesis.reach_bounds import reach_bounds
from paminsa_viz.synthesis.workspace_samples import Samples

Pose = tuple[float, float, float, float]

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


def reach_items(
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
