"""How large a volume is: cells away from its surface as a whole, those at it by samples.

Each node of a grid stands for the cube about it. Points are drawn in the cubes where the surface
may pass and checked as the nodes are. What a node's estimated depth says of its cube is a control
variate: the samples correct it on average, so the result has no bias by the cells' size, however
the surface is curved, and its standard deviation follows from them. Fewer headings make a volume
larger, by an amount that falls with the square of their distance: the limit is extrapolated from
all and from every second one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.grid import home_side
from paminsa_viz.synthesis.volume.margins import heading_margins, time_per_position
from paminsa_viz.synthesis.volume.reach import can_be_taken, reach_bounds, takes_own_headings

_BAND = 1.25
"""Depth up to which a node's cube is sampled [cells]; its corners are 0.87 away."""

_EACH = 2
"""Points a cube, where the time suffices."""

_NECK = 3
"""Nodes between two parts up to which a neck may be hidden between them."""

_LEAST = 200
"""Points, however long they take."""

_DEVIATIONS = 3.0
"""Standard deviations that are stated as the error."""

_SEED = 5
"""Of the points: the same volume comes out every time."""

Holds = NDArray[np.bool_]


class VolumeNodes(NamedTuple):
    """What is known at the nodes of a grid; arrays are (x, y, z).

    Attributes:
        x, z: Coordinates of the nodes; y has those of x [m].
        inside: Nodes of the volume.
        apart: Nodes where all requirements hold that are not joined to it.
        depth: Estimated distance to what ends the volume [m].
        reachable: Nodes of the reachable body.
        body: Estimated distance to what ends the reachable body [m].
    """

    x: Array
    z: Array
    inside: Holds
    apart: Holds
    depth: Array
    reachable: Holds
    body: Array


@dataclass(frozen=True)
class Measured:
    """Sizes of a volume, with its error, and of the reachable body [m^3]."""

    volume: float
    error: float
    reachable: float


