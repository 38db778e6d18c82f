"""The volume where requirements hold: positions and heights where they do for every heading."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on, of_part
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.causes import (
    DISCONNECTED,
    FIRST_REACH,
    FIRST_REQUIREMENT,
    INSIDE,
    OTHER_SIDE,
    SINGULAR,
    VolumeCause,
    causes_of,
    margin_distance,
    margin_slope,
    reach_distances,
)
from paminsa_viz.synthesis.volume.grid import FINE, Resolution, axes_of, home_side, joined_to_home
from paminsa_viz.synthesis.volume.margins import heading_margins, headings
from paminsa_viz.synthesis.volume.measure import VolumeNodes, measure
from paminsa_viz.synthesis.volume.reach import can_be_taken, reach_bounds, takes_own_headings


@dataclass(frozen=True, eq=False)
class Volume:
    """Where every requirement holds for every heading, joined to home.

    Arrays lie on a grid of nodes and have the shape (x, y, z).

    Attributes:
        design, requirements: What it was solved for.
        x, y, z: Coordinates of the nodes, equally spaced [m].
        headings: Sampled headings over each range that is more than one heading.
        cause: Code of the cause at each node: the index of an entry of ``causes``; 0 inside.
        causes: What the codes mean.
        reached_margins: (requirements, nodes) least margin of each requirement over its headings
            at the nodes of ``reachable`` [SI]; minus infinite where there is no value.
        depth: Estimated distance to what ends the volume, negative outside of it [m]; the surface
            is where it is zero.
        nearest: Code of the cause that ends the volume next to a node inside; elsewhere the cause.
        reachable: Nodes whose poses can be taken with every heading, joined to home.
        volume: [m^3], see `volume.measure`.
        error: Three standard deviations of the samples, what every second heading changes, and
            parts that may be joined by a neck thinner than the cells [m^3].
        reachable_volume: Volume of the reachable body [m^3].
        home_inside: Whether home is in the volume. If not, it is the largest connected part that
            can be reached from home.
    """

    design: Design
    requirements: Requirements
    x: Array
    y: Array
    z: Array
    headings: int
    cause: NDArray[np.uint8]
    causes: tuple[VolumeCause, ...]
    reached_margins: Array
    depth: Array
    nearest: NDArray[np.uint8]
    reachable: NDArray[np.bool_]
    volume: float
    error: float
    reachable_volume: float
    home_inside: bool

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Nodes of the volume."""
        return self.cause == INSIDE

    @property
    def empty(self) -> bool:
        """Whether no node meets all requirements."""
        return not self.inside.any()

    @property
    def cell(self) -> float:
        """Distance of the nodes [m]; of those next to the axis, where it is not rounded."""
        middle = self.x.size // 2
        return float(self.x[middle + 1] - self.x[middle])

    @property
    def sampled_headings(self) -> int:
        """How many headings the requirements were sampled at: one if all are for one heading."""
        needed = self.requirements
        ranges = [needed.headings(bound) for bound in needed.bounds] or [needed.theta]
        return max(len(headings(limits, self.headings)) for limits in ranges)

    @property
    def reachable_share(self) -> float:
        """Share of the reachable volume; NaN where nothing can be reached."""
        return self.volume / self.reachable_volume if self.reachable_volume > 0 else float("nan")

    @property
    def margins(self) -> Array:
        """``reached_margins`` at all nodes (requirements, x, y, z) [SI]; NaN out of reach."""
        found = np.full((len(self.reached_margins), *self.reachable.shape), np.nan)
        found[:, self.reachable] = self.reached_margins
        return found

    @property
    def met(self) -> NDArray[np.bool_]:
        """Where each requirement is met, (requirements, x, y, z); False out of reach."""
        return self.margins >= 0.0

    @cached_property
    def removed_alone(self) -> Array:
        """Share of the reachable nodes at which each requirement is broken (requirements,)."""
        met = self.reached_margins >= 0.0
        return 1.0 - met.sum(axis=1) / max(1, met.shape[1])

    @cached_property
    def removed_last(self) -> Array:
        """Share of the reachable nodes at which each is the only one broken (requirements,)."""
        broken = ~(self.reached_margins >= 0.0)
        only = broken.sum(axis=0) == 1
        return (broken & only).sum(axis=1) / max(1, broken.shape[1])

    def shares(self) -> dict[VolumeCause, float]:
        """Return what share of the reachable nodes each cause takes, those that take any."""
        codes = np.bincount(self.cause[self.reachable], minlength=len(self.causes))
        count = max(1, int(self.reachable.sum()))
        return {self.causes[code]: codes[code] / count for code in np.flatnonzero(codes)}


