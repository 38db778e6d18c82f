"""Why a pose is not in a volume: causes, a map of them, and distances to where they begin.

Distances to where margins are zero follow to first order; a volume is what zero encloses.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field, solve_field, xy_grid
from paminsa_viz.model.reach import LEAST_MARGIN, MARGINS, Limit
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.volume.reach import ReachBounds, contains, reach_bounds


class CauseKind(Enum):
    """Kind of a cause."""

    INSIDE = "inside"
    OTHER_SIDE = "other side"
    SINGULAR = "singularity"
    DISCONNECTED = "not connected"
    REACH = "reach"
    REQUIREMENT = "requirement"


class VolumeCause(NamedTuple):
    """Why a node is not in a volume.

    Attributes:
        code: Its number, the index in `Volume.causes`.
        kind: Its kind.
        text: For people.
        word: For tables, without blanks.
        requirement: Index of the requirement, None for other causes.
        leg: Index of the leg, None where no leg is the cause.
    """

    code: int
    kind: CauseKind
    text: str
    word: str
    requirement: int | None = None
    leg: int | None = None


_THROUGH_A_NODE = 1e-5
"""Depth below which a node counts as inside the volume, as a part of the largest depth."""

INSIDE, OTHER_SIDE, SINGULAR, DISCONNECTED, FIRST_REACH = range(5)
FIRST_REQUIREMENT = FIRST_REACH + 3 * len(MARGINS)
"""Codes: reach is FIRST_REACH + 4 * leg + limit, requirements count from FIRST_REQUIREMENT."""

_FIXED = (
    VolumeCause(INSIDE, CauseKind.INSIDE, "all requirements hold", "inside"),
    VolumeCause(OTHER_SIDE, CauseKind.OTHER_SIDE, "on the other side of the guides", "other-side"),
    VolumeCause(
        SINGULAR, CauseKind.SINGULAR, "at a singularity, or beyond one from home", "singular"
    ),
    VolumeCause(DISCONNECTED, CauseKind.DISCONNECTED, "not connected to home", "not-connected"),
    *(
        VolumeCause(
            FIRST_REACH + len(MARGINS) * leg + index,
            CauseKind.REACH,
            limit.reason(leg),
            f"{limit.word}:leg{leg + 1}",
            leg=leg,
        )
        for leg in range(3)
        for index, limit in enumerate(MARGINS)
    ),
)


def causes_of(requirements: Requirements) -> tuple[VolumeCause, ...]:
    """Return every cause by its code: those of all volumes, then the requirements."""
    broken = (
        VolumeCause(
            FIRST_REQUIREMENT + index,
            CauseKind.REQUIREMENT,
            requirement_label(bound),
            f"requirement{index + 1}:{bound.quantity}",
            requirement=index,
        )
        for index, bound in enumerate(requirements.bounds)
    )
    return (*_FIXED, *broken)


_TURN_SLACK = 1e-9


@dataclass(frozen=True, eq=False)
class Slice:
    """Causes at the cells of a map, at its own heading and height.

    Attributes:
        cause: (y, x) codes, see `Volume.causes`; of several requirements that break, the one whose
            margin is the most negative part of its bound.
        broken: (requirements, y, x) where each requirement breaks.
        causes: What the codes mean.
    """

    cause: NDArray[np.uint8]
    broken: NDArray[np.bool_]
    causes: tuple[VolumeCause, ...]


@of_design
def cause_slice(
    design: Design,
    requirements: Requirements,
    x: ArrayLike,
    y: ArrayLike,
    theta: float,
    z: float,
    *,
    field: Field | None = None,
) -> Slice:
    """Return what breaks at each cell of a map, at one heading and height.

    A requirement whose own range of headings or heights the map is not in does not count.

    Args:
        design: The robot.
        requirements: What has to hold.
        x, y: Positions of columns and rows [m].
        theta: Heading [rad].
        z: Height [m].
        field: The map as it is solved already, if it is.
    """
    grid = xy_grid(x, y, theta, z)
    if field is None:
        field = solve_field(design.geometry, grid)
    columns, rows = grid.axes[1][1], grid.axes[0][1]
    regular = reach_bounds(design.geometry, columns[None, :], rows[:, None], (theta, theta)).regular
    reachable = (field.status == Limit.OK) | (field.status == Limit.SINGULAR)
    shape = (len(requirements.bounds), *field.status.shape)
    broken, worst = np.zeros(shape, np.bool_), np.full(shape, np.inf)
    for index, bound in enumerate(requirements.bounds):
        if not counts(requirements, bound, theta, z):
            continue
        with np.errstate(all="ignore"):
            margin = bound.margin(bound.entry.over(field, design))
        margin = np.where(np.isnan(margin), -np.inf, margin)
        broken[index] = (margin < 0.0) & reachable
        worst[index] = margin / bound_size(bound)
    cause = np.full(field.status.shape, INSIDE, np.uint8)
    if len(worst):
        cause = np.where(broken.any(axis=0), FIRST_REQUIREMENT + worst.argmin(axis=0), cause)
    cause = np.where(regular & (field.status != Limit.SINGULAR), cause, SINGULAR)
    cause = np.where(reachable, cause, FIRST_REACH + _tag(field)).astype(np.uint8)
    return Slice(cause, broken, causes_of(requirements))


def counts(requirements: Requirements, bound: Requirement, theta: float, z: float) -> bool:
    """Say whether a requirement is about a heading [rad] and a height [m]."""
    low, high = requirements.headings(bound)
    turned = bool(contains(low - _TURN_SLACK, high + _TURN_SLACK, theta))
    return turned and (bound.z is None or bound.z[0] <= z <= bound.z[1])


def bound_size(bound: Requirement) -> float:
    """Return the size of a bound, for comparison with those of others."""
    sizes = [abs(limit) for limit in (bound.low, bound.high) if limit]
    return min(sizes) if sizes else 1.0


def _tag(field: Field) -> NDArray[np.uint8]:
    """Return 4 * leg + limit of the least margin, see `model.measures.least_margin` (...)."""
    return np.nan_to_num(field.solve(LEAST_MARGIN)[1]).astype(np.uint8)


def reach_distances(bounds: ReachBounds, z: Array) -> tuple[Array, NDArray[np.uint8]]:
    """Return the distance to the end of what can be reached, and the code of what ends it (...).

    The distance is negative beyond [m]; to first order, exact for guide, leg axis and the circle of
    singular positions.

    Args:
        bounds: Extremes of X_1 over the headings, at positions.
        z: Heights that broadcast against the positions [m].
    """
    g = bounds.geometry
    ratio2 = g.span_ratio**2
    zeta2 = (z + g.platform_joint_height) ** 2

    def bars(radius: Array, limit: float) -> Array:
        """Return (|85| - limit) over the size of its gradient."""
        w2 = ratio2 * radius**2
        length = np.sqrt(w2 + zeta2)
        with np.errstate(all="ignore"):
            slope = np.sqrt(ratio2 * w2 + zeta2) / length
            return np.where(length > 0.0, (length - limit) / slope, -limit)

    position = bounds.position
    if bounds.turn <= 0.0:  # every position is singular, the center least of all
        position = position - 2.0 * np.abs(position).max()
    limits = {
        Limit.STRETCHED: -bars(bounds.far, g.crank_length + g.coupler_length),
        Limit.FOLDED: bars(bounds.near, abs(g.coupler_length - g.crank_length)),
        Limit.GUIDE: g.stroke * (g.magnification - 1) - bounds.far,
        Limit.AXIS: bounds.near - g.axis_clearance,
    }
    least, code = position, np.full(position.shape, SINGULAR, np.uint8)
    for limit, distance in limits.items():
        leg = bounds.far_leg if limit in (Limit.STRETCHED, Limit.GUIDE) else bounds.near_leg
        nearer = distance < least
        tag = FIRST_REACH + len(MARGINS) * leg + MARGINS.index(limit)
        least, code = np.where(nearer, distance, least), np.where(nearer, tag, code)
    return least, code.astype(np.uint8)


def margin_slope(margin: Array) -> Array:
    """Return the size of a margin's gradient (x, y, z) [a node's distance], at least.

    Of the two differences along an axis the larger counts; what is not finite does not.
    """
    finite = np.where(np.isfinite(margin), margin, np.nan)
    squared = np.zeros(margin.shape)
    for axis in range(3):
        change = np.diff(finite, axis=axis)
        np.abs(change, out=change)
        slope = np.zeros(margin.shape)
        for part in (slice(None, -1), slice(1, None)):
            view = slope[(slice(None),) * axis + (part,)]
            np.fmax(view, change, out=view)
        slope *= slope
        squared += slope
    return np.sqrt(squared, out=squared)


def margin_distance(margin: Array, slope: Array, step: float) -> Array:
    """Return a margin over its slope, the distance to where it is zero to first order [m].

    NaN where the margin is NaN; where it is infinite, a step on its side.

    Args:
        margin: (x, y, z) on nodes.
        slope: (x, y, z) as of `margin_slope`.
        step: Distance of the nodes [m].
    """
    # A constant margin has no slope, and is as far away as can be.
    far = step * max(margin.shape)
    with np.errstate(all="ignore"):
        found = margin * (step / slope)
    np.clip(found, -far, far, out=found)
    np.copysign(step, margin, out=found, where=np.isinf(margin))
    found[margin == 0.0] = 0.0
    return found


def zero_surface(depth: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return the closed surface where a depth is zero: vertices [nodes] and faces.

    By marching cubes (Lorensen and Cline 1987), so that each vertex is on an edge of the grid.
    Beyond the last nodes is outside, and the faces' normals point there.

    Args:
        depth: (x, y, z) on nodes, above zero inside; somewhere it is.
    """
    # Late: needed only where there is a volume.
    from skimage.measure import marching_cubes

    size = float(np.abs(depth).max())
    edge = np.pad(depth, 1, constant_values=-size)
    # A surface through a node itself would have faces without area there, and gaps between them.
    edge[np.abs(edge) < _THROUGH_A_NODE * size] = _THROUGH_A_NODE * size
    vertices, faces, *_ = marching_cubes(edge, 0.0, method="lorensen", gradient_direction="ascent")
    return vertices.astype(float) - 1.0, faces.astype(np.int64)