@dataclass(frozen=True)
class _Surface:
    """Cubes at the surface of a body, and points that are drawn in them.

    Attributes:
        whole: Cubes of the body away from its surface.
        cubes: Cubes at the surface.
        expected: What share of the cubes at the surface belongs to the body, by the depth at their
            nodes, on average.
        share: (n,) that of the cube of each point.
        points: (n, 3) [m].
    """

    whole: float
    cubes: int
    expected: float
    share: Array
    points: Array

    @classmethod
    def of(
        cls, nodes: VolumeNodes, inside: Holds, apart: Holds, depth: Array, count: float
    ) -> _Surface:
        """Draw ``count`` points or so, up to some in each cube at the surface of a body."""
        # Late: it takes a third of a second to load.
        from scipy import ndimage

        rng = np.random.default_rng(_SEED)
        step = float(nodes.x[1] - nodes.x[0])
        near = (
            np.asarray(ndimage.binary_dilation(inside, np.ones((3, 3, 3), np.bool_)), np.bool_)
            & ~apart
        )
        edge = (np.abs(depth) < _BAND * step) & near
        share = np.clip(0.5 + depth / step, 0.0, 1.0)[edge]
        index = np.argwhere(edge)
        if len(index) <= count:
            each = int(min(_EACH, count // max(1, len(index))))
            drawn = np.tile(np.arange(len(index)), each)
            level = np.repeat(np.arange(each), len(index))
        else:
            each, level = 1, np.zeros(int(count))
            drawn = rng.choice(len(index), int(count), replace=False)
        i, j, k = index[drawn].T
        offset = rng.uniform(size=(len(drawn), 3))
        offset[:, 2] = (level + offset[:, 2]) / each  # one in each layer of a cube
        points = np.column_stack([nodes.x[i], nodes.x[j], nodes.z[k]]) + step * (offset - 0.5)
        expected = float(share.mean()) if len(share) else 0.0
        return cls(float((inside & ~edge).sum()), len(index), expected, share[drawn], points)

    def size(self, holds: Holds) -> tuple[float, float]:
        """Return the cubes of the body and their standard deviation, given which points are in."""
        if not self.cubes:
            return self.whole, 0.0
        off = holds - self.share
        deviation = self.cubes * float(np.sqrt((off**2).mean() / len(off)))
        return self.whole + self.cubes * (self.expected + float(off.mean())), deviation


def measure(
    design: Design,
    requirements: Requirements,
    nodes: VolumeNodes,
    count: int,
    both_sides: bool,
    budget: float,
    progress: Progress = go_on,
) -> Measured:
    """Return how large a volume is.

    Args:
        design: The robot.
        requirements: What has to hold.
        nodes: What is known on the grid.
        count: Headings over a range.
        both_sides: Whether heights on the other side of the guides than home count.
        budget: Time that costly quantities may take [s]; they get fewer points where it is short.
        progress: Is told that work goes on, and may end it.

    Raises:
        Canceled: If ``progress`` says so.
    """

    def still(done: float, /, **known: Any) -> bool | None:
        """Tell that work goes on; the nodes before have told how far it is."""
        return progress(1.0, **known)

    cube = float(nodes.x[1] - nodes.x[0]) ** 3
    none = np.zeros(nodes.inside.shape, np.bool_)
    rim = _Surface.of(nodes, nodes.reachable, none, nodes.body, np.inf)
    reachable, deviation = rim.size(_taken(design, requirements, rim.points, both_sides))
    if not requirements.bounds:
        return Measured(cube * reachable, _DEVIATIONS * cube * deviation, cube * reachable)
    each = time_per_position(design, requirements, count, 1)
    affordable = max(_LEAST, 0.5 * budget / each) if each > 0.0 else np.inf
    edge = _Surface.of(nodes, nodes.inside, nodes.apart, nodes.depth, affordable)
    holds = _taken(design, requirements, edge.points, both_sides)
    looser = holds.copy()
    taken = holds.copy()
    holds[taken], looser[taken] = _met(design, requirements, edge.points[taken], count, still)
    volume, deviation = edge.size(holds)
    fewer = edge.size(looser)[0] - volume
    volume = min(volume - fewer / 3.0, reachable)
    error = _DEVIATIONS * deviation + fewer + _uncertain(nodes)
    return Measured(cube * max(volume, 0.0), cube * error, cube * reachable)


def _uncertain(nodes: VolumeNodes) -> float:
    """Return the nodes of parts that a neck thinner than the cells may join to the volume."""
    # Late: it takes a third of a second to load.
    from scipy import ndimage

    if not nodes.apart.any():
        return 0.0
    cube = np.ones((3, 3, 3), np.bool_)
    parts = np.empty(nodes.apart.shape, np.int32)
    ndimage.label(nodes.apart, cube, output=parts)
    close = np.asarray(ndimage.binary_dilation(nodes.inside, cube, _NECK), np.bool_)
    near = parts[close]
    return float(np.isin(parts, near[near > 0]).sum())


def _taken(design: Design, requirements: Requirements, points: Array, both_sides: bool) -> Holds:
    """Return which points (n, 3) belong to the reachable body."""
    x, y, z = points.T
    bounds = reach_bounds(design.geometry, x, y, requirements.theta)
    on_side = home_side(design.geometry, z, both_sides) >= 0.0
    return can_be_taken(*bounds.margin(z)) & bounds.regular & on_side


def _met(
    design: Design, requirements: Requirements, points: Array, count: int, progress: Progress
) -> tuple[Holds, Holds]:
    """Return where requirements are met at points (n, 3), for all and for every second heading."""
    level = np.zeros(1)
    found = heading_margins(
        design, requirements, points[:, :2], level, count, progress, lift=points[:, 2]
    )
    own, (x, y, z) = np.ones(len(points), np.bool_), points.T
    for bound in requirements.bounds:
        if bound.theta is not None:
            own &= takes_own_headings(design.geometry, x, y, z, bound)
    every, second = ((margins[..., 0] >= 0.0).all(axis=0) & own for margins in found)
    return every, second
