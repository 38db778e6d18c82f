"""The grid of a volume: how fine it is, what it spans, and what of it is joined to home."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry, KneeBranch
from paminsa_viz.model.reach import home_pose, workspace_radius
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.margins import time_per_position
from paminsa_viz.synthesis.volume.reach import cosine_range


@dataclass(frozen=True)
class Resolution:
    """How finely a volume is sampled.

    Attributes:
        nodes: Nodes of the box around what can be reached, at most.
        headings: Headings over a range; an odd number.
        budget: Time that costly quantities may take [s]; they get larger cells where it is short.
    """

    nodes: int
    headings: int
    budget: float

    def __post_init__(self) -> None:
        if self.nodes < 64 or self.headings < 3 or self.headings % 2 == 0:
            problem = "64 nodes or more, and an odd number of headings from 3 on, are needed"
            raise InvalidInput("resolution", problem)


COARSE = Resolution(8_000, 5, 0.06)
"""While a length is changed: some ten milliseconds."""

FINE = Resolution(600_000, 17, 5.0)
"""About 10^7 poses."""


_LEAST_NODES = 300
"""Nodes of a volume of the costliest quantities."""


_MOST_OF_NODES, _LEAST_GRID = 3.0, 5_000
"""How many times the nodes asked for a grid has at most, besides how many that any grid may have.

In a body as thin as a needle, of R_pl nearly R_b, most nodes lie beyond it.
"""

_FEW_NODES = 0.1
"""Share of the nodes asked for below which headings are left out as well."""


def axes_of(
    design: Design, requirements: Requirements, resolution: Resolution, both_sides: bool
) -> tuple[Array, Array, int]:
    """Return the nodes along x (and y) and along z, and how many headings there are.

    One node at least lies beyond all that can be reached. Costly quantities get fewer nodes, and
    where these are very few also fewer headings.
    """
    g = design.geometry
    nearest = np.arccos(np.clip(cosine_range(*requirements.theta)[1], -1.0, 1.0))
    offset = float(singular_radius(g, nearest))
    radius = min(workspace_radius(g), offset)
    bars = g.crank_length + g.coupler_length
    height = np.sqrt(max(bars**2 - (g.span_ratio * offset) ** 2, 0.0))
    if not (radius > 0.0 and height > 0.0):  # nothing can be reached
        radius, height = max(radius, 0.1 * g.base_radius), max(height, 0.1 * bars)
    low, high = -height - g.platform_joint_height, height - g.platform_joint_height
    if not both_sides:
        end = side_end(g)
        low, high = (low, min(high, end)) if g.knee is KneeBranch.LOWER else (max(low, end), high)
    high = max(high, low + 0.1 * bars)
    size = (2.0 * radius) ** 2 * (high - low)
    step = float(np.cbrt(size / resolution.nodes))
    heights = max(2, round((high - low) / step))
    headings, nodes = resolution.headings, float(resolution.nodes)
    while True:
        each = time_per_position(design, requirements, headings, heights) / heights
        if each > 0.0:
            nodes = max(_LEAST_NODES, min(resolution.nodes, resolution.budget / each))
        if headings <= COARSE.headings or nodes >= _FEW_NODES * resolution.nodes:
            break
        headings = (headings - 1) // 4 * 2 + 1
    step = float(np.cbrt(size / nodes))
    while True:
        half = int(np.ceil(radius / step)) + 1
        count = int(np.ceil((high - low) / step)) + 3
        count += 1 - count % 2  # odd, so that every second node reaches the ends
        if (2 * half + 1) ** 2 * count <= _MOST_OF_NODES * nodes + _LEAST_GRID:
            break
        step *= 1.1
    middle = 0.5 * (low + high)
    z = middle + step * (np.arange(count) - (count - 1) / 2)
    return np.asarray(step * np.arange(-half, half + 1), np.float64), z, headings


def side_end(geometry: Geometry) -> float:
    """Return the height of P at which all of the platform has left home's side of the guides [m].

    Hanging, P is the last of it below them; with the upper knee the joints 5 are the last above
    them, so that home is on its side however far they are above P.
    """
    return 0.0 if geometry.knee is KneeBranch.LOWER else -geometry.platform_joint_height


def home_side(geometry: Geometry, z: Array, both_sides: bool) -> Array:
    """Return how far heights of P are from the end of home's side, positive on it [m]."""
    if both_sides:
        return np.full(z.shape, np.inf)
    beyond = z - side_end(geometry)
    return -beyond if geometry.knee is KneeBranch.LOWER else beyond


def joined_to_home(
    nodes: NDArray[np.bool_], x: Array, z: Array, geometry: Geometry
) -> tuple[NDArray[np.bool_], bool]:
    """Return the nodes that are joined to home, or the largest part if home is not among them."""
    # Late: it takes a third of a second to load.
    from scipy import ndimage

    labels = np.empty(nodes.shape, np.int32)
    count = int(np.asarray(ndimage.label(nodes, output=labels)))
    if count == 0:
        return np.zeros(nodes.shape, np.bool_), False
    middle = len(x) // 2
    home = labels[middle, middle, int(np.abs(z - home_pose(geometry)[3]).argmin())]
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return labels == (home or sizes.argmax()), bool(home)