@of_design
def solve_volume(
    design: Design,
    requirements: Requirements,
    *,
    resolution: Resolution = FINE,
    both_sides: bool = False,
    progress: Progress = go_on,
) -> Volume:
    """Find where every requirement holds for its whole range of headings, joined to home.

    Reach and singularity are decided for the whole range in closed form; quantities at the sampled
    headings. A node belongs to the volume if each of its poses can be taken, none is singular nor
    beyond a singularity from home, and every requirement is met; and if a path of such nodes joins
    it to home (`model.reach.home_pose`).

    Args:
        design: The robot.
        requirements: What has to hold.
        resolution: How finely to sample.
        both_sides: Whether heights on the other side of the guides than home count.
        progress: Is told what part is done, and may end it.

    Raises:
        Canceled: If ``progress`` says so.
    """
    x, z, headings = axes_of(design, requirements, resolution, both_sides)
    step = float(x[1] - x[0])
    g = design.geometry
    bounds = reach_bounds(g, x[:, None, None], x[None, :, None], requirements.theta)
    margin, which = bounds.margin(z)
    side = home_side(g, z, both_sides)
    reached = can_be_taken(margin, which)
    del margin  # as large as all that is kept of a requirement
    takes = reached & bounds.regular & (side >= 0.0)
    reachable = joined_to_home(takes, x, z, g)[0]
    margins = _margins(design, requirements, x, z, reachable, headings, progress)
    met = (margins >= 0.0).all(axis=0) & reachable
    inside, home_inside = joined_to_home(met, x, z, g)

    body, nearest = reach_distances(bounds, z)
    nearest = np.where(side < body, np.uint8(OTHER_SIDE), nearest)
    body = np.minimum(body, side)
    body = np.where(reachable, np.maximum(body, 0.0), -np.abs(body))
    least, worst = _distances(requirements, margins, z, step)
    reached_margins = margins[:, reachable]
    nearest = np.where(least < body, FIRST_REQUIREMENT + worst, nearest).astype(np.uint8)
    depth = np.fmin(body, least)
    depth = np.where(inside, np.maximum(depth, 0.0), -np.abs(depth))
    del margins, least  # half of the memory, while the volume is measured

    cause = np.full(takes.shape, INSIDE, np.uint8)
    cause[~inside] = DISCONNECTED
    cause = np.where(reachable & ~met, FIRST_REQUIREMENT + worst, cause).astype(np.uint8)
    cause[np.broadcast_to(~bounds.regular, cause.shape)] = SINGULAR
    cause = np.where(reached, cause, FIRST_REACH + which).astype(np.uint8)
    cause[..., side < 0.0] = OTHER_SIDE

    nodes = VolumeNodes(x, z, inside, met & ~inside, depth, reachable, body)
    measured = measure(
        design, requirements, nodes, headings, both_sides, resolution.budget, progress
    )
    return Volume(
        design, requirements, x, x, z, headings, cause, causes_of(requirements),
        reached_margins, depth, np.where(inside, nearest, cause), reachable, measured.volume,
        measured.error, measured.reachable, home_inside,
    )  # fmt: skip


BLOCK = 512
"""Positions whose margins are worked out at a time."""


def _margins(
    design: Design,
    requirements: Requirements,
    x: Array,
    z: Array,
    reachable: NDArray[np.bool_],
    headings: int,
    progress: Progress,
) -> Array:
    """Return the margins on the nodes (requirements, x, y, z); NaN out of reach."""
    found = np.full((len(requirements.bounds), *reachable.shape), np.nan)
    columns = reachable.any(axis=2)
    if not columns.any() or not requirements.bounds:
        return found
    used = np.flatnonzero(reachable.any(axis=(0, 1)))
    heights = slice(int(used[0]), int(used[-1]) + 1)
    index = np.nonzero(columns)
    positions = np.column_stack([x[index[0]], x[index[1]]])
    for start in range(0, len(positions), BLOCK):
        part = slice(start, min(start + BLOCK, len(positions)))
        share = of_part(progress, part.start / len(positions), part.stop / len(positions))
        solved, _ = heading_margins(
            design, requirements, positions[part], z[heights], headings, share
        )
        found[:, index[0][part], index[1][part], heights] = solved
    for number, bound in enumerate(requirements.bounds):
        if bound.theta is not None:  # it has no value where these headings cannot be taken
            own = takes_own_headings(design.geometry, x[:, None, None], x[None, :, None], z, bound)
            found[number][~own] = -np.inf
    found[:, ~reachable] = np.nan
    return found


def _distances(
    requirements: Requirements, margins: Array, z: Array, step: float
) -> tuple[Array, NDArray[np.uint8]]:
    """Return the least distance to where a requirement breaks (x, y, z) [m], and which does."""
    least = np.full(margins.shape[1:], np.inf)
    worst = np.zeros(margins.shape[1:], np.uint8)
    for number, bound in enumerate(requirements.bounds):
        distance = margin_distance(margins[number], margin_slope(margins[number]), step)
        if bound.z is not None:
            distance = np.maximum(distance, np.maximum(bound.z[0] - z, z - bound.z[1]))
        nearer = distance < least
        least[nearer], worst[nearer] = distance[nearer], number
    return least, worst
